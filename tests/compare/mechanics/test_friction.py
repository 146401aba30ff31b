"""The judge's friction: by hand, and what it finds of a motion whose friction is another one."""

from dataclasses import replace

import numpy as np
import pytest

from compare.engines import registry
from compare.judge.checks import checks
from compare.mechanics.friction import by_law
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.motion_vectors import MotionVectors
from compare.mechanics.scales import judged_errors, resting, travels
from scenes import Motion, Sampling, load
from scenes.scene import GuideFriction, PinFriction
from tests import scene_files
from tests.comparisons import sampled

PIN = PinFriction(at="P3", radius=0.04, coefficient=0.1)
GUIDE = GuideFriction(slider="slider", coefficient=0.2, length=0.3, viscous=10.0)
SCENE = replace(load("toggle_press"), friction=(PIN, GUIDE))
SAMPLING = Sampling(72)
MOTION = registry.reference(SCENE)(SAMPLING.inputs(SCENE))
ROUND_OFF = 1e-12  # of the peaks, which cancel little here


def test_friction_of_a_pin_and_a_guide_by_hand() -> None:
    """A pin's line of force touches its friction circle; a guide's two contacts resist, and its film does."""
    law = by_law(MotionVectors(SCENE, MOTION), MOTION.samples)
    turning = MOTION["toggle.omega"] - MOTION["rocker.omega"]
    size = np.hypot(MOTION["P3.fx"], MOTION["P3.fy"])
    moment = -np.sign(turning) * 0.04 * 0.1 / np.sqrt(1.01) * size
    N1, N2 = (MOTION["slider.guide_force"] / 2 + end * MOTION["slider.guide_moment"] / 0.3 for end in (-1, 1))
    force = -np.sign(MOTION["P5.vy"]) * 0.2 * (np.abs(N1) + np.abs(N2)) - 10.0 * MOTION["P5.vy"]
    power = moment * turning + force * MOTION["P5.vy"]
    for channel, by_hand in {
        "P3.friction_moment": moment,
        "slider.friction_force": force,
        "friction.power": power,
    }.items():
        assert not np.abs(law[channel] - by_hand).max() > ROUND_OFF * np.abs(by_hand).max()
        assert not np.abs(MOTION[channel] - by_hand).max() > ROUND_OFF * np.abs(by_hand).max()


@sampled(3)
@pytest.mark.parametrize("channel", ["P3.friction_moment", "slider.friction_force", "friction.power"])
@pytest.mark.parametrize("factor", [-1.0, 0.0, 1.001])
def test_another_friction_is_found_without_a_reference(channel: str, factor: float) -> None:
    """Turned round, left out, or off by a thousandth."""
    mechanics, travel = Mechanics(SCENE), travels(SCENE, MOTION)
    right = max(check.worst for check in checks(mechanics, MOTION, travel))
    wrong = Motion({**MOTION.samples, channel: factor * MOTION[channel]})
    found = {check.check: check.worst for check in checks(mechanics, wrong, travel)}
    assert not right > 1e-10
    assert found["reaction"] > 0.9 * abs(factor - 1)  # of its peak


def test_no_force_is_judged_where_a_joint_reverses() -> None:
    """At the dead points, and nowhere else among the samples."""
    scene = scene_files.load("slider_crank")
    scene = replace(scene, friction=(GuideFriction(slider=next(iter(scene.slides)), coefficient=0.1, length=0.2),))
    motion = registry.reference(scene)(SAMPLING.inputs(scene))
    rests = resting(MotionVectors(scene, motion))
    other = Motion({channel: samples + 1.0 for channel, samples in motion.samples.items()})
    errors = judged_errors(Mechanics(scene), other, motion, dict.fromkeys(motion.samples, 1.0))
    assert rests.any()
    assert not errors["drive.torque"][rests].any()
    assert errors["drive.torque"][~rests].all()
    assert all(errors[c].all() for c in errors if c.endswith((".x", ".vy", ".alpha")))
