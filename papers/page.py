"""The audit's page: one self-contained HTML file that looks like a report."""

from collections.abc import Iterable, Sequence
from html import escape

import pandas as pd
import plotly.graph_objects as go

from compare.engines.environment import environment
from compare.report.html import figure_html, head, table_html, template

from .claims import Claim
from .table import RULES, overview, table


def page(claims: Sequence[Claim], pictures: Iterable[tuple[str, str, go.Figure]], notes: Sequence[str]) -> str:
    """Return the whole page, given the pictures with titles and notes, and what a reader has to know."""
    return template("papers", "audit.html").substitute(
        head=head("The source papers, audited"),
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


def _picture(title: str, note: str, figure: go.Figure) -> str:
    return f'<section><h3>{escape(title)}</h3><p class="source">{escape(note)}</p>{figure_html(figure)}</section>'
