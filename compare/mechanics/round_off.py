"""The part of an error that arithmetic in doubles explains, sample by sample. Only what is above it is a fault.

Three figures, of which the largest counts: the condition κ of the constraint Jacobian times the unit round-off ε; of a
force ε κ times the largest force that acts over the size of that force; and how far the motion moves when the numbers
of the scene, the drive's position and the instants are off by a few units in the last place: each model rounds them its
own way before the first equation. Near a lock the third is by far the largest, since velocities have the condition once
in them, accelerations thrice. The second is what loads leave that cancel in a joint: a spring along a crank, a mass on
a spring that is moved as it would move by itself.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, reduce

import numpy as np

from scenes import Failure, Motion, Rows
from scenes.model.inputs import inputs_in
from scenes.model.motion import Samples

from .elements import magnitudes
from .friction import newtons
from .mechanics import EPS, Mechanics
from .motion_vectors import MotionVectors
from .reference import Reference
from .scales import off_origin, sizes

UNKNOWN = 1e-3  # of κ ε: a length that is off by a few last places changes the pose by about that


@dataclass(frozen=True)
class Explained:
    """Relative errors that need no other explanation, at the samples of one run."""

    condition: Samples  # of the constraint Jacobian, shape (n,)
    sensitivity: Mapping[str, Samples]  # by channel, each of shape (n,)
    written: Mapping[str, Samples] = field(default_factory=dict)  # the same of what is written at decimals
    terms: Mapping[str, Samples] = field(
        default_factory=dict
    )  # of forces: the largest that acts over what errors are divided by
    largest: str = ""  # of what acts, in words

    @property
    def decidable(self) -> bool:
        """Whether doubles can tell that the linkage moves at all: not next to a singular pose."""
        return bool(np.isfinite(list(self.sensitivity.values())).all() and (self.condition * EPS < UNKNOWN).all())

    def left(self, channel: str) -> Samples:
        """What one rounding of the largest term leaves of a channel, relative: ε κ, of forces times their `terms`."""
        return EPS * self.condition * np.maximum(self.terms.get(channel, 1.0), 1.0)

    def error(self, channel: str) -> Samples:
        """The largest error of a channel that needs no explanation, shape (n,)."""
        return np.maximum(self.left(channel), self.sensitivity[channel]) + self.written.get(channel, 0.0)

    @cached_property
    def errors(self) -> Mapping[str, Samples]:
        """These by channel, worked out once for all runs at the same samples."""
        return {channel: self.error(channel) for channel in self.sensitivity}

    @cached_property
    def largest_errors(self) -> Mapping[str, float]:
        """By channel the largest of them, of all samples."""
        return {channel: float(error.max()) for channel, error in self.errors.items()}

    def why(self, channel: str) -> str:
        """In words what leaves the largest error of a channel that needs no explanation."""
        if np.max(self.terms.get(channel, 0.0)) > 1 and np.max(self.left(channel)) > np.max(self.sensitivity[channel]):
            return f"{self.largest} cancels in it"
        return "numbers of the scene that are off by their last places move it as much"

    def left_over(self, errors: Mapping[str, Samples]) -> dict[str, Samples]:
        """Errors by channel, zero where they need no explanation; NaN is not explained."""
        return {
            channel: np.where(error <= self.errors[channel], 0.0, error - self.written.get(channel, 0.0))
            for channel, error in errors.items()
        }


def explain(reference: Reference, sampling: Rows) -> Explained:
    """What is explained at the samples of a run, as commanded; a `Failure` where the reference has no motion there."""
    scene, mechanics = reference.scene, reference.mechanics
    true = reference.at(sampling.inputs(scene))
    moved = _sensitivity(reference, true)
    # Places far off the origin are rounded by their own size, not the linkage's: the condition counts that many times.
    known = mechanics.constraints.condition(true) * off_origin(mechanics, true)
    state = MotionVectors(scene, true)
    forces = magnitudes(mechanics, true)
    joints = (channel for channel in mechanics.forces if channel in true and mechanics.units[channel] == "N")
    forces |= {f"the force {channel}": np.abs(true[channel]) for channel in joints}
    largest = reduce(np.maximum, forces.values(), np.zeros_like(known))
    strongest = max(forces, key=lambda name: float(forces[name].max()), default="")
    size = forces[strongest].max() if forces else 0.0
    units: dict[str, Samples | float] = {**mechanics.newtons, **newtons(mechanics, state)}
    terms = {
        channel: largest * unit / sizes(true, reference.scene.channels[channel], reference.scale[channel])
        for channel, unit in units.items()
        if channel in true
    }
    return Explained(known, moved, terms=terms, largest=f"{strongest}, {size:.3g} N,")


def _sensitivity(reference: Reference, true: Motion) -> dict[str, Samples]:
    """By how much each channel moves when all numbers and the drive are off by a few last places, shape (n,)."""
    unknown = {channel: np.full(true["time"].shape, np.inf) for channel in true.samples}
    moved: dict[str, Samples] = {}
    try:
        for other in perturbed(reference.mechanics, true):
            with np.errstate(invalid="ignore"):
                by_channel = reference.errors(other, true)
            for channel, error in by_channel.items():
                known = np.where(np.isnan(error), np.inf, error)  # where both scenes stand in a singular pose
                moved[channel] = np.maximum(moved.get(channel, 0.0), known)
    except Failure:  # it cannot be assembled: then doubles know nothing of the motion
        return unknown
    return moved or unknown


def perturbed(mechanics: Mechanics, true: Motion) -> Iterator[Motion]:
    """Yield the motions of the perturbed scenes beside one; none where one of them cannot be solved."""
    others = zip(mechanics.neighbours, mechanics.perturbed, mechanics.rounded_drive(true), strict=False)
    for solve, other, drive in others:
        yield solve(inputs_in(other.scene, drive))
