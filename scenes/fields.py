"""What the fields of a scene, and of the tables of its file, may hold: names, and numbers of some quantity.

A quantity is declared once, in the type of its fields, as `mass: Mass`. In a table pydantic holds numbers to its sign;
`scenes.numbers` finds it in the annotations of the scene, for whatever else asks what the numbers of a scene are.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from annotated_types import Ge, GroupedMetadata, Gt
from pydantic import AllowInfNan, BaseModel, ConfigDict, Strict, StringConstraints

from . import limits

NAME = r"^[A-Za-z][A-Za-z0-9_]*$"
ENGINE = r"[A-Za-z0-9][A-Za-z0-9_.-]{0,39}"  # it is part of file names, and of lists with commas
_PAIR, _POINT = (rf"{NAME[:-1]}{between}{NAME[1:]}" for between in ("-", r"\."))
_ENGINE = rf"^{ENGINE}(@[A-Za-z0-9_.-]+)?$"
_TWO = 2 * limits.NAME + 1  # characters of two names and what joins them
PATTERNS = {
    NAME: "letters, digits and '_', starting with a letter",
    _PAIR: "two point names joined by '-'",
    _POINT: "a point of a body, as 'body.point'",
    _ENGINE: "an engine's, of letters, digits, '_', '.' and '-'",
}
Name = Annotated[str, StringConstraints(pattern=NAME, max_length=limits.NAME)]
EngineName = Annotated[str, StringConstraints(pattern=_ENGINE, max_length=_TWO)]
Known = Annotated[str, StringConstraints(max_length=limits.NAME)]  # a name that is looked up
PointPair = Annotated[str, StringConstraints(pattern=_PAIR, max_length=_TWO)]
BodyPoint = Annotated[str, StringConstraints(pattern=_POINT, max_length=_TWO)]


class FileTable(BaseModel):
    """A TOML table: no unknown keys, no silent conversion of types."""

    # A file's tables are built together when the first one is read, not each by itself on import.
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, defer_build=True)


@dataclass(frozen=True)
class Quantity(GroupedMetadata):
    """A kind of number: of what dimension, sign and size it is."""

    dimension: str  # by which `Scene.all_units` has its unit
    smallest: float = 0.0  # SI, of what is not zero; products of such numbers stay far within what a double holds
    largest: float = 1e15
    negative: bool = True  # whether it may be
    zero: bool = True

    def __iter__(self) -> Iterator[object]:
        """Yield what pydantic is to hold a number of a table to."""
        yield from (Strict(), AllowInfNan(False))
        if not self.negative:
            yield Ge(0) if self.zero else Gt(0)

    @property
    def sign(self) -> str:
        """What is expected of its sign, as messages name it."""
        return "a number other than zero" if self.negative else "zero or more" if self.zero else "more than zero"

    def has_sign(self, value: Any) -> Any:
        """Whether a number, or each of an array, has a sign that it may have."""
        return (self.negative or value >= 0) & (self.zero or value != 0)

    def fits(self, value: Any) -> Any:
        """Whether a number in SI, or each of an array, is of a size that all models can take."""
        size = abs(value)
        return (value == 0) | ((self.smallest <= size) & (size <= self.largest))


Vector: TypeAlias = tuple[float, float]

Number = Annotated[float, Strict(), AllowInfNan(False)]  # of a file, but of no scene
Positive = Annotated[Number, Gt(0)]
Pair = Annotated[tuple[Number, Number], Strict(False)]  # TOML has arrays, not tuples; the numbers stay strict

Coordinate = Annotated[float, Quantity("length")]
Length = Annotated[float, Quantity("length", 1e-15, negative=False, zero=False)]
RestLength = Annotated[float, Quantity("length", 1e-15, negative=False)]
Mass = Annotated[float, Quantity("mass", 1e-15, negative=False)]
Inertia = Annotated[float, Quantity("inertia", 1e-45, 1e45, negative=False)]
Stiffness = Annotated[float, Quantity("stiffness", 1e-15, negative=False, zero=False)]
Newtons = Annotated[float, Quantity("force")]
Component = Annotated[float, Quantity("direction")]  # of a direction, whose length is of no matter
Gravity = Annotated[float, Quantity("gravity")]
Time = Annotated[float, Quantity("time", 1e-15)]
Position = Annotated[float, Quantity("position")]  # of the drive: an angle, or a displacement
Speed = Annotated[float, Quantity("speed", 1e-15, zero=False)]  # of the drive too

Place = Annotated[tuple[Coordinate, Coordinate], Strict(False)]
Direction = Annotated[tuple[Component, Component], Strict(False)]
ForceVector = Annotated[tuple[Newtons, Newtons], Strict(False)]
