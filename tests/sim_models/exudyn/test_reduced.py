"""Exudyn with one coordinate for every body to which the ground leaves no more: the same from fewer unknowns."""

from dataclasses import replace

import numpy as np
import pytest

import scenes
from scenes import Sampling
from scenes.motion import channels
from sim_models.exudyn.drive import HeldDrive
from sim_models.exudyn.engine import DEFAULT, build
from sim_models.exudyn.equations import Equations
from sim_models.exudyn.reduced import ReducedSystem
from tests import scene_files

from .helpers import NAMES, by_level, check, referred, run
from .test_joints import SMOOTH

IN_PAIRS = replace(DEFAULT, reduced=True)


def reduced(name: str) -> tuple[int, int, set[str], set[str]]:
    """Return how many coordinates and constraints are left, and which bodies have but one coordinate."""
    system = ReducedSystem(scene_files.load(name), HeldDrive(0.0))
    return system.unknowns, system.counts()["constraints"], set(system.pivots), set(system.sliders)


@pytest.mark.parametrize("name", NAMES)
def test_mechanism(name: str) -> None:
    scene, reference = referred(name)
    motion = run(scene, IN_PAIRS, samples=60)
    assert set(motion.samples) == set(channels(scene))
    check(by_level(motion, reference), SMOOTH)


def test_bodies_that_share_a_pivot() -> None:
    scene, reference = referred("shared_pivot")
    check(by_level(run(scene, IN_PAIRS, samples=60), reference), SMOOTH)
    assert reduced("shared_pivot") == (9, 9, {"crank", "rocker", "other"}, set())


def test_toggle_press_has_9_and_9_unknowns_and_the_same_motion() -> None:
    scene = scenes.load("toggle_press")
    motions = []
    for settings, unknowns in ((IN_PAIRS, 9), (DEFAULT, 15)):
        simulation = build(scene, settings, Sampling(72, 2))
        simulation.solve()
        assert simulation.counters["coordinates"] == simulation.counters["constraints"] == unknowns
        motions.append(simulation.read())
    for channel in channels(scene):
        one, other = (motion[channel] for motion in motions)
        # what DEFAULT promises of forces; of what is zero, 1 um or 1 uN
        assert np.abs(one - other).max() <= 1e-6 * max(1, np.abs(other).max()), channel


def test_what_stays_a_whole_body() -> None:
    """On a wedge another body slides; a disc slides on what turns; a coupler turns about no pin of the ground."""
    assert reduced("wedge") == (7, 7, set(), {"follower"})
    assert reduced("oldham") == (7, 7, {"crank"}, set())
    assert reduced("swinging_block") == (5, 5, {"crank", "block"}, set())
    assert reduced("three_at_a_pin") == (9, 9, {"crank", "rocker"}, {"slider"})


def test_no_force_is_found_where_none_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Equations, "forces", None)
    motion = run(scenes.load("toggle_press"), IN_PAIRS, channels=frozenset({"P5.ay"}))
    assert set(motion.samples) == {"time", "crank_angle", "P5.ay"}
