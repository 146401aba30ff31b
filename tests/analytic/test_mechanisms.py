"""Every joint, drive and load over its whole cycle: the analytic core against two formulations that share nothing."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import analytic
import scenes
from compare.engines.registry import Solve
from scenes import Sampling, Scene
from scenes.channels import named
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import Slide
from tests import absolute_coordinates, scene_files
from tests.agreement import errors, off_50_digits
from tests.comparisons import References, sampled
from tests.linkages import xy

# A slot that the file declares from the other side, on a body that is not placed yet when the block is, or is.
FLIPPED = {
    "shaper": ("block", "rocker"),
    "swinging_block": ("rod", "block"),
    "carried_block": ("block", "coupler"),
    "carried_yoke": ("yoke", "coupler"),
    "slotted_class_iii": ("block", "plate"),
    "turning_law": ("block", "rocker"),
}
NAMES = (*scene_files.MECHANISMS, "two_blocks", "carried_yoke", *scenes.shipped())


def flipped(scene: Scene, block: str, on: str) -> Scene:
    """Return the scene with a slot declared from the other side: the other's first point along a line of the block."""
    slider, other = scene.bodies[block], scene.bodies[on]
    assert slider.slide is not None
    first = [complex(*body.local[body.points[0]]) for body in (slider, other) if body.local is not None]
    through = sum(first) - complex(*slider.slide.through)  # the first point of a body given by lengths is its origin
    turned = replace(other, slide=Slide(block, xy(through), slider.slide.along))
    return replace(scene, bodies={**scene.bodies, block: replace(slider, slide=None), on: turned})


def off_by(scene: Scene, solve: Solve) -> Mapping[str, Samples]:
    """Return by channel how far the core is from absolute coordinates."""
    # off the ends of the cycle: none of them is on the switch of a press force
    time = np.linspace(0.00137, 0.99871, 49) * scene.cycle
    driven = scene.drive.law.at(time)
    expected = absolute_coordinates.solve(scene, *driven, time)
    assert set(expected) == set(scene.channels.names()) - {"time"}
    return errors(solve(inputs_of(scene, time)), expected)


@sampled(3)
@pytest.mark.parametrize("name", NAMES)
def test_against_absolute_coordinates(references: References, name: str) -> None:
    reference = references(name)
    for channel, error in off_by(reference.scene, reference.at).items():
        # Of both, some roundings of 1e-16; the clamp, near its lock at the end, makes them a thousand times larger.
        assert error.max() <= (1e-12 if "clamp" in name else 1e-13), channel


@sampled(1)
@pytest.mark.parametrize("name", FLIPPED)
def test_slots_from_the_other_side(name: str) -> None:
    """The route is the same: which of the two is called the slider is no matter of the linkage's."""
    drawn = scene_files.load(name)
    scene = flipped(drawn, *FLIPPED[name])
    assert analytic.route(scene) == analytic.route(drawn)
    for channel, error in off_by(scene, analytic.solver(scene)).items():
        assert error.max() <= 1e-13, channel  # as above


@sampled(4)
@pytest.mark.parametrize("name", NAMES)
def test_against_50_digits(references: References, name: str) -> None:
    """Newton on the constraints from the sketch, and Newton-Euler with multipliers: each channel by its own peak."""
    sampling = Sampling(72 if name in ("toggle_press", "class_iii") else 24)
    amplified = {"reaction", "torque", "force"} | ({"acceleration"} if "clamp" in name else set())
    for channel, error in off_50_digits(references(name), sampling).items():
        # A few dozen roundings of 1e-16 each. The worst are 7e-14 in an acceleration and 1e-13 in a reaction, both of
        # the clamp near its lock.
        assert error.max() <= (1e-12 if named(channel).group in amplified else 1e-13), channel
