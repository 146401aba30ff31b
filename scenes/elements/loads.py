"""Loads: forces on points of bodies, and moments, as functions of where those are. They are the scene's input.

What a load depends on, a slider's displacement and velocity or the drive's position, each model finds by its own means.
A slider's displacement is that of its body's first point along its guide from `through`, in the frame of the guide.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..bodies import Slide
from ..fields import Coordinate, Direction, ForceVector, Length, NewtonMetres, Newtons
from .tables import LoadCurve

Frame: TypeAlias = Literal["ground", "body"]


@dataclass(frozen=True)
class Force:
    """A constant force; in its body's frame it turns with the body."""

    body: str
    at: str
    force: ForceVector  # N
    frame: Frame = "ground"
    table = None  # as of all that do not follow one

    @property
    def kind(self) -> str:
        """What it is, as an engine names what it knows."""
        return "forces" if self.frame == "ground" else "forces that turn with their body"


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
    table = None
    kind = "press forces"

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
    """The simplest force along a guide: by a table against the slider's displacement, which is constant beyond."""

    body: str  # slides on the ground
    at: str
    displacements: tuple[Coordinate, ...] = field(metadata={"path": "table.*.0"})  # m, increasing
    forces: tuple[Newtons, ...] = field(metadata={"path": "table.*.1"})  # N, along `along`
    force = None
    kind = "force tables"

    @cached_property
    def table(self) -> LoadCurve:
        """The forces along the guide against the displacement."""
        return LoadCurve(displacements=self.displacements, forces=self.forces)


@dataclass(frozen=True)
class GuideForce:
    """A force along the guide of a sliding body, whose reaction acts on what has the guide, at the same place."""

    body: str
    at: str
    force: Newtons | None = None  # N, along `along`; or a table
    table: LoadCurve | None = None
    kind = "forces along guides"


@dataclass(frozen=True)
class TableForce:
    """A force of one direction whose size follows a table; in its body's frame it turns with the body."""

    body: str
    at: str
    along: Direction  # of any length
    table: LoadCurve
    frame: Frame = "ground"
    kind = "forces by tables"

    @property
    def direction(self) -> tuple[Any, Any]:
        """The unit vector along it."""
        x, y = self.along
        length = np.sqrt(x * x + y * y)
        return x / length, y / length


@dataclass(frozen=True)
class Moment:
    """A moment on a body, counter-clockwise positive, constant or by a table."""

    body: str
    at: str  # where it is drawn; it turns the body alike wherever it acts
    moment: NewtonMetres | None = None  # N m; or a table
    table: LoadCurve | None = None
    kind = "moments"


PlainLoad: TypeAlias = Force | PressForce | ForceTable  # what every engine knows, but for forces that turn
TabledLoad: TypeAlias = ForceTable | GuideForce | TableForce | Moment  # whose size may be by a table
Load: TypeAlias = Force | PressForce | TabledLoad
