"""The audit's page: one self-contained HTML file that looks like a scene's report."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from html import escape

import pandas as pd
import plotly.graph_objects as go

from compare.report.html import head, list_html, section_html, table_html, template, versions_html

from .claims import Claim, Verdict

COLUMNS = ("claim", "printed", "computed", "residual", "verdict", "corrected", "residual")
GREEK = {"alpha": "α", "gamma": "γ", "epsilon": "ε", "theta": "θ", "omega": "ω"}


def page(
    claims: Mapping[str, Sequence[Claim]], pictures: Iterable[tuple[str, str, go.Figure]], notes: Sequence[str]
) -> str:
    """Return the audit's page, given the claims by their source, pictures with titles and notes, and notes on all."""
    return template("papers", "audit.html").substitute(
        head=head("The source papers, audited"),
        overview=table_html(overview(claims)),
        notes=list_html(notes),
        sources="".join(f"<h2>{escape(source.capitalize())}</h2>{_table(rows)}" for source, rows in claims.items()),
        pictures="".join(section_html(title, figure, note) for title, note, figure in pictures),
        environment=versions_html(),
    )


def overview(claims: Mapping[str, Sequence[Claim]]) -> pd.DataFrame:
    """Return how many claims of each source came out how."""
    counts = {source: Counter(claim.verdict for claim in rows) for source, rows in claims.items()}
    return pd.DataFrame(
        {"source": source} | {str(verdict): count[verdict] for verdict in Verdict} for source, count in counts.items()
    )


def _table(claims: Iterable[Claim]) -> str:
    columns = "".join(f"<th>{name}</th>" for name in COLUMNS)
    return f'<div class="scroll"><table class="audit"><tr>{columns}</tr>{"".join(map(_row, claims))}</table></div>'


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
    """Return a formula as HTML: letters in Greek, what follows _ and e^ below and above the line."""
    greek = re.sub("|".join(GREEK), lambda name: GREEK[name[0]], escape(formula))
    below = re.sub(r"_(\w+)", r"<sub>\1</sub>", greek)
    return re.sub(r"e\^(iθ[₁-₅]?)", r"e<sup>\1</sup>", below)


def _size(residual: float | None) -> str:
    return "–" if residual is None else f"{residual:.1e}"
