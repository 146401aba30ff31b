"""Earlier runs, by their `summary.json`: whatever lies there, since a user may have put anything in its place."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import tau
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import numpy as np
from pydantic import AfterValidator, BaseModel, FiniteFloat, ValidationError

from scenes import InputError, Motion, Scene
from scenes.errors import at_place, one_line, path_in_file
from scenes.file.toml import SUMMARY_BYTES, read_text
from scenes.model.motion import Samples

from ...mechanics.axis import axis, turns_fully

MOTION_BYTES = 2**28  # of a motion's file, at most
WHOLE = 1e-9  # of a turn: what a whole one may lack

OneLine: TypeAlias = Annotated[str, AfterValidator(one_line)]  # whatever the file has there
Json: TypeAlias = dict[str, Any]


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
    differs: dict[OneLine, FiniteFloat | None]


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

    scene: Json
    sampling: Json
    environment: dict[str, str]
    engines: dict[OneLine, _Engine]
    errors: list[SummaryError]
    peaks: list[SummaryPeak]
    cheapest: list[_Choice]
    verdict: dict[str, OneLine]
    picture: str = ""
    complete: bool = True
    since_baseline: list[Change] | None = None
    since_last_run: list[Change] | None = None


@dataclass(frozen=True)
class Before:
    """An earlier run as the page of a later one shows it."""

    peaks: Sequence[SummaryPeak]
    ground: Mapping[str, tuple[float, float]]  # m, where its points were
    motion: Motion  # of the reference; without channels where it is not at hand


def before(summary: Summary, path: Path, scene: Scene) -> Before:
    """An earlier run by its summary, and the motion that lies beside that, if it can be read."""
    samples, ground = dict[str, Samples](), dict[str, tuple[float, float]]()
    with suppress(InputError, OSError, ValueError, KeyError, TypeError, AttributeError):
        ground = {str(point): (float(x), float(y)) for point, (x, y) in summary.scene["ground"].items()}
        names, *rows = read_text(_file(path, scene).with_name("motion.analytic.csv"), MOTION_BYTES).splitlines()
        values = np.array([row.split(",") for row in rows], np.float64).T
        samples = dict(zip((name.partition(" [")[0] for name in names.split(",")), values, strict=True))
    return Before(summary.peaks, ground, Motion(samples))


def at_positions(scene: Scene, motion: Motion, later: Motion) -> Motion:
    """An earlier motion where a later one has samples, straight between its own; NaN beyond its ends.

    One of whole turns goes on as it began, but for angles, which a turn takes further.
    """
    over = axis(scene).channel
    if over not in motion:
        return Motion({})
    order, wanted = np.argsort(motion[over]), later[over]
    x = motion[over][order]
    turn = tau if turns_fully(scene) and np.ptp(x) > tau * (1 - WHOLE) else None
    at = {"time": later["time"]}
    for channel in motion.samples.keys() - {"time"}:
        values = motion[channel][order]
        slope = (values[-1] - values[0]) / (np.ptp(x) or 1.0)
        at[channel] = np.interp(wanted, x, values - slope * x, np.nan, np.nan, turn) + slope * wanted
    return Motion(at)


def _file(path: Path, scene: Scene) -> Path:
    return path / scene.name / "summary.json" if path.is_dir() else path


def summary_of(file: Path) -> Summary:
    """What a file has, or InputError."""
    try:
        return Summary.model_validate_json(read_text(file, SUMMARY_BYTES))
    except FileNotFoundError:
        raise InputError("cannot be read (No such file or directory)") from None
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
