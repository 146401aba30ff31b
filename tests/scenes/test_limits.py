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

SCENES = str(Path(scenes.__file__).parent)
Tables = dict[str, Any]
TraceFunction = Callable[..., Any]


def four_bars(count: int) -> Tables:
    """Return a chain of four-bars, each driving the next: two bodies and five points a four-bar, with one crank."""
    bodies: Tables = {"crank": {"points": {"O": [0, 0], "A0": [1, 0]}}}
    sketch: Tables = {"angle": 1, "A0": [0.5, 0.8]}
    for i in range(count):
        bodies[f"coupler{i}"] = {"lengths": {f"A{i}-B{i}": 4}}
        bodies[f"rocker{i}"] = {"lengths": {f"G{i}-B{i}": 2.5, f"B{i}-A{i + 1}": 2, f"G{i}-A{i + 1}": 1}}
        sketch |= {f"B{i}": [4 * i + 4, 2.4], f"A{i + 1}": [4 * i + 5, 0.5]}
    return {
        "format": 1,
        "name": "chain",
        "ground": {"points": {"O": [0, 0], **{f"G{i}": [4 * i + 4, 0] for i in range(count)}}},
        "bodies": bodies,
        "drive": {"body": "crank", "speed": 1},
        "sketch": sketch,
        "output": {"point": "B0"},
    }


def bodies(count: int) -> Tables:
    """Return whole four-bars with a crank, one body less where the count is even: no scene has such a number."""
    return four_bars((count - 1) // 2)


def points(count: int) -> Tables:
    """Return one four-bar, whose seven points are named ten times, and a crank with as many more as are asked for."""
    tables = four_bars(1)
    tables["bodies"]["crank"]["points"] |= {f"P{i}": [i, 1] for i in range(count - 9)}
    return masses(tables)


def masses(tables: Tables) -> Tables:
    for body in tables["bodies"].values():
        body |= {"mass": 1, "com": [0, 0], "inertia": 1}
    return tables


def loads(count: int) -> Tables:
    return masses(four_bars(1)) | {"loads": [{"body": "crank", "at": "A0", "force": [1, 0]}] * count}


def springs(count: int) -> Tables:
    spring = {"between": ["ground.G0", "crank.A0"], "stiffness": 1, "length": 0}
    return masses(four_bars(1)) | {"springs": [spring] * count}


def law(count: int) -> Tables:
    return four_bars(1) | {"drive": {"body": "crank", "law": [[i, i % 7] for i in range(count)]}}


def table(count: int) -> Tables:
    tables = tomllib.loads(scene_files.text("driven_toggle"))
    tables["loads"][0]["table"] = [[i, 1] for i in range(count)]
    return tables


def variations(count: int) -> Tables:
    """Return a scene that varies the coordinates of the points of its crank."""
    paths = [f"bodies.crank.points.P{i // 2}.{i % 2}" for i in range(count)]
    return points(limits.POINTS) | {"variations": [{"path": path, "plus_minus": 0.01} for path in paths]}


def name(count: int) -> Tables:
    return four_bars(1) | {"name": "x" * count}


def title(count: int) -> Tables:
    return four_bars(1) | {"title": "x" * count}


def source(count: int) -> Tables:
    return four_bars(1) | {"source": "x" * count}


LIMITS: dict[Callable[[int], Tables], tuple[str, int]] = {
    bodies: ("bodies", limits.BODIES),
    points: ("bodies", limits.POINTS),
    loads: ("loads", limits.LOADS),
    springs: ("springs", limits.LOADS),
    law: ("drive.law", limits.ROWS),
    table: ("loads.0.table", limits.ROWS),
    variations: ("variations", limits.VARIATIONS),
    name: ("name", limits.NAME),
    title: ("title", limits.TITLE),
    source: ("source", limits.SOURCE),
}


def load(tables: Tables, folder: Path) -> scenes.Scene:
    file = folder / "a.toml"
    file.write_text(scene_files.toml(tables), encoding="utf-8")
    return scenes.load(file)


@pytest.mark.parametrize("tables", LIMITS)
def test_a_limit(tables: Callable[[int], Tables], tmp_path: Path) -> None:
    place, most = LIMITS[tables]
    load(tables(most), tmp_path)
    with pytest.raises(InputError) as caught:
        load(tables(most + 1), tmp_path)
    line = str(caught.value)
    assert f"a.toml: {place}: expected {most} " in line
    assert f"found {most + 1}" in line


def test_names_that_are_looked_up(tmp_path: Path) -> None:
    long = "x" * (limits.NAME + 1)
    for place in ("drive.body", "loads.0.at", "output.slider"):
        with pytest.raises(InputError, match=f"{place}: expected 64 characters at most, found 65"):
            scenes.load(scene_files.write(tmp_path, "toggle_press", {place: long}))


def steps(tables: Tables, folder: Path) -> int:
    """Return how many bytecode instructions of `scenes` loading takes: the same number on every machine."""
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


@pytest.mark.parametrize("tables", [bodies, lambda count: points(10 * count)], ids=["bodies", "points"])
def test_work_grows_with_the_size(tables: Callable[[int], Tables], tmp_path: Path) -> None:
    """Seven and a half times as many, and no more than seven times the work; a loop within a loop takes more.

    The first count is left out: since Python 3.12 instructions are traced only where an earlier call asked for them.
    """
    _, small, large = (steps(tables(count), tmp_path) for count in (13, 13, 97))
    assert large < 7 * small, large / small
