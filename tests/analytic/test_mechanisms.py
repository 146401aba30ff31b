"""Every joint, drive and load over its whole cycle: the analytic core against two formulations that share nothing."""

from dataclasses import replace

import numpy as np
import pytest

import analytic
import scenes
from compare.engines import registry
from compare.engines.reference import establish, relative_errors
from compare.judge.errors import GROUPS
from scenes import Sampling, Scene
from scenes.motion import channels, quantity
from scenes.scene import Slide
from tests import absolute_coordinates
from tests.agreement import kind, scales
from tests.conftest import SceneFrom
from tests.mechanisms import MECHANISMS

# A slot that the file declares from the other side, on a body that is not placed yet when the block is, or is.
FLIPPED = {
    "quick_return": ("block", "rocker"),
    "swinging_block": ("rod", "block"),
    "carried_block": ("block", "coupler"),
    "carried_yoke": ("yoke", "coupler"),
    "slotted_class_iii": ("block", "plate"),
    "turning_law": ("block", "rocker"),
}
# One bar runs through two blocks that turn on the ground: nothing but the four bodies together holds any of them.
TWO_BLOCKS = """
format = 1
name = "two_blocks"
ground.points = { O = [0, 0], C = [3, 0], D = [3, 2] }
bodies.crank.lengths = { "O-A" = 1 }
bodies.crank.mass = 1
bodies.coupler.lengths = { "A-B" = 5 }
bodies.coupler.mass = 2
bodies.one.points = { C = [0, 0] }
bodies.one.slides = { on = "bar", through = [0, 0], along = [1, 0] }
bodies.one.mass = 0.5
bodies.two.points = { D = [0, 0] }
bodies.two.slides = { on = "bar", through = [0, 0.5], along = [1, 0] }
bodies.two.mass = 0.3
bodies.bar.points = { B = [0, 0], T = [3, 0] }
bodies.bar.mass = 4
drive = { body = "crank", speed = 1 }
sketch = { A = [1, 0], B = [3, 4.5], T = [3, 7.5] }
output = { point = "T" }
"""
# RPP on a moving guide: a yoke runs on the coupler of a four-bar, and in it a block that turns about the ground.
CARRIED_YOKE = """
format = 1
name = "carried_yoke"
gravity = [1, -9.81]
ground.points = { O = [0, 0], C = [0.4, 0], F = [0.15, 0.5] }
bodies.crank.lengths = { "O-A" = 0.08 }
bodies.crank.mass = 1
bodies.coupler.points = { A = [0, 0], B = [0.35, 0] }
bodies.coupler.mass = 4
bodies.rocker.lengths = { "C-B" = 0.25 }
bodies.rocker.mass = 2
bodies.yoke.points = { Y = [0.02, 0.03], T = [0.1, -0.05] }
bodies.yoke.slides = { on = "coupler", through = [0, 0.04], along = [1, 0.1] }
bodies.yoke.mass = 3
bodies.block.points = { F = [0.01, -0.02] }
bodies.block.slides = { on = "yoke", through = [0.03, 0], along = [0.3, 1] }
bodies.block.mass = 1.5
bodies.block.com = [0.04, 0.01]
bodies.block.inertia = 0.002
drive = { body = "crank", speed = 9 }
loads = [{ body = "yoke", at = "T", force = [20, -30] }]
springs = [{ between = ["yoke.T", "rocker.C"], stiffness = 200, length = 0.1 }]
sketch = { A = [0.08, 0], B = [0.375, 0.249] }
output = { point = "B" }
"""
LIBRARY = {f"library/{name}": file.read_text(encoding="utf-8") for name, file in scenes.shipped().items()}
TEXTS = {**MECHANISMS, "two_blocks": TWO_BLOCKS, "carried_yoke": CARRIED_YOKE, **LIBRARY}


def flipped(scene: Scene, block: str, on: str) -> Scene:
    """Return the scene with a slot declared from the other side; both bodies are given by points."""
    slider, other = scene.bodies[block], scene.bodies[on]
    assert slider.slide is not None
    assert slider.local is not None
    assert other.local is not None
    first = [np.array(body.local[body.points[0]]) for body in (slider, other) if body.local is not None]
    x, y = first[0] + first[1] - slider.slide.through
    turned = replace(other, slide=Slide(block, (float(x), float(y)), slider.slide.along))
    return replace(scene, bodies={**scene.bodies, block: replace(slider, slide=None), on: turned})


def off_by(scene: Scene) -> dict[str, float]:
    """Return by channel how far the core is from absolute coordinates, relative to the peak of its kind."""
    # off the ends of the cycle: none of them is on the switch of a press force
    time = np.linspace(0.00137, 0.99871, 97) * scene.drive.cycle
    driven = scene.drive.at(time)
    motion = analytic.solve(scene, driven.position, time)
    expected = absolute_coordinates.solve(scene, *driven)
    assert set(expected) == set(channels(scene)) - {"time"}
    scale, off = scales(scene, motion), {}
    for channel, samples in expected.items():
        difference = motion[channel] - samples
        if quantity(channel) == "angle":
            difference = np.remainder(difference + np.pi, 2 * np.pi) - np.pi
        off[channel] = float(np.abs(difference).max() / scale[kind(channel)])
    return off


@pytest.mark.parametrize("name", TEXTS)
def test_against_absolute_coordinates(scene_from: SceneFrom, name: str) -> None:
    for channel, error in off_by(scene_from(TEXTS[name])).items():
        # Of both, some roundings of 1e-16; the clamp, near its lock at the end, makes them a thousand times larger.
        assert error <= (1e-12 if "clamp" in name else 1e-13), channel


@pytest.mark.parametrize("name", FLIPPED)
def test_slots_from_the_other_side(scene_from: SceneFrom, name: str) -> None:
    scene = flipped(scene_from(TEXTS[name]), *FLIPPED[name])
    for channel, error in off_by(scene).items():
        assert error <= 1e-13, channel  # as above


def test_flipping_changes_what_is_placed_first(scene_from: SceneFrom) -> None:
    """The route is the same: which of the two is called the slider is no matter of the linkage's."""
    for name, slot in FLIPPED.items():
        scene = scene_from(TEXTS[name])
        assert analytic.route(flipped(scene, *slot)) == analytic.route(scene)


@pytest.mark.parametrize("name", TEXTS)
def test_against_50_digits(scene_from: SceneFrom, name: str) -> None:
    """Newton on the constraints from the sketch, and Newton-Euler with multipliers: each channel by its own peak."""
    scene = scene_from(TEXTS[name])
    engine = registry.engine(registry.ORACLE)
    run = engine.build(scene, engine.DEFAULT, Sampling(24))
    run.solve()
    exact = run.read()
    motion = analytic.solve(scene, exact[scene.drive_channel], exact["time"])
    errors = relative_errors(motion, exact, establish(scene).scale)
    assert set(errors) == set(channels(scene)) - {"time"}
    for channel, error in errors.items():
        # The worst are 7e-14 in an acceleration and 1e-13 in a reaction, both of the clamp near its lock.
        tolerance = 1e-12 if GROUPS[quantity(channel)] in ("reaction", "torque", "acceleration") else 1e-13
        assert error.max() <= tolerance, channel
