"""The page: one self-contained HTML file, opened from disk with no network."""

from html import escape

import pandas as pd
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from scenes.scene import ConstantSpeed

from ..engines.axis import axis, cycle_name, position_name
from ..engines.environment import environment
from ..speed.ladders import SAMPLING
from ..speed.work_precision import TIE
from ..study import Study
from . import tables
from .curves import assur_groups, over_angle, panels
from .hard.section import section as hard_section
from .hard.stability import stability_maps
from .html import figure_html, table_html, template
from .linkage import linkage
from .lock import over_distance
from .speed import tables as speed_tables
from .speed.figure import work_precision

ONLY_ANALYTIC = (
    "By the inner joint of each group. From the reference: only the analytic core knows Assur groups. To lock: by how"
    " much the nearest length, or guide, would have to be off for the group to lock as it stands."
)

EXPLAINED = (
    "Explained by doubles: the condition of the constraint Jacobian times the unit round-off, or how far the motion"
    " moves when the scene's numbers are off by a few last places. Only what is above it is a fault."
)

STABILITY = """<p>The largest relative error of single runs without extrapolation, or how they failed. The sweeps that
pymunk needs by theory follow from the spectral radius &rho; of block Gauss-Seidel in its own space, &beta; being the
part of a joint's error that a step corrects.</p>"""


def page(study: Study) -> str:
    """Return the whole report as HTML."""
    scene = study.scene
    curves = "".join(
        _section(panel.title, over_angle(study, panel)) for panel in panels(study.reference, study.sampling)
    )
    locks, near = assur_groups(study), over_distance(study)
    if locks is not None:
        curves += _section("Assur groups: transmission angle, and distance to lock", locks, ONLY_ANALYTIC)
    if near is not None:
        curves += _section("Errors against the distance to lock", near, EXPLAINED)
    return template("compare.report", "page.html").substitute(
        title=escape(scene.title),
        source=escape(scene.source),
        setup=escape(tables.setup(study)),
        verdict=escape(tables.verdict(study)),
        notes="".join(f"<li>{escape(note)}</li>" for note in tables.notes(study)),
        overview=table_html(tables.overview(study)),
        gates=table_html(study.gates),
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
        stability=_stability(study),
        hard=hard_section(study.hard),
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


def _stability(study: Study) -> str:
    if study.maps.empty:
        return ""
    sections = "".join(_section(title, figure) for title, figure in stability_maps(study.maps))
    return f'<h2>Where the engines are stable</h2>{STABILITY}<div class="grid">{sections}</div>'


def _section(title: str, figure: go.Figure, note: str = "") -> str:
    said = f'<p class="source">{escape(note)}</p>' if note else ""
    return f"<section><h3>{escape(title)}</h3>{said}{figure_html(figure)}</section>"
