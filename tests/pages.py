"""Pages: what is packed in them, one in a browser, and what a reader changes there."""

import gzip
import json
import re
from base64 import b64decode
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

WITHIN = ("data:", "blob:")  # of an address in the page itself: a picture of a figure
DRAWN = """async () => {
  for (const plot of document.querySelectorAll('.plot')) {
    plot.scrollIntoView();
    while (!plot.querySelector('.uplot')) await new Promise(requestAnimationFrame);
  }
  scrollTo(0, 0);
}"""


def unpacked(text: str) -> list[str]:
    """The library and all figures of a page, as JSON."""
    packed = dict(re.findall(r'<script type="application/gzip" id="(\w+)">([^<]*)</script>', text))
    figures, library = (gzip.decompress(b64decode(packed[name])).decode() for name in ("figures", "uplot"))
    return [library, *(json.dumps(figure, separators=(",", ":")) for figure in json.loads(figures))]


def check_figures(text: str) -> None:
    """Check that a page has figures, and that plotly takes each of them as it is."""
    import plotly.graph_objects as go

    _, *figures = unpacked(text)
    assert figures
    for figure in map(json.loads, figures):
        taken = json.loads(go.Figure(figure).to_json())
        del taken["layout"]["template"]
        assert taken == figure


def draw_all(page: "Page") -> None:
    """Have every figure drawn, as for a reader who scrolls to the end."""
    page.evaluate(DRAWN)


def without_scripts(text: str) -> str:
    """A page without its scripts, and what is packed in them."""
    return re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL)


@contextmanager
def silent(browser: "Browser", path: Path, **context: Any) -> "Iterator[Page]":
    """Yield a page; at the end nothing was written to the console, and nothing but itself was requested."""
    page, heard = browser.new_page(**context), list[str]()
    page.on("console", lambda message: heard.append(message.text))
    page.on("pageerror", lambda error: heard.append(str(error)))
    page.on("request", lambda request: heard.append(request.url) if not request.url.startswith(WITHIN) else None)
    page.goto(path.as_uri())
    yield page
    page.close()
    assert heard == [path.as_uri()], heard


def pin(page: "Page", point: str) -> complex:
    """Where the picture shows a pin, px."""
    box = page.locator(f"#linkage [data-point={point}] > .pin").bounding_box()
    assert box is not None
    return complex(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)


def typed(page: "Page", path: str, value: float) -> None:
    page.locator(f'#bench input[aria-label^="{path} in"]').fill(str(value))


def now(page: "Page", name: str) -> list[str]:
    """The cells of a row: as judged, now, change, where."""
    return page.locator("#bench .asked tr", has_text=name).locator("td").all_text_contents()


def found_by_axe(page: "Page", scheme: Any) -> list[Any]:
    """What axe-core finds on a page, light or dark: each rule, and where; the page is light again."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe-playwright-python is not installed")
    page.emulate_media(color_scheme=scheme)
    violations = axe.Axe().run(page, None, {"resultTypes": ["violations"]}).response["violations"]
    page.emulate_media(color_scheme="light")
    return [(rule["id"], [node["target"] for node in rule["nodes"]][:3]) for rule in violations]
