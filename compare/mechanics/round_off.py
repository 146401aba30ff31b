"""The part of an error that arithmetic in doubles explains, sample by sample. Only what is above it is a fault.

Three figures, of which the largest counts: the condition κ of the constraint Jacobian times the unit round-off ε; of a
force ε κ times the largest force that acts over the size of that force; and how far the motion moves when the numbers
of the scene, the drive's position and the instants are off by a few units in the last place: each model rounds them its
own way before the first equation. Near a lock the third is by far the largest, since velocities have the condition once
in them, accelerations thrice. The second is what loads leave that cancel in a joint: a spring along a crank, a mass on
a spring that is moved as it would move by itself.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, reduce

import numpy as np

from scenes import Failure, Motion, Rows
from scenes.model.motion import Samples

from .elements import magnitudes
from .friction import newtons
from .mechanics import DRAWS, EPS, ULPS, Mechanics
from .motion_vectors import MotionVectors
from .projection import projected
from .reference import Reference
from .scales import off_origin, relative_errors, sizes

MAX_EXCUSED = 1e-2  # relative, of a force to what it is left of: more than that is an error, and no decimals excuse it
MIN_POSITION = 1e-3  # of the drive's range
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


def explain(reference: Reference, sampling: Rows, written: Mapping[str, Samples] | None = None) -> Explained:
    """What is explained at the samples of a run, as commanded; a `Failure` where the reference has no motion there.

    `written` has by channel the relative errors that decimals leave, each of shape (n,), where the run was written.
    """
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
    excused = {
        channel: np.minimum(left, MAX_EXCUSED * np.maximum(terms.get(channel, 1.0), 1.0))
        for channel, left in (written or {}).items()
    }
    return Explained(known, moved, excused, terms, f"{strongest}, {size:.3g} N,")


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
    others = zip(mechanics.neighbours, mechanics.perturbed, rounded_drive(mechanics, true), strict=False)
    for solve, other, drive in others:
        yield solve(drive.inputs(other.scene))


def rounded_drive(mechanics: Mechanics, motion: Motion) -> Iterator[Motion]:
    """Yield the drive and the instants a few last places off a motion's, for each perturbed scene.

    A position that passes through zero is no better known there than where it is a thousandth of its range.
    """
    drive = mechanics.scene.channels.drive.position
    position, time = motion[drive], motion["time"]
    off = ULPS * EPS * np.maximum(np.abs(position), MIN_POSITION * max(drive.span for drive in mechanics.scene.drives))
    for number in range(DRAWS):
        sign = (-1) ** number
        yield Motion({drive: position + sign * off, "time": time * (1 + sign * ULPS * EPS)})


def projected_apart(
    mechanics: Mechanics, motion: Motion, true: Motion, scale: Mapping[str, float], ends: Sequence[float] | None
) -> dict[str, Samples]:
    """By how much the projection of a motion moves when numbers and drive are a few last places off, shape (n,)."""
    moved: dict[str, Samples] = {}
    for other, drive in zip(mechanics.perturbed, rounded_drive(mechanics, motion), strict=True):
        rounded = Motion({**motion.samples, **drive.samples})
        projection = projected(other, rounded, ends)
        neighbour = Motion({**projection.closed.samples, **projection.forces})
        for channel, error in relative_errors(mechanics.scene.channels, neighbour, true, scale).items():
            moved[channel] = np.fmax(moved.get(channel, 0.0), error)
    return moved
