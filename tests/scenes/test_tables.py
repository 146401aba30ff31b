"""Tables in, scene out: what needs no file."""

import tomllib
from copy import deepcopy
from dataclasses import replace
from multiprocessing.reduction import ForkingPickler
from pickle import loads
from typing import Any

import numpy as np
import pytest

import scenes
from compare.judge.floor import UnsolvedError
from compare.report.output.files import unsolved_summary
from scenes import Sampling, Scene
from tests import scene_files

ROD = "bodies.rod.lengths.A-B"


@pytest.fixture
def tables() -> dict[str, Any]:
    return tomllib.loads(scene_files.text("offset_slider_crank"))


def test_a_scene_of_tables_is_that_of_their_file(tables: dict[str, Any]) -> None:
    for name in (*scenes.shipped(), "elements", "outlined", "swinging_segments"):
        of_file = scenes.load(scene_files.path(name))
        whole = tomllib.loads(scene_files.text(name))
        of_tables = scenes.from_tables(whole, of_file.file)
        assert of_tables == of_file, name
        assert of_tables.tables == of_file.tables == whole, name
    assert scenes.from_tables(tables).file == "tables"


def test_it_shares_nothing_with_them(tables: dict[str, Any]) -> None:
    scene, before = scenes.from_tables(tables), deepcopy(tables)
    tables["bodies"]["rod"]["lengths"]["A-B"] = 5
    assert scene.tables == before
    other = scenes.with_changes(scene, {ROD: 310.0})
    assert scene.tables == before
    assert other.tables["bodies"]["rod"]["lengths"] == {"A-B": 310.0}
    assert scenes.numbers_in(scene, [ROD]) == [300]
    assert scenes.numbers_in(other, [ROD]) == [310]


def test_a_scene_changed_in_steps_is_the_one_that_is_read_changed() -> None:
    steps = scenes.with_changes(scenes.with_changes(scenes.load("toggle_press"), {"drive.speed": 30}), {"name": "x"})
    at_once = scenes.load("toggle_press", {"drive.speed": 30, "name": "x"})
    assert steps == at_once
    assert steps.file == at_once.file == "toggle_press, drive.speed = 30, name = x"
    assert steps.tables == at_once.tables


def test_numbers_of_other_kinds_are_those_of_toml(tables: dict[str, Any]) -> None:
    """Of NumPy, and tuples: programs have them; what is kept is what a file would have."""
    whole = scenes.from_tables(tables)
    tables["ground"]["points"]["O"] = (np.int64(0), np.float64(0))
    tables["bodies"]["slider"]["mass"] = np.float32(7)
    tables["format"] = np.int16(1)
    scene = scenes.from_tables(tables)
    assert scene == whole
    assert scene.tables["ground"]["points"]["O"] == [0, 0]
    assert repr(scene.tables["format"]) == "1"


def test_processes_and_reports_get_it() -> None:
    """A process has the tables too; a summary never had them. Equal scenes are found by each other."""
    scene = scenes.load("toggle_press")
    sent = loads(ForkingPickler.dumps(scene))
    assert sent == scene
    assert sent.tables == scene.tables
    assert hash(sent) == hash(scene)
    assert "tables" not in unsolved_summary(scene, Sampling(24), UnsolvedError(""))["scene"]
    assert "tables=" not in repr(scene)


def test_a_scene_with_other_numbers_has_no_tables() -> None:
    """These would have the old numbers."""
    scene = scenes.load("toggle_press").with_numbers({"bodies.rod.mass": 61.0})
    assert not scene.tables
    for refused in (
        lambda: scenes.numbers_in(scene, ["bodies.rod.mass"]),
        lambda: scenes.with_changes(scene, {"drive.speed": 30}),
    ):
        assert scene_files.refused(refused).startswith("toggle_press: expected a scene as its tables have it")


CIRCLE: dict[str, Any] = {}
CIRCLE["bodies"] = CIRCLE
ODD: dict[str, tuple[Any, str]] = {
    "no tables": ([1], "mine: tables: expected tables by name, as tomllib.loads(...) returns them, found [1]"),
    "nothing": ({}, "mine: format: missing"),
    "a circle": (CIRCLE, "levels of tables and lists at most"),
    "a number as key": ({"format": 1, "bodies": {3: {}}}, "mine: bodies: expected texts as keys, found 3"),
    "nothing as value": ({"format": 1, "gravity": None}, "mine: gravity: expected what TOML has, found None"),
    "a complex number": ({"bodies": {"rod": {"mass": 1j}}}, "mine: bodies.rod.mass: expected what TOML has, found 1j"),
    "a large integer": ({"bodies": {"rod": {"mass": 10**5000}}}, "mine: bodies.rod.mass: expected an integer of"),
    "an unknown body": ({"drive": {"body": "x"}}, "mine: format: missing"),
}


@pytest.mark.parametrize("name", ODD)
def test_what_no_file_has_is_refused_in_a_line(name: str) -> None:
    given, expected = ODD[name]
    assert expected in scene_files.refused(lambda: scenes.from_tables(given, "mine"))


def test_a_scene_is_expected() -> None:
    for value in ("toggle_press", None):
        line = scene_files.refused(lambda value=value: scenes.with_changes(value, {}))  # type: ignore[misc]
        assert line.startswith("scene: expected a Scene, as scenes.load(...) returns it, found")


def test_messages_name_the_file_and_the_path(tables: dict[str, Any]) -> None:
    scene: Scene = replace(scenes.from_tables(tables, "mine.toml"))
    del tables["bodies"]["rod"]
    line = scene_files.refused(lambda: scenes.from_tables(tables, "mine.toml"))
    assert line.startswith("mine.toml: ")
    line = scene_files.refused(lambda: scenes.with_changes(scene, {"bodies.rot.mass": 2}))
    assert line == "mine.toml, bodies.rot.mass = 2: bodies.rot.mass: the file has no 'rot' there; did you mean 'rod'?"
