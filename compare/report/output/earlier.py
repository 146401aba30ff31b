"""Earlier runs, by their `summary.json`: whatever lies there, since a user may have put anything in its place."""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import tau
from pathlib import Path
from typing import Annotated, Any, TypeAlias, TypeVar

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    FailFast,
    Field,
    FiniteFloat,
    ValidationError,
)

from scenes import InputError, Motion, Scene
from scenes.errors import at_place, one_line, path_in_file
from scenes.file.toml import read_text
from scenes.model.motion import Samples

from ...mechanics.axis import axis, turns_fully

MAX_MOTION_BYTES = 2**28  # of a motion's file
MAX_BYTES = 2**24  # of a summary.json: one of a hundred bodies has a few megabytes
MAX_TABLES = 500_000  # lists and tables in it, each of which takes more memory than its text
MAX_ENTRIES = 10_000  # of a table of engines, versions, units, or a list of changes
WHOLE_TURN_TOL = 1e-9  # of a turn: what a whole one may lack

OneLine: TypeAlias = Annotated[str, AfterValidator(one_line)]  # whatever the file has there
Json: TypeAlias = dict[str, Any]
T = TypeVar("T")


def _few(entries: object) -> object:
    if isinstance(entries, dict | list) and len(entries) > MAX_ENTRIES:
        raise ValueError(f"expected {MAX_ENTRIES} entries at most")
    return entries


# An error for each of a million wrong entries takes more memory than the file has bytes; the first is enough.
Table = Annotated[dict[OneLine, T], BeforeValidator(_few)]
Rows = Annotated[list[T], FailFast()]
FewRows = Annotated[list[T], BeforeValidator(_few)]


class _Scene(BaseModel):
    """What is used of a scene, where there is any of it."""

    title: OneLine = ""
    units: Table[tuple[str, Annotated[float, Field(gt=1e-30, lt=1e30)]]] = {}


def _usable(scene: Json) -> Json:
    _Scene.model_validate(scene)
    return scene


class _Engine(BaseModel):
    version: OneLine
    status: OneLine
    settings: dict[str, Any] | None  # of a result: its file and how it was read


class SummaryError(BaseModel):
    """The errors of a channel."""

    engine: OneLine
    channel: OneLine
    group: OneLine
    max: FiniteFloat | None
    floor: FiniteFloat | None
    explained: FiniteFloat | None


class SummaryPeak(BaseModel):
    """One of the designer's numbers, SI."""

    name: OneLine
    of: OneLine
    channel: OneLine = ""
    value: FiniteFloat
    unit: OneLine
    differs: Table[FiniteFloat | None]


class _Choice(BaseModel):
    group: OneLine
    level: OneLine
    engine: OneLine
    note: OneLine
    setting: OneLine
    ratio: FiniteFloat | None = None  # of its time to that of the fastest engine of the same run


@dataclass(frozen=True)
class Change:
    """What changed since an earlier run, in one line."""

    text: OneLine
    worse: bool = False

    def __str__(self) -> str:
        return f"{'worse than' if self.worse else 'changed since'} the baseline: {self.text}"


class Summary(BaseModel):
    """What is compared and listed of a `summary.json`."""

    scene: Annotated[Json, AfterValidator(_usable)]
    sampling: Json
    environment: Table[str]
    engines: Table[_Engine]
    errors: Rows[SummaryError]
    peaks: Rows[SummaryPeak]
    cheapest: Rows[_Choice]
    verdict: Table[OneLine]
    limits_verdict: Table[OneLine] | None = None
    picture: str = ""
    complete: bool = True
    since_baseline: FewRows[Change] | None = None
    since_last_run: FewRows[Change] | None = None


@dataclass(frozen=True)
class Before:
    """An earlier run as the page of a later one shows it."""

    peaks: Sequence[SummaryPeak]
    ground: Mapping[str, tuple[float, float]]  # m, where its points were
    motion: Motion  # of the reference; without channels where it is not at hand


def before(summary: Summary, path: Path, scene: Scene) -> Before:
    """An earlier run by its summary, and the motion that lies beside that, if it can be read."""
    samples, ground = dict[str, Samples](), dict[str, tuple[float, float]]()
    # An earlier run is shown as far as it can be read. Its files may be of any age, or edited, and no error in them is
    # one of this run.
    with suppress(InputError, OSError, ValueError, KeyError, TypeError, AttributeError):
        ground = {str(point): (float(x), float(y)) for point, (x, y) in summary.scene["ground"].items()}
        names, *rows = read_text(_file(path, scene).with_name("motion.analytic.csv"), MAX_MOTION_BYTES).splitlines()
        values = np.array([row.split(",") for row in rows], np.float64).T
        samples = dict(zip((name.partition(" [")[0] for name in names.split(",")), values, strict=True))
    return Before(summary.peaks, ground, Motion(samples))


def at_positions(scene: Scene, motion: Motion, later: Motion) -> Motion:
    """An earlier motion where a later one has samples, straight between its own; NaN beyond its ends.

    One of whole turns goes on as it began, but for angles, which a turn takes further.
    """
    along = axis(scene).channel
    if along not in motion:
        return Motion({})
    order, wanted = np.argsort(motion[along]), later[along]
    x = motion[along][order]
    turn = tau if turns_fully(scene) and np.ptp(x) > tau * (1 - WHOLE_TURN_TOL) else None
    interpolated = {"time": later["time"]}
    for channel in motion.samples.keys() - {"time"}:
        values = motion[channel][order]
        # A motion of whole turns is periodic but for angles, which gain a turn. The straight line from end to end is
        # taken off, what is left is interpolated with the turn as its period, and the line is added again. Of a motion
        # that is no whole turn the line changes nothing, since interpolation is linear, and beyond its ends is NaN.
        slope = (values[-1] - values[0]) / (np.ptp(x) or 1.0)
        interpolated[channel] = np.interp(wanted, x, values - slope * x, np.nan, np.nan, turn) + slope * wanted
    return Motion(interpolated)


def _file(path: Path, scene: Scene) -> Path:
    return path / scene.name / "summary.json" if path.is_dir() else path


def json_of(file: Path) -> Any:
    """What a JSON file holds that is not too large, or InputError."""
    try:
        text = read_text(file, MAX_BYTES)
        if text.count("[") + text.count("{") > MAX_TABLES:
            raise InputError(f"expected {MAX_TABLES} lists and tables at most, found more")
        return json.loads(text)
    except FileNotFoundError:
        raise InputError("cannot be read (No such file or directory)") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"not valid JSON: {str(error) or type(error).__name__}") from None


def summary_of(file: Path) -> Summary:
    """What a file has, or InputError.

    What was read is looked at in place: of JSON as text pydantic copies, for every field that lacks, what lacks it.
    """
    known = json_of(file)
    try:
        return Summary.model_validate(known)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = path_in_file((*first["loc"], ""))
        raise InputError(f"expected the summary.json of an earlier run; {place} {first['msg']}") from None


def read(path: Path, scene: Scene, option: str = "--baseline") -> Summary:
    """The summary of an earlier run of a scene, by its `summary.json`, or the folder that it had as `--out`."""
    file = _file(path, scene)
    with at_place(f"{option}: {one_line(str(file))}"):
        summary = summary_of(file)
        if summary.scene.get("name") != scene.name:
            raise InputError(f"expected a result of {scene.name}, found one of {summary.scene.get('name')}")
    return summary


def last(folder: Path, scene: Scene) -> Summary | None:
    """The summary of the last run of a scene into a folder, if there is one that can be read."""
    with suppress(InputError):
        return read(folder / scene.name / "summary.json", scene)
    return None
