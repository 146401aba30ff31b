"""Friction in the Exudyn model, against statics by hand, powers, and equations written in the tests."""

from functools import cache
from math import log2
from typing import Any

import numpy as np
import pytest

from scenes import Failure, Motion, Sampling, Scene
from sim_models.exudyn.engine import LONG_WORK_PRECISION, WORK_PRECISION
from sim_models.exudyn.friction import JointFriction
from sim_models.exudyn.settings import TimeStepping
from tests import scene_files
from tests.absolute_coordinates import solve
from tests.agreement import errors, worst
from tests.friction_scenes import everywhere

from .helpers import run

SAMPLES = 12


@cache
def referred(scene: Scene) -> dict[str, Any]:
    """Its motion from equations written in the tests."""
    times = Sampling(SAMPLES).times(scene)
    return solve(scene, *scene.drive.law.at(times), times)


def off(motion: Motion, expected: dict[str, Any]) -> float:
    return max(worst(errors(motion, expected)).values())


@pytest.mark.parametrize("family", ["generalised-alpha 0.5", "generalised-alpha 0.8, extrapolated"])
def test_order(family: str) -> None:
    """It is that of the reactions without friction."""
    scene = everywhere(scene_files.load("toggle_press"), 0.1)
    every = [*WORK_PRECISION, *LONG_WORK_PRECISION]
    members = {s.steps: s for s in every if isinstance(s, TimeStepping) and s.family == family}
    coarse, fine = (off(run(scene, members[steps], SAMPLES), referred(scene)) for steps in (72, 144))
    order = members[72].order
    assert order is not None
    assert abs(log2(coarse / fine) - order) <= 0.35


def test_senses_at_rest_are_those_of_the_motion_that_is_prescribed() -> None:
    """The trapezoidal rule is off by 0.004 of the range where a rod is at rest on another body: no friction there."""
    scene = everywhere(scene_files.load("telescope"), 0.1)
    loose = next(settings for settings in WORK_PRECISION if settings.label == "trapezoidal, loose Newton, 72")
    assert off(run(scene, loose, SAMPLES), referred(scene)) <= 0.05


def test_a_solution_that_does_not_go_back_to_none_is_none() -> None:
    """Newton's method in one step finds forces that are 20 times larger, of a branch that begins at infinity."""
    joints = object.__new__(JointFriction)
    joints._pins, joints._bend, joints._slope = np.array([False, True, True, True]), np.zeros(4), np.ones(4)
    joints._scene = scene_files.load("crank")
    r0 = [[-0.4, -2.7], [-1.4, 0.0], [2.0, 0.0], [0.6, 0.0]]
    K = [
        [[-1.2, 0.3], [-0.1, -0.7], [0.3, 0.0], [1.3, -1.0]],
        [[-0.4, 0.0], [-0.2, 0.3], [0.4, 0.2], [0.0, -0.3]],
        [[0.1, 0.4], [0.1, -0.9], [0.8, -0.2], [0.4, -0.2]],
        [[0.5, -0.1], [0.7, 0.6], [-0.3, -1.3], [0.2, -0.4]],
    ]
    sense = np.array([[1.0, -1.0, -1.0, 1.0]])
    with pytest.raises(Failure, match=r"past 0\.6623 of"):
        joints._followed(np.array([r0]), np.array([K]), sense, np.zeros(1))
