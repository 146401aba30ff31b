"""The report in a real browser: still, self-contained, readable at every width, in the dark, on paper and aloud."""

import re
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unicodedata import normalize

import pytest

from compare.report.output import files
from scenes import load
from scenes.limits import NAME
from tests import scene_files
from tests.comparisons import studied
from tests.pages import found_by_axe, silent

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

WIDTHS = (390, 1400, 1920)  # px
LEGIBLE = 4.5  # contrast, by WCAG 2.1 AA

CONTRASTS = """() => {
  const context = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
  const rgba = colour => {
    context.clearRect(0, 0, 1, 1);
    context.fillStyle = colour;
    context.fillRect(0, 0, 1, 1);
    return [...context.getImageData(0, 0, 1, 1).data];
  };
  const luminance = ([r, g, b]) => [r, g, b]
    .map(c => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, k) => sum + [0.2126, 0.7152, 0.0722][k] * c, 0);
  const behind = element => {
    for (let e = element; e; e = e.parentElement) {
      const fill = rgba(getComputedStyle(e).backgroundColor);
      if (fill[3] === 255) return fill;
    }
    return [255, 255, 255];
  };
  const contrasts = {}, walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement, style = getComputedStyle(element);
    if (!walker.currentNode.data.trim() || !element.getClientRects().length || style.visibility === 'hidden') continue;
    if (element.closest('script, style, title, option')) continue;
    const [text, ground] = [rgba(element.closest('svg') ? style.fill : style.color), behind(element)];
    const [light, dark] = [luminance(text), luminance(ground)].sort((a, b) => b - a);
    const name = `${text.slice(0, 3)} on ${ground.slice(0, 3)}: ${walker.currentNode.data.trim().slice(0, 30)}`;
    contrasts[`${text} on ${ground}`] = [(light + 0.05) / (dark + 0.05), name];
  }
  return Object.values(contrasts);
}"""


def test_the_answers_are_on_the_first_screen(browser: "Browser", press_report: Path) -> None:
    """Whether the models agree, the largest pin force and its place, the torque that the drive needs."""
    page = browser.new_page(viewport={"width": 1400, "height": 900}, reduced_motion="reduce")
    page.goto((press_report / "report.html").as_uri())
    for selector, wanted in (
        (".verdict", r"✓ Agrees\s*exudyn and pymunk agree with the closed form to 0\.0\d+ %"),
        ("tr:has(th:text-is('Largest pin force'))", r"382\.0 kN\s+P1\s+204\.7°\s+\de-\d"),
        ("tr:has(th:text-is('Peak driving torque'))", r"11\.448 kN m\s+255\.\d°\s+\de-\d"),
        ("tr:has(th:text-is('Peak braking torque'))", r"−13\.888 kN m\s+162\.8°\s+\de-\d"),
        ("tr:has(th:has-text('pymunk')):has(.go)", r"ok\s+0\.\d+ %\s+P5\.a[xy]\s+\d+(\.\d)?°"),
    ):
        place = page.locator(selector).first
        box = place.bounding_box()
        assert box is not None
        assert box["y"] + box["height"] <= 900, selector
        assert re.search(wanted, place.inner_text()), place.inner_text()
    page.close()


@pytest.mark.parametrize("width", WIDTHS)
def test_no_sideways_scrolling(report: "Page", width: int) -> None:
    report.set_viewport_size({"width": width, "height": 900})
    report.evaluate("document.querySelectorAll('details').forEach(part => (part.open = true))")
    assert report.evaluate("document.documentElement.scrollWidth") == width
    outside = report.evaluate(
        """() => [...document.querySelectorAll('main *')].filter(e => !e.closest('.scroll, svg')
          && e.getBoundingClientRect().right > innerWidth + 1).map(e => e.outerHTML.slice(0, 80))"""
    )
    assert outside == []
    report.evaluate("document.querySelectorAll('details').forEach(part => (part.open = false))")
    report.set_viewport_size({"width": 1400, "height": 900})


def test_names_as_long_as_may_be_are_broken(browser: "Browser", tmp_path: Path) -> None:
    """Of a body in a sentence, of a limit beside the verdict, and of a title that is one word."""
    name, body = "W" * NAME, {"points": {"O": [0, 0], "W" * NAME: [2, 0]}, "mass": 4}
    limits, named = {f"{name}.speed": {"most": 1}}, {"bodies": {name: body}, "drive.body": name, "title": name}
    changes = named | {"sketch": {name: [2, 0]}, "output.point": name, "limits": limits}
    path = files.write(studied(load(scene_files.write(tmp_path, "crank", changes))), tmp_path) / "report.html"
    with silent(browser, path, viewport={"width": 390, "height": 900}) as page:
        assert page.locator(".verdict", has_text=name).count()
        assert page.evaluate("document.documentElement.scrollWidth") == 390


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_all_text_is_legible(report: "Page", scheme: Any) -> None:
    """Texts of figures and of the linkage too, against the ground behind them."""
    report.emulate_media(color_scheme=scheme)
    contrasts = report.evaluate(CONTRASTS)
    assert len(contrasts) >= 8
    assert [name for contrast, name in contrasts if not (contrast >= LEGIBLE)] == []
    report.emulate_media(color_scheme="light")


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessible_by_axe(report: "Page", scheme: Any) -> None:
    assert found_by_axe(report, scheme) == []


def test_every_figure_is_in_words(report: "Page") -> None:
    labels = report.evaluate(
        "[...document.querySelectorAll('.plot, svg.linkage')].map(e => [e.getAttribute('role'), e.ariaLabel])"
    )
    assert len(labels) == 16
    assert all(role in ("img", "figure") and label for role, label in labels)
    (pin,) = [label for _, label in labels if label.startswith("Pin P1:")]
    assert re.search(r"force \[kN\]: from −[\d.]+ \([xy]\) at [\d.]+ to 382 \(magnitude\) at 20\d", pin)
    assert re.search(r"relative error \[-\]: from .* to \de-\d \(pymunk error\) at \d+", pin)


@pytest.mark.slow
def test_paper_has_every_column(report: "Page") -> None:
    """First the verdict, the picture and the numbers; then every heading of every table, none of it cut off."""
    pypdf = pytest.importorskip("pypdf", reason="pypdf is not installed")
    pages = [normalize("NFKC", page.extract_text()) for page in pypdf.PdfReader(BytesIO(report.pdf(format="A4"))).pages]
    for wanted in ("Agrees", "Largest pin force", "382.0 kN", "Largest force at P1", "pymunk"):
        assert wanted in pages[0]
    assert "Motion and forces" not in pages[0]
    printed = re.sub(r"\s", "", "".join(pages))
    paper = "th[scope=col]:not(#bench *)"  # the page's own solution is for a screen
    headings = report.evaluate(f"[...document.querySelectorAll('{paper}')].map(e => e.textContent)")
    assert len(headings) > 80
    assert [heading for heading in headings if re.sub(r"\s", "", normalize("NFKC", heading)) not in printed] == []
    report.set_viewport_size({"width": 1047, "height": 900})  # px of the longer side of A4 within its margins
    report.emulate_media(media="print")
    cut = "[...document.querySelectorAll('.scroll:has(table)')].filter(e => e.scrollWidth > innerWidth)"
    assert report.evaluate(f"{cut}.map(e => [e.ariaLabel, e.scrollWidth])") == []
    report.emulate_media(media="screen")
    report.set_viewport_size({"width": 1400, "height": 900})


def test_nothing_is_hidden_again_after_printing(report: "Page") -> None:
    for media in ("print", "screen"):
        report.emulate_media(media=media)
        assert report.evaluate("document.querySelector('.desk').getAnimations().length") == 0, media
