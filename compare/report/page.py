"""The page: one self-contained HTML file, opened from disk with no network."""

from html import escape

from scenes.scene import ConstantSpeed

from ..engines.axis import axis, cycle_name, position_name
from ..speed.speed_table import SAMPLING
from ..speed.work_precision import NEAR, TIE
from ..study import Study
from . import tables
from .curves import over_angle, panels
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
    scene = study.scene
    return template("compare.report", "page.html").substitute(
        {table.__name__: table_html(table(study)) for table in TABLES},
        head=head(scene.title),
        title=escape(scene.title),
        source=escape(scene.source),
        setup=escape(tables.setup(study)),
        verdict=escape(tables.verdict(study)),
        notes=list_html(tables.notes(study)),
        gates=table_html(study.gates),
        linkage=figure_html(linkage(study)),
        axis=escape(axis(scene).quantity),
        position=escape(position_name(scene)),
        steady="" if isinstance(scene.drive, ConstantSpeed) else ", as if the drive were steady",
        springs=", springs" if scene.springs else "",
        scales=escape(tables.scales(scene)),
        curves=_curves(study),
        channels=table_html(study.errors),
        speed_verdict=escape(speed_tables.verdict(study)),
        speed_figure=figure_html(work_precision(study)),
        cheapest=_cheapest(study),
        speed_notes=list_html(speed_tables.notes(study)),
        speed=table_html(study.speed),
        speed_samples=SAMPLING.samples,
        cycle=cycle_name(scene),
        level=f"{100 * NEAR:.0f} %",
        tie=f"{100 * TIE:.0f} %",
        stability=stability_section(study.maps),
        hard=hard_section(study.hard),
        settings=table_html(tables.settings(study), "text"),
        environment=versions_html(),
    )


def _curves(study: Study) -> str:
    """Return every figure over the drive's position, and those of the distance to singular configurations."""
    sections = [
        section_html(panel.title, over_angle(study, panel)) for panel in panels(study.reference, study.sampling)
    ]
    groups, distance = assur_groups(study), over_distance(study)
    if groups is not None:
        sections.append(
            section_html(
                "Assur groups: transmission angle, and distance to the singular configuration", groups, ONLY_ANALYTIC
            )
        )
    if distance is not None:
        sections.append(section_html("Errors against the distance to the singular configuration", distance, ROUND_OFF))
    return "".join(sections)


def _cheapest(study: Study) -> str:
    """Return the cheapest settings of every channel group, that of the sentence opened."""
    main = speed_tables.main_group(study)
    return "".join(
        details_html(group, table_html(table, "text"), opened=group == main)
        for group, table in speed_tables.cheapest_settings(study).items()
    )
