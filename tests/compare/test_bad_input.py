"""The command line: bad arguments and bad scenes end in one line and leave nothing behind."""

import re
from pathlib import Path

import pytest

from compare.cli.arguments import sampling
from compare.run import main
from scenes import Scene
from tests import scene_files
from tests.comparisons import sampled


def refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Run what must exit 2 with one line, and return the line."""
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    return err


@sampled(22)
@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--engines", "exudin"], ["exudin", "did you mean 'exudyn'"]),
        (["--engines", ""], ["--engines", "analytic"]),
        (["--samples", "ten"], ["--samples", "whole number", "'ten'"]),
        (["--samples", "-5"], ["--samples"]),
        (["--turns", "0"], ["--turns", "from 1"]),
        (["--turns", "9" * 5000], ["--turns", "from 1 to 10000", "99…'"]),
        (["--samples", "100000", "--turns", "10000"], ["25000000 values", "1000000001 samples of 53 channels"]),
        (["--samples", "36000", "--turns", "15"], ["25000000 values at most", "--channels"]),
        (["new", ""], ["expected", "new NAME"]),
        (["two\nlines\x1b"], [r"two lines\x1b: no such scene"]),
        (["x" * 5000], ["xxx…: cannot be read (File name too long)"]),
        (["a\0b"], [r"a\x00b: cannot be read (embedded null byte)"]),
        (["--nonsense"], ["no option '--nonsense'"]),
        (["four_bar", "--chek"], ["no option '--chek'; did you mean '--check'?"]),
        (["four_bar", "--sample=7"], ["--sample", "whole number from 8"]),
        (["toggle_pres"], ["toggle_pres", "did you mean 'toggle_press'"]),
        (["no/such/scene.toml"], ["no/such/scene.toml", "no such"]),
        (["toggle_press", "toggle_press"], ["two scenes"]),
        (["double_toggle_clamp", "--turns", "2"], ["--turns 2", "double_toggle_clamp", "once from start to end"]),
        (["--vary", "drive.speed"], ["--vary drive.speed", "PATH=FROM:TO:COUNT"]),
        (["--vary", "drive.speed=1:2"], ["PATH=FROM:TO:COUNT"]),
        (["--vary", "drive.speed=1:2:three"], ["PATH=FROM:TO:COUNT"]),
        (["--vary", "drive.speed=1:2:3:4"], ["PATH=FROM:TO:COUNT"]),
        (["--vary", "drive.speed=1:1:3"], ["two different values"]),
        (["--vary", "drive.speed=1:inf:3"], ["two different values"]),
        (["--vary", "drive.speed=nan:1:3"], ["two different values"]),
        (["--vary", "drive.speed=-1e308:1e308:3"], ["two different values"]),
        (["--vary", ""], ["PATH=FROM:TO:COUNT"]),
        (["--vary", "=1:2:3"], ["toggle_press: : the file has no ''"]),
        (["--vary", f"{'x' * 5000}=1:2:three"], ["xxx…: expected PATH=FROM:TO:COUNT"]),
        (["--vary", "drive.speed=1:2:1000000000"], ["COUNT from 2 to 200, found 1000000000"]),
        (["--vary", f"drive.speed=1:2:{'9' * 5000}"], ["PATH=FROM:TO:COUNT"]),
        (["--vary", "drive.speed=1:2:1"], ["COUNT from 2 to 200", "1"]),
        (["--vary", "drive.speed=1:2:15", "--vary", "drive.start=0:1:14"], ["200 members at most", "210"]),
        (["--vary", "drive.sped=1:2:3"], ["toggle_press: drive.sped", "did you mean 'speed'"]),
        (["--vary", "drive.body=1:2:3"], ["drive.body", "the path of a number"]),
        (["--vary", "drive.speed=1:2:3", "--vary", "drive.speed=1:2:3"], ["drive.speed", "each number once"]),
        (["toggle_press", "four_bar", "--vary", "loads.0.force.1=1:2:3"], ["four_bar: loads.0.force.1"]),
        (["--vary", "drive.speed=1:2:3", "--full"], ["--full", "--vary"]),
        (["--vary", "drive.speed=1:2:3", "--channels", "P5.y"], ["--channels", "--vary"]),
        (["--vary", "drive.speed=1:2:3", "--accuracy", "exact"], ["--accuracy", "--vary"]),
        (["--vary", "drive.speed=1:2:3", "--baseline", "old.json"], ["--baseline: expected it without --vary"]),
        (["--format", "github"], ["arguments: --format: expected it with --check"]),
        (["--workers", "2"], ["--workers", "--vary"]),
        (["--vary", "drive.speed=1:2:3", "--workers", "0"], ["--workers", "1 to 256"]),
        (["--vary", "drive.speed=1:2:3", "--workers", "2", "--scheduler", "a:1"], ["--scheduler", "--workers"]),
        (["--vary", "drive.speed=1:2:3", "--scheduler", "x://a"], ["--scheduler x://a", "none answers"]),
        (["--accuracy", "fasst"], ["--accuracy", "found 'fasst'; did you mean 'fast'?"]),
        (["--channels", "P5.y,P5.z"], ["--channels", "toggle_press", "P5.z", "did you mean 'P5.y'"]),
        (["--channels", "P5.*,slidr.*"], ["toggle_press has no channel 'slidr.*'; one of O.fx"]),
        (["--channels", "time"], ["toggle_press has no channel 'time'; one of O.fx"]),
        (["toggle_press", "four_bar", "--channels", "P5.y"], ["--channels", "four_bar", "P5.y"]),
        (["four_bar", "--monte-carlo", "10"], ["four_bar: variations: missing; --monte-carlo draws machines from"]),
        (["--monte-carlo", "1"], ["--monte-carlo: expected a whole number from 2 to 1000000, found '1'"]),
        (["--monte-carlo", "ten"], ["--monte-carlo: expected a whole number"]),
        (["--seed", "3"], ["--seed: expected it with --monte-carlo"]),
        (["--monte-carlo", "10", "--vary", "drive.speed=1:2:3"], ["--vary: not allowed with argument --monte-carlo"]),
        (["--monte-carlo", "10", "--full"], ["--full: expected it without --monte-carlo"]),
        (["--result", "theirs"], ["expected NAME=FILE.csv"]),
        (["--result", "analytic=a.csv"], ["'analytic' is the name of an engine"]),
        (["--result", "../x=a.csv"], ["expected NAME=FILE.csv"]),
        (["--result", "theirs=missing.csv"], ["missing.csv: no such file"]),
        (["--result", "theirs=."], ["expected a text file, found a folder"]),
        (["--result", f"theirs={'x' * 5000}"], ["File name too long"]),
    ],
)
def test_bad_arguments(
    arguments: list[str], expected: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused([*arguments, "--out", str(tmp_path / "out")], capsys)
    for part in expected:
        assert part in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("samples", "turns"), [(36_000, 1), (360, 1000)])
def test_a_large_request_is_no_bad_input(samples: int, turns: int, toggle_press: Scene) -> None:
    assert sampling(toggle_press, samples, turns).count == samples * turns + 1


def test_a_linkage_that_cannot_close(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The rocker is too short to reach the toggle's pin all the way round."""
    file = scene_files.write(tmp_path, "toggle_press", {"bodies.rocker.lengths.O-P3": 30})
    assert main([str(file), "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    words = "toggle_press.toml: bodies: cannot_assemble: .*crank angle.*turns only.*rocker and toggle in line at P3"
    assert re.search(words, line)


def test_a_folder_that_cannot_be_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    for out in (tmp_path / "file", tmp_path / "file" / "below"):
        line = refused(["--engines", "analytic", "--out", str(out)], capsys)
        assert "--out" in line
        assert "is a file" in line


def test_a_write_that_fails_leaves_the_old_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "toggle_press"
    target.mkdir()
    (target / "report.html").write_text("the old one", encoding="utf-8")

    def disk_full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("compare.report.output.files.page", disk_full)
    assert main(["--engines", "analytic", "--out", str(tmp_path)]) == 2
    assert (target / "report.html").read_text(encoding="utf-8") == "the old one"
    assert [path.name for path in target.iterdir()] == ["report.html"]
    assert [path.name for path in tmp_path.iterdir()] == ["toggle_press"]
