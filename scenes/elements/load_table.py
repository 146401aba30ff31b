"""The table of a load in a scene file: which of its keys go together, and which load they make."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from .. import limits
from ..bodies import GROUND, Body
from ..errors import InputError
from ..fields import Direction, ForceVector, Known, Length, NewtonMetres, Newtons, Pair
from .element import ElementTable
from .loads import (
    Force,
    ForceTable,
    Frame,
    GuideForce,
    Load,
    Moment,
    PressForce,
    TableForce,
    TurningForce,
    closing_sense,
)
from .tables import COLUMN, LoadCurve, Over


def _shape(force: object) -> str:
    return "number" if isinstance(force, int | float) else "vector"


class LoadTable(ElementTable):
    """A force on a point of a body, or a moment: constant, in the last part of the closing stroke, or by a table."""

    key = "loads"
    about = "Forces and moments on bodies."
    rank = 0
    kinds = (Force, TurningForce, PressForce, GuideForce, ForceTable, TableForce, Moment)

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
            return (ForceTable if plain else GuideForce)(self.body, at, force, table)
        if self.last is None or slide is None:
            return (Force if frame == "ground" else TurningForce)(self.body, at, force)
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
