"""The parts of a page: its head, sections, figures, tables, lists."""

from collections.abc import Iterable, Mapping
from html import escape
from importlib.resources import files
from string import Template

import pandas as pd
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from ..engines.environment import environment


def template(package: str, name: str) -> Template:
    """Return a template that lies beside the modules of a package."""
    return Template((files(package) / name).read_text(encoding="utf-8"))


def head(title: str) -> str:
    """Return the start of a self-contained page, open for further elements of its head."""
    return template("compare.report", "head.html").substitute(title=escape(title), plotly=get_plotlyjs())


def figure_html(figure: go.Figure) -> str:
    """Return a figure as wide as the page; it scrolls on a narrow screen."""
    return f'<div class="scroll wide">{_plot(figure)}</div>'


def _plot(figure: go.Figure) -> str:
    config = {"displayModeBar": False, "responsive": True}
    return str(figure.to_html(full_html=False, include_plotlyjs=False, config=config))


def section_html(title: str, figure: go.Figure, note: str = "") -> str:
    """Return a titled figure with a note above it, for a grid of figures."""
    source = f'<p class="source">{escape(note)}</p>' if note else ""
    return f"<section><h3>{escape(title)}</h3>{source}{_plot(figure)}</section>"


def table_html(table: pd.DataFrame, kind: str = "") -> str:
    """Return a table of numbers, or one of `kind` text, whose cells may break into lines."""
    if table.empty:
        return "<p>None.</p>"
    html = table.to_html(index=False, border=0, na_rep="–", float_format=lambda value: f"{value:.3g}", justify="right")
    return f'<div class="scroll {kind}">{html}</div>'


def list_html(sentences: Iterable[str]) -> str:
    """Return sentences as a list."""
    return f"<ul>{''.join(f'<li>{escape(sentence)}</li>' for sentence in sentences)}</ul>"


def details_html(summary: str, content: str, *, opened: bool = False) -> str:
    """Return HTML that is hidden until the reader opens its summary."""
    return f"<details{' open' * opened}><summary>{escape(summary)}</summary>{content}</details>"


def versions_html(engines: Mapping[str, str] | None = None) -> str:
    """Return the versions of engines, where given, and of all else that a page was made on."""
    versions = dict(engines or {}) | environment()
    return table_html(pd.DataFrame(versions.items(), columns=["environment", "version"]), "text")
