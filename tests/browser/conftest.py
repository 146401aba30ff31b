"""A browser, and one report in it: of the toggle press by three engines."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from compare.report.output import files
from compare.study import Study
from scenes import load
from tests.comparisons import studied
from tests.pages import draw_all, silent

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
PATIENCE = 180e3  # ms, for what a page does: what is waited for comes, on a busy machine late


@pytest.fixture(scope="session")
def press_study() -> Study:
    return studied(load("toggle_press"), ["analytic", "exudyn", "pymunk"])


@pytest.fixture(scope="session")
def press_report(press_study: Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the report, with the page and every engine's motion."""
    return files.write(press_study, tmp_path_factory.mktemp("press"))


@pytest.fixture(scope="package")  # tests of other folders look for processes that were left
def browser() -> Iterator["Browser"]:
    """Return Debian's chromium, driven by playwright; tests with it are skipped where either is missing."""
    driver = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("no chromium is installed")
    with driver.sync_playwright() as started:
        found = started.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        found.on("context", lambda context: context.set_default_timeout(PATIENCE))
        yield found
        found.close()


@pytest.fixture(scope="module")
def report(browser: "Browser", press_report: Path) -> Iterator["Page"]:
    """Yield the report with all its figures drawn."""
    size = {"width": 1400, "height": 900}
    with silent(browser, press_report / "report.html", viewport=size, reduced_motion="reduce") as page:
        page.wait_for_selector("#linkage .player:not([hidden])")
        draw_all(page)
        yield page
