"""Friction in every joint of a scene, in every engine: equations written in the tests, powers, no friction, jams."""

from dataclasses import replace
from functools import cache
from math import atan, sin
from typing import Any

import numpy as np
import pytest

from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.channels import Role
from scenes.scene import PinFriction
from tests import absolute_coordinates, scene_files
from tests.absolute_friction import JammedError
from tests.agreement import errors, worst
from tests.comparisons import sampled
from tests.friction_scenes import everywhere

from .engines import ENGINES, Held, by_name, every, on_each

SAMPLING = Sampling(12)
FRICTION = [held for held in ENGINES if held.friction < np.inf]
# Guides that turn, a cylinder and an elbow that drive, three bodies at a pin, a driven slider, a group that is no dyad.
NAMES = (
    *("rocking_guide", "gas_spring", "lift", "elbow", "three_at_a_pin", "slotted_class_iii", "toggle_press", "wedge"),
    *("servo_press", "excavator_bucket", "walking_leg", "swinging_segments", "busy_bucket", "class_iii", "shaper"),
    *("four_bar", "two_rods", "quick_return"),
)


@cache
def referred(scene: Scene) -> dict[str, Any]:
    """Its motion from equations written in the tests."""
    time = SAMPLING.times(scene)
    return absolute_coordinates.solve(scene, *scene.drive.law.at(time), time)


@cache
def found(held: Held, scene: Scene) -> Motion:
    motion = held.run(scene, SAMPLING)
    assert set(motion.samples) >= set(scene.channels.names())
    return motion


def off(held: Held, scene: Scene) -> float:
    return max(worst(errors(found(held, scene), referred(scene))).values())


def jams(scene: Scene) -> float | None:
    """The factor on all coefficients past which nothing moves it, or None where it is above 1."""
    try:
        referred(scene)
    except JammedError as jam:
        return jam.factor
    return None


@sampled(5)
@on_each(NAMES, FRICTION)
def test_every_channel(held: Held, name: str) -> None:
    assert not off(held, everywhere(scene_files.load(name), 0.1)) > held.friction


@every(FRICTION)
@sampled(2)
@pytest.mark.parametrize("more", [{"viscous": 3.0}, {"smooth": 0.7}, {"viscous": 5.0, "smooth": 2.0}])
def test_viscous_and_smooth(held: Held, more: dict[str, float]) -> None:
    plain = everywhere(scene_files.load("rocking_guide"), 0.15)
    scene = everywhere(plain, 0.15, **more)
    assert not off(held, scene) > held.friction
    change = errors(found(held, scene), referred(plain))
    assert max(worst(change).values()) >= 1e-3  # it matters


@every(FRICTION)
@sampled(2)
@pytest.mark.parametrize("name", ["lift", "rocking_guide", "servo_press"])
def test_the_drive_pays_for_friction(held: Held, name: str) -> None:
    """Its power is more than without friction by just what friction takes, since nothing moves otherwise."""
    plain = scene_files.load(name)
    motion, before = found(held, everywhere(plain)), found(held, plain)
    effort = next(channel for channel in ("drive.torque", "drive.force") if channel in motion.samples)
    rate = plain.drive.law.at(SAMPLING.times(plain)).rate
    taken = motion["friction.power"]
    assert (taken <= 0).all()
    assert taken.min() < 0
    # Roundings alone, but for steps of the time that friction changes: else both are by the same poses.
    missing, least = (motion[effort] - before[effort]) * rate + taken, 1e-4 if held.name == "exudyn steps" else 1e-10
    assert not np.abs(missing).max() > least * np.abs(motion[effort] * rate).max()


@every(FRICTION)
@pytest.mark.parametrize("coefficient", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("name", ["two_rods", "carried_block"])
@sampled(4)
def test_jams_where_no_solution_follows(held: Held, name: str, coefficient: float) -> None:
    scene = everywhere(scene_files.load(name), coefficient)
    if factor := jams(scene):
        ended = held.outcome(scene, SAMPLING)
        assert isinstance(ended, Failure)
        assert ended.status is Status.jammed
        assert coefficient > 0.3
        assert held.engine != "exudyn" or f"past {factor:.3g}" in ended.reason
    elif held.engine == "analytic" and isinstance(ended := held.outcome(scene, SAMPLING), Failure):
        assert ended.status is Status.undetermined  # of several solutions, as `test_friction_ladder` finds them too
    else:
        # As often as forces grow by friction
        assert not off(held, scene) > (5 if held.engine == "pymunk" else 100) * held.friction
        assert coefficient < 3


@every(FRICTION)
def test_no_coefficients_change_nothing(held: Held) -> None:
    plain = scene_files.load("toggle_press")
    none, before = found(held, everywhere(plain, 0.0)), found(held, plain)
    for channel, values in before.samples.items():
        assert (none[channel] == values).all(), channel
    for channel in everywhere(plain, 0.0).channels.names(Role.friction):
        assert not none[channel].any()


@every(by_name("50 digits", "analytic"))
@sampled(2)
@pytest.mark.parametrize("name", ["toggle_press", "rocking_guide", "class_iii"])
def test_friction_to_zero(held: Held, name: str) -> None:
    """The forces' difference to those without friction falls as mu over four decades."""
    scene = scene_files.load(name)
    without = found(held, scene).samples
    apart = [
        max(worst(errors(found(held, everywhere(scene, mu)), without)).values())
        for mu in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
    ]
    # The next term is mu times some ten joints: a tenth at 1e-2, of the logarithm a twentieth.
    assert np.abs(np.diff(np.log10(apart)) + 1).max() <= 0.05


@every(by_name("50 digits", "analytic"))
def test_nothing_rubs_while_the_drive_dwells(held: Held) -> None:
    """The law's last sixth is a dwell: the forces are those without friction there, and others before."""
    dwell = [{"to": 3, "within": 0.5, "law": "cycloidal"}, {"within": 0.1}]
    scene = scene_files.load("slider_crank", {"drive": {"body": "crank", "start": 1, "segments": dwell}})
    motion, without = found(held, everywhere(scene)), found(held, scene)
    rubbing = np.array([False, *[True] * 9, False, False, False])  # it starts from rest too
    assert np.array_equal(motion["drive.torque"] != without["drive.torque"], rubbing)
    assert np.array_equal(motion["friction.power"] < 0, rubbing)
    for channel in scene.channels.names(Role.force):
        assert (motion[channel] == without[channel])[~rubbing].all(), channel


@every(held for held in FRICTION if held.name != "exudyn steps")
@pytest.mark.parametrize("name", ["rocking_guide", "three_at_a_pin", "class_iii"])
@sampled(3)
def test_a_pin_s_force_touches_its_circle_and_opposes_the_turning(held: Held, name: str) -> None:
    """|moment| = r sin(arctan mu) |R|, against the rate of its bodies on each other."""
    scene = everywhere(scene_files.load(name), 0.2)
    motion = found(held, scene)
    pins = {pin.channel: pin for pin in scene.pins}
    for friction in scene.friction:
        if not isinstance(friction, PinFriction):
            continue
        pin = pins[friction.channel(scene).rpartition(".")[0]]
        moment, force = motion[friction.channel(scene)], np.hypot(*(motion[f"{pin.channel}.f{axis}"] for axis in "xy"))
        rates = (motion[f"{body}.omega"] if body in scene.turning else 0.0 for body in (pin.second, pin.first))
        second, first = rates
        assert np.all(moment * (second - first) <= 0)
        apart = np.abs(np.abs(moment) - friction.radius * sin(atan(0.2)) * force)
        assert not apart.max() > max(1e-12, held.friction) * np.abs(moment).max()  # roundings of a group


@every(by_name("50 digits", "analytic"))
def test_a_smooth_friction_is_less(held: Held) -> None:
    sharp = everywhere(scene_files.load("rocking_guide"))
    smooth = replace(sharp, friction=tuple(replace(friction, smooth=2.0) for friction in sharp.friction))
    assert np.all(found(held, smooth)["friction.power"] > found(held, sharp)["friction.power"])
