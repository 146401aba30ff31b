"""Friction in the Exudyn model, against statics by hand, powers, and equations written in the tests."""

from dataclasses import replace
from functools import cache
from math import log2
from typing import Any

import numpy as np
import pytest

from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.model.motion import channels, friction_channels
from sim_models.exudyn.engine import DEFAULT, EXACT, LONG_WORK_PRECISION, WORK_PRECISION
from sim_models.exudyn.friction import JointFriction
from sim_models.exudyn.settings import TimeStepping
from tests import scene_files
from tests.absolute_coordinates import solve
from tests.absolute_friction import JammedError
from tests.agreement import errors, worst
from tests.friction_scenes import drawer, everywhere

from .helpers import BOTH_ROUTES, run

SAMPLES = 12
# Guides that turn, a cylinder and an elbow that drive, three bodies at a pin, a driven slider, a group that is no dyad.
JOINTS = ("rocking_guide", "gas_spring", "lift", "elbow", "three_at_a_pin", "slotted_class_iii", "toggle_press")
MORE = ("servo_press", "excavator_bucket", "walking_leg", "swinging_segments", "busy_bucket", "class_iii", "wedge")
ALL = (*JOINTS, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE))
EASY = {EXACT: 1e-9, DEFAULT: 1e-4}  # measured 1e-10, by differences, and 1e-5


@cache
def referred(scene: Scene) -> dict[str, Any]:
    """Its motion from equations written in the tests."""
    times = Sampling(SAMPLES).times(scene)
    return solve(scene, *scene.drive.law.at(times), times)


def off(motion: Motion, expected: dict[str, Any]) -> float:
    return max(worst(errors(motion, expected)).values())


@pytest.mark.parametrize("settings", [EXACT, pytest.param(DEFAULT, marks=pytest.mark.slow)], ids=["exact", "steps"])
@pytest.mark.parametrize("name", ALL)
def test_every_channel(name: str, settings: TimeStepping) -> None:
    scene = everywhere(scene_files.load(name), 0.1)
    motion = run(scene, settings, SAMPLES)
    assert set(motion.samples) == set(channels(scene))
    assert off(motion, referred(scene)) <= EASY[settings]


@pytest.mark.parametrize("more", [{"viscous": 3.0}, {"smooth": 0.7}, {"viscous": 5.0, "smooth": 2.0}])
def test_viscous_and_smooth(more: dict[str, float]) -> None:
    scene = everywhere(scene_files.load("rocking_guide"), 0.15, **more)
    assert off(run(scene, EXACT, SAMPLES), referred(scene)) <= EASY[EXACT]
    assert off(run(scene, EXACT, SAMPLES), referred(everywhere(scene, 0.15))) >= 1e-3  # it matters


@BOTH_ROUTES
@pytest.mark.parametrize("name", ["lift", pytest.param("servo_press", marks=pytest.mark.slow)])
def test_the_drive_pays_for_friction(name: str, settings: TimeStepping) -> None:
    """Its power is more than without friction by just what friction takes, since nothing moves otherwise."""
    plain = scene_files.load(name)
    scene, effort = everywhere(plain, 0.1), "drive.torque" if plain.drive.slide is None else "drive.force"
    motion, before = run(scene, settings, SAMPLES), run(plain, settings, SAMPLES)
    power = (motion[effort] - before[effort]) * scene.drive.law.at(motion["time"]).rate
    taken = motion["friction.power"]
    assert (taken <= 0).all()
    assert taken.min() < 0
    assert np.abs(power + taken).max() <= EASY[settings] * np.abs(motion[effort] * power).max() ** 0.5


@BOTH_ROUTES
def test_drawer(settings: TimeStepping) -> None:
    """The pull P beside the guide makes it hold M = P e, so that the contacts carry 2 P e / length each.

    With friction P = Q + 2 mu e / length P, which has a solution where length > 2 mu e = 0.15 m alone.
    """
    for length in (10.0, 0.3, 0.1501):
        pull = 10 / (1 - 0.15 / length)
        motion = run(drawer(length), settings, SAMPLES)
        # 1 / (1 - 0.15 / length) is up to 1500: by that roundings grow, and by its square the pull
        assert np.abs(motion["drive.force"] / pull - 1).max() <= 1e-10
        assert np.abs(motion["drawer.friction_force"] - 10 + pull).max() <= 1e-10 * pull
    for length in (0.1499, 0.05):
        with pytest.raises(Failure, match=rf"puller at 1 m: .* past {length / 0.15:.4g} of") as caught:
            run(drawer(length), settings, SAMPLES)
        assert caught.value.status is Status.jammed


def test_a_pull_at_the_first_point_never_jams() -> None:
    scene = drawer(0.05)
    load = replace(scene.loads[0], at="D")  # the resistance in the link's line, and nothing for the guide to hold
    motion = run(replace(scene, loads=(load,)), EXACT, SAMPLES)
    assert np.abs(motion["drive.force"] - 10).max() <= 1e-12


@pytest.mark.parametrize("coefficient", [0.3, pytest.param(1.0, marks=pytest.mark.slow), 3.0])
@pytest.mark.parametrize("name", ["two_rods", pytest.param("carried_block", marks=pytest.mark.slow)])
def test_jams_where_no_solution_follows(name: str, coefficient: float) -> None:
    scene = everywhere(scene_files.load(name), coefficient)
    try:
        expected = referred(scene)
    except JammedError as jam:
        with pytest.raises(Failure, match=f"past {jam.factor:.3g}") as caught:
            run(scene, EXACT, SAMPLES)
        assert caught.value.status is Status.jammed
        assert coefficient > 0.3
    else:
        # The differences' 1e-10, as often as forces grow by friction
        assert off(run(scene, EXACT, SAMPLES), expected) <= 1e-7
        assert coefficient < 3


def test_no_coefficients_change_nothing() -> None:
    plain = scene_files.load("toggle_press")
    none, before = (run(scene, EXACT, SAMPLES) for scene in (everywhere(plain, 0.0), plain))
    for channel, values in before.samples.items():
        assert (none[channel] == values).all(), channel
    for channel in friction_channels(everywhere(plain, 0.0)):
        assert not none[channel].any()


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
