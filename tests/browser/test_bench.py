"""The page solves the linkage: its numbers are the core's, before and after edits, and what is edited is marked."""

import gzip
import json
import re
from base64 import b64decode, b64encode
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import analytic
from compare.measure.many.machines import draws
from compare.report.output import files
from compare.study import Study
from scenes import load
from tests import scene_files
from tests.comparisons import SLOW, studied
from tests.pages import now, pin, silent, typed

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser
CURVES = """async () => {
  for (let frame = 0; frame < 2; frame++) await new Promise(requestAnimationFrame);
  const [panel] = document.querySelector('.plot').plot.panels;
  return panel.traces.flatMap(({ name, mode }, k) => (mode === 'lines' ? [[name, [...panel.u.data[k + 1][1]]]] : []));
}"""  # of the first plot, as they are drawn
NAMES = "document.querySelector('.plot').plot.panels[0].traces.map(({ name }) => name)"


@pytest.fixture(scope="module")
def bench(browser: "Browser", press_report: Path) -> "Iterator[Page]":
    size = {"width": 1400, "height": 900}
    with silent(browser, press_report / "report.html", viewport=size, reduced_motion="reduce") as page:
        page.wait_for_selector("#bench .controls:not([hidden])")
        yield page


@pytest.fixture
def undone(bench: "Page") -> "Iterator[Page]":
    yield bench
    if bench.locator(".undo").is_visible():
        bench.locator(".undo").click()
    assert "edited" not in (bench.locator("body").get_attribute("class") or "")


def test_the_page_says_by_how_much_it_differs(bench: "Page") -> None:
    assert float(bench.locator("#self-check").get_attribute("data-difference") or "nan") <= 1e-12


def test_a_dragged_pin_is_where_the_pointer_is(undone: "Page") -> None:
    start = pin(undone, "P3")
    still = {point: pin(undone, point) for point in ("O", "P2", "P4", "P5")}
    undone.mouse.move(start.real, start.imag)
    undone.mouse.down()
    undone.mouse.move(start.real - 12, start.imag + 15, steps=3)
    undone.mouse.up()
    assert abs(pin(undone, "P3") - (start + complex(-12, 15))) < 0.2
    for point, place in still.items():
        assert abs(pin(undone, point) - place) < 0.2, point


def test_what_is_edited_is_marked_and_no_engine_has_a_number(undone: "Page") -> None:
    assert not undone.get_by_text("Edited: not cross-checked").is_visible()
    typed(undone, "bodies.slider.mass", 1600)
    assert undone.get_by_text("Edited: not cross-checked").is_visible()
    ok = undone.evaluate("getComputedStyle(document.querySelector('.verdict strong')).color")
    soft = undone.evaluate("getComputedStyle(document.querySelector('header .soft')).color")
    assert ok == soft, "no green"
    undone.locator(".plot").first.scroll_into_view_if_needed()
    first = undone.locator(".readout").first
    undone.wait_for_function("document.querySelector('.readout td:not(:empty)')")
    assert {*first.locator("tr", has_text="exudyn").locator("td").all_text_contents()} == {"–"}


def test_the_judged_curve_is_beside_the_edited_one_and_alone_where_all_is_undone(undone: "Page") -> None:
    undone.locator(".plot").first.scroll_into_view_if_needed()
    undone.wait_for_function("document.querySelector('.plot .uplot')")
    ((name, judged),) = undone.evaluate(CURVES)
    typed(undone, "bodies.toggle.lengths.P2-P4", 761)
    (_, edited), (beside, as_judged) = undone.evaluate(CURVES)
    assert beside == f"{name} as judged"
    assert as_judged == judged
    assert np.abs(np.subtract(edited, judged)).max() > 0.1  # mm
    undone.locator(".undo").click()
    assert undone.evaluate(CURVES) == [[name, judged]]
    undone.locator("#bench [name=machines]").check()
    undone.wait_for_function(f"{NAMES}.includes('machines')")
    typed(undone, "bodies.toggle.lengths.P2-P4", 761)
    undone.locator(".plot").first.scroll_into_view_if_needed()
    undone.wait_for_function(f"{NAMES}.includes('{name} as judged')")
    assert "machines as judged" not in undone.evaluate(NAMES)
    undone.locator("#bench [name=machines]").uncheck()


def test_the_machines_are_in_every_plot_whenever_it_is_drawn(undone: "Page") -> None:
    """One that was far when they were drawn too, and one drawn by that time; none has them where they are left out."""
    undone.locator("#bench [name=machines]").check()
    undone.wait_for_function("document.querySelector('#bench .machines').textContent")
    plots = undone.locator("section:has(> h3:text-matches('^Pin ')) .plot")
    banded = "place => place.plot?.width && place.plot.panels[0].traces.some(({ name }) => name === 'machines')"
    assert plots.count() > 4
    for plot in plots.all():
        plot.scroll_into_view_if_needed()
        undone.wait_for_function(banded, arg=plot.element_handle())
    undone.locator("#bench [name=machines]").uncheck()
    assert not any(plot.evaluate(banded) for plot in plots.all())


def test_the_scene_that_is_copied_has_the_numbers_shown(undone: "Page", tmp_path: Path) -> None:
    """Solved from its file, the design has the peaks that the page has, to the digits shown."""
    typed(undone, "bodies.rod.lengths.P4-P5", 320)
    typed(undone, "drive.speed", 75)
    undone.locator(".copy").click()
    (tmp_path / "edited.toml").write_text(undone.locator("#scene-text").input_value(), encoding="utf-8")
    scene = load(tmp_path / "edited.toml")
    motion = analytic.solve(scene, np.linspace(0, 2 * np.pi, 20001))
    peak = np.hypot(motion["P1.fx"], motion["P1.fy"]).max() / 1e3
    was, shown, change = now(undone, "Pin P1")[:3]
    assert abs(float(shown.split()[0]) - peak) <= 0.051
    assert change == f"{100 * (peak / float(was.split()[0]) - 1):+.1f} %".replace("-", "−")
    stroke = (motion["P5.y"].max() - motion["P5.y"].min()) * 1e3
    assert abs(float(now(undone, "stroke")[1].split()[0]) - stroke) <= 0.051


def test_a_design_that_does_not_assemble_keeps_the_nearest_pose(undone: "Page") -> None:
    typed(undone, "bodies.rocker.lengths.O-P3", 150)
    message = undone.locator("#bench .open").inner_text()
    assert "finds no solution at" in message
    assert "from 130.0° to 270.0°, where it cannot close P5" in message  # in 5° steps; the core: 128.05° to 274.44°
    assert all(np.isfinite(pin(undone, point)) for point in ("P3", "P4", "P5"))


def test_a_guide_goes_with_its_slider(undone: "Page") -> None:
    """It is moved and lengthened: the block stays in its middle, and reaches both ends over a turn."""
    guide = undone.locator("#linkage [data-guides=P5]")

    def box() -> list[float]:
        found = guide.evaluate(
            "g => { const b = g.getBoundingClientRect(), s = g.ownerSVGElement.getBoundingClientRect();"
            " return [b.x, b.y - s.y, b.width, b.height]; }"
        )
        return [float(number) for number in found]

    before, slider = box(), pin(undone, "P5")
    typed(undone, "bodies.slider.slides.through.0", 120)
    typed(undone, "bodies.crank.points.P2.0", 90)  # a longer stroke
    moved, x = box(), pin(undone, "P5").real
    assert x > slider.real + 10
    assert abs((moved[0] + moved[2] / 2 - x) - (before[0] + before[2] / 2 - slider.real)) < 0.2
    assert moved[3] > 1.1 * before[3]
    top = undone.locator("#linkage svg").bounding_box()
    assert top is not None
    ends = []
    for sample in range(0, 361, 5):
        undone.locator("#linkage [type=range]").fill(str(sample))
        ends.append(pin(undone, "P5").imag - top["y"])
    assert moved[1] < min(ends) < moved[1] + 0.3 * moved[3]
    assert moved[1] + 0.7 * moved[3] < max(ends) < moved[1] + moved[3]
    undone.locator(".undo").click()
    assert np.allclose(box(), before, atol=0.1)


def test_all_can_be_undone(bench: "Page") -> None:
    before = bench.locator("#linkage svg").inner_html()
    typed(bench, "bodies.rod.lengths.P4-P5", 330)
    assert bench.locator("#linkage svg").inner_html() != before
    bench.locator(".undo").click()
    places = bench.evaluate(
        "[...document.querySelectorAll('#linkage [data-point]')].map(g => g.getAttribute('transform')).join()"
    )
    typed(bench, "bodies.rod.lengths.P4-P5", 300)
    assert (
        bench.evaluate(
            "[...document.querySelectorAll('#linkage [data-point]')].map(g => g.getAttribute('transform')).join()"
        )
        == places
    )
    assert now(bench, "Pin P1")[1:3] == ["", ""]


def test_the_numbers_that_move_a_peak_most_have_the_longest_bars(undone: "Page") -> None:
    """By 1 % more of a length, against the core with that length."""
    undone.locator("#bench .numbers").scroll_into_view_if_needed()
    undone.wait_for_function("document.querySelector('#bench .weight span:not(:empty)')")  # of the first pin
    row = undone.locator("#bench .numbers tr", has=undone.locator('th:text-is("bodies.toggle.lengths.P2-P4")'))
    of_another_pin = row.locator("span").inner_text()
    undone.locator("#bench [name=weighed]").select_option(label="Pin P1: ground on crank")
    row.locator("span").filter(has_not_text=of_another_pin).wait_for()
    shown = float(row.locator("span").inner_text().split()[0].replace("−", "-"))
    position = np.linspace(0, 2 * np.pi, 3601)
    core = analytic.solve_many(
        load("toggle_press"), {"bodies.toggle.lengths.P2-P4": np.array([759.924, 760.076])}, position
    )
    low, high = np.hypot(core["P1.fx"], core["P1.fy"]).max(axis=1)
    assert shown == pytest.approx((high - low) / 2e-4 / ((high + low) / 2), rel=0.05)


def test_a_tampered_program_offers_nothing(browser: "Browser", press_report: Path, tmp_path: Path) -> None:
    """With one digit of the judged numbers another, the page says so, and no number can be changed."""
    text = (press_report / "report.html").read_text(encoding="utf-8")
    packed = re.search(r'id="design">([^<]*)<', text)
    assert packed is not None
    data = json.loads(gzip.decompress(b64decode(packed[1])))
    data["exact"]["samples"][3][5] *= 1 + 1e-9
    text = text.replace(packed[1], b64encode(gzip.compress(json.dumps(data).encode())).decode())
    (tmp_path / "report.html").write_text(text, encoding="utf-8")
    with silent(browser, tmp_path / "report.html") as page:
        page.wait_for_selector("#self-check[data-difference]", state="attached")
        assert not page.locator("#bench .numbers").is_visible()
        assert float(page.locator("#self-check").get_attribute("data-difference") or "nan") > 1e-11
        assert page.locator("#self-check").is_visible()


def test_a_linkage_with_a_larger_group_is_shown_and_not_edited(browser: "Browser", tmp_path: Path) -> None:
    folder = files.write(studied(load("class_iii"), ["analytic"]), tmp_path)
    with silent(browser, folder / "report.html") as page:
        page.wait_for_selector("#linkage .player:not([hidden])")
        assert "take iterations" in page.locator("#self-check").inner_text()
        assert not page.locator("#bench").count()


def test_the_machines_are_those_of_the_command_line(undone: "Page", press_study: Study) -> None:
    """The range of a peak of 500 machines is that of the machines that `--monte-carlo 500` draws."""
    undone.locator("#bench [name=machines]").check()
    undone.wait_for_function("document.querySelector('#bench .machines').textContent")
    low, _, high, _ = now(undone, "Pin P1")[4].split()
    scene = press_study.scene
    core = analytic.solve_many(scene, draws(scene, 0, 0, 500), np.linspace(0, 2 * np.pi, 361))
    peaks = np.sort(np.hypot(core["P1.fx"], core["P1.fy"]).max(axis=1)) / 1e3
    assert abs(float(low) - peaks[5]) <= 0.1  # kN: the digits shown, and samples of 5 degrees
    assert abs(float(high) - peaks[494]) <= 0.1
    undone.locator("#bench [name=machines]").uncheck()


def test_without_a_script_the_picture_stands(browser: "Browser", press_report: Path) -> None:
    page = browser.new_page(java_script_enabled=False)
    page.goto((press_report / "report.html").as_uri())
    assert page.locator("#linkage svg.linkage .pin").count() == 6
    assert page.get_by_text("For this the page needs a script.").is_visible()
    assert not page.get_by_role("button", name="Play").is_visible()
    page.close()


@pytest.mark.parametrize(
    ("path", "value"), [("bodies.slider.mass", -1), ("drive.speed", 0), ("bodies.rod.lengths.P4-P5", 0)]
)
def test_a_number_that_no_file_may_have_changes_nothing(undone: "Page", path: str, value: float) -> None:
    typed(undone, path, value)
    assert not undone.get_by_text("Edited: not cross-checked").is_visible()


@SLOW
def test_every_number_that_is_changed_is_an_edit(browser: "Browser", tmp_path: Path) -> None:
    """One without a unit too: a coefficient of friction; the torque is then that of the core with it."""
    folder = files.write(studied(load("crank_press_friction"), ["analytic"]), tmp_path)
    with silent(browser, folder / "report.html", viewport={"width": 1400, "height": 900}) as page:
        page.wait_for_selector("#bench .controls:not([hidden])")
        typed(page, "friction.1.coefficient", 0.2)
        assert page.get_by_text("Edited: not cross-checked").is_visible()
        shown = float(now(page, "Drive: torque")[1].split()[0].replace("−", "-").replace(",", ""))
    core = analytic.solve(
        load("crank_press_friction", {"friction.1.coefficient": 0.2}), np.linspace(0, 2 * np.pi, 7201)
    )
    peak = core["drive.torque"][np.abs(core["drive.torque"]).argmax()] / 1e3
    assert shown == pytest.approx(peak, rel=2e-3)  # the press force goes within a sample


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["cross_slide", "swinging_block", "shaper", "telescope", "gas_spring", "elbow", "bucket"]
)
def test_linkages_of_other_kinds_are_edited_without_an_error(browser: "Browser", name: str, tmp_path: Path) -> None:
    """Every number in turn by 1 %, and every pin that can be dragged by some px."""
    folder = files.write(studied(scene_files.load(name), ["analytic"]), tmp_path)
    with silent(browser, folder / "report.html", viewport={"width": 1400, "height": 1000}) as page:
        page.wait_for_selector("#self-check[data-difference]", state="attached")
        assert page.locator("#bench .controls").is_visible()
        for box in page.locator("#bench [type=number]").all():
            if (value := float(box.input_value())) != 0:
                box.fill(repr(1.01 * value))
                box.fill(repr(value))
        for point in page.locator("#linkage .draggable").all():
            place = point.locator(".pin").bounding_box()
            assert place is not None
            page.mouse.move(place["x"] + 6, place["y"] + 6)
            page.mouse.down()
            page.mouse.move(place["x"] + 10, place["y"] + 3)
            page.mouse.up()
