"""Claims as pieces of a page: how many came out how, and one row each. Their style is that of `report.html`."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from html import escape

import pandas as pd

from .claims import Claim, Verdict

COLUMNS = ("claim", "printed", "computed", "residual", "verdict", "corrected", "residual")
GREEK = {"alpha": "α", "gamma": "γ", "epsilon": "ε", "theta": "θ", "omega": "ω"}
RULES = """<p>Residuals are the largest over the motion, relative: lengths to the first link, rates to the drive's,
forces to the peak, numbers to themselves. A verdict follows from them. <b>holds</b>: an equation to 1e-12, a number to
half a unit of its last digit. <b>misprint</b>: only the corrected form holds. <b>wrong branch</b>: only with another
sign of a root or an inverse function. <b>inconsistent</b>: it contradicts other printed claims.
<b>not reproducible</b>: no reading gives it. <b>underdetermined</b>: it is among what missing or rounded inputs
allow.</p>"""


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
