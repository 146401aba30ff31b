"""Earlier runs, by their `summary.json`: whatever lies there, since a user may have put anything in its place."""

from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from pydantic import AfterValidator, BaseModel, FiniteFloat, ValidationError

from scenes import InputError, Scene
from scenes.errors import at_place, one_line, path_in_file
from scenes.file.toml import SUMMARY_BYTES, read_text

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


class _Verdict(BaseModel):
    word: OneLine
    sentence: OneLine


class _Change(BaseModel):
    text: OneLine
    worse: bool


class Summary(BaseModel):
    """What is compared and listed of a `summary.json`."""

    scene: Json
    sampling: Json
    environment: dict[str, str]
    engines: dict[OneLine, _Engine]
    errors: list[SummaryError]
    peaks: list[SummaryPeak]
    cheapest: list[_Choice]
    verdict: _Verdict
    picture: str = ""
    complete: bool = True
    since_baseline: list[_Change] | None = None
    since_last_run: list[_Change] | None = None


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
    file = path / scene.name / "summary.json" if path.is_dir() else path
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
