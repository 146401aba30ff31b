"""A result of another program stands beside the engines: read by its mapping, judged, named where it is wrong."""

import json
import re
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

import scenes
from compare.judge.foreign import assess_result
from compare.judge.measure import Measurement, gates
from compare.results.result import read_result
from compare.run import main
from scenes import InputError, Scene
from tests import scene_files
from tests.comparisons import References, only_few_settings, sampled
from tests.foreign import DEGREES, ELSEWHERE, MAPPED, Writer, channels, instants

PRESS = scenes.load("toggle_press")


def judged(scene: Scene, file: Path, references: References) -> Measurement:
    return assess_result(references(scene.name), read_result(scene, f"theirs={file}"))


@sampled(2)
@pytest.mark.parametrize(
    ("decimals", "promise", "least", "most"),
    [(".17g", 1e-9, 0.0, 1e-13), (".10e", 1e-9, 1e-12, 1e-9), (".6g", 1e-9, 1e-7, 1e-4), (".6f", 1e-9, 1e-7, 1e-4)],
)
def test_it_agrees_as_well_as_it_is_written(
    tmp_path: Path, references: References, decimals: str, promise: float, least: float, most: float
) -> None:
    """In mm, kN, degrees that jump, a turned and mirrored frame, on the other side, at instants of its own."""
    writer = replace(ELSEWHERE, decimals=decimals)
    own = instants(PRESS)
    assert np.ptp(np.diff(own)) > 0.1 * np.diff(own).mean()
    columns = writer.columns(PRESS, own, channels(PRESS))
    columns |= {c: (angle - angle[0]) % 360 + angle[0] for c, angle in columns.items() if c.endswith(".angle")}
    assert np.abs(np.diff(columns["toggle.angle"])).max() > 180
    found = judged(PRESS, writer.file(tmp_path, columns, f"promise = {promise}\n{MAPPED}"), references)
    assert found.run.status.name == "ok", found.run.reason
    worst = found.worst()
    assert worst.keys() >= {"position", "velocity", "acceleration", "reaction", "torque"}
    assert all(least <= worst[group] <= most for group in worst if group != "drive"), worst  # of the decimals
    assert all(error <= 1e-13 for error in found.worst("unexplained").values())  # of doubles
    assert {check.check for check in found.checks} >= {"closure", "Newton", "Euler", "power", "reaction"}


def test_the_angle_between_two_bodies_does_not_turn_with_the_frame(tmp_path: Path, references: References) -> None:
    scene = scene_files.load("elbow")
    columns = ELSEWHERE.columns(scene, instants(scene), ["crank_angle", *channels(scene)])
    found = judged(scene, ELSEWHERE.file(tmp_path, columns, f"promise = 1e-9\n{MAPPED}"), references)
    assert found.run.status.name == "ok", found.run.reason


def test_the_other_side_of_one_of_two_of_a_name_is_of_a_channel(tmp_path: Path) -> None:
    """A slider has the name of its pin, and both have forces."""
    text = scene_files.text("offset_slider_crank")
    (tmp_path / "alike.toml").write_text(re.sub(r"\bslider(?= *[].=\"])(?! = \")", "B", text), encoding="utf-8")
    scene, pair = scenes.load(tmp_path / "alike.toml"), ["B.fx", "B.fy", "B.guide_force"]
    columns = Writer().columns(scene, instants(scene, 12), pair)

    def signs(other_side: str) -> list[float]:
        found = read_result(
            scene, f"theirs={Writer().file(tmp_path, columns, f'other_side = {other_side}')}"
        ).run.motion
        assert found is not None
        return [float(np.median(found[c] / columns[c])) for c in pair]

    assert signs('["B.guide_force"]') == [1, 1, -1]
    assert signs('["B.fx", "B.fy"]') == [-1, -1, 1]
    assert signs('["*"]') == [-1, -1, -1]
    with pytest.raises(
        InputError, match=r"other_side: 'B' is of several; expected one or more of B.fx, B.fy, B.guide_f"
    ):
        signs('["B"]')


@sampled(3)
@pytest.mark.parametrize("channel", ["P4.y", "P4.vx", "P5.ay", "rod.angle", "toggle.alpha", "P3.fx", "drive.torque"])
def test_decimals_excuse_no_more_than_half_of_the_last(tmp_path: Path, references: References, channel: str) -> None:
    """A channel that is off by three of its last decimals, and a promise below these, is not ok; one is excused."""
    writer = replace(ELSEWHERE, decimals=".4f")
    columns = writer.columns(PRESS, np.linspace(0, 0.9, 37), channels(PRESS))
    sizes = {}
    for last, status in ((0.0, "ok"), (3.0, "inaccurate")):
        off = columns | {channel: columns[channel] + last * 1e-4}
        found = judged(PRESS, writer.file(tmp_path, off, f"promise = 1e-9\n{MAPPED}"), references)
        sizes[last] = next(row.unexplained for row in found.errors if row.channel == channel)
        assert found.run.status.name in (status, "inconsistent" if last else status), found.run.reason
    assert sizes[0.0] <= 1e-13 < 1e-9 < sizes[3.0]


def test_the_reference_is_evaluated_at_its_instants_and_never_interpolated(
    tmp_path: Path, references: References
) -> None:
    """Four rows anywhere in the third turn are as good as a whole cycle; one is enough."""
    for own in (np.array([2.111, 2.2, 2.5003, 2.9]), np.array([0.3217])):
        columns = Writer().columns(PRESS, own, ["P5.y", "P5.ay"])
        found = judged(PRESS, Writer().file(tmp_path, columns, "promise = 1e-12"), references)
        assert found.run.status.name == "ok", found.run.reason
        assert found.run.motion is not None
        assert np.array_equal(found.run.motion["time"], own)
        assert {row.channel for row in found.errors} == {"P5.y", "P5.ay", "crank_angle"}


def test_the_axis_may_be_the_drives_position_and_run_backwards(tmp_path: Path, references: References) -> None:
    """Against the drive from 200 degrees on, counted modulo one turn: velocities are the opposite then."""
    scene = scenes.load("four_bar")
    time = np.linspace(1.6, 0.2, 61) * scene.cycle
    angle = scene.drive.law.at(time).position
    columns = Writer().columns(scene, time, ["T.x", "T.y", "T.vx", "T.vy", "T.ax", "crank.angle"])
    way = {c: -columns[c] if ".v" in c else columns[c] for c in columns if c != "time"}
    for mapping, status in (("backwards = true", "ok"), ("", "expected a later instant")):
        by_angle = {"crank_angle": np.degrees(angle) % 360} | way
        file = Writer(decimals=".14g").file(tmp_path, by_angle, mapping, **DEGREES)
        if status == "ok":
            found = judged(scene, file, references)
            assert found.run.status.name == "ok", found.run.reason
            assert found.worst()["velocity"] < 1e-12
        else:
            with pytest.raises(scenes.InputError, match=status):
                read_result(scene, f"theirs={file}")


def test_a_law_needs_the_time_and_a_late_log_has_its_zero(tmp_path: Path, references: References) -> None:
    scene = scene_files.load("turning_law")
    columns = Writer().columns(scene, instants(scene), [f"{scene.output}.x", f"{scene.output}.vy", "crank_angle"])
    file = Writer().file(tmp_path, columns | {"time": columns["time"] + 12.5}, time="zero = 12.5")
    assert judged(scene, file, references).run.status.name == "ok"
    file.with_suffix(".toml").write_text(f'columns = {{"{scene.output}.x" = "c1", "crank_angle" = "c3"}}')
    with pytest.raises(scenes.InputError, match=r"columns\.time: missing; the drive follows a motion law"):
        read_result(scene, f"theirs={file}")


def test_a_run_reports_where_a_result_comes_from(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It stands beside the engines in each table, in the page, in the gates and in `summary.json`."""
    monkeypatch.chdir(tmp_path)
    scene = scenes.load("four_bar")
    writer = replace(ELSEWHERE, decimals=".6f")
    good = writer.file(tmp_path, writer.columns(scene, instants(scene), channels(scene)), MAPPED, "good")
    columns = Writer().columns(scene, scene.cycle * np.linspace(0, 1, 49), ["T.x", "T.y"])
    bad = Writer().file(tmp_path, columns | {"T.y": -columns["T.y"]}, name="bad")
    with only_few_settings():
        asked = ["four_bar", "--engines", "analytic", "--samples", "36", "--check"]
        status = main([*asked, "--out", "out", f"--result=bench={good}", f"--result=other={bad}"])
    printed = capsys.readouterr().out
    assert status == 1
    assert "missed: other: " in printed
    assert "likely cause: other: T.y has the opposite sign" in printed
    assert "bench gives no crank_angle; it is taken as commanded" in printed
    assert "other gives 2 of " in printed
    summary = json.loads(Path("out/four_bar/summary.json").read_text())
    origin = summary["engines"]["bench"]["settings"]
    assert origin["sha256"] == sha256(good.read_bytes()).hexdigest()
    assert (origin["made_by"], origin["made_with"]) == ("A. Designer", "Mechanica 7")
    assert origin["mapping"]["frame"]["mirrored"] is True
    assert origin["mapping"]["columns"]["time"] == "c0"
    assert summary["engines"]["bench"]["status"] == "ok"
    assert {row["engine"] for row in summary["errors"]} == {"analytic", "bench", "other"}
    assert any("other" in peak["differs"] for peak in summary["peaks"]), "it has a whole cycle"
    page = Path("out/four_bar/report.html").read_text()
    assert origin["sha256"] in page
    assert "bench (Mechanica 7)" in page
    assert "bench error" in page
    assert len(Path("out/four_bar/motion.bench.csv").read_text().splitlines()) == 91
    again = read_result(scene, "back=out/four_bar/motion.bench.csv")
    assert set(again.run.motion.samples if again.run.motion else ()) == {"time", "crank_angle", *channels(scene)}


def test_a_declared_tolerance_is_its_gate(tmp_path: Path, references: References) -> None:
    """Its group's tolerance is held against what its decimals do not explain."""
    columns = Writer().columns(PRESS, instants(PRESS), ["P5.y", "P5.vy"])
    off = columns | {"P5.y": columns["P5.y"] + 1e-6 * references("toggle_press").stroke}
    held = replace(PRESS, tolerances={"theirs": {"position": 5e-7, "velocity": 5e-7}})
    found = judged(held, Writer().file(tmp_path, off), references)
    assert found.run.status.name == "ok"
    assert {gate.group: gate.missed for gate in gates(held, [found])} == {"position": True, "velocity": False}


def test_the_mapping_may_be_in_the_scene(tmp_path: Path, references: References) -> None:
    """Beside the table or in the scene, and not in both."""
    names = ["T.x", "A.vy"]
    plain, writer = scene_files.load("offset_slider_crank"), Writer(length=1e-3)
    file = writer.file(tmp_path, writer.columns(plain, instants(plain, 20), names))
    columns = {channel: f"c{k}" for k, channel in enumerate(["time", *names])}
    table = {"theirs": {"units": {"length": "mm"}, "columns": columns}}
    scene = scenes.load(scene_files.write(tmp_path, "offset_slider_crank", {"results": table}))
    with pytest.raises(scenes.InputError, match=r"the scene has a mapping too, results\.theirs"):
        read_result(scene, f"theirs={file}")
    file.with_suffix(".toml").unlink()
    found = judged(scene, file, references)
    assert found.run.status.name == "ok", found.run.reason
    assert getattr(found.run.settings, "mapping_in", "").endswith("results.theirs")
