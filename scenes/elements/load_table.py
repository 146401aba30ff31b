"""The table of a load in a scene file, and which load its keys mean."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Discriminator, Field, Strict, Tag

from .. import limits
from ..bodies import GROUND, Body
from ..errors import InputError
from ..fields import Direction, FileTable, Finite, ForceVector, Known, Length, NewtonMetres, Newtons
from .loads import Force, ForceTable, Frame, GuideForce, Load, Moment, PressForce, TableForce, closing_sense
from .tables import COLUMN, Over, Table

Row = Annotated[tuple[Finite, Finite], Strict(False)]
KEYS = ("force", "moment", "table")  # of which a load has one


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
    last: Length | None = Field(None, description="Only in this last part of the stroke that closes against the force.")
    moment: NewtonMetres | None = Field(None, description="Instead of `force`: a moment, counter-clockwise positive.")
    table: Annotated[list[Row], Field(min_length=2, max_length=limits.ROWS)] | None = Field(
        None,
        description="Instead: [argument, value], a force along the body's guide or `along`, or without `at` a moment.",
    )
    over: Over | None = Field(
        None, description="What the table's arguments are: `drive`, `time`, or the slider's `displacement`."
    )
    along: Direction | None = Field(None, description="The direction of a table's force where it is not the guide's.")
    periodic: bool | None = Field(None, description="Whether the table goes on for ever.")
    frame: Frame | None = Field(None, description="`body` for a force that turns with its body; else `ground`.")

    def element(self, place: str, bodies: Mapping[str, Body]) -> Load:
        """The load, its numbers as they are, or InputError where the keys do not go together."""
        given = [key for key in KEYS if getattr(self, key) is not None]
        if len(given) != 1:
            raise InputError(f"{place}: expected either 'force', 'moment' or 'table'")
        (key,) = given
        self._check_keys(place, key)
        if self.body not in bodies:
            return Moment(self.body, "", 0.0)  # which is refused by its name
        slide, at = bodies[self.body].slide, self.at or bodies[self.body].points[0]
        number = isinstance(self.force, float | int)
        on_guide = number or (key == "table" and self.along is None and not (self.at is None and slide is None))
        if slide is None and (on_guide or self.over == "displacement" or self.last is not None):
            why = "over" if self.over == "displacement" else "last" if self.last is not None else key
            ground = " on the ground" if self.last is not None else ""
            raise InputError(f"{place}.{why}: expected a body that slides{ground}, found '{self.body}'")
        if slide is not None and on_guide:
            return self._along_guide(place, at, grounded=slide.on == GROUND)
        if self.along is not None:
            return TableForce(self.body, at, self.along, self._table(place, "forces"), self._frame)
        if key != "force":
            return Moment(self.body, at, self.moment, self._table(place, "moments") if self.table else None)
        force: Any = self.force
        if self.last is None:
            return Force(self.body, at, force, self._frame)
        if slide is None or slide.on != GROUND:
            raise InputError(f"{place}.last: expected a body that slides on the ground, found '{self.body}'")
        return PressForce(self.body, at, force, self.last, closing_sense(force, slide))

    def _check_keys(self, place: str, key: str) -> None:
        """Refuse keys beside the one that they do not go with, and what is missing."""
        vector = key == "force" and not isinstance(self.force, float | int)
        table_force = key == "table" and self.along is not None
        fits = {
            "last": (vector, "a 'force' of [x, y]"),
            "over": (key == "table", "a 'table'"),
            "periodic": (key == "table" and self.over is not None, "a 'table' and 'over'"),
            "along": (key == "table" and self.at is not None and self.over is not None, "'at', 'over' and a 'table'"),
            "frame": ((vector and self.last is None) or table_force, "a 'force' of [x, y], or 'along'"),
        }
        for name, (fitting, what) in fits.items():
            if getattr(self, name) is not None and not fitting:
                raise InputError(f"{place}.{name}: expected {what} with it")
        if vector and self.at is None:
            raise InputError(f"{place}.at: missing; a force acts at a point of its body")

    def _along_guide(self, place: str, at: str, *, grounded: bool) -> Load:
        if self.table is None:
            force: Any = self.force
            return GuideForce(self.body, at, force)
        if grounded and self.over in (None, "displacement") and not self.periodic:
            return ForceTable(self.body, at, *zip(*self.table, strict=True))
        return GuideForce(self.body, at, None, self._table(place, "forces"))

    def _table(self, place: str, values: str) -> Table:
        over = self.over or "displacement"
        if self.over is None and values == "moments":
            raise InputError(f"{place}.over: missing; expected 'drive', 'time' or 'displacement' with a moment's table")
        first, second = zip(*self.table or (), strict=True)
        return Table(**{COLUMN[over]: first, values: second}, periodic=bool(self.periodic))

    @property
    def _frame(self) -> Frame:
        return self.frame or "ground"
