"""Names of files that do not decode, and other odd ones: a report, or one line."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from compare.report.pages.index import index_page
from compare.run import main
from tests import scene_files
from tests.comparisons import SLOW

ROOT = Path(__file__).parents[2]
ASKED = ["--engines", "analytic", "--samples", "12"]
UNDECODED = os.fsdecode(b"of \xff bytes")


@pytest.mark.usefixtures("few_settings")
def test_a_scene_and_a_folder_whose_names_do_not_decode(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / f"{UNDECODED}.toml"
    scene.write_bytes(scene_files.path("crank").read_bytes())
    out = tmp_path / UNDECODED
    assert main([str(scene), *ASKED, "--out", str(out)]) == 0
    assert capfd.readouterr().err == ""
    known = json.loads((out / "crank" / "summary.json").read_text(encoding="utf-8"))
    assert os.fsencode(known["scene"]["file"]).endswith(b"of \xff bytes.toml")
    (out / "crank").rename(out / UNDECODED)
    assert "of%20%FF%20bytes/report.html" in index_page(out)


@SLOW
def test_a_name_under_a_locale_that_lacks_its_letters(tmp_path: Path) -> None:
    scene = tmp_path / "größe.toml"
    scene.write_bytes(scene_files.path("crank").read_bytes())
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "compare.run", str(scene), *ASKED, "--out", str(tmp_path / "über")]
    done = subprocess.run(command, env=os.environ | plain, capture_output=True, check=False, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, b"")
    assert (tmp_path / "über" / "crank" / "report.html").is_file()


@pytest.mark.parametrize("value", ["2020-01-01", "2020-01-01T10:00:00Z", "10:00:00"])
def test_a_date_is_no_value(value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "dated.toml"
    text = scene_files.path("crank").read_text(encoding="utf-8")
    scene.write_text(f"{text}\n[results.other]\nmade_by = [{value}]\n", encoding="utf-8")
    assert main([str(scene), *ASKED, "--out", str(tmp_path / "out")]) == 2
    line = capsys.readouterr().err
    assert "results.other.made_by: expected a number or a text" in line
    assert line.count("\n") == 1
