"""The study's tables: one row a point for `design.csv`, and those that the page shows."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from compare.report.tables import TableRows

from ..constraints import BOTH, SLENDER, STROKE, Clearance, slacks
from ..formulas import INITIAL, MEASURES, PUBLISHED, SCHEME_4, UNITS, Design, measure
from ..printed import LARGEST_FORCE_RATIO, LENGTH_RATIO, PLATEN_STROKE, TABLE_1
from .recheck import Recheck
from .search import FEASIBLE_TOL, OPTIMUM_TOL, VARIABLES, gains
from .study import AHEAD, BASELINE, FORCE, LENGTHS, LITERALLY, MAIN, MOST_ROOM, ROOM, SIX, Point

Row: TypeAlias = dict[str, Any]

PRINTED_AS = {"R_V start": "R_V startup"}  # in table 1
DIGITS = {"M_P": 4, "R_S": 5, "L_sum": 2, "S_m": 2, "R_V start": 3, "R_V max": 3, "R_V peak-valley": 3}  # shown
IN_WORDS = {"R_V start": "R_V at the start", "R_V peak-valley": "peak-valley of R_V", "a_m range": "range of a_m"}


def variables(d: Design) -> dict[str, float]:
    """A design as the source lists it, mm and deg."""
    listed = {name: float(value / unit) for name, value, unit in zip(d._fields, d, UNITS, strict=True)}
    return {name: listed[name] for name in (*VARIABLES, "L3")}


def rows(points: Sequence[Point]) -> list[Row]:
    """Return everything that is known of the published designs and of each point, flat."""
    table: list[Row] = [_row("published", name, d) for name, d in PUBLISHED.items()]
    for p in points:
        o, short = p.optimum, min(p.short, default=np.nan)
        outcome = {"violation": o.violation, "starts": o.starts, "feasible": o.feasible, "agree": o.agree}
        table.append(_row(p.set, p.at, o.design) | outcome | {"evolution_short": short})
    return table


def _row(name: str, place: str, d: Design) -> Row:
    worth = {name_of_measure: measure(name_of_measure, d) for name_of_measure in MEASURES} | {"gain": _gain(d)}
    return {"set": name, "at": place} | variables(d) | worth


def _gain(d: Design) -> float:
    """How far a design is ahead of scheme 4 in the worst of M_P, R_S and L_sum, relatively."""
    return float(min(gains(d, SCHEME_4)))


def of(points: Sequence[Point], name: str) -> list[Point]:
    """The points of one set that have a design."""
    return [point for point in points if point.set == name and point.optimum.feasible]


def improved(points: Sequence[Point]) -> list[Point]:
    """The points that a restart has improved, and those of the curve and of the next step without a design."""
    missing = [p for p in points if p.set in (MAIN, LENGTHS) and not p.optimum.feasible]
    return [*missing, *(p for p in points if not min(p.short, default=0.0) >= -OPTIMUM_TOL)]


def curve(points: Sequence[Point], name: str, label: str = "") -> TableRows:
    """One row a point of a set, as the page shows it, `label` before where it is."""
    return [_shown(label + point.at, point.optimum.design) | _searched(point) for point in of(points, name)]


def ahead(points: Sequence[Point]) -> TableRows:
    """One row for each search for a design ahead of scheme 4, scheme 4 itself first."""
    table = [_shown("scheme 4", SCHEME_4)]  # which nothing searched for
    for name in (FORCE, AHEAD, ROOM):
        table += curve(points, name, "" if name == AHEAD else f"{name.removeprefix(f'{AHEAD}, ')}: ")
    return table


def _shown(label: str, d: Design) -> Row:
    return (
        {"at": label, "gain [%]": f"{100 * _gain(d):+.3f}"}
        | {name: f"{measure(name, d):.{count}f}" for name, count in DIGITS.items()}
        | {"a_m range [1/m]": f"{1e3 * measure('a_m range', d):.2f}"}
        | {name: f"{value:.2f}" for name, value in variables(d).items()}
    )


def _searched(point: Point) -> Row:
    evolution = f"{min(point.short):.0e}" if point.short else "–"
    agree = f"{point.optimum.agree} of {point.optimum.starts}"
    return {"agree": agree, "evolution": evolution, "violation": f"{point.optimum.violation:.0e}"}


def published() -> TableRows:
    """The published designs' measures beside what is printed."""
    return [
        {"design": name, "measure": row, "printed": TABLE_1[PRINTED_AS.get(row, row)][name]}
        | {"computed": f"{measure(row, d):.5f}"}
        for name, d in PUBLISHED.items()
        for row in TABLE_1
        if row in MEASURES
    ]


def constraints(points: Sequence[Point]) -> TableRows:
    """The slack of every printed constraint, of both published designs and of the curve's points."""
    shown = dict(PUBLISHED) | {p.at: p.optimum.design for p in of(points, MAIN)}
    slack = {label: slacks(d, BOTH) for label, d in shown.items()}
    return [
        {"constraint": name} | {label: f"{float(of_design[name]):.4f}" for label, of_design in slack.items()}
        for name in slacks(INITIAL, BOTH)
    ]


def assumed(clearances: Mapping[str, Clearance]) -> TableRows:
    """What is assumed of the unknown sizes, mm."""
    return [
        {"assumed": name, "L1 - Hb <=": f"{c.B:.2f}", "L5 - Hb <=": f"{c.D:.2f}", "L3 >=": f"{c.L3:.2f}"}
        | {"L4 >=": f"{c.L4:.2f}"}
        | {pin: f"{size:.2f}" for pin, size in c.sizes.items()}
        for name, c in clearances.items()
    ]


def rechecked(rechecks: Sequence[Recheck]) -> TableRows:
    """Each design by the dynamic models."""
    return [
        {"design": r.design, "engine": r.engine, "status": r.status}
        | {"M_P": f"{r.M_P:.5f}", "R_S": f"{r.R_S:.6f}", "R_V max": f"{r.R_V_max:.5f}"}
        | {f"{group} error": f"{error:.0e}" for group, error in r.errors.items()}
        for r in rechecks
    ]


def findings(points: Sequence[Point]) -> Iterator[str]:
    """What the study finds, a sentence each."""
    best, steps = of(points, MAIN), of(points, LENGTHS)
    for name, chosen in (("Coordination curve", best), ("Least L_sum", steps)):
        least = min((point.optimum.agree for point in chosen), default=0)
        yield f"{name}: {len(chosen)} points; of the starts of each, {least} or more agree on the best."
    short = [value for point in (*best, *steps) for value in point.short]
    if short:
        outcome = "improves none of them" if min(short) >= -OPTIMUM_TOL else "improves one of them"
        yield (
            f"Differential evolution, restarted from nothing {len(short)} times, {outcome}: it falls short by"
            f" {min(short):.0e} to {max(short):.0e}, relatively."
        )
    strict = {p.at: p.optimum for p in points if p.set == LITERALLY}
    none = [place for place, optimum in strict.items() if not optimum.feasible]
    most = max((optimum.value for optimum in strict.values() if optimum.feasible), default=np.nan)
    yield f"With {LITERALLY}, no design is found at {', '.join(none) or 'no point'}, and M_P is {most:.2f} at most."
    for point in of(points, BASELINE):
        d = point.optimum.design
        yield (
            f"The largest M_P at any R_S is {point.optimum.value:.4f}, with R_S = {measure('R_S', d):.4f} and"
            f" S_m = {measure('S_m', d):.1f} mm, or others, since it leaves alpha_max free; in print it is"
            f" {LARGEST_FORCE_RATIO}."
        )
    for point in of(points, AHEAD):
        yield f"Ahead of scheme 4 ({point.at}): {_outcome(point)}."
    for point in of(points, MOST_ROOM):
        yield (
            "All constraints as printed leave room ahead of scheme 4 while"
            f" (d_D + d_E)/2 <= {point.optimum.value:.2f} mm, whatever other sizes let scheme 4 be."
        )


def _outcome(point: Point) -> str:
    """How far a design is ahead of scheme 4, in what, and which printed limits it misses for that."""
    d = point.optimum.design
    gain = 100 * _gain(d)
    if abs(gain) <= 100 * OPTIMUM_TOL:
        return "none is found but scheme 4 itself"
    if gain < 0:
        return f"none is found, the best is {-gain:.3f} % behind"
    parts = [f"one is ahead by {gain:.3f} % in each of M_P, R_S and L_sum"]
    if point.at.startswith(SIX):
        changes = {words: measure(name, d) / measure(name, SCHEME_4) - 1 for name, words in IN_WORDS.items()}
        parts += [f"{words} {100 * change:+.4f} %" for words, change in changes.items()]
    limits = {
        STROKE: f"S_m is {measure('S_m', d):.1f} mm, over the printed {PLATEN_STROKE[1]:g}",
        SLENDER: f"L1/L2 is {measure('L1/L2', d):.3f}, over the printed {LENGTH_RATIO[1]:g}",
    }
    slack = slacks(d, point.problem.clearance)
    return "; ".join([*parts, *(text for name, text in limits.items() if slack[name] < -FEASIBLE_TOL)])
