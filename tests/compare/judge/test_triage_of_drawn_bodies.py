"""The likely cause where a body as drawn weighs something else: its mass and its moment of inertia are off together."""

from collections.abc import Mapping

import pytest

from compare.engines import registry
from compare.judge.causes.words import words
from compare.judge.triage import cause
from scenes import Motion
from tests import scene_files
from tests.comparisons import SAMPLING, References, sampled

SCENE = scene_files.load("outlined")
LENGTHS = {number.path: 1.002 for number in SCENE.numbers.values() if number.quantity.dimension == "length"}
ROCKER, COUPLER = "rocker's mass is 10 % too large", "coupler's mass is 10 % too small"


@sampled(2)
@pytest.mark.parametrize(
    ("shares", "expected"),
    [
        ({"bodies.rocker.thickness": 1.1}, ROCKER),
        ({"bodies.rocker.density": 1.1, "bodies.coupler.thickness": 0.9}, f"{COUPLER} and {ROCKER}"),
        ({"bodies.rocker.density": 1.1, "gravity.1": 1.03}, f"{ROCKER} and gravity is 3 % too large"),
        (LENGTHS, "each length is 0.2 % too large"),
        ({**LENGTHS, "gravity.1": 1.03}, "the cause is unknown"),  # gravity is varied where bodies have no drawing
    ],
)
def test_the_numbers_of_a_drawing(references: References, shares: Mapping[str, float], expected: str) -> None:
    reference = references("outlined")
    other = SCENE.with_numbers({path: share * SCENE.numbers[path].value for path, share in shares.items()})
    motion = registry.reference(other)(SAMPLING.inputs(SCENE))
    named = cause(reference, SAMPLING, Motion({channel: motion[channel] for channel in other.channels.names()}))
    assert words(SCENE, named) == expected
