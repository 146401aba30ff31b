"""Every optimisation of the study, two processes at a time.

The coordination curve comes first: the largest M_P at each of 13 values of R_S. Then the tolerance-hierarchical step
from each of its points: the least L_sum with M_P and R_S within 0.5 % of theirs. Both with the least clearance with
which both published designs can be; the curve under other assumptions too. Last, how far a design can be ahead of
scheme 4.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count, product
from typing import TypeAlias

import numpy as np

from compare.engines.processes.inside import Ended, Limits
from compare.engines.processes.isolation import isolated
from compare.engines.processes.stopping import Progress

from ..constraints import ALONE, BOTH, LITERAL, LOOSEST, Clearance, slacks
from ..formulas import MEASURES, SCHEME_4, measure
from .search import Limit, Optimum, Problem, restart, search

LIMITS = Limits(seconds=3600.0, workers=2)  # a point takes minutes of processor time at most
RATIOS = tuple(round(1 + 0.01 * step, 2) for step in range(13))  # of R_S
MEASURE_TOL = 0.005
PIN_ROOM = tuple(range(120, 141, 4))  # mm, of (d_D + d_E)/2

LITERALLY = "160 deg read literally"
ASSUMPTIONS = {
    "sizes that allow both published designs": (BOTH, frozenset({LITERAL})),
    "sizes that allow scheme 4": (ALONE, frozenset({LITERAL})),
    "any sizes": (LOOSEST, frozenset({LITERAL})),
    LITERALLY: (BOTH, frozenset[str]()),
}
BROKEN = frozenset(name for name, slack in slacks(SCHEME_4, BOTH).items() if slack < 0)  # LITERAL among them
MAIN = next(iter(ASSUMPTIONS))
LENGTHS = "least L_sum"


@dataclass(frozen=True)
class Point:
    """One optimisation and how it ended."""

    set: str
    at: str
    problem: Problem
    optimum: Optimum
    short: tuple[float, ...] = ()  # what each restart by differential evolution falls short, relatively


@dataclass(frozen=True)
class Effort:
    """How many starts a point has, and how many restarts by differential evolution where any are made."""

    starts: int = 64
    restarts: int = 1


Task: TypeAlias = tuple[str, str, Problem, Effort]


def study(effort: Effort, ratios: Sequence[float], progress: Progress) -> list[Point]:
    """Every point, set by set; `progress` takes what was done last."""
    half = replace(effort, starts=max(effort.starts // 2, 1))  # for all that is not in the source
    again = replace(half, restarts=0)
    curve = [
        (name, f"R_S = {ratio:.2f}", fixed_ratio(ratio, *assumed), effort if name == MAIN else again)
        for name, assumed in ASSUMPTIONS.items()
        for ratio in ratios
    ]
    beyond = list(_beyond(half))
    done, total = count(1), len(ratios) + len(curve) + len(beyond)

    def solve(tasks: Sequence[Task]) -> list[Point]:
        solved = dict[tuple[str, str], Point]()
        for (name, place, *_), point in isolated(_point, tasks, LIMITS, lambda: None):
            if isinstance(point, Ended):
                raise RuntimeError(f"{name}, {place}: {point.reason}")
            solved[name, place] = point
            progress(f"{next(done)} of {total} points: {name}, {place}")
        return [solved[name, place] for name, place, *_ in tasks]

    points = solve([*curve, *beyond])
    # Two rounds, since the second one's limits are values of the first: M_P and R_S of each point of the main curve.
    best, rest = points[: len(ratios)], points[len(ratios) :]
    steps = [(LENGTHS, p.at, least_length(p), effort) for p in best if p.optimum.feasible]
    return [*best, *solve(steps), *rest]


def fixed_ratio(ratio: float, clearance: Clearance = BOTH, waived: frozenset[str] = frozenset({LITERAL})) -> Problem:
    """The search for the largest M_P at one value of R_S."""
    return Problem("M_P", clearance, (Limit("R_S", ratio, ratio),), waived)


def least_length(point: Point) -> Problem:
    """The search for the least L_sum, M_P and R_S within the tolerance of a point's."""
    values = {name: measure(name, point.optimum.design) for name in ("M_P", "R_S")}
    limits = (Limit(name, (1 - MEASURE_TOL) * value, (1 + MEASURE_TOL) * value) for name, value in values.items())
    return replace(point.problem, objective="L_sum", limits=tuple(limits))


# --- beyond the source: how far ahead of scheme 4 a design can be -----------------------------------------------------

AHEAD = "ahead of scheme 4"
FORCE = "ahead of scheme 4 in M_P, no worse in R_S and L_sum"
ROOM = "ahead of scheme 4, by (d_D + d_E)/2"
BASELINE = "largest M_P of all"
MOST_ROOM = "largest L4 that is no worse than scheme 4"
THREE, SIX = "M_P, R_S, L_sum", "all six objectives"
AS_PRINTED, MET = "all constraints", "those that scheme 4 meets"


def no_worse(name: str) -> Limit:
    """The limit that a measure is no worse than scheme 4's."""
    value = measure(name, SCHEME_4)
    return Limit(name, -np.inf, value) if MEASURES[name].least else Limit(name, value, np.inf)


AIMS = {THREE: (), SIX: tuple(no_worse(name) for name in ("R_V start", "R_V peak-valley", "a_m range"))}
CONDITIONS: Mapping[str, tuple[frozenset[str], tuple[Limit, ...]]] = {
    AS_PRINTED: (frozenset({LITERAL}), ()),
    "none broken further": (BROKEN, (no_worse("L1/L2"), Limit("S_m", -np.inf, measure("S_m", SCHEME_4)))),
    MET: (BROKEN, ()),
}
SIZES = {"for both": BOTH, "for scheme 4": ALONE}


def ahead(aim: str, condition: str, clearance: Clearance) -> Problem:
    """The search for the largest gain on scheme 4 that M_P, R_S and L_sum have at once."""
    waived, limits = CONDITIONS[condition]
    return Problem("M_P", clearance, (*AIMS[aim], *limits), waived, SCHEME_4)


def _beyond(effort: Effort) -> Iterator[Task]:
    once = replace(effort, restarts=0)
    # All combinations of aims, of what must hold, and of what is assumed of the sizes. Where the answer differs between
    # them it depends on what the source leaves open.
    for aim, condition, sizes in product(AIMS, CONDITIONS, SIZES):
        searched = once if (aim, sizes) == (SIX, "for scheme 4") else effort  # slow, and stricter
        yield AHEAD, f"{aim}; {condition}; sizes {sizes}", ahead(aim, condition, SIZES[sizes]), searched
    force, ratio, length = (no_worse(name) for name in ("M_P", "R_S", "L_sum"))
    yield BASELINE, "any R_S", Problem("M_P", BOTH), effort
    yield FORCE, AS_PRINTED, Problem("M_P", BOTH, (ratio, length)), effort
    for room in PIN_ROOM:
        yield ROOM, f"{room} mm", ahead(THREE, AS_PRINTED, replace(ALONE, L4=float(room))), once
    yield MOST_ROOM, AS_PRINTED, Problem("L4", replace(ALONE, L4=0.0), (force, ratio, length)), effort


def _point(task: Task) -> Point:
    set_name, place, problem, effort = task
    optimum = search(problem, effort.starts)
    restarts = effort.restarts if optimum.feasible else 0
    short = tuple(restart(problem, optimum, seed) for seed in range(restarts))
    return Point(set_name, place, problem, optimum, short)
