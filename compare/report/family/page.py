"""A family's files: one page, and the table that it shows."""

from html import escape
from pathlib import Path
from string import Template

import pandas as pd
from plotly.offline import get_plotlyjs

from ...engines.environment import environment
from ...family.family import Family
from ..files import placed
from ..html import figure_html, table_html, template
from . import tables
from .figure import MOST_LINES, curves


def write(family: Family, folder: Path) -> Path:
    """Write `family.html` and `family.csv` into `folder/<scene>/` and return that folder.

    Raises:
        InputError: the folder cannot be written; what it held is then unchanged.
    """
    with placed(folder, family.scene.name, "family.*") as aside:
        tables.in_si(family).to_csv(aside / "family.csv", index=False)
        (aside / "family.html").write_text(page(family), encoding="utf-8")
    return folder / family.scene.name


def page(family: Family) -> str:
    """Return the whole report as HTML."""
    able = [member.cycle for member in family.members if member.cycle is not None]
    slides = any("bottom" in cycle.quantities for cycle in able)
    versions = {m.run.engine: m.run.version for member in family.members for m in member.measurements}
    few = f"{MOST_LINES} of the {len(able)} members that run, evenly chosen." if len(able) > MOST_LINES else ""
    title = escape(family.scene.title)
    return template("compare.report.family", "page.html").substitute(
        head=Template(template("compare.report", "page.html").template.partition("</head>")[0]).substitute(
            title=title, plotly=get_plotlyjs()
        ),
        title=title,
        source=escape(family.scene.source),
        setup=escape(tables.setup(family)),
        verdict=escape(tables.verdict(family)),
        overview=table_html(tables.overview(family)),
        stroke="along the guide" if slides else "the diagonal of the box around the point's path",
        notes="".join(f"<li>{escape(note)}</li>" for note in tables.notes(family)),
        lines=f"One line a member, coloured by {escape(tables.names(family)[0])}. {few}",
        curves=figure_html(curves(family)) if able else "<p>None.</p>",
        environment=table_html(pd.DataFrame((versions | environment()).items(), columns=["of", "version"]), "text"),
    )
