"""The files as they are written, `format = 1`: keys, types, ranges. Numbers are in the units of the scene file."""

from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, Strict, ValidationError

from .. import limits
from ..bodies import BodyTable
from ..drive import DriveTable
from ..elements.friction import FrictionTable
from ..elements.loads import LoadTable
from ..elements.springs import SpringTable, TorsionSpringTable
from ..errors import InputError, nearest, one_line, path_in_file
from ..fields import PATTERNS, EngineName, FileTable, Gravity, Known, Name, Place, Position, Positive, parts
from ..scene import LimitTable, VariationTable

# To Python, True is 1.
Format = Annotated[Literal[1], BeforeValidator(lambda value: str(value) if isinstance(value, bool) else value)]


class Units(FileTable):
    """What the numbers of the file are in; SI where absent."""

    length: str = Field("m", description='Of all coordinates and lengths, as "mm".')
    mass: str = Field("kg", description="Of masses, and with the length's square of inertias.")
    force: str = Field("N", description="Of loads, and over the length of stiffnesses.")
    angle: str = Field("rad", description='Of angles of the drive and the sketch, as "deg".')
    moment: str | None = Field(None, description='Of moments; the force times metre, as "kN*m", where absent.')
    speed: str | None = Field(
        None, description='Of a crank as "rpm", or rad/s where absent; of a driven slider as "mm/s", or m/s.'
    )


class GroundTable(FileTable):
    """What does not move."""

    points: Annotated[dict[Name, Place], Field(min_length=1)] = Field(description="The fixed points, by name: [x, y].")


class SketchTable(FileTable):
    """Rough positions of the moving points, a key each, at one place of the drive: how the bodies are assembled."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Place] = Field(init=False)

    angle: Position | None = Field(None, description="The crank's angle in the sketch; 0 where absent.")
    displacement: Position | None = Field(None, description="The driven slider's displacement in the sketch.")


class OutputTable(FileTable):
    """The point that the report is about."""

    slider: Known | None = Field(None, description="A point of a body that slides on the ground.")
    point: Known | None = Field(None, description="Any other moving point.")


class TolerancesTable(FileTable):
    """The largest relative errors by channel group; `--check` fails where one is larger."""

    position: Positive | None = Field(None, description="Of points, over their own travel; of angles, over 1 rad.")
    velocity: Positive | None = Field(None, description="Over the same times the drive's rate.")
    acceleration: Positive | None = Field(None, description="Over the same times its square.")
    reaction: Positive | None = Field(None, description="Of the forces of joints and guides, over their peaks.")
    torque: Positive | None = Field(None, description="Of the driven crank's torque, over its peak.")
    force: Positive | None = Field(None, description="Of the driven slider's force, over its peak.")


class SceneFile(FileTable):
    """A whole scene file."""

    format: Format = Field(description="The version of this format.")
    name: Name = Field(description='Of the folder of results: letters, digits and "_", a letter first.')
    title: str = Field("", max_length=limits.TITLE, description="The heading of the report.")
    source: str = Field("", max_length=limits.SOURCE, description="Where its numbers come from.")
    units: Units = Field({}, validate_default=True, description="What the numbers of the file are in; SI where absent.")
    gravity: Annotated[tuple[Gravity, Gravity], Strict(False)] | None = Field(
        None, description="[x, y] in m/s^2; none where absent."
    )
    ground: GroundTable = Field(description="What does not move.")
    bodies: dict[Name, BodyTable] = Field(
        min_length=1,
        max_length=limits.BODIES,
        description="The moving bodies, by name. A pin's force acts from the body named first here on the other one.",
    )
    drive: DriveTable = Field(description="The driven body, and how it moves.")
    loads: list[LoadTable] = Field([], max_length=limits.LOADS, description="Forces and moments on bodies.")
    springs: list[SpringTable] = Field(
        [], max_length=limits.LOADS, description="Linear springs and dampers between two points."
    )
    torsion_springs: list[TorsionSpringTable] = Field(
        [], max_length=limits.LOADS, description="Springs and dampers that twist, at a pin."
    )
    friction: list[FrictionTable] = Field(
        [], max_length=limits.LOADS, description="Friction of pins and guides; none where absent."
    )
    variations: list[VariationTable] = Field(
        [], max_length=limits.VARIATIONS, description="What the workshop may deviate, for `--monte-carlo`."
    )
    sketch: SketchTable = Field(description="Rough positions, which show how the bodies are assembled.")
    output: OutputTable = Field(description="The point that the report is about.")
    tolerances: dict[EngineName, TolerancesTable] = Field({}, description="By engine, largest errors for `--check`.")
    limits: dict[str, LimitTable] = Field(
        {}, max_length=limits.LOADS, description='By channel or magnitude, as "P1.force", what `--check` holds it to.'
    )
    results: dict[Name, dict[str, Any]] = Field({}, description="By name how to read a result, for `--result`.")


BEYOND = {  # by keys that files may be thought to have
    "gear cam belt chain": "no such joint here, bodies are joined by pins and straight slides",
    "clearance backlash": "no clearance here, joints are without play",
    "drive.torque drive.force": "a drive is not pushed, expected its motion, by which this is found",
}
File = TypeVar("File", bound=FileTable)


def validated(file: type[File], tables: object) -> File:
    """What the tables of a file hold; InputError, `<path in it>: <what was expected>`, where they do not fit."""
    try:
        return file.model_validate(tables)
    except ValidationError as error:
        raise InputError(_explained(error, file)) from None


def _explained(error: ValidationError, file: type[FileTable]) -> str:
    """A line on the first of the errors in a file; the rest is counted, since one slip often causes several."""
    first, *rest = sorted(error.errors(include_url=False), key=lambda e: e["type"] != "extra_forbidden")
    location = [part for part in first["loc"] if part not in ("[key]", "vector", "number")]
    given, limits_of = first["input"], first.get("ctx", {})
    entries = "points, each as 'body.point'" if "between" in location else "numbers"
    count = "three" if "harmonics" in location else "two"
    match first["type"]:
        case "extra_forbidden" if why := _beyond(location):
            text = f"{why}; see docs/limits.md"
        case "extra_forbidden":
            text = f"unknown key{nearest(str(location[-1]), _keys_at(file, location[:-1]))}"
        case "float_type" if location[:-1] == ["sketch"] and isinstance(given, list):
            text = "expected a number, since it is where the drive is; a point needs another name"
        case "missing" if not isinstance(location[-1], int):
            text = "missing; the file needs it"
        case "missing" | "too_long" if limits_of.get("max_length", 2) == 2:
            text = f"expected {count} {entries}"
        case "too_short":
            text = f"expected {limits_of['min_length']} or more entries, found {limits_of['actual_length']}"
        case "too_long" | "string_too_long" as kind:
            what = "entries" if kind == "too_long" else "characters"
            text = f"expected {limits_of['max_length']} {what} at most, found {len(given)}"
        case "string_pattern_mismatch":
            text = f"not a name: expected {PATTERNS[limits_of['pattern']]}"
        case "model_type" | "dict_type":
            text = "expected a table"
        case "less_than_equal":
            text = f"expected {limits_of['le']:g} at most, found {given:g}"
        case kind:
            as_written = kind in ("greater_than", "greater_than_equal", "literal_error")
            shown = one_line(repr(given), 40) if as_written else f"'{one_line(str(given), 40)}'"
            text = f"{first['msg'].replace('Input should be', 'expected')}, found {shown}"
    return f"{path_in_file(location)}: {text}" + (f" (and {len(rest)} more)" if rest else "")


def _beyond(location: Sequence[int | str]) -> str | None:
    """What a key that is not known asks for beyond these models, and what they have instead."""
    names = {str(location[-1]).removesuffix("s"), ".".join(map(str, location))}
    return next((why for keys, why in BEYOND.items() if not names.isdisjoint(keys.split())), None)


def _keys_at(model: type[BaseModel], location: list[int | str]) -> Iterator[str]:
    for part in location:
        if isinstance(part, str) and part in model.model_fields:
            kinds = (kind for kind in parts(model.model_fields[part].annotation) if isinstance(kind, type))
            model = next((kind for kind in kinds if issubclass(kind, BaseModel)), model)
    yield from model.model_fields
