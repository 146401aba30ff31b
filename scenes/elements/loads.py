"""Loads: forces on points of bodies, and moments, as functions of where those are. They are the scene's input.

What a load depends on, a slider's displacement and velocity or the drive's position, each model finds by its own means.
A slider's displacement is that of its body's first point along its guide from `through`, in the frame of the guide.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, Tag

from .. import limits
from ..bodies import GROUND, Body, Slide
from ..demand import Demand, of_size
from ..errors import InputError
from ..fields import Direction, ForceVector, Known, Length, NewtonMetres, Newtons, Pair
from .element import Element, ElementTable, End
from .tables import COLUMN, LoadCurve, Over

if TYPE_CHECKING:
    from ..scene import Scene

Frame: TypeAlias = Literal["ground", "body"]


class Framed:
    """What is given in the frame of the ground, unless a subclass is in that of its body."""

    frame: Frame = "ground"


@dataclass(frozen=True)
class Load(Element, Framed):
    """A force on a point of a body, or a moment."""

    body_key = "body"
    point_key = "at"
    is_moment: ClassVar[bool] = False

    body: str
    at: str

    @property
    def turned(self) -> "Load | None":
        """The same numbers in the other frame, that of the body or of the ground; None of one without frames."""
        return None

    @property
    def always(self) -> "Load":
        """The same load where nothing switches it off."""
        return self

    def largest_along(self, slide: Slide) -> Any:  # noqa: ARG002
        """Its largest part along a guide on the ground, N."""
        return 0.0

    @property
    def ends(self) -> tuple[End]:
        """The body and its point."""
        return ((self.body, self.at),)

    @property
    def named(self) -> str:
        """What a sentence calls it, with a gap for its spot."""
        return "the load at {place}"

    def bodies(self, scene: "Scene") -> frozenset[str]:
        """Its body, and what that slides on."""
        slide = scene.slides.get(self.body)
        return frozenset((self.body,) if slide is None else (self.body, slide.on))

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield what of its names does not fit the scene, and what of its table."""
        if self.table is not None:
            yield from self.table.problems(scene, f"{place}.table")
        yield from super().problems(scene, place)


@dataclass(frozen=True)
class Force(Load):
    """A constant force."""

    kind = "forces"
    plain = True
    steady = True

    force: ForceVector  # N

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """Its larger part."""
        return float(np.abs(self.force).max())

    @property
    def turned(self) -> "Force":
        """The same numbers in the frame of its body."""
        return TurningForce(self.body, self.at, self.force)

    def largest_along(self, slide: Slide) -> Any:
        """Its part along the guide."""
        return push(self.force, slide)


@dataclass(frozen=True)
class TurningForce(Force):
    """A constant force in the frame of its body, with which it turns."""

    kind = "forces that turn with their body"
    plain = False
    frame = "body"

    @property
    def turned(self) -> Force:
        """The same numbers in the frame of the ground."""
        return Force(self.body, self.at, self.force)


@dataclass(frozen=True)
class PressForce(Load):
    """A constant force that resists a slider in the last part of its closing stroke, and only there.

    The slider closes while it moves against the force. Its stroke ends where a cycle of the drive takes it furthest
    against the force; from `last` before that end it meets the force, and on the way back it does not.
    """

    kind = "press forces"
    plain = True

    force: ForceVector  # N, ground frame; its body slides on the ground
    last: Length  # m
    closing: int  # the sign of the displacement's rate while the slider closes

    def acts(self, displacement: Any, velocity: Any, end: float) -> NDArray[np.bool_]:
        """Where the force acts: displacements, m, velocities, m/s, of one shape; the stroke ends at `end`, m."""
        before_end = (end - displacement) * self.closing
        acts: NDArray[np.bool_] = (before_end <= self.last) & (velocity * self.closing > 0)
        return acts

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """Its larger part."""
        return float(np.abs(self.force).max())

    @property
    def always(self) -> Force:
        """A constant force."""
        return Force(self.body, self.at, self.force)

    def largest_along(self, slide: Slide) -> Any:
        """Its part along the guide."""
        return push(self.force, slide)

    def settled(self, scene: "Scene") -> "PressForce":
        """The same force, which its slider closes against."""
        return replace(self, closing=closing_sense(self.force, scene.slides[self.body]))

    def demands(self, scene: "Scene", place: str) -> Iterator[Demand]:
        """Yield that it has a part along the guide."""
        if slide := scene.bodies[self.body].slide:
            text = f"{place}.force: expected a part along the guide, which the slider closes against, found {{:g}}"
            yield Demand(text, (part := push(self.force, slide)) != 0, (part,))


def push(force: tuple[Any, Any], slide: Slide) -> Any:
    """The part of a force along a guide."""
    return force[0] * slide.along[0] + force[1] * slide.along[1]


def closing_sense(force: tuple[Any, Any], slide: Slide) -> Any:
    """The sign of the rate of a slider's displacement while it closes against a force; of many machines an array."""
    against = push(force, slide) > 0
    return np.where(against, -1, 1) if np.ndim(against) else -1 if against else 1


@dataclass(frozen=True)
class GuideForce(Load):
    """A force along the guide of a sliding body, whose reaction acts on what has the guide, at the same place."""

    kind = "forces along guides"

    force: Newtons | None = None  # N, along `along`; or a table
    table: LoadCurve | None = None

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """The largest entry of its table, or its own size."""
        return float(np.abs(self.table.values if self.table else self.force or 0.0).max())

    def largest_along(self, slide: Slide) -> Any:  # noqa: ARG002
        """Its largest size."""
        return self.table.largest if self.table else self.force


@dataclass(frozen=True)
class ForceTable(GuideForce):
    """A force along a guide on the ground, by a table against the displacement, constant beyond it."""

    kind = "force tables"
    plain = True


@dataclass(frozen=True)
class TableForce(Load):
    """A force of one direction whose size follows a table; in its body's frame it turns with the body."""

    kind = "forces by tables"

    along: Direction  # of any length
    table: LoadCurve
    frame: Frame = "ground"

    @property
    def turned(self) -> "TableForce":
        """The same numbers in the other frame."""
        return replace(self, frame="body" if self.frame == "ground" else "ground")

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """The largest entry of its table."""
        return float(np.abs(self.table.values).max())

    def largest_along(self, slide: Slide) -> Any:
        """Its largest part."""
        return push(self.direction, slide) * self.table.largest

    def demands(self, scene: "Scene", place: str) -> Iterator[Demand]:
        """Yield that its direction has a length, and what its table has to be."""
        yield of_size(f"{place}.along: expected a direction of a size", np.hypot(*self.along))
        yield from super().demands(scene, place)

    @property
    def direction(self) -> tuple[Any, Any]:
        """The unit vector along it."""
        x, y = self.along
        length = np.sqrt(x * x + y * y)
        return x / length, y / length


@dataclass(frozen=True)
class Moment(Load):
    """A moment on a body, counter-clockwise positive, constant or by a table.

    It turns the body alike wherever it acts, and is drawn at its point.
    """

    kind = "moments"
    is_moment = True

    moment: NewtonMetres | None = None  # N m; or a table
    table: LoadCurve | None = None

    @property
    def spot(self) -> str:
        """Its body, which all of it turns."""
        return self.body

    @property
    def named(self) -> str:
        """What a sentence calls it, with a gap for its spot."""
        return "the moment on {place}"

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """That on an arm as long as the linkage."""
        return float(np.abs(self.table.values if self.table else self.moment or 0.0).max()) / size


TabledLoad: TypeAlias = GuideForce | TableForce | Moment  # whose size may be by a table


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
