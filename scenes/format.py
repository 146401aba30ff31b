"""The scene file as it is written, `format = 1`: keys, types, ranges. Numbers are in the units of the file."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, Strict, StringConstraints

from .scene import GROUND

NAME = r"^[A-Za-z][A-Za-z0-9_]*$"
Name = Annotated[str, StringConstraints(pattern=NAME)]
PointPair = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_]*-[A-Za-z][A-Za-z0-9_]*$")]
BodyPoint = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_]*\.[A-Za-z][A-Za-z0-9_]*$")]
Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Pair = Annotated[tuple[Number, Number], Strict(False)]  # TOML has arrays, not tuples; the numbers stay strict
Points = Annotated[dict[Name, Pair], Field(min_length=1)]


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

    on: str = GROUND
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

    body: str
    speed: Number | None = None
    start: Number | None = None
    end: Number | None = None
    law: Annotated[list[Pair], Field(min_length=4)] | None = None
    periodic: bool | None = None


class LoadTable(Table):
    """A force on a point of a body: constant, only in the last part of the closing stroke, or a table against it."""

    body: str
    at: str
    force: Pair | None = None
    last: Positive | None = None
    table: Annotated[list[Pair], Field(min_length=2)] | None = None


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

    slider: str | None = None
    point: str | None = None


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
    title: str = ""
    source: str = ""
    units: Units = Units()
    gravity: Pair | None = None
    ground: GroundTable
    bodies: Annotated[dict[Name, BodyTable], Field(min_length=1)]
    drive: DriveTable
    loads: list[LoadTable] = []
    springs: list[SpringTable] = []
    sketch: SketchTable
    output: OutputTable
    tolerances: dict[Name, TolerancesTable] = {}
