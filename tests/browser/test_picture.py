"""The picture of the moving linkage in a browser: where its names and values find room, and as a file."""

import re
from base64 import b64encode
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import scenes
from compare.report.output import files
from tests.chain import chain
from tests.comparisons import SLOW, studied
from tests.pages import silent

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = pytest.mark.browser

PIXELS = """async ([data, kind]) => { // of a picture, or of a film after a second: its corner, how many are of a force
  const film = kind === "film", shown = document.createElement(film ? "video" : "img");
  shown.muted = true;
  const shows = new Promise(done => (shown[film ? "onloadeddata" : "onload"] = done));
  shown.src = `data:${film ? "video/webm" : "image/svg+xml"};base64,${data}`;
  await shows;
  if (film) await Promise.all([shown.play(), new Promise(done => setTimeout(done, 1000))]);
  const sheet = Object.assign(document.createElement("canvas"), { width: 900, height: 900 });
  const pen = sheet.getContext("2d");
  pen.drawImage(shown, 0, 0);
  const all = pen.getImageData(0, 0, 900, 900).data;
  let force = 0;
  for (let k = 0; k < all.length; k += 4) {
    force += all[k] > 140 && all[k + 1] < 80 && all[k + 2] < 120 && all[k + 3] > 200;
  }
  return { corner: [...all.slice(0, 4)], force };
}"""


@pytest.mark.parametrize(("button", "begins"), [("svg", b"<svg"), ("film", bytes.fromhex("1a45dfa3"))])
def test_the_picture_is_saved(report: "Page", tmp_path: Path, button: str, begins: bytes) -> None:
    """As it stands, with its own style; or as a film, a WebM file."""
    with report.expect_download(timeout=60_000) as download:
        report.locator(f"#linkage button.{button}").click()
    file = tmp_path / download.value.suggested_filename
    download.value.save_as(file)
    assert file.read_bytes().startswith(begins)
    pixels = report.evaluate(PIXELS, [b64encode(file.read_bytes()).decode(), button])
    panel = report.evaluate("getComputedStyle(document.querySelector('.card')).backgroundColor")
    colours = [int(part) for part in re.findall(r"\d+", panel)]
    assert np.abs(np.array(pixels["corner"][:3]) - colours).max() <= 4, "the ground is that of the page"
    assert 50 < pixels["force"] < 20_000, "arrows and values in their colour, of one pose"


def labelled_wrongly(page: "Page") -> list[Any]:
    """What is wrong at any sample: texts on each other or cut off, arrows without their values."""
    wrong: list[Any] = page.evaluate(
        """() => {
          const slider = document.querySelector("#linkage [type=range]"), wrong = [];
          const svg = document.querySelector("#linkage svg"), frame = svg.getBoundingClientRect();
          const shown = kind => [...svg.querySelectorAll(kind)].filter(e => !e.style.display);
          for (let n = 0; n <= +slider.max; n++) {
            slider.value = n;
            slider.dispatchEvent(new Event("input"));
            const texts = shown("text").filter(e => e.textContent).map(e => e.getBoundingClientRect());
            const across = (a, b) => a.left < b.right - 1 && b.left < a.right - 1;
            const meet = a => b => across(a, b) && a.top < b.bottom - 2 && b.top < a.bottom - 2;
            if (texts.some((a, k) => texts.slice(k + 1).some(meet(a)))) wrong.push(["overlap", n]);
            if (texts.some(a => a.left < frame.left - 1 || a.right > frame.right + 1)) wrong.push(["cut off", n]);
            if (shown(".value").length !== shown(".force:has(.head)").length) wrong.push(["without a value", n]);
          }
          return wrong;
        }"""
    )
    return wrong


def test_every_arrow_has_its_value_and_no_text_lies_on_another(report: "Page") -> None:
    assert labelled_wrongly(report) == []


@SLOW
@pytest.mark.parametrize("width", [390, 1400])
def test_many_forces_and_long_names_find_room(width: int, browser: "Browser", tmp_path: Path) -> None:
    """Of seventeen links; the text below the picture counts the forces that do not, which are the smaller ones."""
    file = chain(8, tmp_path)
    file.write_text(re.sub(r"\bT(\d+)", r"Middle_of_rocker_\1", file.read_text()))
    place = files.write(studied(scenes.load(file), ["analytic"]), tmp_path)
    with silent(browser, place / "report.html", viewport={"width": width, "height": 900}) as page:
        page.wait_for_selector("#linkage .player:not([hidden])")
        assert labelled_wrongly(page) == []
        values = page.locator("#linkage svg .value:visible").count()
        left = re.search(r"No room for (\d+) smaller ones", page.inner_text(".now"))
        assert values > 4  # of four digits each
        assert left is not None or width > 1000
