"""The page: one self-contained HTML file, opened from disk with no network."""

from html import escape
from importlib.resources import files
from string import Template

import pandas as pd
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from . import tables
from .drawing import linkage
from .environment import environment
from .figures import over_angle, panels, speed_against_error
from .study import Study


def page(study: Study) -> str:
    """Return the whole report as HTML."""
    template = Template((files("compare") / "report.html").read_text(encoding="utf-8"))
    scene = study.scene
    curves = [(panel.title, over_angle(study, panel)) for panel in panels(study.reference)]
    return template.substitute(
        title=escape(scene.title),
        source=escape(scene.source),
        setup=escape(tables.setup(study)),
        verdict=escape(tables.verdict(study)),
        notes="".join(f"<li>{escape(note)}</li>" for note in tables.notes(study)),
        overview=_table(tables.overview(study)),
        gates=_table(tables.gates(study)),
        linkage=_figure(linkage(study)),
        curves="".join(f"<section><h3>{escape(title)}</h3>{_figure(figure)}</section>" for title, figure in curves),
        groups=_table(tables.by_group(study)),
        channels=_table(study.errors),
        checks=_table(tables.checks(study)),
        residuals=_table(tables.residuals(study)),
        speed_figure=_figure(speed_against_error(study)),
        speed=_table(study.speed),
        settings=_table(tables.settings(study), "text"),
        environment=_table(pd.DataFrame(environment().items(), columns=["environment", ""]), "text"),
        plotly=get_plotlyjs(),
    )


def _figure(figure: go.Figure) -> str:
    return str(
        figure.to_html(full_html=False, include_plotlyjs=False, config={"displayModeBar": False, "responsive": True})
    )


def _table(table: pd.DataFrame, kind: str = "") -> str:
    if table.empty:
        return "<p>None.</p>"
    html = table.to_html(index=False, border=0, na_rep="–", float_format=lambda value: f"{value:.3g}", justify="right")
    return f'<div class="scroll {kind}">{html}</div>'
