"""Magnitudes and transmission angles of a table are judged as channels are."""

import json
from pathlib import Path

import numpy as np
import pytest

import analytic
import scenes
from compare.judge.foreign import assess_result
from compare.results.result import read_result
from compare.run import main
from scenes import InputError, Scene, Status
from scenes.model.motion import Samples
from tests.comparisons import References, only_few_settings, sampled
from tests.foreign import Writer, instants

GROUPS = {"speed": "velocity", "acceleration": "acceleration", "force": "reaction", "transmission": "position"}


def _columns(scene: Scene) -> dict[str, Samples]:
    """Return all magnitudes as lengths of their vectors, and the transmission angles; SI."""
    times = np.append(0.0, instants(scene, 60, 1.0))
    true = analytic.solve(scene, scene.drive.law.at(times).position, times)
    lengths = {name: np.hypot(true[x], true[y]) for name, (x, y) in scene.channels.magnitudes.items()}
    angles = {name: true[name] for name in true.samples if name.endswith(".transmission")}
    assert angles
    return {"time": times} | lengths | angles


@sampled(1)
@pytest.mark.parametrize("name", ["four_bar", "toggle_press"])
def test_each_is_held_against_the_reference(name: str, tmp_path: Path, references: References) -> None:
    scene, writer = scenes.load(name), Writer(decimals=".12g")
    columns = _columns(scene)
    found = assess_result(references(name), read_result(scene, f"theirs={writer.file(tmp_path, columns)}"))
    assert found.run.status is Status.ok, found.run.reason
    rows = {row.channel: row for row in found.errors}
    assert rows.keys() >= columns.keys() - {"time"}
    assert all(rows[c].group == GROUPS[c.rpartition(".")[2]] for c in columns if c != "time")
    assert max(row.unexplained for row in found.errors) < 1e-11
    for channel in [*columns][1:]:  # each by itself, by five times what is promised of its magnitude
        off = {"time": columns["time"], channel: columns[channel] * 1.005}
        wrong = assess_result(references(name), read_result(scene, f"theirs={writer.file(tmp_path, off)}"))
        error = (0.005 * columns[channel] / np.maximum(rows[channel].scale, columns[channel])).max()
        assert wrong.run.status is (Status.inaccurate if error > 1e-3 else Status.ok), (channel, wrong.run.reason)
        assert {row.channel: row.max for row in wrong.errors}[channel] == pytest.approx(error, rel=1e-6)


def test_a_joint_without_one_is_named(tmp_path: Path) -> None:
    scene = scenes.load("four_bar")
    columns = _columns(scene)
    for name in ("A.transmission", "B.forces"):
        table = {"time": columns["time"], name: columns["time"]}
        with pytest.raises(InputError, match=rf"columns\.{name}: no such channel of the scene; did you mean 'B\."):
            read_result(scene, f"theirs={Writer().file(tmp_path, table)}")


def test_a_whole_report_has_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One that is right and one that is off, named as this project's own files name channels."""
    monkeypatch.chdir(tmp_path)
    scene = scenes.load("four_bar")
    columns = {c: values for c, values in _columns(scene).items() if c in ("time", "B.force", "B.transmission")}
    good = Writer(decimals=".9g").file(tmp_path, columns, name="good")
    bad = Writer(decimals=".9g").file(tmp_path, columns | {"B.force": 1.1 * columns["B.force"]}, name="bad")
    with only_few_settings():
        asked = ["four_bar", "--engines", "analytic", "--samples", "36", "--check", "--out", "out"]
        assert main([*asked, f"--result=good={good}", f"--result=bad={bad}"]) == 1
    assert "B.force is off the reference by" in capsys.readouterr().out
    summary = json.loads(Path("out/four_bar/summary.json").read_text())
    assert {name: summary["engines"][name]["status"] for name in ("good", "bad")} == {"good": "ok", "bad": "inaccurate"}
    assert {row["channel"] for row in summary["errors"] if row["engine"] == "good"} >= {"B.force", "B.transmission"}
    assert "B.force [N]" in Path("out/four_bar/motion.good.csv").read_text().splitlines()[0]
