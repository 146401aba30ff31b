"""Pieces of a page: templates, figures and tables."""

from importlib.resources import files
from string import Template

import pandas as pd
import plotly.graph_objects as go


def template(package: str, name: str) -> Template:
    """Return a template that lies beside the modules of a package."""
    return Template((files(package) / name).read_text(encoding="utf-8"))


def figure_html(figure: go.Figure) -> str:
    """Return a figure as a piece of a page."""
    return str(
        figure.to_html(full_html=False, include_plotlyjs=False, config={"displayModeBar": False, "responsive": True})
    )


def table_html(table: pd.DataFrame, kind: str = "") -> str:
    """Return a table as a piece of a page."""
    if table.empty:
        return "<p>None.</p>"
    html = table.to_html(index=False, border=0, na_rep="–", float_format=lambda value: f"{value:.3g}", justify="right")
    return f'<div class="scroll {kind}">{html}</div>'
