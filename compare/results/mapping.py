"""How a result's columns are read: the file beside it, or a table of the scene."""

from collections.abc import Mapping
from os.path import isfile
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from scenes import InputError, Scene
from scenes.errors import at_place, one_line
from scenes.fields import FileTable, Finite, Pair, Positive
from scenes.file.explained import validated
from scenes.file.toml import read_toml
from scenes.file.units import factor
from scenes.limits import SOURCE

Text = Annotated[str, Field(max_length=SOURCE)]
BASE = {"length": "m", "angle": "rad", "force": "N", "time": "s"}


class UnitsTable(FileTable):
    """What the columns are in, where they name nothing else; SI where absent."""

    length: str = Field("m", description="Of places, and of the frame's origin.")
    angle: str = Field("rad", description="Of angles, also the frame's.")
    force: str = Field("N", description="Of forces; moments are in force times length.")
    time: str = Field("s", description="Of instants; rates are in length or angle over time.")


class FrameTable(FileTable):
    """The result's frame, as seen from the scene's."""

    origin: Pair = Field((0.0, 0.0), description="Where its origin is.")
    angle: Finite = Field(0.0, description="How far its x axis is turned, counter-clockwise.")
    mirrored: bool = Field(False, description="Whether its y axis is turned clockwise from its x axis.")


class ColumnTable(FileTable):
    """A column that is more than its name."""

    column: Text = Field(description="Its name.")
    unit: str | None = Field(None, description="Of its numbers.")
    sign: Literal[1, -1] = Field(1, description="-1 where it is positive the other way.")
    zero: Finite = Field(0.0, description="What it reads where the channel is zero, as where a log starts late.")


class MappingFile(FileTable):
    """A whole mapping."""

    made_by: Text = Field("", description="Who made the result.")
    made_with: Text = Field("", description="By which program, in which version.")
    separator: Literal[",", ";", "\t", " "] | None = Field(None, description="Between columns.")
    decimal: Literal[".", ","] | None = Field(None, description="Before the decimals.")
    units: UnitsTable = Field(UnitsTable.model_validate({}), description="Of the columns.")
    frame: FrameTable = Field(FrameTable.model_validate({}), description="Of places, vectors and angles.")
    backwards: bool = Field(False, description="Whether its drive runs the other way, from the last row to the first.")
    other_side: list[Text] = Field(
        [], description='Joints, sliders, "drive" or channels of forces that are on the other body.'
    )
    promise: Positive = Field(1e-3, lt=1, description="The largest relative error, besides that of its decimals.")
    columns: dict[str, Text | ColumnTable] = Field({}, description="By channel; where absent those named as channels.")


def mapping_of(scene: Scene, name: str, file: Path) -> tuple[MappingFile, str]:
    """Return how a result is read, and where that is written; without either all is as in this project's own files."""
    mapping_file = f"{file.parent / file.stem}.toml"
    in_scene = scene.tables.get("results", {}).get(name)
    there = isfile(mapping_file)  # noqa: PTH113 - Path raises for odd names
    if there and in_scene is not None:
        raise InputError(f"{one_line(mapping_file)}: the scene has a mapping too, results.{name}; expected one of them")
    where, tables = f"{scene.file}: results.{name}", in_scene or {}
    if there:
        where, tables = mapping_file, read_toml(mapping_file, {}, "mapping")
    with at_place(one_line(where)):
        return validated(MappingFile, tables), where


def factors(units: UnitsTable) -> Mapping[str, float]:
    """Return by SI unit of channels what to multiply numbers by that are in the units of a mapping."""
    m, rad, newton, s = (factor(getattr(units, name), si, name, f"units.{name}") for name, si in BASE.items())
    return {
        **{"m": m, "rad": rad, "s": s, "N": newton, "N*m": newton * m},
        **{"m/s": m / s, "m/s^2": m / s**2, "rad/s": rad / s, "rad/s^2": rad / s**2},
    }


def named_columns(columns: tuple[str, ...], known: tuple[str, ...]) -> dict[str, str | ColumnTable]:
    """Return the columns that are named as channels are in this project's files: `P5.y [mm]`, or `P5.y`."""
    by_channel: dict[str, str | ColumnTable] = {}
    for column in columns:
        channel, _, unit = column.partition(" [")
        if channel in by_channel:
            raise InputError(f"expected a column for each channel, found two of {channel}; a mapping picks one")
        if channel in known:
            by_channel[channel] = ColumnTable.model_validate({"column": column, "unit": unit.removesuffix("]") or None})
    if not by_channel:
        shown = f", found {one_line(', '.join(columns), 100)}"
        raise InputError(f"expected a mapping beside it, or columns named as channels, {known[0]} and so on{shown}")
    return by_channel
