"""Loads: forces on points of bodies, as functions of where those are. They are the scene's input.

What a load depends on, a slider's displacement and velocity or a spring's length, each model finds by its own means.
A slider's displacement is that of its body's first point along its guide from `through`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, Strict

from . import limits
from .bodies import GROUND, Body, Slide
from .errors import InputError
from .fields import BodyPoint, Coordinate, FileTable, ForceVector, Known, Length, Newtons, RestLength, Stiffness


@dataclass(frozen=True)
class Force:
    """A constant force."""

    body: str
    at: str
    force: ForceVector  # N, ground frame


@dataclass(frozen=True)
class PressForce:
    """A constant force that resists a slider in the last part of its closing stroke, and only there.

    The slider closes while it moves against the force. Its stroke ends where a cycle of the drive takes it furthest
    against the force; from `last` before that end it meets the force, and on the way back it does not.
    """

    body: str  # slides on the ground
    at: str
    force: ForceVector  # N, ground frame
    last: Length  # m
    closing: int  # the sign of the displacement's rate while the slider closes

    def acts(self, displacement: Any, velocity: Any, end: float) -> NDArray[np.bool_]:
        """Where the force acts: displacements, m, velocities, m/s, of one shape; the stroke ends at `end`, m."""
        before_end = (end - displacement) * self.closing
        acts: NDArray[np.bool_] = (before_end <= self.last) & (velocity * self.closing > 0)
        return acts


def push(force: tuple[Any, Any], slide: Slide) -> Any:
    """The part of a force along a guide."""
    return force[0] * slide.along[0] + force[1] * slide.along[1]


def closing_sense(force: tuple[Any, Any], slide: Slide) -> Any:
    """The sign of the rate of a slider's displacement while it closes against a force; of many machines an array."""
    against = push(force, slide) > 0
    return np.where(against, -1, 1) if np.ndim(against) else -1 if against else 1


@dataclass(frozen=True)
class ForceTable:
    """A force along a slider's guide against its displacement: straight lines between the entries, constant beyond."""

    body: str  # slides on the ground
    at: str
    displacements: tuple[Coordinate, ...] = field(metadata={"path": "table.*.0"})  # m, increasing
    forces: tuple[Newtons, ...] = field(metadata={"path": "table.*.1"})  # N, along `along`

    def along(self, displacement: Any) -> Any:
        """The forces along the guide, N, at displacements of any shape, m."""
        if not self._of_many:
            return np.interp(displacement, self.displacements, self.forces)
        force = self.forces[0]
        for (x0, f0), (x1, f1) in pairwise(zip(self.displacements, self.forces, strict=True)):
            force = force + (f1 - f0) / (x1 - x0) * np.clip(displacement - x0, 0, x1 - x0)
        return force

    @cached_property
    def _of_many(self) -> bool:
        """Whether the entries are those of many machines, as of `scenes.file.changes`."""
        return any(np.ndim(number) for number in (*self.displacements, *self.forces))


@dataclass(frozen=True)
class Spring:
    """A linear spring between points of two bodies, either of which may be the ground; it pulls when it is longer."""

    first: tuple[str, str]  # body, point
    second: tuple[str, str]
    stiffness: Stiffness  # N/m
    length: RestLength  # m, without force


Load: TypeAlias = Force | PressForce | ForceTable
TableRow = Annotated[tuple[Coordinate, Newtons], Strict(False)]


class LoadTable(FileTable):
    """A force on a point of a body: constant, only in the last part of the closing stroke, or a table against it."""

    body: Known = Field(description="The body on which it acts.")
    at: Known = Field(description="The point of the body at which it acts.")
    force: ForceVector | None = Field(None, description="The force: [x, y].")
    last: Length | None = Field(None, description="Only in this last part of the stroke that closes against the force.")
    table: Annotated[list[TableRow], Field(min_length=2, max_length=limits.ROWS)] | None = Field(
        None, description="Instead of `force`: [displacement of the slider, force along its guide]."
    )

    def load(self, place: str, bodies: Mapping[str, Body]) -> Load:
        """The load, its numbers as they are, or InputError; one on a body that there is not is a constant force."""
        if (self.force is None) == (self.table is None):
            raise InputError(f"{place}: expected either 'force' or 'table'")
        if self.body not in bodies or (self.force is not None and self.last is None):
            return Force(self.body, self.at, self.force or (0.0, 0.0))
        slide = bodies[self.body].slide
        if slide is None or slide.on != GROUND:
            key = "table" if self.last is None else "last"
            raise InputError(f"{place}.{key}: expected a body that slides on the ground, found '{self.body}'")
        if self.force is not None and self.last is not None:
            return PressForce(self.body, self.at, self.force, self.last, closing_sense(self.force, slide))
        if self.last is not None:
            raise InputError(f"{place}.last: expected a 'force' with it, not a 'table'")
        return ForceTable(self.body, self.at, *zip(*self.table or (), strict=True))


class SpringTable(FileTable):
    """A linear spring between two points."""

    between: Annotated[tuple[BodyPoint, BodyPoint], Strict(False)] = Field(
        description='Each as "body.point", or "ground.S".'
    )
    stiffness: Stiffness = Field(description="Force by length.")
    length: RestLength = Field(description="Its length without force.")

    def spring(self) -> Spring:
        """The spring, its numbers as they are."""
        first, second = ((body, point) for body, _, point in (text.partition(".") for text in self.between))
        return Spring(first, second, self.stiffness, self.length)
