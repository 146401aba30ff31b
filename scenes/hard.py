"""Hard cases: ladders in one parameter of a scene, with what is to be expected on each rung, and why.

A ladder file names the paths of a scene file that change, and the value that all of them take on each rung:

    format = 1
    title = "Rod close to its locking pose"
    scene = "toggle_press"                     # a shipped scene, or a scene file beside the ladder
    parameter = "length of the rod"
    paths = ["bodies.rod.lengths.P4-P5"]       # or ["turns"], the cycles of the drive
    steps = { "1e-1" = 330, "1e-2" = 303 }     # label = value, in the units of the scene file
    status = { "1e-2" = "cannot_assemble" }    # of the rungs that no model can solve; "invalid" where there is no scene
    expected = "What should happen."
    why = "Where the difficulty comes from."
    digits = true                              # where the digits that the reference loses are to be counted
    long = true                                # only where the ladder takes minutes

No ladder is for a wrong start velocity: a scene has none to set, each model finds its own from the drive.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from .changes import Value, as_text, change
from .engine import Status
from .errors import InputError, nearest
from .format import LadderFile, explain
from .reader import LIBRARY, load, tables_of
from .scene import Scene
from .toml_file import read_toml

HARD = LIBRARY / "hard"
TURNS = "turns"
INVALID = "invalid"  # the status of a rung that the reader has to refuse, beside those of an engine


@dataclass(frozen=True)
class Rung:
    """One value of a ladder's parameter."""

    label: str
    value: Value  # in the units of the scene file
    turns: int  # cycles of the drive
    status: str  # that the reference has to end with at 360 samples a cycle
    scene_file: str | Path
    changes: Mapping[str, Value]  # by path

    def scene(self) -> Scene:
        """Return the scene with this rung's value in it.

        Raises:
            InputError: there is no such scene, as there is none where `status` is `INVALID`.
        """
        return load(self.scene_file, self.changes)


@dataclass(frozen=True)
class Ladder:
    """One scene with one parameter that gets harder, or easier, from rung to rung."""

    name: str
    title: str
    parameter: str
    expected: str  # what should happen
    why: str  # where the difficulty comes from
    digits: bool  # whether the digits that the reference loses are counted
    rungs: tuple[Rung, ...]


def catalogue(*, long: bool = False) -> tuple[str, ...]:
    """Return the names of the shipped ladders: of the `long` ones, which take minutes, or of the others."""
    return tuple(name for name, path in _shipped().items() if _file(path).long == long)


def ladder(name_or_path: str | Path) -> Ladder:
    """Read a ladder.

    Args:
        name_or_path: the name of a shipped ladder, or a .toml file.

    Raises:
        InputError: the file cannot be read or asks for something impossible; the text is one line that names the file,
            the path in it, what was expected, and the nearest valid name.
    """
    path = _shipped().get(str(name_or_path), Path(name_or_path))
    file = _file(name_or_path)
    try:
        rungs = _rungs(file, path)
    except InputError as error:
        raise InputError(f"{name_or_path}: {error}") from None
    return Ladder(path.stem, file.title, file.parameter, file.expected, file.why, file.digits, rungs)


def _shipped() -> dict[str, Path]:
    return {path.stem: path for path in sorted(HARD.glob("*.toml"))}


def _file(name_or_path: str | Path) -> LadderFile:
    tables = read_toml(name_or_path, _shipped(), "ladder")
    try:
        return LadderFile.model_validate(tables)
    except ValidationError as error:
        raise InputError(f"{name_or_path}: {explain(error, LadderFile)}") from None


def _rungs(file: LadderFile, path: Path) -> tuple[Rung, ...]:
    scene_file = path.parent / file.scene if file.scene.endswith(".toml") else file.scene
    with _at("scene"):
        tables = tables_of(scene_file)
    for label, status in file.status.items():
        with _at(f"status.{label}"):
            _check_status(label, status, file)
    rungs = []
    for label, value in file.steps.items():
        counts = file.paths == [TURNS]
        changes = {} if counts else dict.fromkeys(file.paths, value)
        with _at(f"steps.{label}"):
            turns = _turns(value) if counts else 1
            change(deepcopy(tables), changes)
        rungs.append(Rung(label, value, turns, file.status.get(label, Status.ok.name), scene_file, changes))
    return tuple(rungs)


@contextmanager
def _at(place: str) -> Iterator[None]:
    """Put the place in the ladder file before every message from within."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def _check_status(label: str, status: str, file: LadderFile) -> None:
    if label not in file.steps:
        raise InputError(f"no such step{nearest(label, file.steps)}")
    known = (*Status.__members__, INVALID)
    if status not in known:
        raise InputError(f"'{status}' is no status{nearest(status, known)}")


def _turns(value: Value) -> int:
    if isinstance(value, str) or value < 1 or value != int(value):
        raise InputError(f"expected a whole number of turns, found {as_text(value)}")
    return int(value)
