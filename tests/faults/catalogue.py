"""Every kind of fault, family by family."""

from collections.abc import Iterator

from . import courses, left_out, read_out, samples, spoilt_elements, spoilt_scene, weight_and_friction
from .fault import Clean, Fault

FAMILIES = (
    read_out.signs,
    read_out.frames,
    read_out.pairs,
    samples.times,
    spoilt_scene.drives,
    spoilt_scene.masses,
    spoilt_scene.geometry,
    spoilt_scene.loads,
    spoilt_elements.elements,
    weight_and_friction.gravity,
    weight_and_friction.friction,
    weight_and_friction.friction_of_joints,
    samples.data,
    samples.solutions,
    courses.courses,
    left_out.left_out,
)


def catalogue(clean: Clean) -> Iterator[Fault]:
    """Yield the faults that a run on one scene can have."""
    for family in FAMILIES:
        yield from family(clean)
