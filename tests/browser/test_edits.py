"""Edits that no shipped scene is an example of: the page has what the core has for the scene copied from it."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import analytic
import scenes
from compare.measure.many.machines import draws
from compare.report.output import files
from scenes.limits import NAME
from tests import scene_files
from tests.comparisons import SLOW, sampled, studied
from tests.pages import now, pin, silent, typed

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

LAW = [{"to": 250, "within": 0.4, "law": "cycloidal"}, {"within": 0.1}, {"to": 450, "within": 0.5, "law": "harmonic"}]
PRESS = {  # by a law, its force gone between two samples; with a number on which nothing depends
    "bodies.slider.com": [0, 0],
    "bodies.slider.inertia": 1e5,
    "drive": {"body": "crank", "start": 90, "segments": LAW, "periodic": True},
    "limits": {"rod.angle": {"most": -86.2939}},
    "variations": [
        {"path": "bodies.slider.inertia", "plus_minus": 1e4},
        {"path": "bodies.rod.lengths.A-B", "plus_minus": 3},
        {"path": "loads.0.last", "plus_minus": 2},
    ],
}
YOKE = {  # with so much friction that a few steps do not always find its balance
    "bodies.yoke.com": [60, 5],
    "bodies.yoke.inertia": 8e4,
    "friction": [
        {"slider": "yoke", "length": 150, "coefficient": 0.1},
        {"slider": "block", "length": 40, "coefficient": 0.05},
        {"at": "A", "radius": 10, "coefficient": 0.1},
    ],
    "bodies.block.com": [0, 0],
    "bodies.block.inertia": 600,
    "gravity": [0, -9.81],
    "loads": [{"body": "yoke", "at": "T", "force": [-400, 0], "last": 60}],
    "variations": [
        {"path": "friction.0.coefficient", "plus_minus": 0.05},
        {"path": "bodies.yoke.slides.through.1", "plus_minus": 1},
    ],
    "limits": {"T.x": {"most": 320}},
}
LEVER = {  # a coupler by three lengths on one line, and as long a name as may be
    "name": "n" * NAME,
    "bodies.coupler": {"lengths": {"A-B": 350, "A-T": 150, "B-T": 200}, "mass": 2},
    "bodies.rocker": {"lengths": {"C-B": 250, "B-D": 150, "C-D": 200}, "mass": 2},
    "sketch.D": [500, 150],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("edits")


def written(folder: Path, name: str, changes: dict[str, Any]) -> tuple[scenes.Scene, Path]:
    """A changed scene, and its page."""
    scene = scenes.load(scene_files.write(folder, name, changes))
    return scene, files.write(studied(scene), folder) / "report.html"


def opened(browser: "Browser", path: Path) -> "Iterator[Page]":
    with silent(browser, path, viewport={"width": 1400, "height": 1000}, reduced_motion="reduce") as page:
        page.wait_for_selector("#bench .controls:not([hidden])")
        yield page


@pytest.fixture(scope="module")
def press(browser: "Browser", folder: Path) -> "Iterator[tuple[scenes.Scene, Page]]":
    scene, path = written(folder, "crank_press", PRESS)
    for page in opened(browser, path):
        yield scene, page


@pytest.fixture(scope="module")
def lever_path(folder: Path) -> Path:
    return written(folder, "elements", LEVER)[1]


@pytest.fixture
def lever(browser: "Browser", lever_path: Path) -> "Iterator[Page]":
    """The page as its reader gets it."""
    yield from opened(browser, lever_path)


def shown(text: str) -> float:
    return float(text.split()[0].replace("−", "-").replace(",", ""))


def copied(page: "Page", folder: Path) -> scenes.Scene:
    page.locator(".copy").click()
    (folder / "copied.toml").write_text(page.locator("#scene-text").input_value(), encoding="utf-8")
    return scenes.load(folder / "copied.toml")


def turn(scene: scenes.Scene) -> tuple[Any, Any]:
    """Many positions of a cycle, and their instants."""
    time = np.linspace(0, scene.cycle, 100_001)
    return scene.drive.law.at(time).position, time


@SLOW
def test_the_peaks_of_a_press_by_a_law_are_between_the_samples(press: "tuple[scenes.Scene, Page]") -> None:
    """The torque is largest where the force ends, up to a sample of 14 ms after the last one that has it."""
    scene, page = press
    core = analytic.solve(scene, *turn(scene))
    torque = core["drive.torque"][np.abs(core["drive.torque"]).argmax()] / 1e3
    assert shown(now(page, "Drive: torque")[0]) == pytest.approx(torque, rel=1e-3)
    assert shown(now(page, "stroke")[0]) == pytest.approx(np.ptp(core["B.y"]) * 1e3, abs=0.06)


@SLOW
def test_the_machines_of_a_press_by_a_law_are_those_of_the_core(press: "tuple[scenes.Scene, Page]") -> None:
    """Also how many meet a limit of an angle, and where one of the numbers that vary is of no matter."""
    scene, page = press
    page.locator("#bench [name=machines]").check()
    page.wait_for_function("document.querySelector('#bench .machines').textContent")
    time = np.linspace(0, scene.cycle, 73)
    angle = analytic.solve_many(scene, draws(scene, 0, 0, 500), scene.drive.law.at(time).position, time)["rod.angle"]
    met = int((np.degrees(np.remainder(angle + np.pi, 2 * np.pi) - np.pi) <= -86.2939).all(axis=1).sum())
    assert 100 < met < 400
    assert f"{met} of them" in page.locator("#bench .machines").inner_text()
    time = np.linspace(0, scene.cycle, 4001)
    core = analytic.solve_many(
        scene, draws(scene, 0, 0, 500), scene.drive.law.at(time).position, time, frozenset(["drive.torque"])
    )
    peaks = np.sort(np.abs(core["drive.torque"]).max(axis=1)) / 1e3
    low, high = map(shown, now(page, "Drive: torque")[4].split(" to "))
    assert low == pytest.approx(peaks[5], rel=2e-3)
    assert high == pytest.approx(peaks[494], rel=2e-3)
    page.locator("#bench [name=machines]").uncheck()


def test_where_a_press_force_begins_and_ends_weighs(press: "tuple[scenes.Scene, Page]") -> None:
    """The torque is largest where the force begins or ends, and moves with that place."""
    scene, page = press
    page.locator("#bench .numbers").scroll_into_view_if_needed()
    page.locator("#bench [name=weighed]").select_option(label="Drive: torque")
    row = page.locator("#bench .numbers tr", has=page.locator('th:text-is("loads.0.last")'))
    row.locator("span:not(:empty)").wait_for()
    last = scene.numbers["loads.0.last"].value
    others = (scene.with_numbers({"loads.0.last": share * last}) for share in (0.99, 1.01))
    low, high = (np.abs(analytic.solve(other, *turn(other))["drive.torque"]).max() for other in others)
    share = 100 * (high - low) / (high + low)
    assert share > 0.1
    assert shown(row.locator("span").inner_text()) == pytest.approx(share, rel=0.05)


def test_a_peak_between_the_last_sample_of_a_turn_and_its_end(browser: "Browser", folder: Path) -> None:
    """The first sample is as high as the last one, and the curve falls after it."""
    position = np.linspace(0, 2 * np.pi, 36001)
    core = analytic.solve(scene_files.load("elements"), position)
    size = np.hypot(core["T.ax"], core["T.ay"])
    start = float(np.degrees(position[size.argmax()])) + 2  # of steps of 5 degrees
    _, path = written(folder, "elements", {"drive.start": start})
    for page in opened(browser, path):
        assert shown(now(page, "T: acceleration")[0]) == pytest.approx(size.max(), rel=5e-4)


@SLOW
def test_a_peak_at_a_row_of_a_law_is_found(browser: "Browser", folder: Path) -> None:
    """Between samples, where the acceleration bends; it is of the other sign than that of the nearest samples."""
    scene, path = written(folder, "turning_law", {})
    core = analytic.solve(scene, *turn(scene))["block.guide_force"]
    for page in opened(browser, path):
        assert shown(now(page, "Guide on block")[0]) == pytest.approx(core[np.abs(core).argmax()], rel=5e-4)


def test_what_is_round_off_is_zero(browser: "Browser", folder: Path) -> None:
    """A torque that nothing asks for has no digits, and no share by which it changes."""
    for page in opened(browser, written(folder, "telescope", {})[1]):
        typed(page, "drive.speed", 7)
        assert now(page, "Drive: torque")[:3] == ["0 N m", "0 N m", "–"]


def test_a_copied_scene_has_points_where_lengths_are_on_one_line(lever: "Page", folder: Path) -> None:
    """With them its numbers are those shown; its name is cut to what a name may have."""
    typed(lever, "bodies.coupler.points.T.0", 160)
    scene = copied(lever, folder)
    core = analytic.solve(scene, np.linspace(0, 2 * np.pi, 7201))
    assert shown(now(lever, "Drive: torque")[1]) == pytest.approx(np.abs(core["drive.torque"]).max(), rel=2e-3)
    assert scene.name == "n" * (NAME - len("_edited")) + "_edited"
    assert lever.locator("#bench b", has_text=f"{scene.name}.toml").count()


@sampled(1)
@pytest.mark.parametrize(
    ("path", "value", "text"),
    [
        ("bodies.rocker.lengths.B-D", 20, "the triangle of C, B, D cannot close"),
        ("loads.0.table.0.0", 500, "the rows of loads.0.table are out of order"),
        ("torsion_springs.1.stiffness", 0, "torsion_springs.1 has neither stiffness nor damping"),
        ("bodies.coupler.points.T.1", 40, "coupler has a mass as a bar, and needs 'com' and 'inertia'"),
    ],
)
def test_numbers_that_no_file_may_have_together_are_no_linkage(
    lever: "Page", path: str, value: float, text: str
) -> None:
    """The formulas have numbers for them, as of a flat triangle; the page has none, and names why."""
    typed(lever, path, value)
    assert text in lever.locator("#bench .open").inner_text()
    assert now(lever, "Drive: torque")[1:4] == ["–", "–", "–"]


def test_a_damper_gets_a_stiffness(browser: "Browser", folder: Path) -> None:
    """The scene that is copied has the length too, which its file had not."""
    for page in opened(browser, written(folder, "twisted_four_bar", {})[1]):
        typed(page, "springs.0.stiffness", 0.3)
        scene = copied(page, folder)
        size = np.abs(analytic.solve(scene, *turn(scene))["drive.torque"]).max()
        assert abs(shown(now(page, "Drive: torque")[1])) == pytest.approx(size, rel=1e-3)


@SLOW
def test_machines_whose_friction_a_few_steps_do_not_balance_are_not_known(browser: "Browser", folder: Path) -> None:
    """The core solves all of them, and all meet the limit: the page has a least and a largest yield."""
    scene, path = written(folder, "scotch_yoke", YOKE)
    time = np.linspace(0, scene.cycle, 73)
    core = analytic.solve_many(scene, draws(scene, 0, 0, 500), scene.drive.law.at(time).position, time)
    assert core.ok.all()
    assert (core["T.x"] <= 0.32).all()
    for page in opened(browser, path):
        page.locator("#bench [name=machines]").check()
        page.wait_for_function("document.querySelector('#bench .machines').textContent")
        text = page.locator("#bench .machines").inner_text()
        left = int(re.findall(r"For (\d+) the page does not find the balance with friction", text)[0])
        assert f"{500 - left} to 500 of them, {(500 - left) / 5:.1f} to 100.0 %, meet all limits" in text
        assert "no solution" not in text


def test_a_torsion_spring_goes_with_a_body_that_is_turned_over(browser: "Browser", folder: Path) -> None:
    """By half a turn, with the frame of the rocker; the angle is counted from the drive's start, as in the core."""
    for page in opened(browser, written(folder, "elements", {})[1]):
        typed(page, "bodies.rocker.points.B.1", -250)
        core = analytic.solve(copied(page, folder), np.linspace(0, 2 * np.pi, 7201))
        size = np.hypot(core["O.fx"], core["O.fy"]).max()
        assert shown(now(page, "Pin O")[1]) == pytest.approx(size, rel=1e-3)


def test_where_there_is_no_solution_there_is_no_force(lever: "Page") -> None:
    """None of zero either; the table keeps to the poses that there are."""
    lever.locator("#linkage [type=range]").fill("36")
    typed(lever, "bodies.crank.points.A.0", 300)
    assert "finds no solution" in lever.locator("#bench .open").inner_text()
    assert lever.locator("#linkage .now").inner_text() == ""


def test_a_number_that_is_not_taken_does_not_stay(lever: "Page") -> None:
    for path, value in (("bodies.rocker.lengths.B-C", "250"), ("drive.speed", "90")):
        for text in ("-5", "0", "", "1e40"):
            box = lever.locator(f'#bench input[aria-label^="{path} in"]')
            box.fill(text)
            box.blur()
            assert box.input_value() == value
    assert not lever.get_by_text("Edited: not cross-checked").is_visible()


def test_the_ends_of_a_periodic_table_are_not_changed_alone(lever: "Page") -> None:
    rows = lever.locator("#bench .numbers th", has_text=re.compile(r"loads\.3\.table\.\d\.1")).all_text_contents()
    assert rows == ["loads.3.table.1.1"]


def test_what_does_not_change_changes_by_nothing(lever: "Page") -> None:
    typed(lever, "drive.speed", 91)
    assert now(lever, "Least transmission angle")[2] == "0 %"


def test_a_slider_that_is_dragged_stays_on_its_guide(browser: "Browser", press_report: Path) -> None:
    """As far along it as the pointer, whatever that is aside."""
    for page in opened(browser, press_report / "report.html"):
        start = pin(page, "P5")
        page.mouse.move(start.real, start.imag)
        page.mouse.down()
        page.mouse.move(start.real - 30, start.imag + 6, steps=3)
        page.mouse.up()
        assert abs(pin(page, "P5") - (start + 6j)) < 0.2


def test_a_slider_that_is_driven_cannot_be_dragged(browser: "Browser", folder: Path) -> None:
    scene, path = written(folder, "garage_door", {})
    for page in opened(browser, path):
        (point,) = scene.bodies[scene.drive.body].points
        assert page.locator("#linkage .draggable").count()
        assert not page.locator(f"#linkage [data-point={point}].draggable").count()
