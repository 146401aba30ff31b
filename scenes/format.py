"""The files as they are written, `format = 1`: keys, types, ranges. Numbers are in the units of the scene file."""

from collections.abc import Iterator
from math import isfinite
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, PlainValidator, Strict, StringConstraints, ValidationError
from pydantic_core import PydanticCustomError

from . import limits
from .errors import nearest, one_line, path_in_file
from .scene import GROUND

NAME = r"^[A-Za-z][A-Za-z0-9_]*$"
_NAMES = 2 * limits.NAME + 1  # characters of two names and what joins them
Name = Annotated[str, StringConstraints(pattern=NAME, max_length=limits.NAME)]
Known = Annotated[str, StringConstraints(max_length=limits.NAME)]  # a name that is looked up
PointPair = Annotated[str, StringConstraints(pattern=rf"{NAME[:-1]}-{NAME[1:]}", max_length=_NAMES)]
BodyPoint = Annotated[str, StringConstraints(pattern=rf"{NAME[:-1]}\.{NAME[1:]}", max_length=_NAMES)]
Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Pair = Annotated[tuple[Number, Number], Strict(False)]  # TOML has arrays, not tuples; the numbers stay strict
Points = Annotated[dict[Name, Pair], Field(min_length=1)]


def _number_or_text(value: object) -> float | str:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise PydanticCustomError("number_or_text", "expected a number or a text")
    if not isinstance(value, str) and not isfinite(value):
        raise PydanticCustomError("number_or_text", "expected a finite number")
    return value


NumberOrText = Annotated[float | str, PlainValidator(_number_or_text)]


class Table(BaseModel):
    """A TOML table: no unknown keys, no silent conversion of types."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Units(Table):
    """What the numbers of the file are in; SI where absent."""

    length: str = "m"
    mass: str = "kg"
    force: str = "N"
    angle: str = "rad"
    speed: str | None = None  # rad/s for a crank, m/s for a driven slider


class GroundTable(Table):
    """The fixed points."""

    points: Points


class SlideTable(Table):
    """A straight guide, in the frame of the body `on`."""

    on: Known = GROUND
    through: Pair
    along: Pair


class BodyTable(Table):
    """A rigid body: its points in its own frame, or its lengths."""

    points: Points | None = None
    lengths: Annotated[dict[PointPair, Positive], Field(min_length=1)] | None = None
    mass: NotNegative | None = None
    com: Pair | None = None
    inertia: NotNegative | None = None
    slides: SlideTable | None = None


class DriveTable(Table):
    """The driven body, a crank or a slider, and its speed or its motion law: [time in s, angle or displacement]."""

    body: Known
    speed: Number | None = None
    start: Number | None = None
    end: Number | None = None
    law: Annotated[list[Pair], Field(min_length=4, max_length=limits.ROWS)] | None = None
    periodic: bool | None = None


class LoadTable(Table):
    """A force on a point of a body: constant, only in the last part of the closing stroke, or a table against it."""

    body: Known
    at: Known
    force: Pair | None = None
    last: Positive | None = None
    table: Annotated[list[Pair], Field(min_length=2, max_length=limits.ROWS)] | None = None


class SpringTable(Table):
    """A linear spring between two points, each as `body.point`."""

    between: Annotated[tuple[BodyPoint, BodyPoint], Strict(False)]
    stiffness: Positive
    length: NotNegative


class SketchTable(Table):
    """Rough point positions, one key a point, at one `angle` of the crank or `displacement` of the driven slider."""

    model_config = ConfigDict(extra="allow", strict=True, frozen=True)
    __pydantic_extra__: dict[str, Pair] = Field(init=False)

    angle: Number | None = None
    displacement: Number | None = None


class OutputTable(Table):
    """The point that the report is about."""

    slider: Known | None = None
    point: Known | None = None


class TolerancesTable(Table):
    """The largest error by channel group, relative to range."""

    position: Positive | None = None
    velocity: Positive | None = None
    acceleration: Positive | None = None
    reaction: Positive | None = None
    torque: Positive | None = None


class SceneFile(Table):
    """A whole scene file."""

    format: Literal[1]
    name: Name
    title: Annotated[str, Field(max_length=limits.TITLE)] = ""
    source: Annotated[str, Field(max_length=limits.SOURCE)] = ""
    units: Units = Units()
    gravity: Pair | None = None
    ground: GroundTable
    bodies: Annotated[dict[Name, BodyTable], Field(min_length=1, max_length=limits.BODIES)]
    drive: DriveTable
    loads: Annotated[list[LoadTable], Field(max_length=limits.LOADS)] = []
    springs: Annotated[list[SpringTable], Field(max_length=limits.LOADS)] = []
    sketch: SketchTable
    output: OutputTable
    tolerances: dict[Name, TolerancesTable] = {}


class LadderFile(Table):
    """A whole ladder file: one scene, with another value at some of its paths on every rung."""

    format: Literal[1]
    title: str
    scene: str
    parameter: str
    paths: Annotated[list[str], Field(min_length=1)]
    steps: Annotated[dict[str, NumberOrText], Field(min_length=1)]
    expected: str
    why: str
    status: dict[str, str] = {}
    digits: bool = False
    long: bool = False


# --- one line for the first thing that is wrong ----------------------------------------------------------------------


def explain(error: ValidationError, file: type[Table]) -> str:
    """Return a line on the first of the errors in a file; the rest is counted, since one slip often causes several."""
    first, *rest = sorted(error.errors(include_url=False), key=lambda e: e["type"] != "extra_forbidden")
    location = [part for part in first["loc"] if part != "[key]"]
    entries = "points, each as 'body.point'" if "between" in location else "numbers"
    match first["type"]:
        case "extra_forbidden":
            text = f"unknown key{nearest(str(location[-1]), _keys_at(file, location[:-1]))}"
        case "missing" if isinstance(location[-1], int):
            text = f"expected two {entries}"
        case "missing":
            text = "missing; the file needs it"
        case "too_short":
            text = f"expected {first['ctx']['min_length']} or more entries, found {first['ctx']['actual_length']}"
        case "too_long" if first["ctx"]["max_length"] == 2:
            text = f"expected two {entries}"
        case "too_long":
            text = f"expected {first['ctx']['max_length']} entries at most, found {len(first['input'])}"
        case "string_too_long":
            text = f"expected {first['ctx']['max_length']} characters at most, found {len(first['input'])}"
        case "string_pattern_mismatch":
            wanted = "letters, digits and '_', starting with a letter"
            wanted = "two point names joined by '-'" if "lengths" in location else wanted
            wanted = "a point of a body, as 'body.point'" if "between" in location else wanted
            text = f"not a name: expected {wanted}"
        case "model_type" | "dict_type":
            text = "expected a table"
        case "greater_than" | "greater_than_equal" | "literal_error":
            text = f"{first['msg'].replace('Input should be', 'expected')}, found {one_line(repr(first['input']), 40)}"
        case _:
            text = f"{first['msg'].replace('Input should be', 'expected')}, found '{one_line(str(first['input']), 40)}'"
    return f"{path_in_file(location)}: {text}" + (f" (and {len(rest)} more)" if rest else "")


def _keys_at(model: type[BaseModel], location: list[int | str]) -> Iterator[str]:
    """Yield the keys that the table at this place of a file may have."""
    for part in location:
        if isinstance(part, str) and part in model.model_fields:
            model = next(_tables_in(model.model_fields[part].annotation), model)
    yield from model.model_fields


def _tables_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _tables_in(argument)
