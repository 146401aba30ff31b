"""The README's first screen of the toggle press as one SVG: `python -m benchmarks.publishing.first_screen`."""

from html import escape
from pathlib import Path
from textwrap import wrap

import compare
from compare.report.notebook import COLUMNS, CheckResult
from compare.report.numbers import units
from compare.report.pages.html import MARKS
from compare.report.tables.first_screen import answers

FILE = Path(__file__).parents[2] / "results" / "published" / "first_screen.svg"
PLACES, ROW = ((420, ""), (770, "value"), (790, ""), (980, "end")), 27  # of columns, px, with their class; px
STYLE = """.linkage .page text { stroke: none; font-size: 14px; } .page path { stroke: var(--soft); stroke-width: 0.3; }
.linkage .page .title { font-size: 20px; font-weight: 700; } .linkage .page .word { fill: var(--ok); font-weight: 700; }
.linkage .page :is(.value, .end) { text-anchor: end; } .linkage .page .value { fill: var(--ink); font-weight: 600; }"""


def first_screen(result: CheckResult) -> str:
    """Return verdict, moving linkage and the designer's numbers of a result."""
    verdict = result.agreement
    whole, _ = answers(result.scene, result.peaks, units(result.reference))
    table = [COLUMNS, *(answer.cells for answer in whole)]
    parts = [_text(25, 38, result.scene.title, "title"), _text(25, 72, f"{MARKS[verdict.word]} {verdict.word}", "word")]
    parts += [_text(120, 72 + 20 * n, line) for n, line in enumerate(wrap(verdict.sentence, 115))]
    for y, cells in zip(range(135, 1000, ROW), table, strict=False):
        parts += [_text(x, y, cell, kind) for (x, kind), cell in zip(PLACES, cells, strict=True)]
        parts.append(f'<path d="M420 {y + 9}H980"/>')
    drawing = result.svg().replace("<svg ", '<svg x="15" y="105" ', 1)
    inside = f'<style>{STYLE}</style>{drawing}<g class="page">{"".join(parts)}</g>'
    size = f'viewBox="0 0 1000 {max(610, 160 + ROW * len(table))}" width="1000" class="linkage"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{inside}</svg>\n'


def _text(x: int, y: int, words: str, kind: str = "") -> str:
    return f'<text x="{x}" y="{y}" class="{kind}">{escape(words)}</text>'


if __name__ == "__main__":
    FILE.write_text(first_screen(compare.check("toggle_press")), encoding="utf-8")
