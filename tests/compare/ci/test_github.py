"""Annotations and step summaries, as GitHub reads them."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from compare.ci import github
from compare.ci.github import line_of
from compare.judge.measure import Miss
from compare.run import main
from scenes import Failure, InputError, Status, load
from tests import scene_files
from tests.comparisons import Plug

SCENE = """format = 1
"tolerances".'pymunk' = { position = 1e-3 }
[tolerances]
x.y = 1
[ tolerances . exudyn ]  # a comment
position = 1e-3
"reaction" = 1e-3
[[loads]]
position = 2
"""


@pytest.fixture(autouse=True)
def _workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GITHUB_WORKSPACE", raising=False)


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("format", 1),
        ("tolerances.pymunk.position", 2),
        ("tolerances.multiprecision.position", 3),
        ("tolerances.exudyn", 5),
        ("tolerances.exudyn.position", 6),
        ("tolerances.exudyn.reaction", 7),
        ("tolerances.exudyn.velocity", 5),
        ("loads.position", 9),
        ("bodies", None),
    ],
)
def test_the_line_of_a_path(path: str, line: int | None, tmp_path: Path) -> None:
    (file := tmp_path / "scene.toml").write_bytes(b"\xef\xbb\xbf" + SCENE.replace("\n", "\r\n").encode())
    assert line_of(file, path.split(".")) == line
    assert line_of(tmp_path / "missing.toml", path.split(".")) is None


def test_an_annotation_is_escaped(tmp_path: Path) -> None:
    """By the rules of the runner: `%`, CR and LF everywhere, `:` and `,` in properties."""
    (folder := tmp_path / "a,b:c%").mkdir()
    scene = replace(load("four_bar"), file=str(folder / "scene.toml"))
    (folder / "scene.toml").write_text("[tolerances.exudyn]\nposition = 1\n", encoding="utf-8")
    miss = Miss("exudyn", "position", "off by 50 %: a, b\r\n::error::c")
    assert github.annotation(scene, "press, x = 1", miss, "exudyn: rod's mass") == (
        "::error file=a%2Cb%3Ac%25/scene.toml,line=2,title=press%2C x = 1 exudyn position::"
        "off by 50 %25: a, b%0D%0A::error::c; likely cause: exudyn: rod's mass"
    )


def test_an_annotation_of_what_has_no_place() -> None:
    shipped = load("four_bar")
    assert github.annotation(shipped, "four_bar", Miss("", "", "a canary")) == "::error title=four_bar::a canary"
    elsewhere = replace(shipped, file="/elsewhere/scene.toml")
    expected = "::error file=/elsewhere/scene.toml,title=four_bar exudyn::crashed"
    assert github.annotation(elsewhere, "four_bar", Miss("exudyn", "", "crashed")) == expected


@pytest.mark.usefixtures("few_settings")
def test_what_a_check_misses_is_annotated_and_summed_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], plug: Plug
) -> None:
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", "summary.md")
    plug(Failure(Status.diverged, "|x| > 1\n<b>"))
    changes = {"tolerances": {"analytic": {"position": 1e-99, "velocity": 1.0}}}
    file = str(scene_files.write(tmp_path, "slider_crank", changes).relative_to(tmp_path))
    command = [file, "--engines", "analytic,stub", "--samples", "8", "--check", "--out", "out"]
    assert main([*command, "--format", "github"]) == 1
    printed = capsys.readouterr().out.splitlines()
    missed, errors = printed[-5:-3], printed[-3:-1]
    assert missed[0].startswith("slider_crank  missed: analytic position: ")
    assert missed[1] == "slider_crank  missed: stub: diverged: |x| > 1 <b>"
    place = f"::error file={file},line={line_of(tmp_path / file, ['tolerances'])},title=slider_crank"
    assert errors[0].startswith(f"{place} analytic position::analytic position: ")
    assert errors[1] == f"{place} stub::stub: diverged: |x| > 1 <b>"
    summary = Path("summary.md").read_text(encoding="utf-8")
    assert summary.startswith("\n### slider\\_crank: disagrees\n\n")
    rows = [text.split(" | ") for text in summary.splitlines() if text.startswith("| ")]
    assert {len(each) for each in rows[:1] + rows[2:]} == {7}, "a cell is cut in two"
    assert re.match(r"\| analytic \| \w+ \| \*\*[^|]* of 1e-99\*\* \| [^|*]* of 1e\+00 \|", " | ".join(rows[2]))
    assert "- missed: stub: diverged: \\|x\\| &gt; 1 &lt;b&gt;" in summary


BAD = {
    'format = 1\nname = "bad"\nmas = 1\n': "bad.toml: mas: unknown key",
    "format = = 1": "bad.toml: not valid TOML: Invalid value (at line 1, column 10)",
    "": "bad.toml: no such scene or file",
}


@pytest.mark.parametrize("text", BAD)
def test_a_file_that_does_not_load_is_annotated(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    if text:
        Path("bad.toml").write_text(text, encoding="utf-8")
    assert main(["bad.toml", "--check", "--format", "github"]) == 2
    out, err = capsys.readouterr()
    assert err.startswith(BAD[text])
    assert out == f"::error file=bad.toml,title=bad.toml::{err}"
    assert main(["bad.toml", "--check"]) == 2
    assert capsys.readouterr().out == ""


def test_what_the_reference_cannot_solve_is_annotated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("GITHUB_WORKSPACE", str(tmp_path))
    file = scene_files.write(tmp_path, "slider_crank", {"bodies.rod.lengths.A-B": 0.1})
    assert main([str(file), "--check", "--format", "github", "--out", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert out.startswith(f"::error file=slider_crank.toml,title={file}::{err}")


def test_a_summary_that_cannot_be_written_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path))
    with pytest.raises(InputError, match=r"GITHUB_STEP_SUMMARY: .*: cannot be written \(Is a directory\)"):
        github.report(load("four_bar"), {}, {})


@pytest.mark.slow
@pytest.mark.usefixtures("few_settings")
def test_members_of_a_family_are_annotated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "summary.md"))
    file = str(scene_files.write(tmp_path, "slider_crank", {"tolerances": {"analytic": {"position": 1e-99}}}))
    command = [file, "--engines", "analytic", "--samples", "8", "--check", "--format", "github", "--out", str(tmp_path)]
    assert main([*command, "--vary", "bodies.rod.lengths.A-B=3:4:2"]) == 1
    assert len([text for text in capsys.readouterr().out.splitlines() if text.startswith("::error file=")]) == 2
    summary = (tmp_path / "summary.md").read_text(encoding="utf-8")
    assert summary.count("\n### ") == summary.count("\n- missed: ") == 2
    assert main([*command, "--vary", "bodies.rod.lengths.A-B=0.1:0.2:2"]) == 1
    assert "every tolerance, since no member runs" in capsys.readouterr().out.splitlines()[-1]
