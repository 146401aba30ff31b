"""Hard cases: ladders in one parameter of a scene, with what is to be expected on each rung, and why.

A ladder is a file, see `LadderFile`: it names paths of a scene file, and the value that all of them take on each rung.
No ladder is for a wrong start velocity: a scene has none to set, each model finds its own from the drive.
"""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import Field, PlainValidator
from pydantic_core import PydanticCustomError

from .errors import InputError, at_place, nearest
from .fields import FileTable
from .file.changes import Value, as_text, change, label
from .file.explained import validated
from .file.format import Format
from .file.reader import LIBRARY, file_of, from_tables, tables_of
from .file.toml import read_toml
from .model.engine import Status
from .scene import Scene

HARD = LIBRARY / "hard"
TURNS = "turns"
INVALID = "invalid"  # the status of a rung that the reader has to refuse, beside those of an engine


def _number_or_text(value: object) -> Value:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise PydanticCustomError("number_or_text", "expected a number or a text")
    if not isinstance(value, str) and not isfinite(value):
        raise PydanticCustomError("number_or_text", "expected a finite number")
    return value


class LadderFile(FileTable):
    """A whole ladder file: one scene, with another value at some of its paths on every rung."""

    format: Format = Field(description="The version of this format.")
    title: str = Field(description="What gets harder.")
    scene: str = Field(description="The file of the scene, beside this one, or the name of a shipped one.")
    parameter: str = Field(description="What the steps are values of.")
    paths: list[str] = Field(
        min_length=1, description="Where in the scene the values go, as `bodies.rod.mass`; `turns` are the drive's."
    )
    steps: dict[str, Annotated[float | str, PlainValidator(_number_or_text)]] = Field(
        min_length=1, description="The rungs: name and value, in the units of the scene file."
    )
    expected: str = Field(description="What is to be expected on the way.")
    why: str = Field(description="Where the difficulty comes from.")
    status: dict[str, str] = Field(
        {}, description="By rung, the reference's status where that is not ok; `invalid` where there is no scene."
    )
    digits: bool = Field(False, description="Whether digits that the reference loses are counted on it.")
    long: bool = Field(False, description="Whether it takes minutes, and is left to the long runs.")


@dataclass(frozen=True)
class Rung:
    """One value of a ladder's parameter."""

    label: str
    value: Value  # in the units of the scene file
    turns: int  # cycles of the drive
    status: str  # that the reference has to end with at 360 samples a cycle
    file: str  # of the scene, with what is changed in it, for messages
    tables: Mapping[str, Any]  # of the scene with this rung's value in it

    def scene(self) -> Scene:
        """The scene; InputError where there is none, as of `INVALID`."""
        return from_tables(self.tables, self.file)


class Ladder(NamedTuple):
    """One scene with one parameter that gets harder, or easier, from rung to rung."""

    name: str
    file: LadderFile
    rungs: tuple[Rung, ...]


def catalogue(*, long: bool = False) -> tuple[str, ...]:
    """The names of the shipped ladders: of the `long` ones, which take minutes, or of the others."""
    return tuple(name for name, path in _shipped().items() if _file(path).long == long)


def ladder(name_or_path: str | Path) -> Ladder:
    """Read a ladder by the name of a shipped one, or from a .toml file; or InputError, one line as of `scenes.load`."""
    path = _shipped().get(str(name_or_path), Path(name_or_path))
    file = _file(name_or_path)
    with at_place(str(name_or_path)):
        return Ladder(path.stem, file, tuple(_rungs(file, path)))


def _shipped() -> dict[str, Path]:
    return {path.stem: path for path in sorted(HARD.glob("*.toml"))}


def _file(name_or_path: str | Path) -> LadderFile:
    tables = read_toml(name_or_path, _shipped(), "ladder")
    with at_place(str(name_or_path)):
        return validated(LadderFile, tables)


def _rungs(file: LadderFile, path: Path) -> Iterator[Rung]:
    scene_file = path.parent / file.scene if file.scene.endswith(".toml") else file.scene
    with at_place("scene"):
        tables = tables_of(scene_file)
    known = (*Status.__members__, INVALID)
    for step, status in file.status.items():
        with at_place(f"status.{step}"):
            if step not in file.steps:
                raise InputError(f"no such step{nearest(step, file.steps)}")
            if status not in known:
                raise InputError(f"'{status}' is no status{nearest(status, known)}")
    counts = file.paths == [TURNS]
    for step, value in file.steps.items():
        # A ladder over turns changes no number of the scene, only for how many cycles it is solved.
        changes, changed = {} if counts else dict.fromkeys(file.paths, value), deepcopy(tables)
        with at_place(f"steps.{step}"):
            if counts and (isinstance(value, str) or value < 1 or value != int(value)):
                raise InputError(f"expected a whole number of turns, found {as_text(value)}")
            change(changed, changes)
        turns, status = int(value) if counts else 1, file.status.get(step, Status.ok.name)
        yield Rung(step, value, turns, status, label(file_of(scene_file), changes), changed)
