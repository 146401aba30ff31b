"""What a result may give besides the channels of engines: magnitudes, as `P.force`, and transmission angles.

A magnitude is the length of a vector of the reference, by its two channels, and is judged on their scale and in their
group. A transmission angle is the reference's own, on a scale of 1 rad, among the positions.
"""

from collections.abc import Collection, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, fields

import numpy as np

from scenes import Inputs, Motion

from ..engines import registry
from ..engines.registry import Solve
from ..mechanics.motion_vectors import Acts
from ..mechanics.reference import Reference

Parts = Mapping[str, tuple[str, str]]  # by magnitude, the channels of its components


@dataclass(frozen=True)
class _WithMagnitudes(Reference):
    parts: Parts = field(default_factory=dict)

    def fitting(self, motion: Motion, true: Motion, may: Sequence[Acts]) -> Motion:
        """`true` on the side of a press force's switch where the motion's forces fit best, with magnitudes of that."""
        return _extended(super().fitting(motion, true, may), self.parts)


def with_derived(reference: Reference, given: Collection[str]) -> Reference:
    """Return a reference with what a result gives besides channels; itself where that is nothing."""
    names = [name for name in given if name not in reference.mechanics.units]
    if not names:
        return reference
    channels = reference.scene.channels
    parts = {name: both for name, both in channels.magnitudes.items() if name in names}
    likes = {name: parts[name][0] if name in parts else "" for name in names}  # a channel that it is judged as
    known = reference.mechanics
    neighbours, mechanics = known.neighbours, copy(known)
    mechanics.units = known.units | {name: channels[name].unit for name in names}
    mechanics.groups = known.groups | {name: channels[name].group for name in names}
    if neighbours and len(parts) < len(names):  # which solve the channels of engines, no angles
        neighbours = tuple(registry.reference(other.scene) for other in known.perturbed)
    # A copy of the mechanics whose cached neighbours also return what is derived, so that round-off explains it as any
    # channel.
    mechanics.__dict__["neighbours"] = tuple(_solver(solve, parts) for solve in neighbours)
    values = {each.name: getattr(reference, each.name) for each in fields(Reference)}
    values["scale"] = {**reference.scale, **{name: reference.scale.get(like, 1.0) for name, like in likes.items()}}
    return _WithMagnitudes(**{**values, "mechanics": mechanics, "at": _solver(reference.at, parts)}, parts=parts)


def _solver(solve: Solve, parts: Parts) -> Solve:
    def extended(inputs: Inputs) -> Motion:
        return _extended(solve(inputs), parts)

    return extended


def _extended(motion: Motion, parts: Parts) -> Motion:
    lengths = {name: np.hypot(motion[x], motion[y]) for name, (x, y) in parts.items()}
    return Motion({**motion.prompt.samples, **lengths}, motion.unsupported)
