"""A family's page in a real browser: the slider, and the picture, numbers, curves and row that follow it."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
import pytest

from compare.run import main
from tests.pages import draw_all, found_by_axe, silent

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

ROCKER = "bodies.rocker.lengths.O-P3"
CHOSEN = """() => ({
  label: document.querySelector('#member + output').textContent,
  spoken: document.getElementById('member').getAttribute('aria-valuetext'),
  heading: document.querySelector('#chosen h3').textContent,
  rows: [...document.querySelectorAll('#rows [aria-current=true]')].map(row => row.cells[0].textContent),
  thick: [...new Set(document.querySelector('.plot').plot.panels.flatMap(({ u }) => u.series.slice(1))
    .filter(({ alpha, width }) => alpha === 1 && width > 2).map(({ label }) => label))],
  numbers: Object.fromEntries([...document.querySelectorAll('#chosen tbody tr')].map(row =>
    [row.cells[0].textContent.toLowerCase(), +row.querySelector('data').value])),
})"""
SERIES = "document.querySelector('.plot').plot?.panels.flatMap(({ u }) => u.series.slice(1))"
PLACES = "[...document.querySelectorAll('#chosen [data-point]')].map(e => getComputedStyle(e).transform)"
GROUND = "document.querySelector('#chosen [data-point=O]:not([data-turn])').getAttribute('transform')"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a family whose first member cannot run."""
    out = tmp_path_factory.mktemp("family")
    asked = ["--vary", f"{ROCKER}=250:310:4", "--engines", "analytic,pymunk", "--samples", "36"]
    assert main(["toggle_press", *asked, "--out", str(out)]) == 0
    return out / "toggle_press"


@pytest.fixture(scope="module")
def opened(browser: "Browser", folder: Path) -> Iterator["Page"]:
    """Yield the page with its curves drawn."""
    with silent(browser, folder / "family.html", viewport={"width": 1400, "height": 900}) as page:
        draw_all(page)
        page.wait_for_function(f"{SERIES}?.some(({{ alpha, width }}) => alpha === 1 && width === 4)")
        yield page


def shows(page: "Page", folder: Path, value: int) -> None:
    """Check that all parts show one member, and its numbers in `family.csv`."""
    label = f"O-P3 = {value}"
    page.wait_for_function(f"document.querySelector('#chosen h3').textContent === '{label}'")
    page.wait_for_function(f"{SERIES}.every(({{ alpha, label }}) => (alpha === 1) === (label === '{label}'))")
    chosen = page.evaluate(CHOSEN)
    assert (chosen["label"], chosen["spoken"], chosen["heading"]) == (label,) * 3
    assert (chosen["rows"], chosen["thick"]) == ([str(value)], [label])
    table = pd.read_csv(folder / "family.csv").set_index(ROCKER).loc[value]
    for name, column in (("stroke", "stroke [m]"), ("peak driving torque", "peak driving torque [N*m]")):
        assert chosen["numbers"][name] == table[column]
    assert chosen["numbers"]["largest pin force"] == table["largest force [N]"]


def test_everything_follows_the_slider(opened: "Page", folder: Path) -> None:
    """By keys; all members are drawn at one scale, and the drive goes on from where it is."""
    shows(opened, folder, 270)
    opened.locator("#moving").uncheck()
    place, seen = opened.evaluate(GROUND), [opened.evaluate(PLACES)]
    for key, value in (("ArrowRight", 290), ("End", 310)):
        opened.locator("#member").press(key)
        shows(opened, folder, value)
        assert opened.evaluate(GROUND) == place
        seen.append(opened.evaluate(PLACES))
    assert len({str(places) for places in seen}) == 3
    opened.locator("#moving").check()
    before = opened.evaluate(PLACES)
    opened.wait_for_function(f"JSON.stringify({PLACES}) !== JSON.stringify({before})")


def test_a_row_or_a_line_chooses_its_member(opened: "Page", folder: Path) -> None:
    opened.locator("#rows tr:has(th:text-is('290'))").click()
    shows(opened, folder, 290)
    opened.locator("#rows tr:has(th:text-is('250'))").click()  # which cannot run
    shows(opened, folder, 290)
    opened.evaluate("document.querySelector('#curves .u-over').scrollIntoView({ block: 'center' })")
    x, y = opened.evaluate(
        """() => { const { u, traces: [{ X, Y }] } = document.querySelector('#curves .plot').plot.panels[0];
          const n = X.length >> 1, box = u.over.getBoundingClientRect();
          return [box.left + u.valToPos(X[n], 'x'), box.top + u.valToPos(Y[n], 'y')]; }"""
    )
    opened.mouse.move(x, y)
    assert "O-P3 = 270: " in opened.locator("#curves .hover").first.inner_text()
    opened.mouse.click(x, y)
    shows(opened, folder, 270)


def test_a_place_is_shown(opened: "Page") -> None:
    """The picture stops there."""
    pin = "document.querySelector('#chosen [data-point=P5]:not([data-turn])')"
    height = f"new DOMMatrix(getComputedStyle({pin}).transform).f"
    opened.locator("tr:has(th:text-is('Closed dead point')) .go").click()
    closed = opened.evaluate(height)
    opened.locator("tr:has(th:text-is('Open dead point')) .go").click()
    assert opened.evaluate("document.getElementById('moving').checked") is False
    assert opened.evaluate(height) < closed - 50


@pytest.mark.parametrize("width", [390, 1400])
def test_the_first_screen_fits(opened: "Page", width: int) -> None:
    opened.set_viewport_size({"width": width, "height": 900})
    assert opened.evaluate("document.documentElement.scrollWidth") == width
    assert opened.locator(".verdict").inner_text().startswith("≈ Agrees in part\nMembers that do not run: 1 of 4")
    assert "O-P3 = 250: cannot_assemble" in opened.locator("#members li").all_inner_texts()[1]


def test_the_first_member_is_there_without_a_script(browser: "Browser", folder: Path) -> None:
    page = browser.new_context(java_script_enabled=False).new_page()
    page.goto((folder / "family.html").as_uri())
    assert page.locator("#chosen svg.linkage").is_visible()
    assert page.locator("#chosen h3").inner_text() == "O-P3 = 270"
    assert not page.locator(".player").is_visible()
    page.context.close()


def test_no_motion_is_offered_where_less_is_asked_for(browser: "Browser", folder: Path) -> None:
    with silent(browser, folder / "family.html", reduced_motion="reduce") as page:
        page.wait_for_selector("#member")
        assert page.locator("#moving").is_hidden()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessible_by_axe(opened: "Page", scheme: Any) -> None:
    assert found_by_axe(opened, scheme) == []
