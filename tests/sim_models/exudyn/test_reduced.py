"""Exudyn with one coordinate for every body to which the ground leaves no more; `test_joints` has its motion."""

from dataclasses import replace

import pytest

import scenes
from sim_models.exudyn.ablations import ReducedSystem
from sim_models.exudyn.drive import ExudynDrive
from sim_models.exudyn.engine import DEFAULT
from sim_models.exudyn.equations import Equations
from tests import scene_files

from .helpers import run


@pytest.mark.parametrize(
    ("name", "left", "pivots", "sliders"),
    [
        ("toggle_press", 9, {"crank", "rocker"}, {"slider"}),  # of 15 each
        ("shared_pivot", 9, {"crank", "rocker", "other"}, set()),
        ("wedge", 7, set(), {"follower"}),  # on the wedge another body slides
        ("oldham", 7, {"crank"}, set()),  # a disc slides on what turns
        ("swinging_block", 5, {"crank", "block"}, set()),
        ("three_at_a_pin", 9, {"crank", "rocker"}, {"slider"}),  # a coupler turns about no pin of the ground
    ],
)
def test_what_is_left(name: str, left: int, pivots: set[str], sliders: set[str]) -> None:
    system = ReducedSystem(scene_files.load(name), ExudynDrive(0.0))
    assert system.unknowns == system.counts()["coordinates"] == system.counts()["constraints"] == left
    assert (set(system.pivots), set(system.sliders)) == (pivots, sliders)


def test_no_force_is_found_where_none_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Equations, "forces", None)
    motion = run(scenes.load("toggle_press"), replace(DEFAULT, reduced=True), channels=frozenset({"P5.ay"}))
    assert set(motion.samples) == {"time", "crank_angle", "P5.ay"}
