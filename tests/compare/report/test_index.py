"""The page over all reports of a folder: a row each, whoever wrote what lies there."""

import json
import re
from base64 import b64decode
from pathlib import Path
from typing import Any, NoReturn
from xml.etree import ElementTree

import pytest

from compare.report.output import files
from compare.report.output.placing import replace_file
from compare.report.pages.index import index_page
from compare.report.tables.first_screen import parted
from compare.run import main
from tests import scene_files
from tests.comparisons import Studies, only_few_settings

ASKED = ["--engines", "analytic", "--samples", "24"]
SHORT = {"bodies.rocker.lengths.O-P3": 30, "name": "short", "title": "<b>short</b>"}


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one report that was there before, one of a scene that cannot run, and others' files."""
    folder = tmp_path_factory.mktemp("reports")
    with only_few_settings():
        assert main(["four_bar", *ASKED, "--out", str(folder)]) == 0
        broken = {"empty": "", "cut": '{"scene": {"na', "list": "[]", "deep": "[" * 100_000, "other": '{"scene": 1}'}
        for name, text in broken.items():
            (folder / name).mkdir()
            (folder / name / "summary.json").write_text(text, encoding="utf-8")
        (folder / "folder" / "summary.json").mkdir(parents=True)
        (folder / ".four_bar-01234567").mkdir()
        (folder / ".four_bar-01234567" / "summary.json").write_text("{", encoding="utf-8")
        short = scene_files.write(folder, "toggle_press", SHORT)
        assert main([str(short), *ASKED, "--out", str(folder)]) == 2
    return folder


def edited(folder: Path, name: str, **changes: Any) -> Path:
    """Another report in a folder, that of the four-bar with changes in its summary."""
    known = json.loads((folder / "four_bar" / "summary.json").read_text(encoding="utf-8"))
    (folder / name).mkdir(exist_ok=True)
    (folder / name / "summary.json").write_text(json.dumps(known | changes), encoding="utf-8")
    return folder


def test_a_row_each(reports: Path) -> None:
    page = (reports / "index.html").read_text(encoding="utf-8")
    assert re.findall(r'<a href="([^#"]+)">([^<]+)</a>', page) == [
        ("four_bar/report.html", "Hoecken&#39;s straight-line linkage"),
        ("short/report.html", "&lt;b&gt;short&lt;/b&gt;"),
    ]
    assert re.findall(r"<strong>. ([^<]+)</strong>", page) == ["Agrees in part", "Not solved"]
    assert "<dt>Stroke</dt> <dd>470.4 mm</dd>" in page
    assert "<dt>Largest force at C</dt>" in page
    left_out = re.findall(r"Left out: (.+)/summary.json: (.+)</p>", page)
    assert [name for name, _ in left_out] == ["cut", "deep", "empty", "folder", "list", "other"]
    assert all(len(why) < 400 for _, why in left_out)
    assert len(page) < 60_000
    pictures = [b64decode(data) for data in re.findall('base64,([^"]+)', page)]
    assert [ElementTree.fromstring(each).tag.rpartition("}")[2] for each in pictures] == ["svg", "svg"]


def test_the_numbers_are_those_of_the_first_screen(studies: Studies) -> None:
    """All but those of single joints; of these the largest pin force, before the drive's."""
    peaks = studies("toggle_press").peaks
    whole, joints = parted(peaks)
    names = [peak.name for peak in whole]
    assert names.index("largest force at P1") == names.index("peak driving torque") - 1
    assert sum("force at" in name for name in names) == 1
    left = [peak for peak in peaks if peak not in (*whole, *joints)]
    assert all(peak.value == 0 for peak in left)


@pytest.mark.parametrize(
    ("known", "expected"),
    [
        ({}, []),
        ({"since_last_run": []}, ["Nothing changed since the last run."]),
        ({"since_last_run": [{"text": "a < b", "worse": False}]}, ["Changed since the last run:", "<li>a &lt; b</li>"]),
        (
            {"since_last_run": [], "since_baseline": [{"text": "c", "worse": True}]},
            ["Changed since the baseline:", '<li class="failed">c</li>'],
        ),
        ({"complete": False}, ["other_one, stopped by the user"]),
        ({"picture": "<script>1</script>"}, ["base64,PHNjcmlwdD4x"]),
        ({"verdict": {"word": "fine", "sentence": ""}}, ["Left out: other_one/summary.json: &#39;fine&#39;"]),
        ({"scene": {}}, ["Left out: other_one/summary.json: &#39;title&#39;"]),
    ],
)
def test_what_a_row_has(known: dict[str, Any], expected: list[str], reports: Path, tmp_path: Path) -> None:
    (tmp_path / "four_bar").symlink_to(reports / "four_bar")
    page = index_page(edited(tmp_path, "other_one", **known))
    _, _, row = page.partition("other_one")
    for text in expected:
        assert text in f"other_one{row}" or text in page
    assert "<script>1" not in page
    if not known:
        assert "hanged since" not in page
    assert 'href="other_one/report.html"' not in page, "there is none"


def test_since_the_last_run(tmp_path: Path) -> None:
    with only_few_settings():
        for length in (100, 101):
            file = scene_files.write(tmp_path, "four_bar", {"bodies.crank.lengths.O-A": length})
            assert main([str(file), *ASKED, "--out", str(tmp_path)]) == 0
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "<li>scene.bodies.crank.lengths.A-O 101 mm, was 100 mm</li>" in page
    assert "peaks: " in page


def test_a_page_of_another_program_stays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    index = tmp_path / "index.html"
    index.write_text("<title>Mine</title>", encoding="utf-8")
    with only_few_settings():
        assert main(["four_bar", *ASKED, "--out", str(tmp_path)]) == 0
    assert index.read_text(encoding="utf-8") == "<title>Mine</title>"
    assert f"index: {index} is left as it is: it is not of this program" in capsys.readouterr().out
    index.unlink()
    index.mkdir()
    assert "is left as it is" in files.write_index(tmp_path) or "cannot be written" in files.write_index(tmp_path)


def test_a_page_appears_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And what a killed run left aside goes with the next."""
    (tmp_path / ".index.html-0123abcd").write_text("half", encoding="utf-8")
    file = tmp_path / "index.html"
    replace_file(file, lambda: "old")

    def full(path: Path, text: str, **_: object) -> NoReturn:
        path.write_bytes(text[:2].encode())
        raise OSError("no space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    with pytest.raises(OSError, match="no space"):
        replace_file(file, lambda: "new")
    assert {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()} == {"index.html": "old"}
