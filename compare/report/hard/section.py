"""The report's section about the hard cases."""

from html import escape

import pandas as pd

from scenes.hard import Ladder

from ...engines import registry
from ..html import figure_html, table_html
from . import tables
from .figure import over_condition

RULES = """<p>Every engine on every rung of every ladder, each run in a process of its own with limits of time and
memory. A run that says ok is held to what its engine promises ($promises) above what doubles explain: the condition
&kappa; of the constraint Jacobian times &epsilon;, and how far the motion moves when the scene's numbers are
off by a few last places. <b>refused</b>: it says that it failed, and it did, or nothing can be solved; noticed
by the engine itself, by the checks of its output that need no reference, by nothing but the reference, by the
limits of its process, or when the scene was read. <b>silent</b>: it says ok and is off, and nobody noticed.
<b>false alarm</b>: it says that it failed, and what it computed is within its promise. A failure is followed by
an attempt at more accurate settings. The reference itself is held to arbitrary precision.</p>"""

DIGITS = """<p>Against arbitrary precision, relative to each channel's own peak, also at the position nearest to the
lock and close around it; of as many as log10 of the condition of the problem and one more. The condition is by how
much more than the scene's numbers a channel changes.</p>"""


def section(cases: pd.DataFrame) -> str:
    """Return the section as a piece of a page; nothing where no hard case was run."""
    if cases.empty:
        return ""
    promises = ", ".join(f"{name} {entry.promise:.0e}" for name, entry in registry.ENTRIES.items())
    said = f'<p class="verdict">{escape(tables.verdict(cases))}</p>'
    figure = over_condition(cases)
    ladders = "".join(_ladder(ladder, table) for ladder, table in tables.ladders(cases))
    return (
        f"<h2>Hard cases</h2>{said}{RULES.replace('$promises', promises)}{table_html(tables.counts(cases))}"
        f"{figure_html(figure) if figure else ''}{ladders}{_digits(cases)}"
    )


def _digits(cases: pd.DataFrame) -> str:
    table = tables.digits(cases)
    if table.empty:
        return ""
    summary = "<summary>Digits that the reference loses next to a lock</summary>"
    return f"<details>{summary}{DIGITS}{table_html(table)}</details>"


def _ladder(ladder: Ladder, table: pd.DataFrame) -> str:
    about = f"<p>{escape(ladder.expected)} <i>{escape(ladder.why)}</i></p>"
    return f"<details><summary>{escape(ladder.title)}</summary>{about}{table_html(table, 'text')}</details>"
