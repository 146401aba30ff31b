"""The audit's page: one self-contained HTML file that looks like a scene's report."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import pandas as pd
from markupsafe import Markup, escape

from compare.report.figures.figure import Figure
from compare.report.pages.html import render

from .claims import Claim, Verdict

COLUMNS = ("claim", "printed", "computed", "residual", "verdict", "corrected", "residual")
GREEK = {"alpha": "α", "gamma": "γ", "epsilon": "ε", "theta": "θ", "omega": "ω"}


def page(
    claims: Mapping[str, Sequence[Claim]], pictures: Iterable[tuple[str, str, Figure]], notes: Sequence[str]
) -> str:
    """The audit's page, given the claims by their source, pictures with titles and notes, and notes on all."""
    return render(
        "audit.html",
        "papers",
        formula=_formula,
        overview=overview(claims),
        notes=notes,
        claims=claims,
        columns=COLUMNS,
        pictures=pictures,
    )


def overview(claims: Mapping[str, Sequence[Claim]]) -> pd.DataFrame:
    """How many claims of each source came out how."""
    counts = {source: Counter(claim.verdict for claim in rows) for source, rows in claims.items()}
    return pd.DataFrame(
        {"source": source} | {str(verdict): count[verdict] for verdict in Verdict} for source, count in counts.items()
    )


def _formula(written: str) -> Markup:
    """A formula as HTML: letters in Greek, what follows _ and e^ below and above the line."""
    greek = re.sub("|".join(GREEK), lambda name: GREEK[name[0]], str(escape(written)))
    below = re.sub(r"_(\w+)", r"<sub>\1</sub>", greek)
    return Markup(re.sub(r"e\^(iθ[₁-₅]?)", r"e<sup>\1</sup>", below))  # escaped above
