"""The report's sections about the hard cases and about where engines are stable."""

from html import escape

import pandas as pd

from ...engines.settings import tiers
from ..html import details_html, figure_html, section_html, table_html
from . import tables
from .figure import over_condition
from .stability import stability_maps

RULES = """<p>Every engine on every rung of every ladder, each run in a process of its own with limits of time and
memory. A run with status ok is held to what its engine promises ($promises), above what round-off explains: the
condition &kappa; of the constraint Jacobian times the unit round-off &epsilon;, and how far the motion moves when the
scene's numbers are off by a few last places. <b>refused</b>: the run failed, and its result is wrong or there is
nothing to solve; found by the engine itself, by the checks of its output that need no reference, by the limits of its
process, or by the reader of the scene. <b>silent</b>: a result that the engine and these checks call ok, and that is
wrong by the reference alone. <b>false alarm</b>: a run that failed, with a result within the promise. A failure is
followed by an attempt at more accurate settings. The reference itself is held to arbitrary precision.</p>"""

DIGITS = """<p>Against arbitrary precision, relative to each channel's own peak, also at the position nearest to the
singular configuration and close around it; of as many as log10 of the condition of the problem and one more. The
condition is by how much more than the scene's numbers a channel changes.</p>"""

STABILITY = """<p>The largest relative error of single runs without extrapolation, or how they failed. The sweeps that
pymunk needs by theory follow from the spectral radius &rho; of block Gauss-Seidel in its own space, &beta; being the
part of a joint's error that a step corrects.</p>"""


def hard_section(cases: pd.DataFrame) -> str:
    """Return the section on the hard cases; nothing where none was run."""
    if cases.empty:
        return ""
    engines = dict.fromkeys(cases["engine"])
    promises = ", ".join(f"{name} {tiers(name)['balanced'].promise:.0e}" for name in engines)
    figure, digits = over_condition(cases), tables.digits(cases)
    lost = "Digits that the reference loses next to a singular configuration"
    ladders = ""
    for ladder, table in tables.ladders(cases):
        about = f"<p>{escape(ladder.expected)} <i>{escape(ladder.why)}</i></p>"
        ladders += details_html(ladder.title, about + table_html(table, "text"))
    ladders += "" if digits.empty else details_html(lost, DIGITS + table_html(digits))
    return (
        f'<h2>Hard cases</h2><p class="verdict">{escape(tables.verdict(cases))}</p>'
        f"{RULES.replace('$promises', promises)}{table_html(tables.counts(cases))}"
        f"{figure_html(figure) if figure else ''}{ladders}"
    )


def stability_section(maps: pd.DataFrame) -> str:
    """Return the section on stability; nothing where no map was made."""
    sections = "".join(section_html(title, figure) for title, figure in stability_maps(maps))
    return f'<h2>Where the engines are stable</h2>{STABILITY}<div class="grid">{sections}</div>' if sections else ""
