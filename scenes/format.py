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
ENGINE = r"[A-Za-z0-9][A-Za-z0-9_.-]{0,39}"  # it is part of file names, and of lists with commas
EngineName = Annotated[str, StringConstraints(pattern=rf"^{ENGINE}(@[A-Za-z0-9_.-]+)?$", max_length=_NAMES)]
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

    # A file's tables are built together when the first one is read, not each by itself on import.
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, defer_build=True)


class Units(Table):
    """What the numbers of the file are in; SI where absent."""

    length: str = Field("m", description='Of all coordinates and lengths, as "mm".')
    mass: str = Field("kg", description="Of masses, and with the length's square of inertias.")
    force: str = Field("N", description="Of loads, and over the length of stiffnesses.")
    angle: str = Field("rad", description='Of angles of the drive and the sketch, as "deg".')
    speed: str | None = Field(
        None, description='Of a crank as "rpm", or rad/s where absent; of a driven slider as "mm/s", or m/s.'
    )


class GroundTable(Table):
    """What does not move."""

    points: Points = Field(description="The fixed points, by name: [x, y].")


class SlideTable(Table):
    """A straight guide, along which the body's first point moves; the body does not turn against what it slides on."""

    on: Known = Field(GROUND, description="The body that has the guide.")
    through: Pair = Field(description="A point of the guide, in the frame of what has it.")
    along: Pair = Field(description="The direction of the guide, in the frame of what has it; of any length.")


class BodyTable(Table):
    """A rigid body: its points in its own frame, or its lengths."""

    points: Points | None = Field(
        None, description="By name: [x, y] in its own frame. A point that two bodies name is a pin."
    )
    lengths: Annotated[dict[PointPair, Positive], Field(min_length=1)] | None = Field(
        None,
        description='Instead of `points`, as "A-B" = 200; each point after the second needs those to two before it.',
    )
    mass: NotNegative | None = Field(None, description="Its mass; without any in the file there are no forces.")
    com: Pair | None = Field(
        None,
        description="Its centre of mass, own frame; not of a point, a uniform bar (points on one line too) or plate.",
    )
    inertia: NotNegative | None = Field(None, description="Its moment of inertia about the centre of mass.")
    slides: SlideTable | None = Field(None, description="The guide on which it slides, if any.")


class DriveTable(Table):
    """The driven body, a crank or a slider, and its speed or its motion law."""

    body: Known = Field(description="A body with one pin on the ground, or one that slides on the ground.")
    speed: Number | None = Field(None, description="The constant speed; negative clockwise, or against `along`.")
    start: Number | None = Field(
        None, description="At time zero: the angle of its x axis, or its displacement from `through`."
    )
    end: Number | None = Field(None, description="Where it stops; without it a crank turns for ever.")
    law: Annotated[list[Pair], Field(min_length=4, max_length=limits.ROWS)] | None = Field(
        None, description="Instead of a speed: [time in s, angle or displacement], for a cubic spline."
    )
    periodic: bool | None = Field(None, description="Whether the law goes on for ever.")


class LoadTable(Table):
    """A force on a point of a body: constant, only in the last part of the closing stroke, or a table against it."""

    body: Known = Field(description="The body on which it acts.")
    at: Known = Field(description="The point of the body at which it acts.")
    force: Pair | None = Field(None, description="The force: [x, y].")
    last: Positive | None = Field(
        None, description="Only in this last part of the stroke that closes against the force."
    )
    table: Annotated[list[Pair], Field(min_length=2, max_length=limits.ROWS)] | None = Field(
        None, description="Instead of `force`: [displacement of the slider, force along its guide]."
    )


class SpringTable(Table):
    """A linear spring between two points."""

    between: Annotated[tuple[BodyPoint, BodyPoint], Strict(False)] = Field(
        description='Each as "body.point", or "ground.S".'
    )
    stiffness: Positive = Field(description="Force by length.")
    length: NotNegative = Field(description="Its length without force.")


class SketchTable(Table):
    """Rough positions of the moving points, a key each, at one place of the drive: how the bodies are assembled."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Pair] = Field(init=False)

    angle: Number | None = Field(None, description="The crank's angle in the sketch; 0 where absent.")
    displacement: Number | None = Field(None, description="The driven slider's displacement in the sketch.")


class OutputTable(Table):
    """The point that the report is about."""

    slider: Known | None = Field(None, description="A point of a body that slides on the ground.")
    point: Known | None = Field(None, description="Any other moving point.")


class VariationTable(Table):
    """What the workshop may deviate: a number of the file, and by how much, for `--monte-carlo`."""

    path: str = Field(max_length=limits.PATH, description='Where the number is, as "bodies.rocker.lengths.O-P3".')
    plus_minus: Annotated[Positive, Field(le=limits.LARGEST)] = Field(
        description="In the number's unit: three standard deviations, or all of a uniform."
    )
    distribution: Literal["normal", "uniform"] = Field("normal", description='"normal" where absent, or "uniform".')


class TolerancesTable(Table):
    """The largest relative errors by channel group; `--check` fails where one is larger."""

    position: Positive | None = Field(None, description="Of points, over their own travel; of angles, over 1 rad.")
    velocity: Positive | None = Field(None, description="Over the same times the drive's rate.")
    acceleration: Positive | None = Field(None, description="Over the same times its square.")
    reaction: Positive | None = Field(None, description="Of the forces of joints and guides, over their peaks.")
    torque: Positive | None = Field(None, description="Of the driven crank's torque, over its peak.")
    force: Positive | None = Field(None, description="Of the driven slider's force, over its peak.")


class SceneFile(Table):
    """A whole scene file."""

    format: Literal[1] = Field(description="The version of this format.")
    name: Name = Field(description='Of the folder of results: letters, digits and "_", a letter first.')
    title: str = Field("", max_length=limits.TITLE, description="The heading of the report.")
    source: str = Field("", max_length=limits.SOURCE, description="Where its numbers come from.")
    units: Units = Field(Units.model_validate({}), description="What the numbers of the file are in; SI where absent.")
    gravity: Pair | None = Field(None, description="[x, y] in m/s^2; none where absent.")
    ground: GroundTable = Field(description="What does not move.")
    bodies: dict[Name, BodyTable] = Field(
        min_length=1,
        max_length=limits.BODIES,
        description="The moving bodies, by name. A pin's force acts from the body named first here on the other one.",
    )
    drive: DriveTable = Field(description="The driven body, and how it moves.")
    loads: list[LoadTable] = Field([], max_length=limits.LOADS, description="Forces on bodies.")
    springs: list[SpringTable] = Field([], max_length=limits.LOADS, description="Linear springs between two points.")
    variations: list[VariationTable] = Field(
        [], max_length=limits.VARIATIONS, description="What the workshop may deviate, for `--monte-carlo`."
    )
    sketch: SketchTable = Field(description="Rough positions, which show how the bodies are assembled.")
    output: OutputTable = Field(description="The point that the report is about.")
    tolerances: dict[EngineName, TolerancesTable] = Field({}, description="By engine, largest errors for `--check`.")
    results: dict[Name, dict[str, Any]] = Field({}, description="By name how to read a result, for `--result`.")


class LadderFile(Table):
    """A whole ladder file: one scene, with another value at some of its paths on every rung."""

    format: Literal[1] = Field(description="The version of this format.")
    title: str = Field(description="What gets harder.")
    scene: str = Field(description="The file of the scene, beside this one, or the name of a shipped one.")
    parameter: str = Field(description="What the steps are values of.")
    paths: list[str] = Field(min_length=1, description="Where in the scene the values go, as `bodies.rod.mass`.")
    steps: dict[str, NumberOrText] = Field(min_length=1, description="The rungs: name and value.")
    expected: str = Field(description="What is to be expected on the way.")
    why: str = Field(description="Where the difficulty comes from.")
    status: dict[str, str] = Field({}, description="By rung, the reference's status where that is not ok.")
    digits: bool = Field(False, description="Whether lost digits are counted on it.")
    long: bool = Field(False, description="Whether it has so many turns that it is left to the long runs.")


# --- one line for the first thing that is wrong ----------------------------------------------------------------------


def explain(error: ValidationError, file: type[Table]) -> str:
    """Return a line on the first of the errors in a file; the rest is counted, since one slip often causes several."""
    first, *rest = sorted(error.errors(include_url=False), key=lambda e: e["type"] != "extra_forbidden")
    location = [part for part in first["loc"] if part != "[key]"]
    entries = "points, each as 'body.point'" if "between" in location else "numbers"
    match first["type"]:
        case "extra_forbidden":
            text = f"unknown key{nearest(str(location[-1]), _keys_at(file, location[:-1]))}"
        case "float_type" if location[:-1] == ["sketch"] and isinstance(first["input"], list):
            text = "expected a number, since it is where the drive is; a point needs another name"
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
            wanted = "an engine's, of letters, digits, '_', '.' and '-'" if "tolerances" in location else wanted
            text = f"not a name: expected {wanted}"
        case "model_type" | "dict_type":
            text = "expected a table"
        case "less_than_equal":
            text = f"expected {first['ctx']['le']:g} at most, found {first['input']:g}"
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
