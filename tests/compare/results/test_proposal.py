"""A proposed mapping: right where it is sure, confirmed by the judgement, never used unasked."""

import re
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

import analytic
from compare.judge.foreign import assess_result
from compare.results.proposal import proposed
from compare.results.result import read_result
from compare.run import main
from scenes import Scene, Status
from scenes.channels import named
from scenes.scene import ConstantSpeed
from tests import scene_files
from tests.comparisons import SLOW, References, sampled
from tests.foreign import ELSEWHERE, Writer, channels, instants, write

SCENE = "offset_slider_crank"
LONGER = ("quick_return", "toggle_press", "servo_press")
Moved = tuple[str, float, float, float]


@pytest.mark.parametrize(
    "writer",
    [Writer(decimals=".8g"), pytest.param(replace(ELSEWHERE, decimals=".8g"), marks=SLOW)],
    ids=["SI", "elsewhere"],
)
def test_it_is_right_where_it_is_sure(writer: Writer, tmp_path: Path, references: References) -> None:
    """Columns in no order, late by a part of a cycle, an angle that is counted modulo a turn and jumps by one."""
    scene, reference = scene_files.load(SCENE), references(SCENE)
    names = [c for c in channels(scene) if c not in ("crank.angle", "crank.omega", "crank.alpha")]
    columns = writer.columns(scene, instants(scene, 70), names)
    turn, middle = 2 * np.pi / writer.angle, columns["rod.angle"].mean()
    columns["rod.angle"] = (columns["rod.angle"] - middle) % turn + middle
    shuffled = np.random.default_rng(3).permutation([*columns]).tolist()
    texts = writer.texts({name: columns[name] for name in shuffled} | {"time": columns["time"] + 7.3})
    file = write(tmp_path, texts, "")
    by_column = {f"c{k}": name for k, name in enumerate(texts)}
    lines = proposed(scene, f"theirs={file}").splitlines()
    sure = {line.split('"')[1]: line for line in lines if "# sure" in line}
    assert len(sure) >= 10
    assert "rod.angle" in sure
    assert all(
        by_column[column] == channel for channel, line in sure.items() for column in re.findall(r'"(c\d+)"', line)
    )
    head = [line for line in lines if not line.startswith('"') or line.startswith('"time"')]
    file.with_suffix(".toml").write_text("\n".join([*head, *sure.values()]))
    found = assess_result(reference, read_result(scene, f"theirs={file}"))
    assert found.run.status is Status.ok, found.run.reason
    assert max(found.worst().values()) < 1e-5


def test_the_command_prints_it_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    scene = scene_files.load(SCENE)
    file = Writer().file(tmp_path, Writer().columns(scene, instants(scene, 40), ["T.x", "A.vy"]))
    file.with_suffix(".toml").unlink()
    assert main(["map", str(scene_files.path(SCENE)), f"theirs={file}"]) == 0
    printed = capsys.readouterr().out
    assert '"A.vy" = "c2"  # sure' in printed
    assert [path.name for path in tmp_path.iterdir()] == ["theirs.csv"]
    file.write_text("a,b\n" + "2,1\n1,2\n" * 5)
    assert main(["map", str(scene_files.path(SCENE)), f"theirs={file}"]) == 2
    assert "expected a column that rises as the time does" in capsys.readouterr().err


@sampled(1)
@pytest.mark.parametrize("name", ["four_bar", "driven_toggle"])
def test_a_log_that_starts_late_is_in_no_other_frame(name: str, tmp_path: Path) -> None:
    """Columns in another order are no frame; and where the drive runs once, it runs within that."""
    scene = scene_files.load(name)
    times, late = np.linspace(0, scene.cycle, 50), 0.4 * scene.cycle
    columns = Writer().columns(scene, times, [f"{scene.output}.{axis}" for axis in "yx"]) | {"time": times + late}
    lines = proposed(scene, f"theirs={Writer().file(tmp_path, columns)}").splitlines()
    assert not [line for line in lines if line.startswith("frame")]
    assert f'"{scene.output}.x" = "c2"  # sure' in "\n".join(lines)
    zero = re.search(r'"time" = { column = "c0", zero = (.*) }', "\n".join(lines))
    assert zero
    assert float(zero[1]) == pytest.approx(late, rel=1e-6)


MOVED = [  # what the rows are by, and by how much: the crank's column, rad, a lag, degrees of the crank, the frame, rad
    *(("crank", zero, 0.0, 0.0) for zero in (0.01, 0.1, 1.0, pi / 2)),
    *(("both", zero, 0.0, 0.0) for zero in (0.01, 1.0)),
    *(("time", 0.0, lag, 0.0) for lag in (0.5, 2.0, 5.0)),
    *(("time", 0.0, 0.0, turn) for turn in (0.01, 0.05, 1.0)),
    *(("both", 1.0, 3.0, 0.05), ("crank", 0.1, 0.0, 0.05), ("time", 0.0, 2.0, 0.05)),
]
CLOSE_TO_TRUE = 5e-3  # of a channel's, or a vector's, largest value: more than what a proposal rounds to nothing leaves


def _proposal(scene: Scene, names: list[str], moved: Moved, folder: Path) -> tuple[int, list[str]]:
    """Return how many lines are sure, and the channels that these lines and the head read from the table wrongly."""
    by, zero, lag, turn = moved
    times = instants(scene, 60)
    writer = Writer(turn=turn, decimals=".10g")
    own = writer.columns(scene, times, names)
    columns = {"time": own.pop("time") + lag / 360 * scene.cycle} if by != "crank" else {}
    columns |= {"crank_angle": scene.drive.law.at(times).position + zero} if by != "time" else {}
    file = writer.file(folder, columns | own)
    lines = proposed(scene, f"theirs={file}").splitlines()
    sure = [line.split('"')[1] for line in lines if "# sure" in line]
    if not sure:
        return 0, []
    file.with_suffix(".toml").write_text("\n".join(lines))
    read = read_result(scene, f"theirs={file}").run.motion
    assert read is not None
    true = analytic.solve(scene, scene.drive.law.at(times).position, times)
    off = {c: read[c] - true[c] for c in sure}
    off |= {c: np.angle(np.exp(1j * off[c])) for c in sure if named(c).name == "angle"}
    sizes = {c: max(np.abs(true[f"{c[:-1]}{q}"]).max() for q in ("xy" if c[-1] in "xy" else c[-1])) for c in sure}
    wrong = [c for c in sure if not np.abs(off[c]).max() <= CLOSE_TO_TRUE * sizes[c]]
    cycles = (read["time"] - times) / scene.cycle
    return len(sure), wrong + ["time"] * bool(not np.abs(cycles - np.round(cycles)).max() <= CLOSE_TO_TRUE / (2 * pi))


@SLOW
@pytest.mark.parametrize(
    ("name", "every"),
    [
        ("four_bar", 5),
        *(pytest.param(name, 4, marks=SLOW) for name in LONGER),
        *(pytest.param(name, 1, marks=pytest.mark.study) for name in LONGER),
    ],
)
def test_it_is_never_sure_and_wrong(name: str, every: int, tmp_path: Path) -> None:
    """Cranks that are moved, lags and turned frames, alone and together, of the output and of all places."""
    scene = scene_files.load(name)
    places = [c for c in channels(scene) if named(c).name in ("x", "y", "angle")]
    output = [c for c in places if c.startswith(f"{scene.output}.")]
    for names in (output, places):
        for moved in MOVED[::every] if isinstance(scene.drive.law, ConstantSpeed) else MOVED[6::every]:
            count, wrong = _proposal(scene, names, moved, tmp_path)
            assert not wrong, (moved, wrong)
            assert count or names == output, moved


@sampled(1)
@pytest.mark.parametrize("moved", [("crank", 1.0, 0.0, 0.0), ("time", 0.0, 90.0, 0.0), ("time", 0.0, 0.0, 0.05)])
def test_a_point_on_the_crank_shows_neither_lag_nor_frame(moved: Moved, tmp_path: Path) -> None:
    names = ["A.x", "A.y", "crank.angle"]
    assert _proposal(scene_files.load("four_bar"), names, moved, tmp_path) == (0, [])
