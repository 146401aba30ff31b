"""A result of another program as a run: its numbers in SI, in the frame and by the signs of this project's channels."""

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from os.path import isfile
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, InputError, Instants, Motion, Scene, Settings, Status, limits
from scenes.channels import TRANSMISSION, Channel, Role
from scenes.errors import at_place, nearest, one_line
from scenes.fields import NAME
from scenes.file.units import factor
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND, ConstantSpeed

from ..engines import registry
from ..engines.runner import Run
from .frame import Frame, seen, vectors
from .guides import to_guides
from .joined import read_tables
from .mapping import ColumnTable, MappingFile, factors, mapping_of, named_columns
from .table import Table

Columns: TypeAlias = dict[str, Samples]  # by channel, shape (n,)

EQUAL_STEP_TOL = 1e-6  # of the last decimal: how far equal steps as written may differ; and of a cycle its end
MAX_BEYOND_RUN = 1e-2  # of a cycle: so far decimals may put a row outside the run of the drive


@dataclass(frozen=True)
class Provenance(Settings):
    """Where a result comes from and how it was read, in place of an engine's settings."""

    file: Annotated[str, "the file it was read from"] = ""
    sha256: Annotated[str, "of the file"] = ""
    made_by: Annotated[str, "who made it"] = ""
    made_with: Annotated[str, "with what"] = ""
    mapping_in: Annotated[str, "where the mapping of its columns is written"] = ""
    mapping: Annotated[Mapping[str, Any], "how its columns are read"] = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class Result:
    """A result of another program."""

    run: Run
    request: Instants  # its own instants, and the channels that it has
    half_decimals: Mapping[str, Samples]  # by channel, of shape (n,), SI: what its numbers may be off as written
    notes: tuple[str, ...]  # what a reader must know

    def asked_for(self, asked: frozenset[str] | None) -> "Result":
        """Return the result with those of its channels alone that are asked for; InputError where it has none."""
        given = self.request.channels or frozenset()
        if asked is None:
            return self
        if not given & asked:
            given_are = one_line(", ".join(sorted(given)), 60)
            raise InputError(f"arguments: --channels: expected one that {self.run.engine} gives: {given_are}")
        return replace(self, request=replace(self.request, channels=given & asked))


def read_results(scenes: Sequence[Scene], texts: Sequence[str], asked: frozenset[str] | None) -> list[Result]:
    """Read the results that arguments name, see `read_result`, in the channels that are asked for; None for all."""
    if len(scenes) > 1:
        raise InputError(f"arguments: --result: expected one scene, which it is of, found {len(scenes)}")
    names = [name_and_files(text)[0] for text in texts]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"arguments: --result: two results are named '{name}'; expected a name for each")
    return [read_result(scenes[0], text).asked_for(asked) for text in texts]


def read_result(scene: Scene, text: str) -> Result:
    """Read a result of a linkage, NAME=FILE.csv as of `--result`; its mapping is beside it, or in the scene.

    Several files, NAME=FILE.csv,FILE.csv, are joined by their instants; the mapping is beside the first of them.

    It is in SI, in the scene's frame, its rows in the order of the time; InputError where it cannot be or does not fit.
    """
    name, files = name_and_files(text)
    mapping, where = mapping_of(scene, name, files[0])
    axes = scene.channels.names(Role.time, Role.input)
    instants = {_named(mapping.columns[axis]).column for axis in axes if axis in mapping.columns}
    table = read_tables(
        files, mapping.separator, mapping.decimal, instants or {scene.channels[axis].header for axis in axes}
    )
    with at_place(one_line(", ".join(map(str, files)))):
        if not mapping.columns:
            mapping = mapping.model_copy(
                update={"columns": named_columns(table.columns, _readable(scene, table.columns))}
            )
        return _mapped(scene, name, files, table, mapping, where)


def name_and_files(text: str) -> tuple[str, list[Path]]:
    """Return the name, which is no engine's, and the files of an argument NAME=FILE.csv, or NAME=FILE.csv,FILE.csv."""
    name, _, file = text.partition("=")
    whole = isfile(file)  # noqa: PTH113 - Path raises for odd names
    files = [Path(file)] if whole else [Path(each) for each in file.split(",") if each]
    if not (files and re.fullmatch(NAME, name) and len(name) <= limits.NAME):
        shown = one_line(text, 60)
        raise InputError(f"--result: expected NAME=FILE.csv, the name of letters, digits and '_', found '{shown}'")
    if name in registry.ENTRIES:
        raise InputError(f"--result: '{name}' is the name of an engine; expected another")
    return name, files


def _mapped(scene: Scene, name: str, files: Sequence[Path], table: Table, mapping: MappingFile, where: str) -> Result:
    known, names = scene.channels.names(Role.kinematic, Role.force, Role.friction), _readable(scene, mapping.columns)
    for other in mapping.columns:
        if other not in names:
            raise InputError(f"columns.{one_line(other, 60)}: no such channel of the scene{nearest(other, names)}")
    rows = len(table.rows)
    if rows * len(mapping.columns) > limits.VALUES:
        raise InputError(f"expected {limits.VALUES} numbers at most, found {rows} rows of {len(mapping.columns)}")
    table, left_out = table.complete(_named(given).column for given in mapping.columns.values())
    numbers, rows = np.array(table.rows), len(table.rows)
    columns, halves = _in_si(scene, table, mapping)
    _to_frame(scene, columns, halves, mapping)
    to_guides(scene, columns, halves, mapping.promise)
    _on_this_side(scene, columns, mapping.other_side)
    if mapping.backwards:
        columns = {c: _backwards(scene.channels[c], values) for c, values in columns.items()}
        halves = {c: values[::-1] for c, values in halves.items()}
        numbers = numbers[::-1]
    drive_channel = scene.channels.drive.position
    with_drive = drive_channel in columns
    notes = [f"{name}: {left_out}"] * bool(left_out)
    if "time" in columns and rows > 2 and columns["time"][-1] == columns["time"][-2]:  # as some write the end twice
        columns, halves = ({c: values[:-1] for c, values in table.items()} for table in (columns, halves))
        notes.append(f"{name} has its last instant twice; the second row of it is left out")
        numbers, rows = numbers[:-1], rows - 1
    _on_time(scene, columns, halves, numbers)
    measured = frozenset(columns) - {"time", drive_channel}
    if not measured:
        raise InputError(f"columns: expected one channel more than the time and {drive_channel} at least")
    drive = inputs_of(scene, columns["time"]).driven().position
    cycles = f"{np.ptp(columns['time']) / scene.cycle:.2g}"
    length = f"{cycles} cycle{'s' * (cycles != '1')} of the drive"
    extent = f"row{'s' * (rows != 1)}, over {length}, from {scene.where(float(drive[0]))} on"
    notes.insert(0, f"{name} has {rows} {extent}")
    if (count := len(measured.intersection(known))) < len(known):
        notes.append(f"{name} gives {count} of {len(known)} channels; it was not asked for the others")
    if (
        drive_channel in columns and scene.drive.slide is None
    ):  # counted on from turn to turn, whatever turn each row is in
        columns[drive_channel] += 2 * np.pi * np.round((drive - columns[drive_channel]) / (2 * np.pi))
    if not with_drive:
        notes.append(f"{name} gives no {drive_channel}; it is taken as commanded")
    motion = Motion({c: columns.get(c, drive) for c in names if c in columns or c == drive_channel})
    origin = Provenance(
        ", ".join(file.name for file in files),
        promise=mapping.promise,
        drive_promise=mapping.promise,
        file=one_line(", ".join(map(str, files))),
        sha256=table.sha256,
        made_by=one_line(mapping.made_by),
        made_with=one_line(mapping.made_with),
        mapping_in=one_line(where),
        mapping=mapping.model_dump(exclude_defaults=True, exclude={"made_by", "made_with", "promise"}),
    )
    run = Run(name, origin, Status.ok, version=origin.made_with, motion=motion)
    return Result(run, Instants(tuple(columns["time"].tolist()), channels=measured), halves, tuple(notes))


def _readable(scene: Scene, columns: Iterable[str]) -> tuple[str, ...]:
    """Return what columns may be: channels, magnitudes, components of guides' forces, transmission angles."""
    # Of any joint, as what a file has in its headings need be no channel of the scene.
    angles = [column for column in columns if column.partition(" [")[0].endswith(TRANSMISSION)]
    if angles:  # the reference knows at which joints they are
        with suppress(Failure):
            found = registry.reference(scene)(inputs_of(scene, np.zeros(1)))
            angles = [name for name in found.samples if scene.channels[name].quantity == TRANSMISSION]
    return (*scene.channels.names(), *scene.channels.names(Role.magnitude), *scene.channels.names(Role.given), *angles)


def _backwards(channel: Channel, values: Samples) -> Samples:
    """Samples in the order of the time where it runs the other way, which changes the sign of rates."""
    is_rate = channel.order == 1 and channel.role is Role.kinematic
    return -values[::-1] if is_rate or channel.role is Role.time else values[::-1]


def _named(given: str | ColumnTable) -> ColumnTable:
    return ColumnTable.model_validate({"column": given}) if isinstance(given, str) else given


def _in_si(scene: Scene, table: Table, mapping: MappingFile) -> tuple[Columns, Columns]:
    """Return the columns in SI, and what their numbers may be off as written."""
    units = factors(mapping.units)
    columns, halves = Columns(), Columns()
    for channel, given in mapping.columns.items():
        column = _named(given)
        values, half = table.numbers(column.column)
        size = units[si := scene.channels[channel].unit]
        if column.unit is not None:
            size = factor(column.unit, si, f"{channel}, as {si} is", f"columns.{channel}.unit")
        columns[channel], halves[channel] = column.sign * size * (values - column.zero), size * half
    return columns, halves


def _to_frame(scene: Scene, columns: Columns, halves: Columns, mapping: MappingFile) -> None:
    given, units = mapping.frame, factors(mapping.units)
    relative = any(drive.on != GROUND for drive in scene.drives)
    frame = Frame(units["rad"] * given.angle, units["m"] * complex(*given.origin), given.mirrored, relative=relative)
    # Half decimals are bounds: a turned component's is the sum of both parts by magnitude.
    c, s = abs(np.cos(frame.angle)), abs(np.sin(frame.angle))
    for x, y in vectors(scene.channels, columns):
        if x in columns and y in columns:
            a, b = halves[x], halves[y]
            halves[x], halves[y] = c * a + s * b, s * a + c * b
        elif frame.angle:
            alone = x if x in columns else y
            raise InputError(f"columns.{alone}: expected both components of a vector in a frame that is turned")
    columns.update(seen(scene.channels, frame, columns))


def _on_this_side(scene: Scene, columns: Columns, other_side: Sequence[str]) -> None:
    stems, turned = {name: scene.channels[name].owner for name in scene.channels.names(Role.force)}, set[str]()
    for pattern in other_side:
        shown = one_line(pattern, 60)
        fits = {channel for channel, stem in stems.items() if fnmatchcase(stem, pattern) or channel == pattern}
        kinds = {scene.channels[channel].kind for channel in fits}
        if len(kinds) > 1 and pattern in stems.values():  # a pin with the name of a slider, or called drive
            raise InputError(f"other_side: '{shown}' is of several; expected one or more of {', '.join(sorted(fits))}")
        if not fits:
            raise InputError(f"other_side: no joint, slider or drive '{shown}'{nearest(shown, stems.values())}")
        turned |= fits
    columns |= {channel: -columns[channel] for channel in turned & columns.keys()}


def _on_time(scene: Scene, columns: Columns, halves: Columns, rows: NDArray[np.int_]) -> None:
    """Complete the instants, s, of rows that have a position of the drive alone, and check their order.

    `rows` are the numbers of the rows in the file; where one is left out, a step is over two of them.
    """
    law, drive_channel = scene.drive.law, scene.channels.drive.position
    if "time" not in columns:
        if not isinstance(law, ConstantSpeed):
            raise InputError("columns.time: missing; the drive follows a motion law")
        if drive_channel not in columns:
            raise InputError(f"columns: expected time, or {drive_channel}")
        position = columns.pop(drive_channel)
        if scene.drive.slide is None and not (np.diff(position) * law.speed > 0).all():
            position = np.unwrap(position)  # it is counted modulo one turn
        columns["time"] = (position - law.start) / law.speed
        halves["time"] = halves.pop(drive_channel) / abs(law.speed)
    steps = np.diff(columns["time"])
    if not (steps > 0).all():
        row = int((~(steps > 0)).argmax())
        way = "; 'backwards' reads a drive that runs the other way" if (steps < 0).all() else ""
        raise InputError(f"row {rows[row + 1]}: expected a later instant than in the row before{way}")
    first, last = columns["time"][0], columns["time"][-1]
    hair = min(halves["time"].max(), MAX_BEYOND_RUN * scene.cycle) + EQUAL_STEP_TOL * scene.cycle
    if not (scene.periodic or (first >= -hair and last <= scene.cycle + hair)):
        runs = f"from 0 to {scene.cycle:g} s, while the drive runs"
        raise InputError(f"time: expected instants {runs}, found {first:g} s to {last:g} s; its 'zero' shifts them")
    # Equal steps as written are taken for exact instants: 0.333, 0.667, 1.000 are not equal, 0.1, 0.2, 0.3 are.
    if len(steps) > 1 and np.ptp(steps / np.abs(np.diff(rows))) <= EQUAL_STEP_TOL * 2 * halves["time"].max():
        halves["time"] = np.zeros(len(steps) + 1)  # equal steps as written are not rounded
