"""The moving linkage in a browser: one position of the drive for the picture and all plots, and the values there."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import pytest

from compare.report.linkage.drawing import Drawing
from compare.report.output import files
from compare.study import Study
from scenes.model.motion import header
from tests import scene_files
from tests.comparisons import sampled, studied
from tests.pages import silent

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

ENGINES = ("analytic", "exudyn", "pymunk")
ROW = 41  # of 73: 205 degrees
NUMBER = r"-?\d[\d.]*(?:e-?\d+)?"
TO_PX = 1.5  # px: half of a line's width, and what a browser rounds
TWO_FRAMES = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


def scrub(page: "Page", row: int) -> None:
    page.locator("#linkage [type=range]").fill(str(row))


def places(page: "Page") -> dict[str, complex]:
    """Where the picture shows every point, in its units."""
    transforms: dict[str, str] = page.evaluate(
        "Object.fromEntries([...document.querySelectorAll('#linkage [data-point]:has(.name)')]"
        ".map(g => [g.dataset.point, g.getAttribute('transform')]))"
    )
    return {point: complex(*map(float, re.findall(NUMBER, place))) for point, place in transforms.items()}


def cursors(page: "Page") -> list[dict[str, Any]]:
    """Of every panel over the crank angle where its cursor is, and the ends of its axis; px, degrees."""
    plots: list[dict[str, Any]] = page.evaluate(
        """[...document.querySelectorAll('.plot')].filter(plot => plot.plot.position !== undefined)
          .flatMap(plot => plot.plot.panels).map(({ u }) => {
            const line = u.over.querySelector('.cursor').getBoundingClientRect(), over = u.over.getBoundingClientRect();
            const { min, max } = u.scales.x;
            const at = line.left + line.width / 2;
            return { at, start: over.left, end: over.right, range: [min, max], height: line.height };
          }).filter(plot => plot.height)"""
    )
    return plots


def test_scrubbing_moves_the_linkage(report: "Page", press_study: Study) -> None:
    drawing = Drawing(press_study.scene, press_study.motion)
    for row in (0, ROW, 72):
        scrub(report, row)
        shown = places(report)
        assert shown.keys() == press_study.scene.owners.keys()
        for point, place in shown.items():
            assert abs(place - complex(drawing.units(drawing.places[point])[row])) < 0.05, point


@sampled(1)
@pytest.mark.parametrize("name", ["twisted_four_bar", "toggle_press_friction"])
def test_moments_and_circles_of_friction_leave_the_picture_whole(browser: "Browser", name: str, tmp_path: Path) -> None:
    """Their signs are no forces' arrows: the script goes on past them, to the player."""
    folder = files.write(studied(scene_files.load(name), ["analytic"]), tmp_path)
    with silent(browser, folder / "report.html", viewport={"width": 800, "height": 600}) as page:
        page.wait_for_selector("#linkage .player:not([hidden])")


def test_a_body_turns_with_its_points(report: "Page") -> None:
    """The other end of the rod, drawn in the rod's own frame, is at its point."""
    scrub(report, ROW)
    off = report.evaluate(
        """() => {
          const bar = document.querySelector('#linkage [data-turn=rod] .bar'), to = bar.getCTM();
          const end = new DOMPoint(...bar.getAttribute('d').split(/[ML ]/).slice(-2).map(Number)).matrixTransform(to);
          const pin = document.querySelector('#linkage [data-point=P5]:not(.body)').getCTM();
          return Math.hypot(end.x - pin.e, end.y - pin.f);
        }"""
    )
    assert off < 0.1


def test_all_cursors_follow(report: "Page") -> None:
    for row in (10, ROW):
        scrub(report, row)
        plots = cursors(report)
        assert len(plots) == 2 * 12  # 3 of the slider, 6 pins, guide, torque, Assur groups
        for plot in plots:
            least, largest = plot["range"]
            share = (360 * row / 72 - least) / (largest - least)
            assert abs(plot["start"] + share * (plot["end"] - plot["start"]) - plot["at"]) < TO_PX


@pytest.mark.parametrize(
    ("title", "channels", "factor"),
    [
        ("P5: acceleration", ["P5.ay"], 1.0),
        ("Pin P3: force of rocker on toggle", ["P3.fx", "P3.fy"], 1e-3),
        ("Drive: torque on crank", ["drive.torque"], 1e-3),
    ],
)
def test_the_values_shown_are_those_of_the_files(
    report: "Page", press_report: Path, press_study: Study, title: str, channels: list[str], factor: float
) -> None:
    """To the digits shown; what is packed is rounded to 2e-9 of a channel's peak."""
    section = report.locator("section", has=report.locator("> h3", has_text=re.compile(f"^{re.escape(title)}$")))
    section.scroll_into_view_if_needed()
    report.evaluate(TWO_FRAMES)  # after which the page knows that the section is in view
    for row in (7, ROW):
        scrub(report, row)
        for engine in ENGINES:
            table = pd.read_csv(press_report / f"motion.{engine}.csv")
            values = np.array([factor * table[header(channel)] for channel in channels])
            magnitude = [float(np.linalg.norm(values[:, row]))] if len(values) > 1 else []
            expected = [*magnitude, *values[:, row]]
            cells = section.locator(".readout tr", has_text=engine).locator("td").all_text_contents()
            for text, value in zip(cells[:-1], expected, strict=True):
                last, peak = 10.0 ** -len(text.partition(".")[2]), np.abs(values).max()
                assert last <= 1e-4 * peak
                assert abs(float(text.replace("−", "-")) - value) <= 0.5 * last + 1e-8 * peak, (engine, text, value)
            comparison = press_study.measurements[ENGINES.index(engine)].comparison
            assert comparison is not None
            if engine != "analytic":
                error = max(comparison.actual[channel][row] for channel in channels)
                floor = max(press_study.reference.floor.by_channel[channel] for channel in channels)
                assert float(cells[-1]) == pytest.approx(max(error, floor), rel=0.06), "to two digits"


def test_keys(report: "Page") -> None:
    scrub(report, ROW)
    slider = report.locator("#linkage [type=range]")
    slider.focus()
    for key, row in (("ArrowRight", ROW + 1), ("ArrowLeft", ROW), ("End", 72), ("ArrowRight", 72), ("Home", 0)):
        report.keyboard.press(key)
        assert slider.input_value() == str(row), key
    assert abs(cursors(report)[0]["at"] - cursors(report)[0]["start"]) < 60
    report.keyboard.press("Space")
    report.wait_for_function("document.querySelector('#linkage [type=range]').value > 2")
    report.keyboard.press("Space")
    assert report.locator(".play").text_content() == "Play"


def test_dragging_over_a_plot(report: "Page") -> None:
    scrub(report, 0)
    plot = report.locator(".plot:has(.cursor)").first
    plot.scroll_into_view_if_needed()
    box = plot.locator(".u-over").first.bounding_box()
    assert box is not None
    y = box["y"] + box["height"] / 2
    report.mouse.move(box["x"] + 30, y)
    report.mouse.down()
    report.mouse.move(box["x"] + 0.5 * box["width"], y)
    report.mouse.up()
    rows = int(report.locator("#linkage [type=range]").input_value())
    assert abs(rows - 36) <= 1
    assert abs(cursors(report)[0]["at"] - box["x"] - 0.5 * box["width"]) < 0.6 * box["width"] / 72


@pytest.mark.parametrize("width", [390, 1400])
def test_hovering_over_a_plot_moves_the_linkage_and_all_cursors(report: "Page", width: int) -> None:
    report.set_viewport_size({"width": width, "height": 900})
    scrub(report, 0)
    plot = report.locator(".plot:has(.cursor)").nth(2)
    row = 0
    for _ in range(20):  # until it is drawn anew, and what is above it too
        plot.evaluate("plot => plot.scrollIntoView({ block: 'end' })")
        report.wait_for_timeout(200)
        if box := plot.locator(".u-over").first.bounding_box():
            report.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + box["height"] / 2)
        row = int(report.locator("#linkage [type=range]").input_value())
        if abs(row - 36) <= 1:
            break
    assert abs(row - 36) <= 1
    shares = [(cursor["at"] - cursor["start"]) / (cursor["end"] - cursor["start"]) for cursor in cursors(report)]
    assert min(shares) > 0.4
    report.mouse.move(1, 1)
    report.set_viewport_size({"width": 1400, "height": 900})


def test_a_place_of_a_number_is_shown(report: "Page") -> None:
    """An element with `data-at` goes to that pose and marks the joint; this one stands still."""
    scrub(report, ROW)
    report.evaluate(
        """document.body.insertAdjacentHTML('beforeend', `<button id="go" data-at="${Math.PI}" data-point="P3"
        style="position: fixed; top: 0; left: 0; z-index: 9">there</button>`)"""
    )
    report.locator("#go").click()
    assert report.locator("#linkage [type=range]").input_value() == "36"
    mark = report.evaluate("document.querySelector('#linkage .marked').getAttribute('transform')")
    assert complex(*map(float, re.findall(NUMBER, mark))) == pytest.approx(places(report)["P3"])
    report.evaluate("document.getElementById('go').remove()")


def test_forces_are_to_scale_and_can_be_left_out(report: "Page", press_study: Study) -> None:
    scrub(report, ROW)
    motion, drawing = press_study.motion, Drawing(press_study.scene, press_study.motion)
    arrow = report.locator("#linkage .force", has=report.locator("title", has_text="P3:"))
    length = float(re.findall(r"scale\(([\d.]+)", str(arrow.locator("> g").first.get_attribute("transform")))[0])
    force = np.hypot(motion["P3.fx"], motion["P3.fy"])[ROW]
    words = str(report.locator(".scale").text_content())
    number, length_of = re.findall(r"joint forces and loads: ([\d.]+) kN = ([\d.]+) mm", words)[0]
    expected = 1e-3 * force / float(number) * 1e-3 * float(length_of) * drawing.per_metre
    assert length == pytest.approx(expected, rel=1e-6)
    report.select_option("[name=force]", label="off")
    assert report.locator("#linkage .force:visible").count() == 0
    report.select_option("[name=force]", label="pymunk")
    assert report.locator("#linkage .force:visible").count() > 5


def test_the_picture_has_a_text(report: "Page", press_study: Study) -> None:
    scrub(report, 36)
    label = str(report.locator("#linkage svg").get_attribute("aria-label"))
    motion = press_study.motion
    largest = 1e-3 * max(
        np.hypot(motion[f"{p.channel}.fx"], motion[f"{p.channel}.fy"])[36] for p in press_study.scene.pins
    )
    assert "crank angle 180.0°" in label
    assert f"Largest joint force: {largest:.1f} kN" in label
    report.wait_for_function("document.querySelector('#linkage [aria-live=polite]').textContent.includes('180.0°')")


def test_magnified_differences(report: "Page", press_study: Study) -> None:
    """The outline of pymunk's pose is off the reference's by what its file is, times what is chosen."""
    scrub(report, ROW)
    chosen = report.locator("[name=magnify] option", has_text="pymunk").get_attribute("value")
    report.select_option("[name=magnify]", value=chosen)
    path = str(report.locator("#linkage .engine").nth(1).get_attribute("d"))
    both = press_study.motion, press_study.motions["pymunk"]
    true, own = (complex(of["P5.x"][ROW], of["P5.y"][ROW]) for of in both)
    magnified = np.array([true + float(str(chosen)) * (own - true)])
    expected = complex(Drawing(press_study.scene, press_study.motion).units(magnified)[0])
    corners = [complex(*map(float, pair.split())) for pair in re.split("[ML]", path) if pair]
    assert min(abs(corner - expected) for corner in corners) < 0.05
    assert abs(expected - places(report)["P5"]) > 0.5, "one sees it"
    report.select_option("[name=magnify]", value="0")
    assert report.locator("#linkage .engine").nth(1).get_attribute("d") == ""


def test_picture_and_plot_are_in_view_together(report: "Page") -> None:
    """At a desk's width, whichever plot the reader looks at; and a value read off a plot moves the linkage."""
    for plot in report.locator(".plot:has(.cursor)").all()[::4]:
        plot.scroll_into_view_if_needed()
        for box in (report.locator("#linkage svg.linkage").first.bounding_box(), plot.bounding_box()):
            assert box is not None
            assert box["y"] > -box["height"] / 2
            assert box["y"] + box["height"] / 2 < 900


def test_the_page_opens_at_rest_where_the_largest_joint_force_is(browser: "Browser", press_report: Path) -> None:
    with silent(browser, press_report / "report.html", viewport={"width": 1400, "height": 900}) as page:
        page.wait_for_selector("#linkage .player:not([hidden])")
        assert page.locator("#linkage output").inner_text() == "205.0°"
        assert "Largest joint force: 382.0 kN, P1: ground on crank" in page.locator("#linkage .now").inner_text()
        page.wait_for_timeout(200)
        assert page.locator("#linkage [type=range]").input_value() == str(ROW)


def test_a_pin_that_is_clicked_has_its_force_as_a_polar_diagram(report: "Page", press_study: Study) -> None:
    """In the frame of the rod, along which it acts but for the rod's own mass."""
    report.locator("#linkage [data-point=P4] > .pin").click()
    diagram = report.locator("#polar")
    assert diagram.locator("[name=vector] option:checked").inner_text() == "force at pin P4"
    diagram.locator("[name=frame]").select_option("rod")
    assert (
        diagram.locator(".caption")
        .inner_text()
        .startswith("Force of toggle on rod. The outer circle is its peak, 194.23 kN")
    )
    tips = diagram.locator(".curve").first.get_attribute("d") or ""
    x, y = np.array([[float(part) for part in tip.split()] for tip in tips[1:].split("L")]).T
    motion = press_study.motion
    force = (motion["P4.fx"] + 1j * motion["P4.fy"]) * np.exp(-1j * motion["rod.angle"])
    assert np.abs((x - 1j * y) / 140 - force / np.abs(force).max()).max() < 1e-3
