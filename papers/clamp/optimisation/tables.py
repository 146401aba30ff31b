"""The study's tables: one row a point for `design.csv`, and those that the page shows."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from ..constraints import LITERAL, Clearance, slacks
from ..formulas import INITIAL, SCHEME_4, UNITS, VARIABLES, Array, third_length
from .measures import MEASURES, measure
from .problem import gains
from .recheck import Recheck
from .search import AGREES
from .study import AHEAD, BASELINE, BOTH, FORCE, LENGTHS, LITERALLY, MAIN, MOST_ROOM, ROOM, Point

Row: TypeAlias = dict[str, Any]

PUBLISHED: Mapping[str, Array] = {"initial": INITIAL, "scheme 4": SCHEME_4}
PRINTED: Mapping[str, Mapping[str, float]] = {
    "initial": {"M_P": 20.20, "R_S": 1.02, "L_sum": 1354, "R_V max": 1.63, "R_V peak-valley": 0.65, "R_V start": 1.16},
    "scheme 4": {"M_P": 23.10, "R_S": 1.09, "L_sum": 1346, "R_V max": 1.80, "R_V peak-valley": 0.65, "R_V start": 1.17},
}
LARGEST_IN_PRINT = 26.55  # M_P of all designs


def variables(X: Array) -> dict[str, float]:
    """Return a design as the source lists it, mm and deg."""
    return dict(zip(VARIABLES, (X / UNITS).tolist(), strict=True)) | {"L3": float(third_length(X))}


def measures(X: Array) -> dict[str, float]:
    """Return what a design is worth, and how far ahead of scheme 4 it is in the worst of M_P, R_S and L_sum."""
    return {name: measure(name, X) for name in MEASURES} | {"gain": float(min(gains(X, SCHEME_4)))}


def rows(points: Sequence[Point]) -> list[Row]:
    """Return everything that is known of the published designs and of each point, flat."""
    published: list[Row] = [
        {"set": "published", "at": name} | variables(X) | measures(X) for name, X in PUBLISHED.items()
    ]
    return [*published, *map(_row, points)]


def _row(point: Point) -> Row:
    optimum = point.optimum
    outcome: Row = {
        "violation": optimum.violation,
        "starts": optimum.starts,
        "feasible": optimum.feasible,
        "agree": optimum.agree,
        "evolution_short": min(point.short, default=np.nan),
    }
    return {"set": point.set, "at": point.at} | variables(optimum.X) | measures(optimum.X) | outcome


def of(points: Sequence[Point], name: str) -> list[Point]:
    """Return the points of one set that have a design."""
    return [point for point in points if point.set == name and point.optimum.feasible]


def improved(points: Sequence[Point]) -> list[Point]:
    """Return the points that a restart has improved, and those of the curve and of the next step without a design."""
    missing = [p for p in points if p.set in (MAIN, LENGTHS) and not p.optimum.feasible]
    return [*missing, *(p for p in points if not min(p.short, default=0.0) >= -AGREES)]


def curve(points: Sequence[Point], name: str) -> pd.DataFrame:
    """Return one row a point of a set, as the page shows it."""
    return pd.DataFrame(_shown(point) for point in of(points, name))


def _shown(point: Point) -> Row:
    X, optimum = point.optimum.X, point.optimum
    digits = {"M_P": 4, "R_S": 5, "L_sum": 2, "S_m": 2, "R_V start": 3, "R_V peak-valley": 3}
    return (
        {"at": point.at}
        | {name: f"{measure(name, X):.{count}f}" for name, count in digits.items()}
        | {name: f"{value:.2f}" for name, value in variables(X).items()}
        | {"agree": f"{optimum.agree} of {optimum.starts}", "violation": f"{optimum.violation:.0e}"}
        | {"evolution": f"{min(point.short):.0e}" if point.short else "–"}
    )


def ahead(points: Sequence[Point]) -> pd.DataFrame:
    """Return one row for each search for a design ahead of scheme 4, scheme 4 itself first."""
    found = [point for name in (FORCE, AHEAD, ROOM) for point in of(points, name)]
    return pd.DataFrame([_against("scheme 4", SCHEME_4), *(_against(_label(p), p.optimum.X, p) for p in found)])


def _label(point: Point) -> str:
    return point.at if point.set == AHEAD else f"{point.set.removeprefix(f'{AHEAD}, ')}: {point.at}"


def _against(label: str, X: Array, point: Point | None = None) -> Row:
    return (
        {"searched": label, "gain [%]": f"{100 * min(gains(X, SCHEME_4)):+.3f}"}
        | {name: f"{measure(name, X):.{digits}f}" for name, digits in {"M_P": 4, "R_S": 5, "L_sum": 2}.items()}
        | {name: f"{measure(name, X):.3f}" for name in ("R_V start", "R_V max", "R_V peak-valley")}
        | {"a_m range [1/m]": f"{1e3 * measure('a_m range', X):.2f}", "S_m": f"{measure('S_m', X):.2f}"}
        | {name: f"{value:.2f}" for name, value in variables(X).items()}
        | {"agree": f"{point.optimum.agree} of {point.optimum.starts}" if point else "–"}
        | {"evolution": f"{min(point.short):.0e}" if point and point.short else "–"}
    )


def published() -> pd.DataFrame:
    """Return the published designs' measures beside what is printed."""
    return pd.DataFrame(
        {"design": name, "measure": of, "printed": f"{printed:g}", "computed": f"{measure(of, PUBLISHED[name]):.5f}"}
        for name, row in PRINTED.items()
        for of, printed in row.items()
    )


def constraints(points: Sequence[Point]) -> pd.DataFrame:
    """Return the slack of every printed constraint, of both published designs and of the curve's ends."""
    shown = dict(PUBLISHED) | {p.at: p.optimum.X for p in of(points, MAIN)}
    return pd.DataFrame(
        {"constraint": name} | {label: f"{float(slacks(X, BOTH)[name]):.4f}" for label, X in shown.items()}
        for name in slacks(INITIAL, BOTH)
    )


def assumed(clearances: Mapping[str, Clearance]) -> pd.DataFrame:
    """Return what is assumed of the unknown sizes, mm."""
    return pd.DataFrame(
        {"assumed": name, "L1 - Hb <=": c.B, "L5 - Hb <=": c.D, "L3 >=": c.L3, "L4 >=": c.L4}
        | dict(zip(("d_B", "d_D", "d_E", "H_s"), c.sizes, strict=True))
        for name, c in clearances.items()
    ).map(lambda value: value if isinstance(value, str) else f"{value:.2f}")


def rechecked(rechecks: Sequence[Recheck]) -> pd.DataFrame:
    """Return what the dynamic models say of each design."""
    return pd.DataFrame(
        {"design": r.design, "engine": r.engine, "status": r.status}
        | {"M_P": f"{r.M_P:.5f}", "R_S": f"{r.R_S:.6f}", "R_V max": f"{r.R_V_max:.5f}"}
        | {f"{group} error": f"{error:.0e}" for group, error in r.errors.items()}
        for r in rechecks
    )


def verdicts(points: Sequence[Point]) -> Iterator[str]:
    """Yield what the study finds, a sentence each."""
    best, steps = of(points, MAIN), of(points, LENGTHS)
    for name, found in (("Coordination curve", best), ("Least L_sum", steps)):
        least = min((point.optimum.agree for point in found), default=0)
        yield f"{name}: {len(found)} points; of the starts of each, {least} or more agree on the best."
    short = [value for point in (*best, *steps) for value in point.short]
    if short:
        outcome = "improves none of them" if min(short) >= -AGREES else "improves one of them"
        yield (
            f"Differential evolution, restarted from nothing {len(short)} times, {outcome}: it falls short by"
            f" {min(short):.0e} to {max(short):.0e}, relatively."
        )
    strict = {p.at: p.optimum for p in points if p.set == LITERALLY}
    none = [at for at, optimum in strict.items() if not optimum.feasible]
    most = max((optimum.value for optimum in strict.values() if optimum.feasible), default=np.nan)
    yield f"With {LITERALLY}, no design is found at {', '.join(none) or 'no point'}, and M_P is {most:.2f} at most."
    for point in of(points, BASELINE):
        X = point.optimum.X
        yield (
            f"The largest M_P at any R_S is {point.optimum.value:.4f}, where R_S = {measure('R_S', X):.4f} and"
            f" S_m = {measure('S_m', X):.1f} mm; in print it is {LARGEST_IN_PRINT}."
        )
    for point in of(points, AHEAD):
        gain = 100 * min(gains(point.optimum.X, SCHEME_4))
        outcome = f"one is ahead by {gain:.3f} %" if gain > 0 else f"none is found, the best is {-gain:.3f} % behind"
        if abs(gain) <= 100 * AGREES:
            outcome = "none is found but scheme 4 itself"
        yield f"Ahead of scheme 4 ({point.at}): {outcome}."
    for point in of(points, MOST_ROOM):
        yield (
            "All constraints as printed leave room ahead of scheme 4 while"
            f" (d_D + d_E)/2 <= {point.optimum.value:.2f} mm, whatever other sizes let scheme 4 be."
        )


def literal_slack() -> dict[str, float]:
    """Return by how many degrees the published designs keep the limit of 160 deg, read literally."""
    return {name: float(np.degrees(slacks(X, BOTH)[LITERAL])) for name, X in PUBLISHED.items()}
