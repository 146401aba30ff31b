"""The files as they are written, `format = 1`: keys, types, ranges. Numbers are in the units of the scene file."""

from datetime import date, time
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, Strict, create_model
from pydantic_core import PydanticCustomError

from .. import limits
from ..bodies import BodyTable
from ..drive import DriveTable
from ..elements import LISTS
from ..fields import EngineName, FileTable, Gravity, Known, Name, Place, Position, Positive
from ..scene import LimitTable, VariationTable

# To Python, True is 1.
Format = Annotated[Literal[1], BeforeValidator(lambda value: str(value) if isinstance(value, bool) else value)]


def _undated(value: Any) -> Any:
    """What a mapping has, which is looked at when it is asked for; no model and no report takes a date."""
    if isinstance(value, date | time):
        raise PydanticCustomError("date", "expected a number or a text")
    for part in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        _undated(part)
    return value


Undated = Annotated[Any, AfterValidator(_undated)]


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

    points: Annotated[dict[Name, Place], Field(min_length=1)] = Field(
        description="The fixed points, by name: [x, y].", examples=[{"A": [0, 0]}]
    )


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


class _LinkageFile(FileTable):
    """The first keys of a scene file."""

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


if TYPE_CHECKING:
    _LoadedFile = _LinkageFile
else:  # with a key for each list of elements
    _LISTS = {
        key: (list[table], Field([], max_length=limits.LOADS, description=table.about)) for key, table in LISTS.items()
    }
    _LoadedFile = create_model("_LoadedFile", __base__=_LinkageFile, **_LISTS)


class SceneFile(_LoadedFile):
    """A whole scene file."""

    variations: list[VariationTable] = Field(
        [], max_length=limits.VARIATIONS, description="What the workshop may deviate, for `--monte-carlo`."
    )
    sketch: SketchTable = Field(description="Rough positions, which show how the bodies are assembled.")
    output: OutputTable = Field(description="The point that the report is about.")
    tolerances: dict[EngineName, TolerancesTable] = Field({}, description="By engine, largest errors for `--check`.")
    limits: dict[str, LimitTable] = Field(
        {}, max_length=limits.LOADS, description='By channel or magnitude, as "P1.force", what `--check` holds it to.'
    )
    results: dict[Name, dict[str, Undated]] = Field({}, description="By name how to read a result, for `--result`.")
