"""The cause of an engine that goes astray where the linkage is nearly singular: that, and not its settings."""

from dataclasses import replace

import numpy as np
import pytest

from compare.engines import registry
from compare.engines.runner import Run
from compare.judge.measure import Measurement, Standard, assess
from compare.judge.triage import near_singular, sentences
from compare.mechanics.reference import Reference, uncertified
from scenes import Motion, Sampling, Settings, Status
from tests import scene_files

# Nearly a parallelogram: it is singular where its rocker is 0.1 mm shorter, at half a turn and at a whole one.
NEARLY = {"bodies.rocker.lengths.D-C": 0.3001, "drive.start": 0.5, "sketch.C": [1, 0.3]}
SAMPLING = Sampling(72)


def astray(reference: Reference, angle: float) -> Measurement:
    """A run that is in the other assembly beyond an angle, rad."""
    scene = reference.scene
    inputs = SAMPLING.inputs(scene)
    own, position = reference.at(inputs), inputs.driven().position
    other = registry.reference(scene_files.load("parallelogram", {**NEARLY, "sketch.C": [0.75, -0.2]}))(inputs)
    mixed = {c: np.where(position > angle, other[c], values) for c, values in own.samples.items() if c in other}
    run = Run("pymunk", Settings("x", promise=1e-2), Status.ok, motion=Motion(mixed))
    return assess(Standard.of(reference, SAMPLING), run)


@pytest.fixture(scope="module")
def nearly() -> Reference:
    return uncertified(scene_files.load("parallelogram", NEARLY))


def test_the_distance_to_the_singular_configuration_is_the_cause(nearly: Reference) -> None:
    """Whatever finer settings leave of the error."""
    failed = replace(astray(nearly, np.pi), finer="more steps leave 1.4%")
    assert failed.run.status is not Status.ok
    line = sentences(nearly, [failed])["pymunk"]
    assert line.startswith("pymunk: the linkage is 0.0001001 m from a singular configuration at crank angle 3.14")
    assert "settings" not in line


def test_far_from_it_there_is_another_cause(nearly: Reference) -> None:
    """Who goes astray a quarter of a turn before, and a linkage that is nowhere near one."""
    assert near_singular(nearly, astray(nearly, np.pi / 2 + 0.2)) == ""
    far = uncertified(scene_files.load("parallelogram", {**NEARLY, "bodies.rocker.lengths.D-C": 0.35}))
    there = astray(nearly, np.pi)
    assert near_singular(far, there) == ""
    assert near_singular(nearly, replace(there, run=replace(there.run, status=Status.timed_out))) == ""
