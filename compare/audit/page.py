"""The audit's page: one self-contained HTML file that looks like a report; and a section for the reports."""

from collections.abc import Iterable, Sequence
from html import escape
from string import Template

import pandas as pd
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from scenes import Scene

from ..engines.environment import environment
from ..report.html import figure_html, table_html, template
from .claims import Claim
from .sources import claims_of, source_of
from .table import RULES, overview, table


def page(claims: Sequence[Claim], pictures: Iterable[tuple[str, str, go.Figure]], notes: Sequence[str]) -> str:
    """Return the whole page, given the pictures with titles and notes, and what a reader has to know."""
    return template("compare.audit", "audit.html").substitute(
        head=Template(template("compare.report", "page.html").template.partition("</head>")[0]).substitute(
            title="The source papers, audited", plotly=get_plotlyjs()
        ),
        overview=table_html(overview(claims)),
        rules=RULES,
        notes="".join(f"<li>{escape(note)}</li>" for note in notes),
        sources="".join(
            f"<h2>{escape(source.capitalize())}</h2>{table([c for c in claims if c.source == source])}"
            for source in dict.fromkeys(claim.source for claim in claims)
        ),
        pictures="".join(_picture(*picture) for picture in pictures),
        environment=table_html(pd.DataFrame(environment().items(), columns=["of", "version"]), "text"),
    )


def section(scene: Scene) -> str:
    """Return the section of a report on the source that a shipped scene is from; nothing for any other scene."""
    source = source_of(scene)
    if source is None:
        return ""
    claims = claims_of(source)
    return (
        f"<h2>The source paper, audited</h2>{table_html(overview(claims))}{RULES}"
        f"<details><summary>Every claim</summary>{table(claims)}</details>"
        "<p>Both sources, with pictures, and by the engines too: <code>python -m compare.audit</code>.</p>"
    )


def _picture(title: str, note: str, figure: go.Figure) -> str:
    return f'<section><h3>{escape(title)}</h3><p class="source">{escape(note)}</p>{figure_html(figure)}</section>'
