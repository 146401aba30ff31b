"""Hundreds of broken scenes: each is refused in one line or ends with a status; nothing escapes, hangs or aborts."""

import tomllib
from collections.abc import Iterator
from copy import deepcopy
from functools import reduce
from math import inf, nan
from operator import getitem
from pathlib import Path
from time import process_time
from typing import Any

import pytest

import scenes
from compare.engines import registry
from compare.judge.floor import establish
from compare.judge.measure import measure
from compare.mechanics.reference import uncertified
from scenes import InputError, Sampling, Status
from tests import scene_files
from tests.comparisons import SLOW, sampled

Place = tuple[str | int, ...]
TOGGLE_PRESS = scene_files.text("toggle_press")
BROKEN_EVERYWHERE = ("busy",)
# Of these only what it does not have: other units, tolerances and variations, slides on bodies, driven sliders, laws,
# press forces, tables, springs, and a body of four points by lengths.
BROKEN_IN_PART = {
    "toggle_press": ("title", "source", "units", "output", "tolerances", "variations"),
    "shaper": ("bodies.block", "drive", "loads"),
    "driven_toggle": ("bodies.plate", "bodies.crosshead", "drive", "loads", "springs", "sketch"),
    "turning_law": ("drive",),
    "outlined": ("bodies.crank", "bodies.rocker"),
}
WHOLE = {name: tomllib.loads(scene_files.text(name)) for name in (*BROKEN_EVERYWHERE, *BROKEN_IN_PART)}
LATER = ("toggle_press", "busy")  # the others have most of what these have, and take less
INSTEAD: dict[str, Any] = {
    **{"gone": None, "NaN": nan, "infinite": inf, "zero": 0, "huge": 1e300, "tiny": 1e-300, "negated": None},
    **{"text": "rod", "truth": True, "list": [], "table": {}, "nested": [[[1, 2], 3], 4]},
}
PATIENCE = 20.0  # s of the processor, for one scene and all engines; a sound one takes a tenth of a second


@pytest.fixture(autouse=True)
def _uncertified(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the 50 digits, which take most of the time and have their own tests."""
    monkeypatch.setattr("compare.judge.floor.solved", lambda scene, *_: uncertified(scene))


def broken_places(name: str) -> list[Place]:
    """Where a base is broken."""
    parts = BROKEN_IN_PART.get(name, ("",))
    return [place for place in places(WHOLE[name]) if ".".join(map(str, place)).startswith(parts)]


def places(node: Any, place: Place = ()) -> Iterator[Place]:
    """Yield the place of everything in a parsed file, tables and arrays included."""
    if place:
        yield place
    children = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, child in children:
        yield from places(child, (*place, key))


def broken(name: str, place: Place, how: str) -> Any:
    """A parsed file with one thing in it removed or replaced."""
    whole: Any = deepcopy(WHOLE[name])
    *way, last = place
    parent = reduce(getitem, way, whole)
    old = parent.pop(last) if how == "gone" else parent[last]
    if how == "negated":
        parent[last] = -old if isinstance(old, int | float) else {"not": old}
    elif how != "gone":
        parent[last] = INSTEAD[how]
    return whole


def check(text: str, folder: Path, engines: tuple[str, ...] = registry.DEFAULT_ENGINES) -> str:
    """Take a scene as far as it goes with the engines' cheapest settings, and return how it ended."""
    file = folder / "broken.toml"
    file.write_text(text, encoding="utf-8")
    started = process_time()
    try:
        reference = establish(scenes.load(file))
    except InputError as error:
        line = str(error)
        assert "\n" not in line
        assert line.startswith(f"{file}: ")
        assert len(line) < len(str(file)) + 400
        return "refused"
    for engine in engines:
        run = measure(reference, engine, Sampling(24), registry.engine(engine).FAST).run
        assert run.status is not Status.crashed, f"{engine}: {run.reason}"
        assert (run.status is Status.ok) == (not run.reason)
        assert "\n" not in run.reason
    assert process_time() - started < PATIENCE
    return "ran"


def cases() -> Iterator[Any]:
    """Every scene in every way; those that take long in every fourth way, and the rest in the study."""
    for name in WHOLE:
        for number, how in enumerate(INSTEAD):
            seldom = SLOW if number % 4 == 0 else pytest.mark.study
            yield pytest.param(name, how, id=f"{name}-{how}", marks=seldom if name in LATER else ())


@sampled(5)
@pytest.mark.parametrize(("name", "how"), [*cases()])
def test_one_thing_broken(name: str, how: str, tmp_path: Path) -> None:
    ends = []
    engines = registry.DEFAULT_ENGINES if name in BROKEN_EVERYWHERE else (registry.REFERENCE,)
    for place in broken_places(name):
        text = scene_files.toml(broken(name, place, how))
        try:
            ends.append(check(text, tmp_path, engines))
        except BaseException as error:
            error.add_note(f"{name}: {how} at {'.'.join(map(str, place))}\n{text}")
            raise
    assert len(ends) > (60 if name in BROKEN_EVERYWHERE else 10)
    assert "refused" in ends


STRUCTURES = {  # those that the reader refuses are among the slips
    "a body pinned to the ground twice": ('"O-P3" = 300', '"O-P1" = 300'),
    "a body pinned to another twice": ('"P4-P5" = 300', '"P4-P3" = 300'),
    "a length that cannot close": ('"O-P3" = 300', '"O-P3" = 3000'),
    "a length that closes only in part": ('"P4-P5" = 300', '"P4-P5" = 150'),
    "a sketch far off": ("P3 = [0, -300]", "P3 = [1e6, -300]"),
    "a sketch in one point": ("P4 = [0, -790]\nP5 = [0, -1090]", "P4 = [0, -300]\nP5 = [0, -300]"),
    "a point on the slider's own line": ("along = [0, 1]", "along = [1, 0]"),
}


@pytest.mark.parametrize("case", STRUCTURES)
def test_structure_broken(case: str, tmp_path: Path) -> None:
    old, new = STRUCTURES[case]
    assert old in TOGGLE_PRESS
    check(TOGGLE_PRESS.replace(old, new, 1), tmp_path)


def test_there_are_hundreds() -> None:
    assert len(INSTEAD) * sum(len(broken_places(name)) for name in WHOLE) > 2000
