"""A proposed mapping: right where it is sure, confirmed by the judgement, never used unasked."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from compare.judge.foreign import assess_result
from compare.results.proposal import proposed
from compare.results.result import read_result
from compare.run import main
from scenes import Status
from tests import scene_files
from tests.comparisons import SLOW, References
from tests.foreign import ELSEWHERE, Writer, channels, instants, write

SCENE = "offset_slider_crank"


@pytest.mark.parametrize(
    "writer",
    [Writer(decimals=".8g"), pytest.param(replace(ELSEWHERE, decimals=".8g"), marks=SLOW)],
    ids=["SI", "elsewhere"],
)
def test_it_is_right_where_it_is_sure(writer: Writer, tmp_path: Path, references: References) -> None:
    """Columns in no order, late by a part of a cycle, an angle that is counted modulo a turn and jumps by one.

    Elsewhere they are in millimetres, degrees and another frame.
    """
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
    wrong = {channel: line for channel, line in sure.items() if by_column[_column(line)] != channel}
    assert not wrong
    head = [line for line in lines if not line.startswith('"') or line.startswith('"time"')]
    file.with_suffix(".toml").write_text("\n".join([*head, *sure.values()]))
    found = assess_result(reference, read_result(scene, f"theirs={file}"))
    assert found.run.status is Status.ok, found.run.reason
    assert max(found.worst().values()) < 1e-5


def _column(line: str) -> str:
    found = re.search(r'"(c\d+)"', line)
    assert found
    return found[1]


def test_the_command_prints_it_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    scene = scene_files.load(SCENE)
    file = write(tmp_path, Writer().texts(Writer().columns(scene, instants(scene, 40), ["T.x", "A.vy"])), "")
    file.with_suffix(".toml").unlink()
    assert main([str(scene_files.path(SCENE)), "--result-mapping", f"theirs={file}"]) == 0
    printed = capsys.readouterr().out
    assert '"A.vy" = "c2"  # sure' in printed
    assert [path.name for path in tmp_path.iterdir()] == ["theirs.csv"]
    file.write_text("a,b\n" + "2,1\n1,2\n" * 5)
    assert main([str(scene_files.path(SCENE)), "--result-mapping", f"theirs={file}"]) == 2
    assert "expected a column that rises as the time does" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["four_bar", "driven_toggle"])
def test_a_log_that_starts_late_is_in_no_other_frame(name: str, tmp_path: Path) -> None:
    """Columns in another order are no frame; and where the drive runs once, it runs within that."""
    scene = scene_files.load(name)
    times, late = np.linspace(0, scene.drive.cycle, 50), 0.4 * scene.drive.cycle
    columns = Writer().columns(scene, times, [f"{scene.output}.{axis}" for axis in "yx"]) | {"time": times + late}
    lines = proposed(scene, f"theirs={write(tmp_path, Writer().texts(columns), '')}").splitlines()
    assert not [line for line in lines if line.startswith("frame")]
    assert f'"{scene.output}.x" = "c2"  # sure' in "\n".join(lines)
    zero = re.search(r'"time" = { column = "c0", zero = (.*) }', "\n".join(lines))
    assert zero
    assert float(zero[1]) == pytest.approx(late, rel=1e-6)
