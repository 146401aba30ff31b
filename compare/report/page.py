"""The page: one self-contained HTML file, opened from disk with no network."""

from collections.abc import Iterable, Iterator, Sequence
from html import escape

import plotly.graph_objects as go

from scenes.scene import ConstantSpeed

from ..engines.axis import axis, cycle_name, position_name
from ..speed.speed_table import SAMPLING
from ..speed.work_precision import NEAR, TIE
from ..study import Study
from . import tables
from .curves import Panel, chosen, over_angle
from .extremes import affordable
from .hard.section import hard_section, stability_section
from .html import details_html, figure_html, head, list_html, section_html, table_html, template, versions_html
from .linkage import linkage
from .singular import assur_groups, over_distance
from .speed import tables as speed_tables
from .speed.figure import work_precision

TABLES = (
    *(tables.overview, tables.sketch, tables.by_group, tables.checks, tables.residuals),
    *(speed_tables.orders, speed_tables.step_costs, speed_tables.ablations),
)  # each at the place of its name in the template

ONLY_ANALYTIC = (
    "By the inner joint of each group, from the reference: only the analytic core knows Assur groups. To lock: by how"
    " much the nearest length, or guide, would have to be off for the pose to be a singular configuration of the group."
)

ROUND_OFF = (
    "Explained by round-off: the condition of the constraint Jacobian times the unit round-off, or how far the motion"
    " moves when the scene's numbers are off by a few last places. Only what is above it is a fault."
)


def page(study: Study) -> str:
    """Return the whole report as HTML."""
    scene, (drawn, left_out) = study.scene, chosen(study)
    picture, sections = linkage(study), list(_sections(study, drawn))
    most = affordable([picture, *(figure for _, figure, _ in sections)])
    return template("compare.report", "page.html").substitute(
        {table.__name__: table_html(table(study)) for table in TABLES},
        head=head(scene.title),
        title=escape(scene.title),
        source=escape(scene.source),
        setup=escape(tables.setup(study)),
        verdict=escape(tables.verdict(study)),
        notes=list_html(tables.notes(study)),
        gates=table_html(study.gates),
        linkage=figure_html(picture, most),
        axis=escape(axis(scene).quantity),
        position=escape(position_name(scene)),
        steady="" if isinstance(scene.drive, ConstantSpeed) else ", as if the drive were steady",
        springs=", springs" if scene.springs else "",
        scales=escape(tables.scales(scene)),
        curves="".join(section_html(title, figure, note, most) for title, figure, note in sections),
        not_drawn=escape(_not_drawn(study, most, left_out)),
        channels=table_html(study.errors, worst="max", whole="errors.csv"),
        speed_verdict=escape(speed_tables.verdict(study)),
        speed_figure=figure_html(work_precision(study)),
        cheapest=_cheapest(study),
        speed_notes=list_html(speed_tables.notes(study)),
        speed=table_html(study.speed, whole="speed.csv"),
        speed_samples=SAMPLING.samples,
        cycle=cycle_name(scene),
        level=f"{100 * NEAR:.0f} %",
        tie=f"{100 * TIE:.0f} %",
        stability=stability_section(study.maps),
        hard=hard_section(study.hard),
        settings=table_html(tables.settings(study), "text"),
        environment=versions_html(),
    )


def _sections(study: Study, drawn: Iterable[Panel]) -> Iterator[tuple[str, go.Figure, str]]:
    """Yield title, figure and note of the panels, and of the figures of singular configurations."""
    for panel in drawn:
        yield panel.title, over_angle(study, panel), ""
    groups, distance = assur_groups(study), over_distance(study)
    if groups is not None:
        yield "Assur groups: transmission angle, and distance to the singular configuration", groups, ONLY_ANALYTIC
    if distance is not None:
        yield "Errors against the distance to the singular configuration", distance, ROUND_OFF


def _not_drawn(study: Study, most: int, left_out: Sequence[Panel]) -> str:
    """Return what of the motion is not drawn, in a sentence or two."""
    sentences, count = [], study.sampling.count
    if count > most:
        sentences.append(
            f"Drawn: at most {most:,} of {count:,} samples a curve, with the first, last, least and largest of every"
            " stretch. All tables are of all samples."
        )
    if left_out:
        names = ", ".join(channel for panel in left_out for channel in panel.judged)
        sentences.append(f"Not drawn, since their errors are smaller than those of the joints here: {names}.")
    return " ".join([*sentences, "Every sample is in motion.*.csv."]) if sentences else ""


def _cheapest(study: Study) -> str:
    """Return the cheapest settings of every channel group, that of the sentence opened."""
    main = speed_tables.main_group(study)
    return "".join(
        details_html(group, table_html(table, "text"), opened=group == main)
        for group, table in speed_tables.cheapest_settings(study).items()
    )
