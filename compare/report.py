"""The page: one self-contained HTML file, opened from disk with no network."""

from html import escape
from importlib.resources import files
from string import Template

import pandas as pd
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from scenes.scene import ConstantSpeed

from . import speed_tables, tables
from .drawing import linkage
from .environment import environment
from .figures import assur_groups, over_angle, panels
from .speed import SAMPLING
from .speed_figure import work_precision
from .study import Study
from .units import axis, cycle_name, position_name
from .work_precision import TIE

ONLY_ANALYTIC = (
    "By the inner joint of each group. From the reference: only the analytic core knows Assur groups. To lock: by how"
    " much the nearest length, or guide, would have to be off for the group to lock as it stands."
)


def page(study: Study) -> str:
    """Return the whole report as HTML."""
    template = Template((files("compare") / "report.html").read_text(encoding="utf-8"))
    scene = study.scene
    curves = "".join(_section(panel.title, over_angle(study, panel)) for panel in panels(study.reference))
    locks = assur_groups(study)
    if locks is not None:
        curves += _section("Assur groups: transmission angle, and distance to lock", locks, ONLY_ANALYTIC)
    return template.substitute(
        title=escape(scene.title),
        source=escape(scene.source),
        setup=escape(tables.setup(study)),
        verdict=escape(tables.verdict(study)),
        notes="".join(f"<li>{escape(note)}</li>" for note in tables.notes(study)),
        overview=table_html(tables.overview(study)),
        gates=table_html(tables.gates(study)),
        linkage=figure_html(linkage(study)),
        axis=escape(axis(scene).quantity),
        position=escape(position_name(scene)),
        steady="" if isinstance(scene.drive, ConstantSpeed) else ", as if the drive were steady",
        springs=", springs" if scene.springs else "",
        scales=escape(tables.scales(scene)),
        curves=curves,
        groups=table_html(tables.by_group(study)),
        channels=table_html(study.errors),
        checks=table_html(tables.checks(study)),
        residuals=table_html(tables.residuals(study)),
        speed_verdict=escape(speed_tables.verdict(study)),
        speed_figure=figure_html(work_precision(study)),
        cheapest=_cheapest(study),
        speed_notes="".join(f"<li>{escape(note)}</li>" for note in speed_tables.notes(study)),
        orders=table_html(speed_tables.orders(study)),
        step_costs=table_html(speed_tables.step_costs(study)),
        ablations=table_html(speed_tables.ablations(study)),
        speed=table_html(study.speed),
        speed_samples=SAMPLING.samples,
        cycle=cycle_name(scene),
        tie=f"{TIE:.0%}".replace("%", " %"),
        settings=table_html(tables.settings(study), "text"),
        environment=table_html(pd.DataFrame(environment().items(), columns=["environment", ""]), "text"),
        plotly=get_plotlyjs(),
    )


def _cheapest(study: Study) -> str:
    tables = speed_tables.cheapest_settings(study).items()
    first = speed_tables.said_group(study)
    said = (
        f"<details{' open' * (group == first)}><summary>{group}</summary>{table_html(table, 'text')}</details>"
        for group, table in tables
    )
    return "".join(said)


def _section(title: str, figure: go.Figure, note: str = "") -> str:
    said = f'<p class="source">{escape(note)}</p>' if note else ""
    return f"<section><h3>{escape(title)}</h3>{said}{figure_html(figure)}</section>"


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
