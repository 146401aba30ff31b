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
from compare.engines.runner import HERE
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
from scenes.hard import ladder
from tests import scene_files
from tests.compare.hard.test_stability import few
from tests.comparisons import SLOW
from tests.faults.table import judged_faults
from tests.pages import draw_all, silent

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator, Page

pytestmark = pytest.mark.browser

ROD = str(scene_files.FOLDER / "ladders" / "rod.toml")
BUTTONS = ("Zoom in", "Zoom out", "Reset axes", "Save as PNG")
ZOOM = "Drag to zoom"  # where dragging moves the linkage otherwise
RANGES = """plot => Object.fromEntries(plot.plot.panels.flatMap(({ u }, number) =>
  ['x', 'y'].map(letter => [letter + number, [u.scales[letter].min, u.scales[letter].max]])))"""
VISIBLE = """plot => plot.plot.panels.flatMap(({ u, traces }) =>
  traces.map(({ legendgroup, name }, k) => [legendgroup ?? name ?? '', u.series[k + 1].show]))"""
KIND = """plot => { const { layout: { hovermode, updatemenus }, linked, panels, traces } = plot.plot;
  return [hovermode, linked, panels.length > 2, traces.map(({ type }) => type), !!updatemenus].join(); }"""
LEAVING = """() => [...document.querySelectorAll('*')].flatMap(e => [...e.attributes]
    .filter(a => ['href', 'src', 'action', 'formaction', 'data', 'xlink:href'].includes(a.name))
    .map(a => a.value)).filter(to => !/^(#|data:|$)/.test(to))"""
AWAY = re.compile(r"https?://(?!www\.w3\.org/)|cloud|\bshare\b|chart studio|plotly", re.IGNORECASE)
NOTEBOOK = ("Download plot as a PNG", "Zoom", "Pan", "Zoom in", "Zoom out", "Autoscale", "Reset axes")  # plotly's
UNCLEAR = re.compile(  # words that a first reader did not understand
    r"\b(rungs?|ladders?|certified to|to lock|cause is unknown|reference's way|That of a|silent wrong|no dyad)\b"
)
TO_PX = 0.02  # of an axis: a pixel or two of a drag over some hundred


def _report(press: Study, folder: Path) -> Path:
    with few((72, 216), SWEEPS=(8, 64)):
        maps = pd.DataFrame([*over_sweeps(press.reference, "pymunk", lambda _: None, HERE)])
    hard = pd.DataFrame(
        [
            row
            for rung in ("shorter", "as_is")
            for engine in ("analytic", "pymunk")
            for row in examine({ROD: ladder(ROD)}, Case(ROD, rung, engine))
        ]
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
    params=[pytest.param(name, marks=[] if name == "report" else SLOW) for name in PAGES],
)
def opened(
    request: pytest.FixtureRequest, browser: "Browser", press_study: Study, tmp_path_factory: pytest.TempPathFactory
) -> "Iterator[Page]":
    """Yield a page of each kind with all of its figures drawn."""
    path = PAGES[request.param](press_study, tmp_path_factory.mktemp(request.param))
    with silent(browser, path, viewport={"width": 1400, "height": 900}, reduced_motion="reduce") as page:
        page.evaluate("document.querySelectorAll('details').forEach(part => (part.open = true))")
        draw_all(page)
        yield page


def plots(page: "Page") -> "Iterator[Locator]":
    """Yield a figure of each kind, in view."""
    kinds = set()
    for plot in page.locator(".plot").all():
        kind = plot.evaluate(KIND)
        if kind not in kinds:
            kinds.add(kind)
            plot.locator(".u-over").first.evaluate("panel => panel.scrollIntoView({ block: 'center' })")
            yield plot


def press(plot: "Locator", button: str) -> None:
    """By the keyboard, which every button takes."""
    plot.locator(f".buttons [aria-label='{button}']").press("Enter")


def drag(plot: "Locator", start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag over the first panel, between shares of its width and height."""
    panel, mouse = plot.locator(".u-over").first, plot.page.mouse
    panel.evaluate("panel => panel.scrollIntoView({ block: 'center' })")
    box = panel.bounding_box()
    assert box is not None
    places = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in (start, end)]
    mouse.move(*places[0])
    mouse.down()
    mouse.move(*places[1], steps=4)
    mouse.up()


@contextmanager
def ranges(plot: "Locator") -> "Iterator[Callable[[], tuple[float, ...]]]":
    """Yield a function that returns the first panel's ranges as shares of those before; at the end they are reset."""
    before = plot.evaluate(RANGES)
    names = list(before)[:2]

    def shares() -> tuple[float, ...]:
        now = plot.evaluate(RANGES)
        return tuple(
            (end - before[name][0]) / (before[name][1] - before[name][0]) for name in names for end in now[name]
        )

    yield shares
    press(plot, "Reset axes")
    assert plot.evaluate(RANGES) == before


def test_every_button_does_what_its_name_is(opened: "Page") -> None:
    for plot in plots(opened):
        linked = plot.evaluate("plot => plot.plot.linked")
        named = [button.get_attribute("title") for button in plot.locator(".buttons button").all()]
        assert named == [*[ZOOM] * linked, *BUTTONS]
        with ranges(plot) as now:
            press(plot, "Zoom in")
            assert now() == pytest.approx((0.25, 0.75) * 2)
            press(plot, "Zoom out")
            assert now() == pytest.approx((0.0, 1.0) * 2)
        with opened.expect_download() as offered:
            press(plot, "Save as PNG")
        assert offered.value.suggested_filename.endswith(".png")
        assert offered.value.path().read_bytes().startswith(b"\x89PNG")


def test_dragging_zooms_along_one_axis_or_both(opened: "Page") -> None:
    """Where a drag moves the linkage, only after the button for it; panels with an axis in common zoom together."""
    for plot in plots(opened):
        if linked := plot.evaluate("plot => plot.plot.linked"):
            with ranges(plot) as now:
                drag(plot, (0.2, 0.5), (0.5, 0.5))
                assert now() == (0.0, 1.0) * 2
            assert opened.locator("#linkage [type=range]").input_value() == "36"
            press(plot, ZOOM)
            assert plot.locator(f"[title='{ZOOM}']").get_attribute("aria-pressed") == "true"
        backwards = plot.evaluate("plot => plot.plot.panels[0].u.scales.x.dir < 0")
        for end, expected in (((0.6, 0.5), (0.3, 0.6, 0.0, 1.0)), ((0.6, 0.9), (0.3, 0.6, 0.1, 0.5))):
            with ranges(plot) as now:
                drag(plot, (0.3, 0.5), end)
                if not backwards:
                    assert now() == pytest.approx(expected, abs=TO_PX)
                across = plot.evaluate(
                    "p => p.plot.panels.filter(({ names }) => names.x === p.plot.panels[0].names.x)"
                    ".map(({ u }) => u.scales.x.min)"
                )
                assert len({*across}) == 1
                plot.locator(".u-over").first.dblclick(position={"x": 10, "y": 10})
                assert now() == (0.0, 1.0) * 2
        if linked:
            press(plot, ZOOM)


def test_every_entry_of_a_legend_hides_its_traces_and_shows_them(opened: "Page") -> None:
    """By the pointer and by keys; the picture of a figure has every entry."""
    for plot in plots(opened):
        before, entries = plot.evaluate(VISIBLE), plot.locator(".key button")
        assert entries.count() == plot.evaluate("plot => plot.plot.traces.filter(t => t.showlegend).length")
        for number in range(entries.count()):
            entry, group = entries.nth(number), plot.evaluate(f"plot => plot.plot.listed[{number}].legendgroup")
            hidden = [[name, visible and name != group] for name, visible in before]
            assert hidden != before
            for wanted in (hidden, before):
                entry.click() if wanted == hidden else entry.press("Space")
                assert plot.evaluate(VISIBLE) == wanted
                assert entry.get_attribute("aria-pressed") == str(wanted == before).lower()
        written: list[str] = plot.evaluate(
            """async plot => { const written = [], { prototype } = CanvasRenderingContext2D, { fillText } = prototype;
              prototype.fillText = function (text, ...at) { written.push(text); fillText.call(this, text, ...at); };
              plot.querySelector("[title='Save as PNG']").click();
              await new Promise(done => setTimeout(done, 200));
              prototype.fillText = fillText;
              return written; }"""
        )
        assert {*entries.all_text_contents()} <= {*written}


def test_values_are_read_off_at_the_pointer(opened: "Page") -> None:
    """Of a curve, a point or a cell: the words beside the pointer have its name or its text, and its number."""
    for plot in plots(opened):
        if plot.evaluate("plot => plot.plot.layout.hovermode === false"):
            continue  # a table above has the values
        target = plot.evaluate(
            """({ plot: { panels } }) => {
              for (const { u, traces } of panels) for (const trace of traces) {
                const finite = [...trace.X.keys()].filter(n => Number.isFinite(trace.X[n] + trace.top[n]));
                if (trace.hoverinfo === 'skip' || !finite.length) continue;
                const n = finite[finite.length >> 1], box = u.over.getBoundingClientRect();
                const x = trace.type === 'bar' ? trace.base[n] + trace.x[n] / 2 : trace.X[n];
                return { at: [box.left + u.valToPos(x, 'x'), box.top + u.valToPos(trace.top[n], 'y')],
                  name: trace.name, text: trace.text?.[n] ?? '' };
              }
            }"""
        )
        opened.mouse.move(*target["at"])
        words = plot.locator(".hover")
        assert words.is_visible()
        assert (target["name"] or "") in words.inner_text() or target["text"].split("<br>")[0] in words.inner_text()
        assert re.search(r"\d", words.inner_text())
        opened.mouse.move(1, 1)
        assert not words.is_visible()


def test_the_buttons_of_speed_change_its_numbers(report: "Page") -> None:
    plot = report.locator(".plot:has(.menu button)")
    plot.scroll_into_view_if_needed()
    seen = []
    for name in ("RMS error", "largest error"):
        plot.locator(f".menu button:has-text('{name}')").click()
        assert plot.locator(".menu [aria-pressed=true]").all_text_contents() == [name]
        seen.append(plot.evaluate("plot => plot.plot.panels.map(({ u }) => u.data.map(of => of && [...of[1]]))"))
    assert seen[0] != seen[1]


def test_figures_are_light_or_dark_and_light_on_paper(report: "Page") -> None:
    ink = "[...document.querySelectorAll('.plot')].map(({ plot }) => plot.panels[0].u.axes[0].stroke())"
    page = "getComputedStyle(document.documentElement).getPropertyValue('--ink').trim()"
    inks = {}
    for scheme in ("dark", "light"):
        report.emulate_media(color_scheme=scheme)
        report.wait_for_function(f"{ink}.every(colour => colour === {page})")
        inks[scheme] = report.evaluate(page)
        report.evaluate("dispatchEvent(new Event('beforeprint'))")
        pictures = report.evaluate(
            """[...document.querySelectorAll('.plot')].map(plot => {
              const [canvas] = plot.querySelectorAll('canvas.paper'), pen = canvas.getContext('2d');
              return [canvas.width >= 3 * 340, [...pen.getImageData(0, 0, 1, 1).data], [...plot.children].length];
            })"""
        )
        assert len(pictures) == 14
        assert all(sharp and ground == [255] * 4 for sharp, ground, _ in pictures)
        report.evaluate("dispatchEvent(new Event('afterprint'))")
        assert not report.locator("canvas.paper").count()
    assert inks["dark"] != inks["light"]


def test_values_of_a_curve_are_replaced(report: "Page") -> None:
    """As often as there are frames: with new ranges."""
    drawn = report.evaluate(
        """async () => {
          const { plot } = document.querySelector('.plot'), frame = () => new Promise(requestAnimationFrame);
          const [{ traces: [trace] }] = plot.panels, { y } = trace, now = () => plot.panels[0].u;
          const before = now().scales.y.max;
          for (let n = 0; n < 30; n++) {
            plot.replace(trace, y.map(v => v + n));
            await frame();
            plot.refresh();
            await null;
          }
          const moved = now().scales.y.max - before, kept = now().data[1][1][0] - y[0];
          plot.replace(trace, y);
          plot.refresh();
          await null;
          return { moved, kept, back: now().scales.y.max - before };
        }"""
    )
    assert (drawn["kept"], drawn["back"]) == (29, 0)
    assert drawn["moved"] > 14


def test_a_page_without_a_script_says_where_the_numbers_are(browser: "Browser", press_report: Path) -> None:
    page = browser.new_context(java_script_enabled=False).new_page()
    page.goto((press_report / "report.html").as_uri())
    assert page.locator(".plot noscript").first.inner_text().startswith("Figures are drawn by a script")
    page.context.close()


def test_nothing_leaves_the_page(opened: "Page") -> None:
    """No link, form, picture or frame; no button for it at a figure."""
    assert opened.evaluate(LEAVING) == []
    for plot in opened.locator(".plot").all():
        assert not AWAY.search(plot.locator(".tools").inner_html())


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
            assert named == [*NOTEBOOK]
            assert page.evaluate(LEAVING) == []
