"""Exudyn with one coordinate for every body to which the ground leaves no more: the same from fewer unknowns."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import scenes
from scenes import Sampling
from scenes.motion import channels
from scenes.scene import MotionLaw
from sim_models.exudyn.engine import DEFAULT, build
from sim_models.exudyn.equations import Equations
from sim_models.exudyn.reduced import ReducedSystem
from tests.absolute_coordinates import solve

from .helpers import check, errors, referred, run, write
from .mechanisms import FOUR_BAR, SCENES, THREE_AT_A_PIN
from .test_joints import KNOTTED, SMOOTH

IN_PAIRS = replace(DEFAULT, reduced=True)

# Two rockers on one pin of the ground, both with their centres of mass off it, one held by a spring and one loaded.
SHARED_PIVOT = FOUR_BAR.replace(
    '[drive]\nbody = "crank"',
    """[bodies.link]
lengths = { "T-U" = 2.5 }
mass = 1
[bodies.other]
points = { D = [0.4, 0.1], U = [2.6, 0.3], V = [1.5, 1] }
mass = 3
com = [1.2, 0.7]
inertia = 0.5
[[springs]]
between = ["ground.A", "other.V"]
stiffness = 40
length = 0.5
[[loads]]
body = "other"
at = "V"
force = [20, 60]
[drive]
body = "crank\"""",
).replace("C = [3.4, 3.9]", "C = [3.4, 3.9]\nT = [1.7, 3.8]\nU = [4.2, 4.4]")


def reduced(text: str, folder: Path) -> tuple[int, int, set[str], set[str]]:
    """Return how many coordinates and constraints are left, and which bodies have but one coordinate."""
    system = ReducedSystem(write(folder, text))
    return system.unknowns, system.counts()["constraints"], set(system.pivots), set(system.sliders)


@pytest.mark.parametrize("name", SCENES)
def test_mechanism(name: str) -> None:
    scene, reference = referred(name)
    motion = run(scene, IN_PAIRS, samples=60)
    assert set(motion.samples) == set(channels(scene))
    check(errors(scene, motion, reference), KNOTTED if isinstance(scene.drive, MotionLaw) else SMOOTH)


def test_bodies_that_share_a_pivot(tmp_path: Path) -> None:
    scene = write(tmp_path, SHARED_PIVOT)
    reference = solve(scene, *scene.drive.at(Sampling(60).times(scene)))
    check(errors(scene, run(scene, IN_PAIRS, samples=60), reference), SMOOTH)
    assert reduced(SHARED_PIVOT, tmp_path) == (9, 9, {"crank", "rocker", "other"}, set())


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


def test_what_stays_a_whole_body(tmp_path: Path) -> None:
    """On a wedge another body slides; a disc slides on what turns; a coupler turns about no pin of the ground."""
    assert reduced(SCENES["wedge"], tmp_path) == (7, 7, set(), {"follower"})
    assert reduced(SCENES["oldham"], tmp_path) == (7, 7, {"crank"}, set())
    assert reduced(SCENES["swinging_block"], tmp_path) == (5, 5, {"crank", "block"}, set())
    assert reduced(THREE_AT_A_PIN, tmp_path) == (9, 9, {"crank", "rocker"}, {"slider"})


def test_no_force_is_found_where_none_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Equations, "forces", None)
    motion = run(scenes.load("toggle_press"), IN_PAIRS, channels=frozenset({"P5.ay"}))
    assert set(motion.samples) == {"time", "crank_angle", "P5.ay"}
