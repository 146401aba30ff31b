"""`--assemblies`: the page, its file, and what it cannot be asked with."""

import json
import re
from pathlib import Path

import pytest

from compare.run import main
from tests import scene_files
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


def test_a_guide_is_drawn_as_it_lies(tmp_path: Path) -> None:
    """At a single pose a slider has no way; its guide is vertical all the same, and that of a slot is the carrier's."""
    assert main(["crank_press", str(scene_files.path("driven_toggle")), "--assemblies", "--out", str(tmp_path)]) == 0
    for name, turn in (("crank_press", -90.0), ("driven_toggle", 0.0)):
        page = (tmp_path / name / "assemblies.html").read_text(encoding="utf-8")
        turns = re.findall(r'<g transform="translate\([^)]*\) rotate\(([^)]*)\)" data-guides=', page)
        assert len(turns) >= 1
        assert {*map(float, turns)} == {turn}, name


@pytest.mark.parametrize("other", [["--vary", "bodies.rocker.lengths.C-B=240:260:2"], ["--monte-carlo", "10"]])
def test_one_thing_at_a_time(other: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["four_bar", "--assemblies", *other]) == 2
    assert "not allowed with argument --assemblies" in capsys.readouterr().err
