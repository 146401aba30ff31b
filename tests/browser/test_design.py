"""Designs as a reader changes them: loads stay, none that does not assemble has peaks, what is copied can be read."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from compare.report.output import files
from scenes import load
from tests import scene_files
from tests.comparisons import studied
from tests.pages import now, silent, typed

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser
LOADS = """[...document.querySelectorAll("#linkage .value.load")].filter(text => text.style.display !== "none")
  .map(text => text.textContent)"""


def reported(browser: "Browser", name: str, folder: Path, changes: scene_files.Changes) -> "Iterator[Page]":
    scene = load(scene_files.write(folder, name, changes)) if changes else scene_files.load(name)
    written = files.write(studied(scene, ["analytic"]), folder)
    with silent(browser, written / "report.html", viewport={"width": 1400, "height": 900}) as page:
        page.wait_for_selector("#bench .controls:not([hidden])")
        yield page


@pytest.fixture(scope="module")
def press(browser: "Browser", tmp_path_factory: pytest.TempPathFactory) -> "Iterator[Page]":
    yield from reported(browser, "crank_press", tmp_path_factory.mktemp("press"), {})


@pytest.fixture(scope="module")
def pounds(browser: "Browser", tmp_path_factory: pytest.TempPathFactory) -> "Iterator[Page]":
    """A lever whose points are called as what every object of a script has, in units without prefixes."""
    yield from reported(browser, "pounds", tmp_path_factory.mktemp("pounds"), {})


def test_loads_are_those_of_the_design(press: "Page") -> None:
    """A press force is drawn where the edited slider closes the last 6 mm of its stroke, as large as it was typed."""
    typed(press, "loads.0.force.1", 900)
    typed(press, "bodies.rod.lengths.A-B", 900)
    count = int(press.locator("#linkage [type=range]").get_attribute("max") or 0)
    angle = np.radians(90.37 + np.linspace(0, 360, count + 1))  # of the crank, 90 mm long; it closes to 270 degrees
    y = 90 * np.sin(angle) - np.sqrt(900**2 - (90 * np.cos(angle)) ** 2)
    acts = (y < -990 + 6) & (angle < np.radians(270))
    for sample in range(0, count + 1, 2):
        press.locator("#linkage [type=range]").fill(str(sample))
        assert press.evaluate(LOADS) == (["900.0 kN"] if acts[sample] else []), sample
    assert acts[::2].sum() == 2
    press.locator(".undo").click()


def test_a_design_that_does_not_assemble_has_no_peaks(press: "Page") -> None:
    typed(press, "bodies.rod.lengths.A-B", 60)  # shorter than the crank
    assert "finds no solution" in press.locator("#bench .open").inner_text()
    rows = press.locator("#bench .asked tbody tr").all()
    assert {tuple(row.locator("td").all_text_contents()[1:4]) for row in rows} == {("–", "–", "–")}
    press.locator(".undo").click()


def test_any_name_and_any_number_is_edited_and_copied(pounds: "Page", tmp_path: Path) -> None:
    """What is typed is in the units of the file; the copied file is read, with its texts and its numbers."""
    typed(pounds, "loads.0.force.1", -120)
    assert now(pounds, "Pin constructor")[:3] == ["75.00 lbf", "135.00 lbf", "+80.0 %"]  # 120 and 15
    pounds.locator(".copy").click()
    (tmp_path / "copied.toml").write_text(pounds.locator("#scene-text").input_value(), encoding="utf-8")
    copied = load(tmp_path / "copied.toml")
    assert copied.title == scene_files.load("pounds").title
    assert copied.numbers["loads.0.force.1"].value == pytest.approx(-120 * 4.4482216152605, rel=1e-12)
    pounds.locator(".undo").click()


def test_a_number_beyond_the_integers_of_toml_is_copied(browser: "Browser", tmp_path: Path) -> None:
    units = {"length": "um", "angle": "deg", "speed": "rpm"}
    for page in reported(browser, "slider_crank", tmp_path, {"units": units}):
        typed(page, "bodies.rod.lengths.A-B", 5e19)
        page.locator(".copy").click()
        (tmp_path / "copied.toml").write_text(page.locator("#scene-text").input_value(), encoding="utf-8")
    assert load(tmp_path / "copied.toml").numbers["bodies.rod.lengths.A-B"].value == pytest.approx(5e13, rel=1e-12)


def test_one_number_has_one_text(pounds: "Page") -> None:
    """In the table of peaks, in that of the design and in the picture."""
    peaks = dict(
        pounds.locator("section.card tr:has(td.value)").evaluate_all(
            "rows => rows.map(row => ['th', 'td'].map(cell => row.querySelector(cell).firstChild.textContent))"
        )
    )
    assert now(pounds, "Drive: torque")[0] == peaks["Peak braking torque"] == "−435.0 lbf in"
    assert now(pounds, "Pin constructor")[0] == peaks["Largest pin force"] == "75.00 lbf"
    assert "Largest joint force: 75.00 lbf, constructor" in pounds.locator("#linkage .now").inner_text()
    visible = pounds.locator("body").inner_text()
    assert "*" not in visible
