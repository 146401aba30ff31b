"""The command line: what it writes, what it says, how it exits."""

import json
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from shutil import copytree
from typing import Any

import numpy as np
import pandas as pd
import pytest

from compare.engines import registry
from compare.measure.speed.speed_table import MIN_ROUNDS, QUICK
from compare.report.output.files import _write_motion
from compare.run import main
from scenes import Motion, Scene, load, shipped
from scenes.model.motion import header
from tests import scene_files


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("results")
    assert main(["--check", "--out", str(folder)]) == 0
    return folder / "toggle_press"


def summary_of(folder: Path) -> Any:
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def test_the_files_of_the_main_job(results: Path) -> None:
    motions = {f"motion.{engine}.csv" for engine in ("analytic", "exudyn", "pymunk")}
    others = {"report.html", "summary.json", "enclosures.csv", "errors.csv", "peaks.csv", "speed.csv"}
    assert {path.name for path in results.iterdir()} == motions | others


def test_motion_files(results: Path, toggle_press: Scene) -> None:
    groups = [f"{joint}.{q}" for joint in ("P3", "P5") for q in ("transmission", "to_lock")]
    for engine in registry.DEFAULT_ENGINES:
        table = pd.read_csv(results / f"motion.{engine}.csv")
        told = [*toggle_press.channels.names(), *(groups if engine == "analytic" else [])]
        assert sorted(table.columns) == sorted(map(header, told))
        assert len(table) == 361
        assert table.notna().all(axis=None)
    assert list(table.columns[:2]) == ["time [s]", "crank_angle [rad]"]


def test_a_motion_file_is_the_text_that_pandas_writes(tmp_path: Path) -> None:
    numbers = [0.0, -0.0, 1.0, -1e22, 1e16, 5e-324, 0.1 + 0.2, 1 / 3, -1.7976931348623157e308, np.pi]
    motion = Motion({"time": np.arange(10) / 360, "P5.y": np.array(numbers), "P3/rod.fx": np.zeros(10)})
    _write_motion(motion, tmp_path / "motion.csv")
    table = pd.DataFrame({header(channel): values for channel, values in motion.samples.items()})
    assert (tmp_path / "motion.csv").read_text(encoding="utf-8") == table.to_csv(index=False)


def test_summary(results: Path, toggle_press: Scene) -> None:
    summary = summary_of(results)
    assert set(summary["engines"]) == set(registry.DEFAULT_ENGINES)
    for engine in summary["engines"].values():
        assert engine["status"] == "ok"
        assert engine["settings"]["label"]
        assert 0 < engine["seconds"]["solve"] < 10
        assert any(character.isdigit() for character in engine["version"])
    assert len(summary["errors"]) == 3 * (len(toggle_press.channels.names()) - 1)
    assert len(summary["gates"]) == 10
    assert summary["verdict"]["word"] == "agrees"
    assert summary["engines"]["exudyn"]["worst_error"]["channel"] == "P5.ax"
    lengths = {"P2-P3": 0.49, "P3-P4": 0.49, "P2-P4": 0.76}
    assert summary["scene"]["bodies"]["toggle"]["lengths"] == pytest.approx(lengths)
    assert summary["environment"]["python"].startswith("3.")
    groups = {"position", "velocity", "acceleration", "reaction", "torque"}
    assert {row["group"] for row in summary["cheapest"]} == groups
    assert {row["level"] for row in summary["cheapest"]} == {"10 %", "1 %", "0.1 %", "1e-4", "1e-6", "1e-8"}
    for engine in registry.DEFAULT_ENGINES:
        rows = [row for row in summary["cheapest"] if row["engine"] == engine and not row["note"]]
        assert all(row["error"] <= 1e-3 and row["solve_s"] > 0 for row in rows if row["level"] == "0.1 %")
    assert {row["family"] for row in summary["step_costs"]} <= {row["family"] for row in summary["orders"]}


def test_peaks_are_the_same_in_both_files(results: Path) -> None:
    told = summary_of(results)["peaks"]
    table = pd.read_csv(results / "peaks.csv")
    assert [peak["name"] for peak in told] == list(table["name"])
    assert [peak["value"] for peak in told] == pytest.approx(table["value"].tolist(), rel=1e-15)
    stroke = table.set_index("name").loc["stroke"]
    assert stroke["value"] == pytest.approx(0.183632, abs=1e-6)
    assert stroke["pymunk differs by"] < 1e-6
    largest = table.set_index("name").loc["largest force at P1"]
    assert (largest["value"], largest["at [rad]"]) == pytest.approx((382_012, 3.5735), rel=1e-4)
    assert (table["name"] + table["of"]).is_unique


def test_speed_file(results: Path) -> None:
    speed = pd.read_csv(results / "speed.csv")
    assert set(speed["engine"]) == set(registry.DEFAULT_ENGINES)
    failed = speed[speed["status"] != "ok"]
    assert failed["reason"].str.len().gt(0).all(), "a setting that fails stays in the table, and says why"
    assert set(failed["family"]) <= {"textbook"}, "what a first script would take may fail, and nothing else"
    speed = speed[speed["status"] == "ok"]
    for engine in registry.DEFAULT_ENGINES:
        assert "balanced" in " ".join(speed["tier"][speed["engine"] == engine].dropna())
    assert (speed["solve_min_s"] > 0).all()
    assert (speed["solve_min_s"] <= speed["solve_median_s"]).all()
    few = speed[(speed["timed_runs"] < MIN_ROUNDS) & speed["build_s"].notna()]  # those of the main runs have none
    with_one_more = (few["timed_runs"] + 1) * (few["build_s"] + few["solve_median_s"])
    assert (with_one_more > QUICK.patience / len(speed)).all(), "fewer of slow settings alone"
    assert (speed["solve_min_s"] <= 1.1 * speed["solve_wall_s"]).all(), "an engine ran in several threads"
    for engine in ("exudyn", "pymunk"):  # more work, less error: the settings are in that order
        rows = speed[speed["engine"] == engine]
        assert rows["reaction_max"].max() > 1e4 * rows["reaction_max"].min()


def test_the_report_needs_no_network(results: Path) -> None:
    page = (results / "report.html").read_text(encoding="utf-8")
    assert len(page.encode()) <= 2.5e6, "it is sent by mail, and opened on phones"
    assert '<script src="' not in page
    assert "<link" not in page.split("<body>")[0].split("</script>")[-1]
    assert page.count('class="plot"') == 14  # 3 of the slider, 6 pins, guide, torque, groups, locks, speed


@pytest.mark.usefixtures("few_settings")
def test_a_second_run_leaves_nothing_stale(results: Path, tmp_path: Path) -> None:
    target = copytree(results, tmp_path / "toggle_press")
    (target / "notes.txt").write_text("the user's own", encoding="utf-8")
    assert main(["--engines", "analytic", "--out", str(tmp_path)]) == 0
    assert sorted(path.name for path in target.glob("motion.*")) == ["motion.analytic.csv"]
    assert (target / "notes.txt").exists()
    assert {path.name for path in tmp_path.iterdir()} == {"toggle_press", "index.html"}, "the folder aside must go"


@pytest.mark.parametrize("words", ["list", "--list", "four_bar --list", "version", "--version"])
def test_list_and_version(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words.split()) == 0
    said = capsys.readouterr().out
    if "list" in words:
        assert all(name in said for name in ("toggle_press", *registry.ENTRIES))
    else:
        assert said == f"linkage-crosscheck {version('linkage-crosscheck')}\n"


def test_a_list_has_titles_of_which_no_scene_is_made(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    titles = {name: load(name).title for name in shipped()}
    monkeypatch.setattr("scenes.file.reader.validated", pytest.fail)
    assert main(["list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert {words[1]: words[2] for line in lines if (words := line.split(maxsplit=2))[0] == "scene"} == titles


@pytest.mark.usefixtures("few_settings")
def test_a_first_run_is_held_against_no_earlier_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """So that all that is known is made ready for comparison only where there is something to compare it with."""
    monkeypatch.setattr("compare.cli.report.plain", pytest.fail)
    assert main(["--engines", "analytic", "--no-speed", "--out", str(tmp_path)]) == 0


@pytest.mark.parametrize("words", [["new"], ["new", "a", "b"], ["map", "four_bar"], ["map", "a", "b", "c=d.csv"]])
def test_a_command_of_other_words_shows_its_own(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert capsys.readouterr().err.startswith(f"arguments: expected python -m compare.run {words[0]} ")


@pytest.mark.usefixtures("few_settings")
def test_what_is_asked_for_and_held(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pymunk's cheapest setting for a per cent is coarser than the one it runs at else; exudyn is missing."""
    monkeypatch.setitem(registry.ENTRIES, "exudyn", replace(registry.ENTRIES["exudyn"], package="no_such_package"))
    held = {engine: {"position": 1e-9} for engine in ("pymunk", "exudyn", "exudin")}
    file = scene_files.write(tmp_path, "toggle_press", {"name": "strict", "tolerances": held})
    asked = ["--samples", "72", "--accuracy", "1e-2", "--channels", "P5.?, drive.torque"]
    arguments = [str(file), "--engines", "pymunk,exudyn", *asked, "--out", str(tmp_path)]
    assert main(arguments) == 0, "without --check a missed tolerance is nobody's trouble"
    said, folder = capsys.readouterr().out, tmp_path / "strict"
    assert [group in said for group in ("position", "torque", "velocity")] == [True, True, False]
    assert "pip install exudyn" in said
    assert "unsupported" in (folder / "report.html").read_text(encoding="utf-8")
    table = pd.read_csv(folder / "motion.pymunk.csv")
    assert list(table.columns) == ["time [s]", "crank_angle [rad]", "P5.x [m]", "P5.y [m]", "drive.torque [N*m]"]
    assert summary_of(folder)["sampling"]["channels"] == ["P5.x", "P5.y", "drive.torque"]
    settings = summary_of(folder)["engines"]["pymunk"]["settings"]
    assert settings["label"] in said
    assert settings["steps"] < registry.engine("pymunk").DEFAULT.steps
    assert (pd.read_csv(folder / "errors.csv")["max"] <= 1e-2).all()
    assert main([*arguments, "--check"]) == 1
    lines = capsys.readouterr().out.splitlines()
    missed, missing = [line for line in lines if "missed: " in line]
    assert missed.startswith("strict  missed: pymunk position")
    assert "1e-09" in missed
    assert "(unsupported: exudyn is not installed: pip install exudyn)" in missing
    assert "strict  not held: tolerances.exudin: no engine of that name; did you mean 'exudyn'?" in lines


@pytest.mark.usefixtures("few_settings")
def test_new_scene_runs_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", str(tmp_path / "mine")]) == 0
    file = tmp_path / "mine.toml"
    assert str(file) in capsys.readouterr().out
    assert main([str(file), "--check", "--out", str(tmp_path)]) == 0
    assert {engine["status"] for engine in summary_of(tmp_path / "mine")["engines"].values()} == {"ok"}


def test_a_report_without_its_table_of_speed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["four_bar", "--engines", "analytic", "--no-speed", "--out", str(tmp_path)]
    assert main(arguments) == 0
    printed = capsys.readouterr().out
    assert "The fastest way" not in printed
    assert all(line.split(maxsplit=1)[1:] for line in printed.splitlines())
    report = (tmp_path / "four_bar" / "report.html").read_text(encoding="utf-8")
    assert "Speed against error" not in report
    assert not (tmp_path / "four_bar" / "speed.csv").exists()
    assert (tmp_path / "four_bar" / "motion.analytic.csv").exists()
