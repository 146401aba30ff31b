"""Every kind of page in a browser: each control does what its name is, nothing leads away, the words are plain."""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd
import pytest

import compare
from benchmarks.faults import write as write_faults
from compare.measure.hard.case import Case, examine
from compare.measure.hard.stability import over_sweeps
from compare.report.pages.report import page as report_page
from compare.run import main
from compare.study import Study
from papers.audit import audit
from papers.audit import write as write_audit
from papers.clamp.formulas import SCHEME_4
from papers.clamp.optimisation.report import write as write_design
from papers.clamp.optimisation.study import Effort, study
from tests import scene_files
from tests.comparisons import SLOW
from tests.faults.table import judged_faults
from tests.pages import silent

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator, Page

pytestmark = pytest.mark.browser

ROD = str(scene_files.FOLDER / "ladders" / "rod.toml")
BUTTONS = ("Download plot as a PNG", "Zoom", "Pan", "Zoom in", "Zoom out", "Autoscale", "Reset axes")
RANGES = """plot => Object.fromEntries(Object.keys(plot._fullLayout).filter(name => /^[xy]axis\\d*$/.test(name))
  .map(name => [name, [...plot._fullLayout[name].range]]))"""
VISIBLE = "plot => plot._fullData.map(trace => [trace.legendgroup || trace.name, trace.visible === true])"
SHOWS = f"([plot, wanted]) => JSON.stringify(({VISIBLE})(plot)) === JSON.stringify(wanted)"
KIND = """plot => { const { hovermode, legend, xaxis3, coloraxis, updatemenus } = plot._fullLayout;
  return [hovermode, legend?.orientation, !!xaxis3, !!coloraxis, updatemenus?.length].join(); }"""
LEAVING = """() => [...document.querySelectorAll('*')].flatMap(e => [...e.attributes]
    .filter(a => ['href', 'src', 'action', 'formaction', 'data', 'xlink:href'].includes(a.name))
    .map(a => a.value)).filter(to => !/^(#|data:|$)/.test(to))"""
AWAY = re.compile(r"https?://(?!www\.w3\.org/)|cloud|share|chart studio|plotly\.com", re.IGNORECASE)
OF_ITSELF = 5e-3  # of an axis whose range plotly finds anew, from the panel's size in px
UNCLEAR = re.compile(  # words that a first reader did not understand
    r"\b(rungs?|ladders?|certified to|to lock|cause is unknown|reference's way|That of a|silent wrong|no dyad)\b"
)
TO_PX = 0.02  # of an axis: a pixel or two of a drag over some hundred


def _report(press: Study, folder: Path) -> Path:
    maps = pd.DataFrame([*over_sweeps(press.reference, "pymunk", lambda _: None, (8, 64), (72, 216))])
    hard = pd.DataFrame(
        [row for rung in ("shorter", "as_is") for e in ("analytic", "pymunk") for row in examine(Case(ROD, rung, e))]
    )
    (folder / "report.html").write_text(report_page(replace(press, maps=maps, hard=hard)), encoding="utf-8")
    return folder / "report.html"


def _many(name: str, *arguments: str) -> Callable[[Study, Path], Path]:
    def run(_: Study, folder: Path) -> Path:
        asked = ["--engines", "analytic,pymunk", "--samples", "36", "--out", str(folder)]
        assert main(["toggle_press", *arguments, *asked]) == 0
        return folder / "toggle_press" / f"{name}.html"

    return run


def _design(_: Study, folder: Path) -> Path:
    points = study(Effort(2, 0), (1.0,), lambda _: None)
    return write_design(points, [], {"ahead": SCHEME_4}, 1.0, folder) / "design.html"


PAGES: Mapping[str, Callable[[Study, Path], Path]] = {
    "report": _report,
    "family": _many("family", "--vary", "bodies.rocker.lengths.O-P3=290:310:3"),
    "monte_carlo": _many("monte_carlo", "--monte-carlo", "60"),
    "faults": lambda _, folder: write_faults(judged_faults(("crank_press", "exudyn"), 400), folder) / "faults.html",
    "audit": lambda _, folder: write_audit(*audit(lambda _: None), folder) / "audit.html",
    "design": _design,
}


@pytest.fixture(
    scope="module",
    params=[pytest.param(name, marks=[] if name in ("report", "family") else SLOW) for name in PAGES],
)
def opened(
    request: pytest.FixtureRequest, browser: "Browser", press_study: Study, tmp_path_factory: pytest.TempPathFactory
) -> "Iterator[Page]":
    """Yield a page of each kind with all of its figures drawn."""
    path = PAGES[request.param](press_study, tmp_path_factory.mktemp(request.param))
    with silent(browser, path, viewport={"width": 1400, "height": 900}, reduced_motion="reduce") as page:
        if page.locator(".plot").count():
            page.wait_for_function("window.Plotly")
        page.evaluate("document.querySelectorAll('details').forEach(part => (part.open = true))")
        page.evaluate("dispatchEvent(new Event('beforeprint'))")  # draws every figure
        page.wait_for_function("[...document.querySelectorAll('.plot')].every(plot => plot._fullLayout)")
        page.evaluate("document.querySelectorAll('.plot').forEach(p => (p._context.doubleClickDelay = 1))")  # no wait
        yield page


def plots(page: "Page") -> "Iterator[Locator]":
    """Yield a figure of each kind."""
    kinds = set()
    for plot in page.locator(".plot").all():
        kind = plot.evaluate(KIND)
        if kind not in kinds:
            kinds.add(kind)
            plot.scroll_into_view_if_needed()
            plot.hover(position={"x": 5, "y": 5})
            yield plot


def press(plot: "Locator", button: str) -> None:
    plot.locator(f".modebar-btn[data-title='{button}']").click(timeout=5000)


def drag(plot: "Locator", start: float, end: float) -> None:
    """Drag over the first panel, between shares of its width and height."""
    panel, mouse = plot.locator(".nsewdrag").first, plot.page.mouse
    panel.scroll_into_view_if_needed()
    box = panel.bounding_box()
    assert box is not None
    places = [(box["x"] + share * box["width"], box["y"] + share * box["height"]) for share in (start, end)]
    mouse.move(*places[0])
    mouse.down()
    mouse.move(*places[1], steps=4)
    mouse.up()


def shares(of: list[float], within: list[float]) -> tuple[float, ...]:
    """Where a range begins and ends within another, as shares of that."""
    return tuple((end - within[0]) / (within[1] - within[0]) for end in of)


@contextmanager
def ranges(plot: "Locator") -> Iterator[Callable[[], tuple[float, ...]]]:
    """Yield a function that returns the first horizontal range as shares of that before; at the end it is reset."""
    before = plot.evaluate(RANGES)
    yield lambda: shares(plot.evaluate(RANGES)["xaxis"], before["xaxis"])
    press(plot, "Reset axes")
    for axis, range_ in plot.evaluate(RANGES).items():
        assert shares(range_, before[axis]) == pytest.approx((0.0, 1.0), abs=OF_ITSELF), axis


def test_every_button_does_what_its_name_is(opened: "Page") -> None:
    for plot in plots(opened):
        linked = plot.evaluate("plot => plot._fullLayout.hovermode") is False
        named = [button.get_attribute("data-title") for button in plot.locator(".modebar-btn").all()]
        assert named == [*BUTTONS, *["Cursor"] * linked]
        with ranges(plot) as now:
            press(plot, "Zoom in")
            assert now() == pytest.approx((0.25, 0.75))
            press(plot, "Zoom out")
            assert now() == pytest.approx((0.0, 1.0))
        with ranges(plot) as now:
            press(plot, "Zoom")
            drag(plot, 0.3, 0.6)
            assert now() == pytest.approx((0.3, 0.6), abs=TO_PX)
            press(plot, "Autoscale")
            assert plot.evaluate("plot => plot._fullLayout.xaxis.autorange")
        with ranges(plot) as now:
            press(plot, "Pan")
            drag(plot, 0.6, 0.4)
            assert now() == pytest.approx((0.2, 1.2), abs=TO_PX)
        if linked:
            press(plot, "Cursor")
            with ranges(plot) as now:
                drag(plot, 0.2, 0.5)
                assert now() == (0.0, 1.0)
            assert opened.locator("#linkage [type=range]").input_value() == "36"
        with opened.expect_download() as offered:
            press(plot, "Download plot as a PNG")
        assert offered.value.suggested_filename.endswith(".png")
        offered.value.cancel()


def test_every_entry_of_a_legend_hides_its_traces_and_shows_them(opened: "Page") -> None:
    for plot in plots(opened):
        before, entries = plot.evaluate(VISIBLE), plot.locator(".legend .traces")
        listed = plot.evaluate("plot => plot._fullData.some(trace => trace.showlegend)")
        assert bool(entries.count()) == listed
        for number in range(entries.count()):
            entry = entries.nth(number)
            group = entry.evaluate("e => e.__data__[0].trace.legendgroup || e.__data__[0].trace.name")
            hidden = [[name, visible and name != group] for name, visible in before]
            assert hidden != before
            for wanted in (hidden, before):
                entry.locator(".legendtoggle").click(timeout=2000)
                opened.wait_for_function(SHOWS, arg=[plot.element_handle(), wanted], timeout=3000)


def test_the_buttons_of_speed_change_its_numbers(report: "Page") -> None:
    plot = report.locator(".plot:has(.updatemenu-button)")
    plot.scroll_into_view_if_needed()
    seen = []
    for name in ("RMS error", "largest error"):
        plot.locator(f".updatemenu-button:has-text('{name}')").click()
        seen.append(plot.evaluate("plot => plot._fullData.map(trace => [...trace.y])"))
    assert seen[0] != seen[1]


def test_nothing_leaves_the_page(opened: "Page") -> None:
    """No link, form, picture or frame; no button that plotly adds by itself; no address for what it sends."""
    assert opened.evaluate(LEAVING) == []
    for plot in opened.locator(".plot").all():
        bar = plot.locator(".modebar-container").inner_html()
        assert not AWAY.search(bar)
        settings = plot.evaluate("p => p._context")
        assert [settings[name] for name in ("plotlyServerURL", "showSendToCloud", "displaylogo")] == ["", False, False]


def test_a_first_reader_understands_the_words(opened: "Page") -> None:
    assert UNCLEAR.findall(opened.locator("main").inner_text()) == []


def test_a_figure_of_a_notebook_has_these_buttons_alone(browser: "Browser", tmp_path: Path) -> None:
    figure = compare.check("four_bar", engines=("analytic",), samples=36).plot("T.ay")
    figure.write_html(tmp_path / "written.html")
    (tmp_path / "text.html").write_text(figure.to_html(), encoding="utf-8")
    for name in ("written", "text"):
        with silent(browser, tmp_path / f"{name}.html") as page:
            page.wait_for_selector(".modebar-btn", state="attached")
            named = [button.get_attribute("data-title") for button in page.locator(".modebar-btn").all()]
            assert named == [*BUTTONS]
            assert page.evaluate(LEAVING) == []
