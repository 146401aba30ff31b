"""The audit's page: one self-contained HTML file that looks like a report."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from string import Template

import pandas as pd
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from .audit_claims import Claim, Verdict
from .environment import environment
from .report import figure_html, table_html

COLUMNS = ("claim", "printed", "computed", "residual", "verdict", "corrected", "residual")

GREEK = {"alpha": "α", "gamma": "γ", "epsilon": "ε", "theta": "θ", "omega": "ω"}


def page(claims: Sequence[Claim], pictures: Iterable[tuple[str, str, go.Figure]], notes: Sequence[str]) -> str:
    """Return the whole page, given the pictures with titles and notes, and what a reader has to know."""
    return _template("audit.html").substitute(
        head=Template(_template("report.html").template.partition("</head>")[0]).substitute(
            title="The source papers, audited", plotly=get_plotlyjs()
        ),
        overview=table_html(overview(claims)),
        notes="".join(f"<li>{escape(note)}</li>" for note in notes),
        sources="".join(
            f"<h2>{escape(source.capitalize())}</h2>{table([c for c in claims if c.source == source])}"
            for source in dict.fromkeys(claim.source for claim in claims)
        ),
        pictures="".join(_picture(*picture) for picture in pictures),
        environment=table_html(pd.DataFrame(environment().items(), columns=["of", "version"]), "text"),
    )


def overview(claims: Sequence[Claim]) -> pd.DataFrame:
    """Return how many claims of each source came out how."""
    sources = dict.fromkeys(claim.source for claim in claims)
    counts = {source: Counter(claim.verdict for claim in claims if claim.source == source) for source in sources}
    rows = (
        {"source": source} | {str(verdict): count[verdict] for verdict in Verdict} for source, count in counts.items()
    )
    return pd.DataFrame(rows)


def table(claims: Iterable[Claim]) -> str:
    """Return claims as a table of a page."""
    head = "".join(f"<th>{name}</th>" for name in COLUMNS)
    return f'<div class="scroll"><table class="audit"><tr>{head}</tr>{"".join(map(_row, claims))}</table></div>'


def _row(claim: Claim) -> str:
    note = f"<small>{_text(claim.note)}</small>" if claim.note else ""
    computed = claim.computed if isinstance(claim.computed, str) else f"{claim.computed:.6g}"
    cells = (
        _text(claim.claim),
        _text(claim.printed),
        _text(computed) + note,
        _size(claim.residual),
        f'<span class="{claim.verdict.replace(" ", "-")}">{claim.verdict}</span>',
        _text(claim.corrected),
        _size(claim.corrected_residual),
    )
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"


def _text(formula: str) -> str:
    """Return a formula as a piece of a page: letters in Greek, what follows _ and e^ below and above the line."""
    greek = re.sub("|".join(GREEK), lambda name: GREEK[name[0]], escape(formula))
    below = re.sub(r"_(\w+)", r"<sub>\1</sub>", greek)
    return re.sub(r"e\^(iθ[₁-₅]?)", r"e<sup>\1</sup>", below)


def _size(residual: float | None) -> str:
    return "–" if residual is None else f"{residual:.1e}"


def _picture(title: str, note: str, figure: go.Figure) -> str:
    return f'<section><h3>{escape(title)}</h3><p class="source">{escape(note)}</p>{figure_html(figure)}</section>'


def _template(name: str) -> Template:
    return Template((files("compare") / name).read_text(encoding="utf-8"))
