"""Loads: forces on points of bodies, and moments, as functions of where those are. They are the scene's input.

What a load depends on, a slider's displacement and velocity or the drive's position, each model finds by its own means.
A slider's displacement is that of its body's first point along its guide from `through`, in the frame of the guide.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag

from .. import limits
from ..bodies import GROUND, Body, Slide
from ..errors import InputError
from ..fields import Direction, FileTable, ForceVector, Known, Length, NewtonMetres, Newtons, Pair
from .tables import COLUMN, LoadCurve, Over

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
class GuideForce:
    """A force along the guide of a sliding body, whose reaction acts on what has the guide, at the same place."""

    body: str
    at: str
    force: Newtons | None = None  # N, along `along`; or a table
    table: LoadCurve | None = None
    kind: str = "forces along guides"  # or "force tables": on the ground, by the displacement, constant beyond


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


TabledLoad: TypeAlias = GuideForce | TableForce | Moment  # whose size may be by a table
Load: TypeAlias = Force | PressForce | TabledLoad


def _shape(force: object) -> str:
    return "number" if isinstance(force, int | float) else "vector"


class LoadTable(FileTable):
    """A force on a point of a body, or a moment: constant, in the last part of the closing stroke, or by a table."""

    body: Known = Field(description="The body on which it acts.")
    at: Known | None = Field(None, description="The point of the body at which it acts; of a moment where it is drawn.")
    force: (
        Annotated[Annotated[ForceVector, Tag("vector")] | Annotated[Newtons, Tag("number")], Discriminator(_shape)]
        | None
    ) = Field(None, description="The force: [x, y]; or a number along the guide of a body that slides.")
    last: Length | None = Field(
        None, description="Only while the slider moves against the force, so near to the end of its stroke."
    )
    moment: NewtonMetres | None = Field(None, description="Instead of `force`: a moment, counter-clockwise positive.")
    table: Annotated[list[Pair], Field(min_length=2, max_length=limits.ROWS)] | None = Field(
        None,
        description="Instead: [argument, value], a force along `along`, or along the guide of a body that slides; of"
        " another body, without `at`, a moment.",
    )
    over: Over | None = Field(
        None, description="What the table's arguments are: `drive`, `time`, or the slider's `displacement`."
    )
    along: Direction | None = Field(None, description="The direction of a table's force where it is not the guide's.")
    periodic: bool | None = Field(None, description="Whether the table goes on for ever.")
    frame: Frame | None = Field(None, description="`body` for a force that turns with its body; else `ground`.")

    def element(self, place: str, bodies: Mapping[str, Body]) -> Load:
        """The load, its numbers as they are, or InputError where the keys do not go together."""
        given = [key for key in ("force", "moment", "table") if getattr(self, key) is not None]
        if len(given) != 1:
            raise InputError(f"{place}: expected either 'force', 'moment' or 'table'")
        self._check_keys(place)
        if self.body not in bodies:
            return Moment(self.body, "", 0.0)  # which is refused by its name
        slide, at, frame = bodies[self.body].slide, self.at or bodies[self.body].points[0], self.frame or "ground"
        by_number = isinstance(self.force, float | int)
        by_table = self.table is not None and self.along is None and not (self.at is None and slide is None)
        grounded = slide is not None and slide.on == GROUND
        sliding = {"over": self.over == "displacement", "last": self.last is not None, given[0]: by_number or by_table}
        for key in (key for key, asked in sliding.items() if asked):
            if not (grounded if key == "last" else slide):
                ground = " on the ground" * (key == "last")
                vector = "[x, y], or " * (key == "force")
                raise InputError(f"{place}.{key}: expected {vector}a body that slides{ground}, found '{self.body}'")
        force: Any = self.force
        table, moment = None, self.force is None and self.along is None and not by_table
        if self.table is not None:
            if moment and self.over is None:
                expected = "expected 'drive', 'time' or 'displacement' with a moment's table"
                raise InputError(f"{place}.over: missing; {expected}")
            first, second = zip(*self.table, strict=True)
            columns = {COLUMN[self.over or "displacement"]: first, "moments" if moment else "forces": second}
            table = LoadCurve(**columns, periodic=bool(self.periodic))
        if table is not None and self.along is not None:
            return TableForce(self.body, at, self.along, table, frame)
        if moment:
            return Moment(self.body, at, self.moment, table)
        if by_number or by_table:
            plain = grounded and table is not None and table.over == "displacement" and not table.periodic
            return GuideForce(self.body, at, force, table, "force tables" if plain else GuideForce.kind)
        if self.last is None or slide is None:
            return Force(self.body, at, force, frame)
        return PressForce(self.body, at, force, self.last, closing_sense(force, slide))

    def _check_keys(self, place: str) -> None:
        vector = isinstance(self.force, tuple)
        turns = (vector and self.last is None) or self.along is not None
        fits = {
            "last": (vector, "a 'force' of [x, y]"),
            "over": (self.table is not None, "a 'table'"),
            "periodic": (self.over is not None, "a 'table' and 'over'"),
            "along": (self.over is not None and self.at is not None, "'at', 'over' and a 'table'"),
            "frame": (turns, "a 'force' of [x, y], or 'along'"),
        }
        for name, (fitting, what) in fits.items():
            if getattr(self, name) is not None and not fitting:
                raise InputError(f"{place}.{name}: expected {what} with it")
        if vector and self.at is None:
            raise InputError(f"{place}.at: missing; a force acts at a point of its body")
