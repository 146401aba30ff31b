"""A scene that is made needs its file no more: another one takes its place, or none, and a run goes on as it began."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import analytic
import scenes
from compare.measure.hard.case import hard_cases
from compare.measure.many.family import Asked, Family
from compare.measure.many.going_on import by_processes, going_on, kept_members
from compare.measure.many.grid import grid, variation
from compare.measure.many.study import MonteCarlo, begun, solved
from compare.measure.speed.speed_table import NO_CLOCK
from compare.report.output import files
from compare.results.mapping import mapping_of
from compare.study import study
from scenes import Sampling, Scene, hard
from tests import scene_files
from tests.comparisons import SLOW

ROD, SPEED = "bodies.rod.lengths.A-B", "drive.speed"
MORE = f"""
[[variations]]
path = "{ROD}"
plus_minus = 0.5
[results.theirs]
promise = 0.25
[limits."B.force"]
most = 3
"""
TEXT = scene_files.text("offset_slider_crank") + MORE
ENGINES, SAMPLING = ["analytic", "exudyn", "pymunk"], Sampling(24)
ANOTHER = (
    TEXT.replace("= 300", "= 290").replace("mass = 7", "mass = 8").replace("0.25", "0.5")
)  # of which every result differs


@pytest.fixture
def two(tmp_path: Path) -> tuple[Scene, Scene]:
    """A scene whose file is as it was, and the same one whose file has another by now."""
    there, other = tmp_path / "there" / "mine.toml", tmp_path / "gone" / "mine.toml"
    for file in (there, other):
        file.parent.mkdir()
        file.write_text(TEXT, encoding="utf-8")
    pair = scenes.load(there), scenes.load(other)
    other.write_text(ANOTHER, encoding="utf-8")
    return pair


def written(folder: Path) -> dict[str, Any]:
    """The files of a result: all but the times of engines, and from where the scene came."""
    summary, timed = json.loads(next(folder.glob("*.json")).read_text("utf-8")), {"engines", "made_from", "scene"}
    left = {key: value for key, value in summary.items() if key not in timed}
    (page,) = (file.read_text("utf-8").splitlines() for file in folder.glob("*.html"))
    lines = [line for line in page if not line.startswith('<tr><th scope="row">')]  # these have times
    return {"summary": left, "page": lines} | {file.name: file.read_text("utf-8") for file in folder.glob("*.csv")}


def test_it_is_judged_and_reported(two: tuple[Scene, Scene], tmp_path: Path) -> None:
    """By engines in processes of their own; the page has the tables, which it changes."""
    reports = []
    for number, scene in enumerate(two):
        result = study(scene, ENGINES, SAMPLING, NO_CLOCK, lambda _: None)
        reports.append(written(files.write(result, tmp_path / str(number))))
        assert scenes.numbers_in(scene, [ROD, SPEED]) == [300, 120]
    assert reports[0] == reports[1]


def test_a_family_is_solved(two: tuple[Scene, Scene], tmp_path: Path) -> None:
    """In this process and by workers; the numbers of its members are those of the scene, with a change."""
    varied = [variation(f"{ROD}=290:310:2")]
    for spread in (None, by_processes(2)):
        tables = []
        for number, scene in enumerate(two):
            asked, folder = Asked(scene, ENGINES[:1], SAMPLING), tmp_path / f"{number}"
            kept = kept_members(folder, scene, asked)
            family = Family(
                scene, varied, asked.engines, [*going_on(kept, asked, grid(varied), spread, lambda _: None)]
            )
            family.members.sort(key=lambda member: member.changes[ROD])
            assert [member.status for member in family.members] == ["ok"] * 2
            tables.append(written(files.write_family(family, folder))["family.csv"])
        assert tables[0] == tables[1]


@SLOW
def test_machines_are_drawn(two: tuple[Scene, Scene], tmp_path: Path) -> None:
    tables = []
    for number, scene in enumerate(two):
        drawn: MonteCarlo = begun(scene, 20, 0, ENGINES[:1], SAMPLING, lambda _: None)
        drawn.blocks.extend(solved(drawn))
        tables.append(written(files.write_monte_carlo(drawn, tmp_path / str(number))))
    assert tables[0] == tables[1]


def test_it_has_its_mappings(two: tuple[Scene, Scene], tmp_path: Path) -> None:
    for scene in two:
        mapping, where = mapping_of(scene, "theirs", tmp_path / "theirs.csv")
        assert (mapping.promise, where) == (0.25, f"{scene.file}: results.theirs")


def test_machines_and_derivatives_are_solved(two: tuple[Scene, Scene]) -> None:
    by_scene = [
        (
            analytic.solve_many(scene, {ROD: np.linspace(290, 310, 3)}, [0.5])["B.x"].tolist(),
            analytic.derivatives(scene, [ROD], [0.5])["B.x"].tolist(),
        )
        for scene in two
    ]
    assert by_scene[0] == by_scene[1]


def test_ladders_go_on(tmp_path: Path) -> None:
    """A ladder has its scenes, and a run of hard cases its ladders: its processes read no file."""
    file, scene = tmp_path / "rod.toml", tmp_path / "toggle_press.toml"
    text = (scene_files.FOLDER / "ladders" / "rod.toml").read_text("utf-8")
    scene.write_text(scene_files.text("toggle_press"), encoding="utf-8")
    file.write_text(text.replace('"toggle_press"', '"toggle_press.toml"'), encoding="utf-8")
    ladder = hard.ladder(file)

    def progress(_: str) -> None:
        for each in (file, scene):
            each.unlink(missing_ok=True)

    rows = hard_cases([str(file)], ["pymunk"], tmp_path, progress, print)
    assert [*rows["status"]] == ["ok", "ok", "cannot_assemble"]
    lengths = [{*(rung.scene().bodies["rod"].lengths or {}).values()} for rung in ladder.rungs]
    assert lengths == [{0.29}, {0.3}, {0.02}]
