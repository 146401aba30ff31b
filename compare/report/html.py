"""The parts of a page: its head, sections, figures, tables, lists."""

from base64 import b64encode
from collections.abc import Iterable, Mapping
from functools import cache
from gzip import compress
from html import escape
from importlib.resources import files
from string import Template

import numpy as np
import pandas as pd
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from ..engines.environment import environment
from .extremes import CURVE, thinned

ROWS = 200  # of a table, at most


def template(package: str, name: str) -> Template:
    """Return a template that lies beside the modules of a package."""
    return Template((files(package) / name).read_text(encoding="utf-8"))


def head(title: str) -> str:
    """Return the start of a self-contained page, open for further elements of its head."""
    return template("compare.report", "head.html").substitute(title=escape(title), plotly=_library())


@cache
def _library() -> str:
    return _packed(get_plotlyjs())


def _packed(text: str) -> str:
    """Return a text as gzip in base64, a third of its size, for the script in the page's head to unpack."""
    return b64encode(compress(text.encode(), mtime=0)).decode()


def figure_html(figure: go.Figure, most: int = CURVE) -> str:
    """Return a figure as wide as the page, of at most so many points a curve; it scrolls on a narrow screen."""
    return f'<div class="scroll wide">{_plot(figure, most)}</div>'


def _plot(figure: go.Figure, most: int) -> str:
    height = figure.layout.height or 450
    packed = _packed(thinned(figure, most).to_json(validate=False))
    script = f'<script type="application/gzip">{packed}</script>'
    return f'<div class="plotly-graph-div" style="height: {height}px">{script}</div>'


def section_html(title: str, figure: go.Figure, note: str = "", most: int = CURVE) -> str:
    """Return a titled figure with a note above it, for a grid of figures."""
    source = f'<p class="source">{escape(note)}</p>' if note else ""
    return f"<section><h3>{escape(title)}</h3>{source}{_plot(figure, most)}</section>"


def table_html(table: pd.DataFrame, kind: str = "", *, worst: str = "", whole: str = "the JSON file") -> str:
    """Return a table of numbers, or one of `kind` text, whose cells may break into lines.

    Of a long table it has the first rows, or those with the largest numbers in the column `worst`; NaN is the largest.
    """
    if len(table) > ROWS:
        size = -table[worst].fillna(np.inf).to_numpy() if worst else np.zeros(len(table))
        order = np.argsort(size, kind="stable")[:ROWS]
        which = f"with the largest {worst}" if worst else "that come first"
        some = f"<p>The {ROWS} rows {escape(which)}, of {len(table):,}; all are in {escape(whole)}.</p>"
        return some + table_html(table.iloc[order], kind)
    if table.empty:
        return "<p>None.</p>"
    html = table.to_html(index=False, border=0, na_rep="–", float_format=lambda value: f"{value:.3g}", justify="right")
    return f'<div class="scroll {kind}">{html}</div>'


def list_html(sentences: Iterable[str]) -> str:
    """Return sentences as a list; of very many the first."""
    written = [*sentences]
    if len(written) > ROWS:
        written = [*written[:ROWS], f"And {len(written) - ROWS:,} more, in the files beside this page."]
    return f"<ul>{''.join(f'<li>{escape(sentence)}</li>' for sentence in written)}</ul>"


def details_html(summary: str, content: str, *, opened: bool = False) -> str:
    """Return HTML that is hidden until the reader opens its summary."""
    return f"<details{' open' * opened}><summary>{escape(summary)}</summary>{content}</details>"


def versions_html(engines: Mapping[str, str] | None = None) -> str:
    """Return the versions of engines, where given, and of all else that a page was made on."""
    versions = dict(engines or {}) | environment()
    return table_html(pd.DataFrame(versions.items(), columns=["environment", "version"]), "text")
