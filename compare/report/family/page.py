"""A family's page: the table of its members, and their curves over one cycle."""

from html import escape

from ...family.family import Family
from ..html import figure_html, head, list_html, table_html, template, versions_html
from . import tables
from .figure import MOST_LINES, curves


def page(family: Family) -> str:
    """Return the whole report as HTML."""
    able = [member.cycle for member in family.members if member.cycle is not None]
    slides = any("bottom" in cycle.quantities for cycle in able)
    few = f"{MOST_LINES} of the {len(able)} members that run, evenly chosen." if len(able) > MOST_LINES else ""
    return template("compare.report.family", "page.html").substitute(
        head=head(family.scene.title),
        title=escape(family.scene.title),
        source=escape(family.scene.source),
        setup=escape(tables.setup(family)),
        verdict=escape(tables.verdict(family)),
        overview=table_html(tables.overview(family), whole="family.csv"),
        stroke="along the guide" if slides else "the diagonal of the box around the point's path",
        notes=list_html(tables.notes(family)),
        lines=f"One line per member, coloured by {escape(tables.names(family)[0])}. {few}",
        curves=figure_html(curves(family)) if able else "<p>None.</p>",
        environment=versions_html({m.run.engine: m.run.version for f in family.members for m in f.measurements}),
    )
