"""`--assemblies`: the page, its file, and what it cannot be asked with."""

import json
from pathlib import Path

import pytest

from compare.run import main
from tests.pages import without_scripts


def test_all_assemblies_are_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["four_bar", "class_iii", "--assemblies", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "four_bar  2 assemblies at crank angle" in said
    assert "the sketch picks the nearest to it" in said
    for name in ("four_bar", "class_iii"):
        assert sorted(path.name for path in (tmp_path / name).iterdir()) == ["assemblies.html", "assemblies.json"]
        known = json.loads((tmp_path / name / "assemblies.json").read_text(encoding="utf-8"))
        assert known["complete"]
        assert [one["meant"] for one in known["assemblies"]] == [True, False]
        page = without_scripts((tmp_path / name / "assemblies.html").read_text(encoding="utf-8"))
        assert page.count("<svg") == 2
        assert page.count("which the sketch picks") == 1


@pytest.mark.parametrize("other", [["--vary", "bodies.rocker.lengths.C-B=240:260:2"], ["--monte-carlo", "10"]])
def test_one_thing_at_a_time(other: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["four_bar", "--assemblies", *other]) == 2
    assert "not allowed with argument --assemblies" in capsys.readouterr().err
