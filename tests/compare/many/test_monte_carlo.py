"""`--monte-carlo` by the command line: its files, what it refuses, and what a stop leaves."""

import json
from collections.abc import Iterator
from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from compare.engines import registry
from compare.engines.processes.isolation import isolated
from compare.measure.many import study as solving
from compare.report.tables.monte_carlo import differences
from compare.run import main
from scenes.model.enclosures import Enclosures
from tests import scene_files
from tests.comparisons import SLOW
from tests.pages import unpacked, without_scripts

from .runs import alone

pytestmark = pytest.mark.usefixtures("few_settings")

VARIATIONS = [
    {"path": "bodies.crank.lengths.O-A", "plus_minus": 0.3},
    {"path": "bodies.rod.lengths.A-B", "plus_minus": 0.6, "distribution": "uniform"},
]
LOOSE = [{"path": "bodies.rod.lengths.A-B", "plus_minus": 60, "distribution": "uniform"}]  # 140 reaches, less does not
FILES = ["monte_carlo.csv", "monte_carlo.html", "monte_carlo.json"]


def scene(folder: Path, variations: list[dict[str, Any]]) -> str:
    changes: dict[str, Any] = {"variations": variations}
    if variations is LOOSE:
        changes["bodies.rod.lengths.A-B"] = 180
    return str(scene_files.write(folder, "offset_slider_crank", changes))


def run(file: str, folder: Path, *arguments: str) -> int:
    return main([file, "--engines", "analytic", "--samples", "36", "--out", str(folder), *arguments])


def summary(folder: Path) -> Any:
    return json.loads((folder / "monte_carlo.json").read_text(encoding="utf-8"))


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solving, "BLOCK", 40)


@pytest.mark.usefixtures("small_blocks")
def test_the_files_of_tolerances(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = scene(tmp_path, VARIATIONS)
    assert run(file, tmp_path / "out", "--monte-carlo", "200", "--seed", "3") == 0
    folder = tmp_path / "out" / "offset_slider_crank"
    assert sorted(path.name for path in folder.iterdir()) == FILES
    table = pd.read_csv(folder / "monte_carlo.csv").set_index("name")
    outer, inner = (np.sqrt((300 + way) ** 2 - 40**2) for way in (100, -100))  # mm: crank and rod in line
    stroke = table.loc["stroke"]
    assert stroke["nominal"] == pytest.approx(1e-3 * (outer - inner), rel=1e-10)
    by_crank, by_rod = 400 / outer + 200 / inner, 400 / outer - 200 / inner
    deviation = 1e-3 * np.hypot(by_crank * 0.1, by_rod * 0.6 / 3**0.5)
    assert stroke["linear standard deviation"] == pytest.approx(deviation, rel=1e-8)
    assert stroke["standard deviation"] == pytest.approx(deviation, rel=0.03)  # of 200 Sobol points
    assert stroke["share of bodies.crank.lengths.O-A"] == pytest.approx((1e-3 * by_crank * 0.1 / deviation) ** 2)
    assert stroke["mean"] == pytest.approx(stroke["nominal"], abs=0.05 * deviation)
    written = summary(folder)
    assert all(number["unexplained"] < 1e-4 for number in written["numbers"] if number["deviation"] > 0)
    assert (written["machines"], written["running"], written["failures"], written["complete"]) == (200, 200, [], True)
    assert len(written["picked"]) == 20
    page = (folder / "monte_carlo.html").read_text(encoding="utf-8")
    assert "{{" not in without_scripts(page), "a piece of the template is left"
    for shown in ("200 of 200 machines run, drawn with seed 3", "Stroke", "O-A", "The worst machine"):
        assert shown in page
    assert len(unpacked(page)) == 3
    assert f"tolerances: {folder / 'monte_carlo.html'}" in capsys.readouterr().out

    machine = written["picked"][11]
    changes = {path: np.array([value]) for path, value in machine["changes"].items()}
    own = alone("offset_slider_crank", changes, 0)
    for name, value in machine["numbers"].items():
        assert value == pytest.approx(own[name].value, rel=1e-9, abs=1e-9), name


def test_machines_that_do_not_run_are_counted(tmp_path: Path) -> None:
    """A rod of less than crank and offset does not reach: a third of those from 120 to 240."""
    assert run(scene(tmp_path, LOOSE), tmp_path / "out", "--monte-carlo", "96") == 0
    folder = tmp_path / "out" / "offset_slider_crank"
    written = summary(folder)
    (failed,) = written["failures"]
    assert failed["status"] == "cannot_assemble"
    assert failed["count"] == pytest.approx(96 * 20 / 120, abs=1)
    assert written["running"] == 96 - failed["count"]
    assert "B cannot be reached" in failed["reason"]
    lost = [machine for machine in written["picked"] if machine["changes"]["bodies.rod.lengths.A-B"] < 140]
    assert lost
    assert all(set(machine["numbers"].values()) == {None} for machine in lost)
    assert "B cannot be reached" in (folder / "monte_carlo.html").read_text(encoding="utf-8")


def test_a_check_fails_where_no_drawn_machine_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A rod of more than crank and offset as drawn, and of less in both machines of this seed."""
    offset = {"path": "bodies.slider.slides.through.1", "plus_minus": 60, "distribution": "uniform"}
    changes: dict[str, Any] = {"variations": [*LOOSE, offset], "bodies.rod.lengths.A-B": 150}
    file = str(scene_files.write(tmp_path, "offset_slider_crank", changes))
    assert run(file, tmp_path / "out", "--monte-carlo", "2", "--seed", "3", "--check") == 1
    printed = capsys.readouterr().out
    assert "0 of 2 machines run" in printed
    assert "missed: every tolerance, since no drawn machine runs" in printed


@SLOW
def test_numbers_that_nothing_changes_are_not_drawn(tmp_path: Path) -> None:
    """The drive's speed moves no dead point but by rounding, of which there is no distribution."""
    speed = [{"path": "drive.speed", "plus_minus": 3}]
    assert run(scene(tmp_path, speed), tmp_path / "out", "--monte-carlo", "40") == 0
    html = without_scripts((tmp_path / "out" / "offset_slider_crank" / "monte_carlo.html").read_text(encoding="utf-8"))
    assert "Peak speed" in html
    assert "Stroke" not in html


@pytest.mark.usefixtures("small_blocks")
def test_a_stop_keeps_the_machines_that_are_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped(*arguments: Any) -> Iterator[Any]:
        yield from [*isolated(*arguments)][:2]
        raise KeyboardInterrupt

    monkeypatch.setattr(solving, "isolated", stopped)
    assert run(scene(tmp_path, VARIATIONS), tmp_path / "out", "--monte-carlo", "100") == 130
    written = summary(tmp_path / "out" / "offset_slider_crank")
    assert not written["complete"]
    assert written["machines"] in (60, 80)  # two blocks of 40, 40 and 20, as they come
    assert "stopped" in capsys.readouterr().err
    assert all(number["deviation"] for number in written["numbers"][:3])


def test_the_engines_differences_are_in_si() -> None:
    """Those of peaks are relative to what the number has as its size: of a dead point, the stroke."""
    peak = SimpleNamespace(name="closed dead point", differs={"exudyn": 1e-6})
    runs = [SimpleNamespace(run=SimpleNamespace(engine=engine)) for engine in ("analytic", "exudyn", "pymunk")]
    study: Any = SimpleNamespace(judged=SimpleNamespace(measurements=runs, peaks=[peak]))
    number: Any = SimpleNamespace(name="closed dead point", size=0.18)
    off = differences(study, number)
    assert off["exudyn"] == pytest.approx(1.8e-7)
    assert np.isnan(off["pymunk"])
    assert "analytic" not in off


@SLOW
def test_of_a_larger_group_too(tmp_path: Path) -> None:
    """Its distance to a singular pose has no exact derivatives: a linear model of differences holds each machine."""
    paths = "bodies.plate.lengths.B-C", "bodies.upper.lengths.C-E", "ground.points.F.0"
    file = scene_files.write(tmp_path, "class_iii", {"variations": [{"path": p, "plus_minus": 0.1} for p in paths]})
    assert run(str(file), tmp_path / "out", "--monte-carlo", "6", "--engines", "analytic") == 0
    numbers = {number["name"]: number for number in summary(tmp_path / "out" / "class_iii")["numbers"]}
    for name in ("distance to a singular pose", "peak driving torque"):
        assert numbers[name]["unexplained"] <= 1e-4  # of the variance: 1 % of a deviation; the square of the tolerances


@SLOW
def test_a_bound_that_is_not_known_is_said_to_be_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where poses are nearly singular, forces of all machines together may have no bound."""
    enclosures = registry.enclosures

    def unbounded(*scene: Any, **off: Any) -> Enclosures:
        found = enclosures(*scene, **off)
        return replace(found, rows=tuple(row._replace(high=inf) for row in found.rows)) if "off" in off else found

    monkeypatch.setattr(registry, "enclosures", unbounded)
    assert run("toggle_press", tmp_path, "--monte-carlo", "3", "--engines", "analytic") == 0
    assert "not known" in (tmp_path / "toggle_press" / "monte_carlo.html").read_text(encoding="utf-8")
