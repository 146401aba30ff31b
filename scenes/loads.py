"""Loads: forces on points of bodies, as functions of where those are. They are the scene's input.

What a load depends on, a slider's displacement and velocity or a spring's length, each model finds by its own means.
A slider's displacement is that of its body's first point along its guide from `through`.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Vector: TypeAlias = tuple[float, float]


@dataclass(frozen=True)
class Force:
    """A constant force."""

    body: str
    at: str
    force: Vector  # N, ground frame


@dataclass(frozen=True)
class PressForce:
    """A constant force that resists a slider in the last part of its closing stroke, and only there.

    The slider closes while it moves against the force. Its stroke ends where a cycle of the drive takes it furthest
    against the force; from `last` before that end it meets the force, and on the way back it does not.
    """

    body: str  # slides on the ground
    at: str
    force: Vector  # N, ground frame
    last: float  # m
    closing: int  # the sign of the displacement's rate while the slider closes

    def acts(self, displacement: Any, velocity: Any, end: float) -> NDArray[np.bool_]:
        """Return where the force acts: displacements, m, velocities, m/s, of one shape; the stroke ends at `end`, m."""
        before_end = (end - displacement) * self.closing
        acts: NDArray[np.bool_] = (before_end <= self.last) & (velocity * self.closing > 0)
        return acts


@dataclass(frozen=True)
class ForceTable:
    """A force along a slider's guide against its displacement: straight lines between the entries, constant beyond."""

    body: str  # slides on the ground
    at: str
    displacements: tuple[float, ...]  # m, increasing
    forces: tuple[float, ...]  # N, along `along`

    def along(self, displacement: Any) -> Any:
        """Return the forces along the guide, N, at displacements of any shape, m."""
        if not self._of_many:
            return np.interp(displacement, self.displacements, self.forces)
        force = self.forces[0]
        for (x0, f0), (x1, f1) in pairwise(zip(self.displacements, self.forces, strict=True)):
            force = force + (f1 - f0) / (x1 - x0) * np.clip(displacement - x0, 0, x1 - x0)
        return force

    @cached_property
    def _of_many(self) -> bool:
        """Whether the entries are those of many machines, as of `scenes.machines`."""
        return any(np.ndim(number) for number in (*self.displacements, *self.forces))


@dataclass(frozen=True)
class Spring:
    """A linear spring between points of two bodies, either of which may be the ground; it pulls when it is longer."""

    first: tuple[str, str]  # body, point
    second: tuple[str, str]
    stiffness: float  # N/m
    length: float  # m, without force


Load: TypeAlias = Force | PressForce | ForceTable
