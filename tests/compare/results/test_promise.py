"""Ok is a promise: no column excuses another, no copy has a vote, and what a result leaves out is reported."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import scenes
from compare.judge.foreign import assess_result
from compare.judge.judgement import coarse, judgement
from compare.judge.measure import Measurement
from compare.results.result import read_result, read_results
from compare.run import main
from scenes import InputError, Sampling
from scenes.model.motion import Samples
from tests import scene_files
from tests.comparisons import SLOW, References, sampled
from tests.foreign import DEGREES, MILLIMETRES, Writer, channels, instants, write

PRESS = scenes.load("toggle_press")


def assessed(references: References, folder: Path, columns: Mapping[str, Samples], **decimals: str) -> Measurement:
    """Return the judgement of columns, those named at their own decimals; a crank's angle is in degrees."""
    texts = {c: [format(value, decimals.get(c, ".12g")) for value in values] for c, values in columns.items()}
    file = write(folder, texts, **DEGREES)
    return assess_result(references(PRESS.name), read_result(PRESS, f"theirs={file}"))


@sampled(2)
@pytest.mark.parametrize("timed", [False, True])
@pytest.mark.parametrize("everything", [False, True])
def test_whole_degrees_excuse_no_lag(tmp_path: Path, references: References, timed: bool, everything: bool) -> None:
    """A lag of 0.2 deg is above the promise at every joint, and a drive in whole degrees shows half of one."""
    speed = PRESS.drive.law.peak_rate
    times = instants(PRESS, 60) if timed else np.radians(np.arange(0.0, 360.0, 5.0)) / speed
    names = channels(PRESS) if everything else ["P5.y", "P5.vy"]
    angle = np.degrees(PRESS.drive.law.at(times).position)
    for lag, status in ((0.0, "ok"), (0.2, "inaccurate")):
        late = Writer().columns(PRESS, times - np.radians(lag) / speed, names)
        axis = {"time": times, "crank_angle": angle} if timed else {"crank_angle": angle}
        found = assessed(references, tmp_path, axis | {c: late[c] for c in names}, crank_angle=".0f")
        assert found.run.status.name == status, found.run.reason


def test_a_drive_that_is_off_by_more_than_its_decimals(tmp_path: Path, references: References) -> None:
    times = instants(PRESS, 30)
    columns = Writer().columns(PRESS, times, ["P5.y"])
    angle = np.degrees(PRESS.drive.law.at(times).position)
    for off, status in ((0.04, "ok"), (0.2, "inconsistent")):
        found = assessed(references, tmp_path, columns | {"crank_angle": angle + off}, crank_angle=".1f")
        assert found.run.status.name == status, found.run.reason


@SLOW
def test_decimals_may_put_a_press_on_the_other_side_of_its_switch(tmp_path: Path, references: References) -> None:
    """At four digits a millimetre decides whether 1600 kN act; the forces of the other side are wrong there too."""
    scene = scenes.load("servo_press")
    writer, times = Writer(1e-3, np.pi / 180, 1e3, decimals=".4g"), np.arange(60.0) * round(scene.cycle / 60, 4)
    columns = writer.columns(scene, times, channels(scene))
    wrong = columns | {c: -columns[c] for c in ("P5.fx", "P5.fy")}
    for written, status in ((columns, "ok"), (wrong, "inconsistent")):
        file = write(tmp_path, writer.texts(written) | {"time": [f"{t:.4f}" for t in times]}, MILLIMETRES)
        found = assess_result(references("servo_press"), read_result(scene, f"theirs={file}"))
        assert found.run.status.name == status, found.run.reason


def test_copies_of_one_result_have_no_vote(tmp_path: Path, references: References) -> None:
    """Nor is one ok that a reference in doubt contradicts: positions alone leave nothing else to check."""
    columns = Writer().columns(PRESS, instants(PRESS, 20), ["P5.y"])
    wrong = Writer().file(tmp_path, columns | {"P5.y": columns["P5.y"] + 0.002}, name="wrong")
    results = [read_result(PRESS, f"{name}={wrong}") for name in ("one", "two")]
    reference = references("toggle_press")
    alone = replace(reference, floor=replace(reference.floor, by_channel={}))
    found = judgement(alone, [], Sampling(24), lambda _: ((), ""), lambda _: None, results=results)
    assert {name: status for name, (status, _) in found.verdicts.items()} == {"one": "inaccurate", "two": "inaccurate"}
    assert not found.reference.floor.doubt
    doubted = replace(reference, floor=replace(reference.floor, doubt="suspect the core"))
    run = assess_result(doubted, results[0]).run
    assert (run.status.name, run.reason.partition("; the reference")[2]) == ("inaccurate", " itself is in doubt")


def test_what_ok_does_not_cover_is_reported(tmp_path: Path, references: References) -> None:
    """A stretch of the cycle, and what decimals hide beyond the promise."""
    times = np.array([0.1, 0.13, 0.2])
    names = ["P5.y", "P5.vy"]
    columns = Writer().columns(PRESS, times, names)
    found = read_result(PRESS, f"theirs={Writer().file(tmp_path, columns)}")
    assert found.notes[0] == "theirs has 3 rows, over 0.1 cycles of the drive, from crank angle 36.0000 deg on"
    alone = read_result(PRESS, f"one={Writer().file(tmp_path, Writer().columns(PRESS, times[:1], names))}")
    assert alone.notes[0].startswith("one has 1 row, over 0 cycles")
    assert not [*coarse(assess_result(references("toggle_press"), found))]
    (line,) = coarse(assessed(references, tmp_path, columns, time=".2f"))
    assert line.startswith("theirs: P5.vy may be off by 2.2e-03 unnoticed, by its decimals")
    columns = Writer().columns(PRESS, instants(PRESS, 20), names)
    (line,) = coarse(assessed(references, tmp_path, columns, **{"P5.y": ".2f"}))
    assert line == "theirs: P5.y is written too coarsely: its decimals are of more than the 1 % that they may excuse"


@sampled(2)
@pytest.mark.parametrize(
    ("rows", "turns", "word"),
    [(1, 0.0, "agrees in part"), (60, 0.9, "agrees in part"), (7, 6 / 7, "agrees in part"), (60, 59 / 60, "agrees")],
)
def test_a_part_of_the_cycle_confirms_no_channel(
    tmp_path: Path, references: References, rows: int, turns: float, word: str
) -> None:
    """Sixty rows over all but the last step are the whole cycle; seven are fewer than engines are asked for."""
    times = np.linspace(0.0, turns * PRESS.cycle, rows)
    file = Writer().file(tmp_path, Writer().columns(PRESS, times, channels(PRESS)))
    results, nothing = [read_result(PRESS, f"theirs={file}")], ((), "")
    judged = judgement(references(PRESS.name), [], Sampling(24), lambda _: nothing, lambda _: None, results=results)
    found = judged.agreement
    assert found.word == word
    assert "in every channel that it gives" in found.sentence
    assert ("gives P2.x over a whole cycle, among others." in found.sentence) == (word != "agrees")


@pytest.mark.parametrize("name", ["driven_toggle", "swinging_law"])
@pytest.mark.parametrize("late", [0.5, -0.1])
def test_rows_outside_the_run_of_a_drive_are_refused(name: str, late: float, tmp_path: Path) -> None:
    """There the drive asks for nothing: a spline goes on as it likes, and a body beyond its end may not assemble."""
    scene = scene_files.load(name)
    assert not scene.periodic
    times = np.linspace(0.0, scene.cycle, 20)
    columns = {**Writer().columns(scene, times, [f"{scene.output}.x"]), "time": times + late * scene.cycle}
    with pytest.raises(InputError, match="while the drive runs"):
        read_result(scene, f"theirs={Writer().file(tmp_path, columns)}")
    rounded = Writer(decimals=".3f").file(tmp_path, {**columns, "time": times})
    assert read_result(scene, f"theirs={rounded}").request.count == 20


def test_channels_that_a_result_has_none_of(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It is refused: of nothing all is ok."""
    scene = scenes.load("four_bar")
    file = Writer().file(tmp_path, Writer().columns(scene, instants(scene, 9), ["T.x"]))
    assert main(["four_bar", "--engines", "analytic", f"--result=theirs={file}", "--channels", "T.y"]) == 2
    assert capsys.readouterr().err == "arguments: --channels: expected one that theirs gives: T.x\n"


def test_a_channel_with_two_columns(tmp_path: Path) -> None:
    file = tmp_path / "theirs.csv"
    file.write_text("time [s],P5.y [mm],P5.y [m]\n0,1,2\n0.1,1,2\n")
    with pytest.raises(scenes.InputError, match=r"a column for each channel, found two of P5\.y"):
        read_results([PRESS], [f"theirs={file}"], None)


def test_places_in_another_unit_are_no_other_assembly(tmp_path: Path, references: References) -> None:
    """Nothing shows that its pins are closed."""
    columns = Writer().columns(PRESS, instants(PRESS, 20), ["P5.y"])
    found = assessed(references, tmp_path, columns | {"P5.y": 1e3 * columns["P5.y"]})
    assert found.run.status.name == "inaccurate"
    assert "of its travel away" in found.run.reason


@pytest.mark.parametrize("first", [0.1, 0.3, 0.8])
def test_a_press_force_acts_by_the_whole_stroke(first: float, tmp_path: Path, references: References) -> None:
    """Rows of a part of the cycle do not show where the closing stroke ends."""
    scene = scenes.load("crank_press")
    times = scene.cycle * (first + np.array([0.0, 0.01, 0.02]))
    file = Writer().file(tmp_path, Writer().columns(scene, times, channels(scene)))
    found = assess_result(references(scene.name), read_result(scene, f"theirs={file}"))
    assert found.run.status.name == "ok", found.run.reason
