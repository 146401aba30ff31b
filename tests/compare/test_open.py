"""`--open`: the browser gets the address of a page that is complete."""

import webbrowser
from pathlib import Path

import pytest

from compare.measure.many.family import INVALID, Member
from compare.run import main
from tests import scene_files

ASKED = [str(scene_files.path("slider_crank")), "--engines", "analytic", "--samples", "8", "--open"]
NONE = [Member({"drive.speed": speed}, INVALID, "not run") for speed in (1.0, 2.0)]
NO_MEMBERS = "compare.measure.many.going_on.members", lambda *_: NONE
FAMILY = ["--vary", "drive.speed=1:2:2"]


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the file to which a browser writes the addresses it is given; it fails where their page is not there."""
    browser, log = tmp_path / "browser", tmp_path / "opened"
    browser.write_text(f'#!/bin/sh\necho "$1" >> {log}; test -s "${{1#file://}}"\n', encoding="utf-8")
    browser.chmod(0o755)
    monkeypatch.setenv("BROWSER", f"{browser} %s")
    monkeypatch.setattr(webbrowser, "_tryorder", None)  # what it found out before
    return log


@pytest.mark.usefixtures("few_settings")
def test_the_page_is_opened(tmp_path: Path, opened: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*ASKED, "--channels", "B.x", "--out", str(tmp_path / "out")]) == 0
    assert opened.read_text(encoding="utf-8") == f"file://{tmp_path}/out/slider_crank/report.html\n"
    assert "no browser" not in capsys.readouterr().out, "the page was not there"


def test_a_page_that_is_not_written_is_not_opened(
    tmp_path: Path, opened: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(*NO_MEMBERS)
    monkeypatch.setattr("compare.report.pages.many.family_page", full)
    assert main([*ASKED, *FAMILY, "--out", str(tmp_path / "out")]) == 2
    assert not opened.exists()


def test_no_browser(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(*NO_MEMBERS)
    monkeypatch.setattr(webbrowser, "open", lambda _: False)
    assert main([*ASKED, *FAMILY, "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out.endswith("family.html: no browser was found to open it\n")
