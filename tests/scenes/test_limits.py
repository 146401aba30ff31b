"""Limits of what a scene may hold: at each one it loads, beyond it one line has the limit and what was asked."""

import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import scenes
from scenes import InputError, limits
from tests import scene_files
from tests.comparisons import sampled

SCENES = str(Path(scenes.__file__).parent)
Tables = dict[str, Any]
TraceFunction = Callable[..., Any]


def four_bars(count: int) -> Tables:
    """A chain of four-bars, each driving the next: two bodies and five points a four-bar, with one crank."""
    bodies: Tables = {"crank": {"points": {"O": [0, 0], "T0": [1, 0]}}}
    sketch: Tables = {"angle": 1, "T0": [0.5, 0.8]}
    for i in range(count):
        bodies[f"coupler{i}"] = {"lengths": {f"T{i}-B{i}": 4}}
        bodies[f"rocker{i}"] = {"lengths": {f"C{i}-B{i}": 2.5, f"B{i}-T{i + 1}": 2, f"C{i}-T{i + 1}": 1}}
        sketch |= {f"B{i}": [4 * i + 4, 2.4], f"T{i + 1}": [4 * i + 5, 0.5]}
    points = {"O": [0, 0], **{f"C{i}": [4 * i + 4, 0] for i in range(count)}}
    tables = {"format": 1, "name": "chain", "ground": {"points": points}, "bodies": bodies, "sketch": sketch}
    return tables | {"drive": {"body": "crank", "speed": 1}, "output": {"point": "B0"}}


def bodies(count: int) -> Tables:
    """Whole four-bars with a crank, one body less where the count is even: no scene has such a number."""
    return four_bars((count - 1) // 2)


def points(count: int) -> Tables:
    """One four-bar, whose points are named nine times, and a crank with as many more as are asked for."""
    tables = masses(four_bars(1))
    tables["bodies"]["crank"]["points"] |= {f"P{i}": [i, 1] for i in range(count - 9)}
    tables["bodies"]["crank"] |= {"com": [0, 0], "inertia": 1}
    return tables


def masses(tables: Tables) -> Tables:
    return tables | {"bodies": {name: body | {"mass": 1} for name, body in tables["bodies"].items()}}


def law(count: int) -> Tables:
    return four_bars(1) | {"drive": {"body": "crank", "law": [[i, i % 7] for i in range(count)]}}


def segments(count: int) -> Tables:
    parts = [{"to": i + 1, "within": 1, "law": "harmonic"} for i in range(min(count, 9))]
    return four_bars(1) | {"drive": {"body": "crank", "segments": [*parts, *[{"within": 1}] * (count - len(parts))]}}


def harmonics(count: int) -> Tables:
    return four_bars(1) | {"drive": {"body": "crank", "harmonics": [[0.1, 1 + i % 5, 0] for i in range(count)]}}


def table(count: int) -> Tables:
    tables = tomllib.loads(scene_files.text("driven_toggle"))
    tables["loads"][0]["table"] = [[i, 1] for i in range(count)]
    return tables


def variations(count: int) -> Tables:
    """A scene that varies the coordinates of the points of its crank."""
    paths = [f"bodies.crank.points.P{i // 2}.{i % 2}" for i in range(count)]
    return points(limits.POINTS) | {"variations": [{"path": path, "plus_minus": 0.01} for path in paths]}


def several(key: str, one: Tables) -> Callable[[int], Tables]:
    return lambda count: masses(four_bars(1)) | {key: [one] * count}


def text(key: str) -> Callable[[int], Tables]:
    return lambda count: four_bars(1) | {key: "x" * count}


LOAD = {"body": "crank", "at": "T0", "force": [1, 0]}
SPRING = {"between": ["ground.C0", "crank.T0"], "stiffness": 1, "length": 0}
TEXTS = ("name", "title", "source")
LIMITS: list[tuple[str, int, Callable[[int], Tables]]] = [
    *(("bodies", limits.BODIES, bodies), ("bodies", limits.POINTS, points)),
    *(("loads", limits.LOADS, several("loads", LOAD)), ("springs", limits.LOADS, several("springs", SPRING))),
    *(("drive.segments", limits.SEGMENTS, segments), ("drive.harmonics", limits.SEGMENTS, harmonics)),
    *(("drive.law", limits.ROWS, law), ("loads.0.table", limits.ROWS, table)),
    ("variations", limits.VARIATIONS, variations),
    *((key, most, text(key)) for key, most in zip(TEXTS, (limits.NAME, limits.TITLE, limits.SOURCE), strict=True)),
]


def load(tables: Tables, folder: Path) -> scenes.Scene:
    file = folder / "a.toml"
    file.write_text(scene_files.toml(tables), encoding="utf-8")
    return scenes.load(file)


@sampled(4)
@pytest.mark.parametrize(("place", "most", "tables"), LIMITS)
def test_a_limit(place: str, most: int, tables: Callable[[int], Tables], tmp_path: Path) -> None:
    load(tables(most), tmp_path)
    line = scene_files.refused(lambda: load(tables(most + 1), tmp_path))
    assert f"a.toml: {place}: expected {most} " in line
    assert f"found {most + 1}" in line


def test_names_that_are_looked_up(tmp_path: Path) -> None:
    long = "x" * (limits.NAME + 1)
    for place in ("drive.body", "loads.0.at", "output.slider"):
        with pytest.raises(InputError, match=f"{place}: expected 64 characters at most, found 65"):
            scenes.load(scene_files.write(tmp_path, "toggle_press", {place: long}))


def steps(tables: Tables, folder: Path) -> int:
    """How many bytecode instructions of `scenes` loading takes: the same number on every machine."""
    count = 0

    def step(*_: object) -> TraceFunction:
        nonlocal count
        count += 1
        return step

    def enter(frame: FrameType, *_: object) -> TraceFunction | None:
        frame.f_trace_opcodes = inside = frame.f_code.co_filename.startswith(SCENES)
        return step if inside else None

    before = sys.gettrace()
    sys.settrace(enter)
    try:
        load(tables, folder)
    finally:
        sys.settrace(before)
    return count


@sampled(1)
@pytest.mark.parametrize("tables", [bodies, lambda count: points(10 * count)], ids=["bodies", "points"])
def test_work_grows_with_the_size(tables: Callable[[int], Tables], tmp_path: Path) -> None:
    """Twice the same step in size takes the same work twice, to a twentieth; a loop within a loop takes three times.

    The first count is left out: since Python 3.12 instructions are traced only where an earlier call asked for them.
    """
    _, small, middle, large = (steps(tables(count), tmp_path) for count in (13, 13, 55, 97))
    assert large - middle <= 1.05 * (middle - small), (small, middle, large)
