"""Friction in the pymunk model, against equations written in the tests, powers, statics and the engine's own motors."""

from functools import cache

import numpy as np
import pytest

from scenes import Failure, Sampling, Scene, Status
from scenes.model.motion import channels, friction_channels
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk.engine import DEFAULT, EXACT, FAST
from sim_models.pymunk.settings import PymunkSettings
from tests import scene_files
from tests.absolute_friction import JammedError
from tests.agreement import errors, worst
from tests.comparisons import sampled
from tests.friction_scenes import drawer, everywhere

from .runs import Array, reference, solve

SAMPLING = Sampling(12)
# Guides that turn, a cylinder and an elbow that drive, three bodies at a pin, a larger group, joints at rest.
NAMES = ("rocking_guide", "gas_spring", "lift", "elbow", "three_at_a_pin", "class_iii", "toggle_press", "two_rods")
MORE = ("servo_press", "excavator_bucket", "walking_leg", "swinging_segments", "busy_bucket", "shaper", "four_bar")
ALL = (*NAMES, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE))


@cache
def referred(scene: Scene) -> dict[str, Array]:
    return reference(scene, SAMPLING)


def off(scene: Scene, settings: PymunkSettings) -> float:
    motion = solve(scene, settings, SAMPLING)
    assert set(motion.samples) == set(channels(scene))
    return max(worst(errors(motion, referred(scene))).values())


# Those of the run without friction, up to 1e-3 and 1e-6 of accelerations, which the extrapolation leaves.
@sampled(5)
@pytest.mark.parametrize(("settings", "tolerance"), [(DEFAULT, 2e-3), (EXACT, 2e-6)], ids=["default", "exact"])
@pytest.mark.parametrize("name", ALL)
def test_every_channel(name: str, settings: PymunkSettings, tolerance: float) -> None:
    assert off(everywhere(scene_files.load(name)), settings) <= tolerance


@pytest.mark.parametrize("more", [{"viscous": 3.0}, {"smooth": 0.7}, {"viscous": 5.0, "smooth": 2.0}])
def test_viscous_and_smooth(more: dict[str, float]) -> None:
    scene = everywhere(scene_files.load("rocking_guide"), 0.15, **more)
    assert off(scene, EXACT) <= 2e-6


@sampled(1)
@pytest.mark.parametrize("name", ["rocking_guide", "lift", "servo_press"])
def test_the_drive_pays_for_friction(name: str) -> None:
    """Its power is more than without friction by just what friction takes, since nothing moves otherwise."""
    plain = scene_files.load(name)
    effort = "drive.torque" if plain.drive.slide is None else "drive.force"
    motion, before = solve(everywhere(plain), DEFAULT, SAMPLING), solve(plain, DEFAULT, SAMPLING)
    rate = plain.drive.law.at(SAMPLING.times(plain)).rate
    taken = motion["friction.power"]
    assert (taken <= 0).all()
    assert taken.min() < 0
    # Roundings alone: both are by the same poses.
    assert np.abs((motion[effort] - before[effort]) * rate + taken).max() <= 1e-10 * np.abs(motion[effort] * rate).max()


@pytest.mark.parametrize("settings", [FAST, EXACT], ids=["fast", "exact"])  # the others move no massless bodies
def test_drawer(settings: PymunkSettings) -> None:
    """The pull P beside the guide makes it hold M = P e, so that the contacts carry 2 P e / length each.

    With friction P = Q + 2 mu e / length P, which has a solution where length > 2 mu e = 0.15 m alone.
    """
    for length in (10.0, 0.3, 0.1501):
        pull = 10 / (1 - 0.15 / length)  # by up to 1500, and roundings by its square
        motion = solve(drawer(length), settings, SAMPLING)
        assert np.abs(motion["drive.force"] / pull - 1).max() <= 1e-9
        assert np.abs(motion["drawer.friction_force"] - 10 + pull).max() <= 1e-9 * pull
    for length in (0.1499, 0.05):
        with pytest.raises(Failure, match="friction holds the linkage at puller at 1 m") as caught:
            solve(drawer(length), settings, SAMPLING)
        assert caught.value.status is Status.jammed


@sampled(3)
@pytest.mark.parametrize("coefficient", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("name", ["two_rods", "carried_block"])
def test_jams_where_no_solution_follows(name: str, coefficient: float) -> None:
    scene = everywhere(scene_files.load(name), coefficient)
    try:
        referred(scene)
    except JammedError:
        with pytest.raises(Failure) as caught:
            solve(scene, EXACT, SAMPLING)
        assert caught.value.status is Status.jammed
    else:
        assert off(scene, EXACT) <= 1e-5  # 2e-6, and more as near a jam as these are


def test_no_coefficients_change_nothing() -> None:
    plain = scene_files.load("toggle_press")
    none, before = (solve(scene, DEFAULT, SAMPLING) for scene in (everywhere(plain, 0.0), plain))
    for channel, values in before.samples.items():
        assert (none[channel] == values).all(), channel
    for channel in friction_channels(everywhere(plain, 0.0)):
        assert not none[channel].any()


@pytest.mark.parametrize("name", ["rocking_guide", "gas_spring", "four_bar", "crank_press"])
def test_the_engines_motors_resist_alike(name: str) -> None:
    """Told how large friction is, they find its sense and the joints' forces by themselves, to the second order."""
    mismatch = []
    for steps in (144, 288):
        settings = PymunkSettings("", steps, 1, 1000)
        simulation = pymunk_model.build(everywhere(scene_files.load(name)), settings, SAMPLING)
        simulation.solve()
        simulation.read()
        mismatch.append(simulation.residuals["friction"])
    # Measured: 1e-8 to 2e-6; with the other sense, or in the wrong joint, a part of the friction, 1e-3 or more.
    assert mismatch[1] <= 1e-5
    assert np.log2(mismatch[0] / mismatch[1]) == pytest.approx(2, abs=0.2)
