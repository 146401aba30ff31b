"""In a browser: a page beside an earlier run's, the page of a scene that cannot run, and the page over all reports."""

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd
import pytest

import analytic
from compare.run import main
from scenes import Sampling, load
from tests import scene_files
from tests.compare.test_against import LONGER, ran
from tests.compare.test_unsolved import SHORT
from tests.comparisons import only_few_settings
from tests.pages import silent

if TYPE_CHECKING:
    from playwright.sync_api import Browser

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The folders of an earlier run and of one against it, of other lengths and fewer samples."""
    place = tmp_path_factory.mktemp("against")
    old = ran(place / "old", {})
    return old, ran(place / "new", LONGER, "--against", str(place / "old"), engines="analytic,pymunk", samples=36)


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the report of a press that goes only part of a turn, and that of the four-bar."""
    folder = tmp_path_factory.mktemp("reports")
    short = scene_files.write(folder, "toggle_press", SHORT)
    with only_few_settings():
        assert main([str(short), "four_bar", "--engines", "analytic", "--samples", "24", "--out", str(folder)]) == 2
    return folder


@pytest.mark.parametrize("width", [390, 1400])
def test_the_ghost_in_a_browser(width: int, browser: "Browser", both: tuple[Path, Path]) -> None:
    """At half a turn it is where the earlier run had it, with the ground's points of then."""
    asked = {"viewport": {"width": width, "height": 900}, "reduced_motion": "reduce"}
    with silent(browser, both[1] / "report.html", **asked) as page:
        page.wait_for_selector("#linkage .player:not([hidden])")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        page.locator("#linkage [type=range]").evaluate("s => { s.value = 18; s.dispatchEvent(new Event('input')); }")
        paths = page.locator("#linkage .engine").evaluate_all(
            "all => all.map(p => [p.getAttribute('d'), p.style.strokeDasharray])"
        )
        assert [bool(drawn) for drawn, _ in paths] == [False, True], "the engine's difference is off"
        assert paths[1][1]
        corners = [complex(*map(float, at.split())) for at in paths[1][0].lstrip("M").replace("M", "L").split("L")]
        scene = load("four_bar")
        motion = analytic.solve(scene, Sampling(36).commanded(scene)[[18]])
        crank, rocker = ([corners[0], corners[1]], corners[-2:])
        scale = abs(crank[1] - crank[0]) / 0.1
        b = complex(motion["B.x"][0], motion["B.y"][0])
        assert abs(rocker[1] - rocker[0]) / scale == pytest.approx(0.25, rel=1e-3)
        assert (rocker[0] - crank[0]) / scale == pytest.approx(0.2, abs=1e-3)
        assert ((rocker[1] - crank[0]) / scale).conjugate() == pytest.approx(b, abs=1e-3)


def test_a_polar_diagram_has_the_run_before_as_it_was(browser: "Browser", both: tuple[Path, Path]) -> None:
    """Beside the engines, whose differences are magnified as without it; in a body's frame it is not drawn."""
    with silent(browser, both[1] / "report.html", viewport={"width": 1400, "height": 900}) as page:
        page.locator("#polar").scroll_into_view_if_needed()
        page.wait_for_selector("#polar .curve[d]")
        magnified = re.search(r"engines are ([\d\u202f]+) times as large", page.inner_text("#polar .caption"))
        assert magnified is not None
        assert float(magnified[1].replace("\u202f", "")) >= 1000
        curves = page.locator("#polar .curve").evaluate_all("all => all.map(p => p.getAttribute('d'))")
        now, then = (max(abs(float(tip.split()[0])) for tip in curves[n][1:].split("L")) for n in (0, -1))
        old, new = (pd.read_csv(folder / "motion.analytic.csv")["O.fx [N]"].abs().max() for folder in both)
        assert then / now == pytest.approx(old / new, rel=1e-2)  # of other samples
        page.select_option("#polar [name=frame]", "crank")
        curves = page.locator("#polar .curve").evaluate_all("all => all.map(p => p.getAttribute('d'))")
        assert [bool(curve) for curve in curves] == [True, True, False]


@pytest.mark.parametrize("width", [390, 1400])
def test_a_scene_that_cannot_run(width: int, browser: "Browser", reports: Path) -> None:
    with silent(browser, reports / "toggle_press" / "report.html", viewport={"width": width, "height": 800}) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.locator(".mark").count() == 1
        assert page.locator(".ghost").is_visible()
        expected = (
            "The drive is to go from 0.0000 deg to 360.0000 deg. The linkage goes from 12.8552 deg to 66.1809 deg."
        )
        assert page.get_by_text(expected).count() == 1


@pytest.mark.parametrize("width", [390, 1400])
def test_all_reports(width: int, browser: "Browser", reports: Path) -> None:
    with silent(browser, reports / "index.html", viewport={"width": width, "height": 800}) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        page.wait_for_function("[...document.images].every(image => image.complete && image.naturalWidth > 0)")
        assert page.locator(".reports > li").count() == 2
