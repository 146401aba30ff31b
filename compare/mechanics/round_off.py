"""The part of an error that arithmetic in doubles explains, sample by sample. Only what is above it is a fault.

Three figures: the condition of the constraint Jacobian times the unit round-off, and how far the motion moves when the
scene's numbers are off by a few units in the last place: each model rounds the lengths its own way before the first
equation. Near a lock the second is by far the larger, since velocities have the condition once in them, accelerations
thrice. The third is what forces leave that cancel in a joint.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import reduce

import numpy as np

from scenes import Failure, Motion, Rows
from scenes.model.motion import Samples

from .elements import applied
from .mechanics import ULPS, Mechanics
from .motion_vectors import MotionVectors
from .reference import Reference
from .scales import off_origin, sizes

EPS = float(np.finfo(float).eps)
MUCH = 100.0  # times what a joint carries: smaller forces leave less there than the other two figures
UNKNOWN = 1e-3  # of κ ε: a length that is off by a few last places changes the pose by about that


@dataclass(frozen=True)
class Explained:
    """Relative errors that need no other explanation, at the samples of one run."""

    condition: Samples  # of the constraint Jacobian, shape (n,)
    sensitivity: Mapping[str, Samples]  # by channel, each of shape (n,)
    written: Mapping[str, Samples] = field(default_factory=dict)  # the same of what is written at decimals
    cancelled: Mapping[str, Samples] = field(default_factory=dict)  # of forces: what large ones leave that cancel
    largest: str = ""  # of these forces, in words

    @property
    def decidable(self) -> bool:
        """Whether doubles can tell that the linkage moves at all: not next to a singular pose."""
        return bool(np.isfinite(list(self.sensitivity.values())).all() and (self.condition * EPS < UNKNOWN).all())

    def error(self, channel: str) -> Samples:
        """The largest error of a channel that needs no explanation, shape (n,)."""
        known = np.maximum(EPS * self.condition, self.sensitivity[channel])
        return np.maximum(known, self.cancelled.get(channel, 0.0)) + self.written.get(channel, 0.0)

    def why(self, channel: str) -> str:
        """In words what leaves the largest error of a channel that needs no explanation."""
        if np.max(self.cancelled.get(channel, 0.0)) > np.max(self.sensitivity[channel]):
            return f"{self.largest} cancels in it"
        return "lengths that are off by their last places move it as much"

    def left_over(self, errors: Mapping[str, Samples]) -> dict[str, Samples]:
        """Errors by channel, zero where they need no explanation; NaN is not explained."""
        return {
            channel: np.where(error <= self.error(channel), 0.0, error - self.written.get(channel, 0.0))
            for channel, error in errors.items()
        }


def explain(reference: Reference, sampling: Rows) -> Explained:
    """What is explained at the samples of a run, as commanded; a `Failure` where the reference has no motion there."""
    scene, mechanics = reference.scene, reference.mechanics
    true = reference.at(sampling.commanded(scene), sampling.times(scene))
    moved = _sensitivity(reference, true)
    known, forces = mechanics.constraints.condition(true) * off_origin(mechanics, true), _forces(mechanics, true)
    largest = reduce(np.maximum, forces.values(), np.zeros_like(known))
    strongest = max(forces, key=lambda name: float(forces[name].max()), default="")
    newtons = forces[strongest].max() if forces else 0.0
    cancelled = {}
    for channel in (channel for channel in mechanics.forces if channel in true):
        times = largest * mechanics.newtons[channel] / sizes(true, channel, reference.scale[channel])
        cancelled[channel] = np.where(times > MUCH, EPS * known * times, 0.0)
    return Explained(known, moved, cancelled=cancelled, largest=f"{strongest}, {newtons:.3g} N,")


def _forces(mechanics: Mechanics, true: Motion) -> dict[str, Samples]:
    """The magnitudes of all forces on the bodies, N, each of shape (n,), with those of joints by channel."""
    everything = [np.ones(true["time"].shape, bool) for _ in mechanics.presses]
    pushes = applied(MotionVectors(mechanics.scene, true, everything)) if mechanics.forces else ()
    joints = {c: np.abs(true[c]) for c in mechanics.forces if c in true and mechanics.units[c] == "N"}
    loads = {push.name: np.abs(push.force) + np.abs(push.moment) / mechanics.size for push in pushes}
    return loads | {f"the force {c}": size for c, size in joints.items()}


def _sensitivity(reference: Reference, true: Motion) -> dict[str, Samples]:
    """By how much each channel moves when lengths, places and drive are off by a few last places, shape (n,)."""
    position, neighbours = true[reference.scene.drive_channel], reference.mechanics.neighbours
    least = 1e-3 * np.ptp(reference.scene.drive.extent)  # an angle that passes through zero is no better known there
    off = ULPS * EPS * np.maximum(np.abs(position), least)
    unknown = {channel: np.full(true["time"].shape, np.inf) for channel in true.samples}
    moved: dict[str, Samples] = {} if neighbours else unknown
    for number, solve in enumerate(neighbours):
        try:
            with np.errstate(invalid="ignore"):
                by_channel = reference.errors(solve(position + (-1) ** number * off, true["time"]), true)
        except Failure:  # it cannot be assembled: then doubles know nothing of the motion
            return unknown
        for channel, error in by_channel.items():
            known = np.where(np.isnan(error), np.inf, error)  # where both scenes stand in a singular pose
            moved[channel] = np.maximum(moved.get(channel, 0.0), known)
    return moved
