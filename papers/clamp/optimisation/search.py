"""Many local searches with exact gradients, and a restart by one that knows neither gradients nor their outcome."""

from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from scipy.optimize import differential_evolution, minimize

from ..formulas import Design, assembles
from ..measures import MEASURES
from .problem import FAR, Problem, Vector, in_box

FEASIBLE = 1e-9  # the largest violation, dimensionless
AGREES = 1e-6  # relative to the best: well above where a search stops, well below the distance of two optima
SEED = 2023
MOST_STARTS = 2**12

GENERATIONS = 1000
ALIKE = 1e-8  # relative: where a whole population is so, it has converged, far below `AGREES`
POPULATION = 15  # times the number of variables
PENALTY = 100.0  # above all multipliers, which are of order one: the least of the penalised objective is then feasible


@dataclass(frozen=True)
class Optimum:
    """The best of a number of local searches; NaN where none ended feasible."""

    design: Design
    value: float  # of the measure
    violation: float
    starts: int
    feasible: int  # searches that ended so
    agree: int  # searches that ended at the best value


def search(problem: Problem, starts: int) -> Optimum:
    """Search from that many points of a Sobol sequence, those at which a design assembles."""
    d = in_box(np.stack([_descend(problem, start) for start in _starts(starts)], axis=1))
    value, violation = MEASURES[problem.objective].of(d), problem.violation(d)
    feasible = assembles(d) & (violation <= FEASIBLE)
    if not feasible.any():
        return Optimum(Design(*[np.nan] * len(d)), np.nan, np.nan, starts, 0, 0)
    best = int(np.argmin(np.where(feasible, value / problem.scale, np.inf)))
    agree = feasible & (np.abs(value - value[best]) <= AGREES * abs(value[best]))
    design = Design(*(values[best] for values in d))
    return Optimum(design, float(value[best]), float(violation[best]), starts, int(feasible.sum()), int(agree.sum()))


def restart(problem: Problem, optimum: Optimum, seed: int) -> float:
    """By how much differential evolution falls short of an optimum, relatively; negative if it is better.

    It starts from nothing and minimises the objective with what is violated added to it (Storn and Price 1997).
    """
    evolved = differential_evolution(
        _penalised,
        [(0.0, 1.0)] * 8,
        args=(problem,),
        maxiter=GENERATIONS,
        popsize=POPULATION,
        mutation=(0.5, 1.0),
        recombination=0.9,
        init="sobol",
        tol=ALIKE,
        polish=False,
        vectorized=True,
        updating="deferred",
        rng=np.random.default_rng(seed),
    )
    known = optimum.value / problem.scale
    return float((evolved.fun - known) / abs(known))


@cache
def _starts(count: int) -> tuple[Vector, ...]:
    from scipy.stats.qmc import Sobol  # which takes longer than all else that is imported

    points = Sobol(8, rng=np.random.default_rng(SEED)).random(MOST_STARTS)
    return tuple(points[assembles(in_box(points.T))][:count])


def _descend(problem: Problem, start: Vector) -> Vector:
    """Where sequential quadratic programming ends (Kraft 1988), in the unit box."""
    rows = lru_cache(1)(lambda point: problem.with_gradients(np.frombuffer(point)))  # each point is asked for again
    count = 1 + len(problem.equalities)
    constraints = [
        {"type": kind, "fun": lambda u, p=p: rows(u.tobytes())[0][p], "jac": lambda u, p=p: rows(u.tobytes())[1][p]}
        for kind, p in (("eq", slice(1, count)), ("ineq", slice(count, None)))
        if kind == "ineq" or count > 1
    ]
    end = minimize(
        lambda u: rows(u.tobytes())[0][0],
        start,
        jac=lambda u: rows(u.tobytes())[1][0],
        bounds=[(0.0, 1.0)] * len(start),
        constraints=constraints,
        method="SLSQP",
        options={"ftol": 1e-13, "maxiter": 200},
    ).x
    return np.asarray(np.clip(end, 0.0, 1.0))


def _penalised(u: Vector, problem: Problem) -> Vector:
    """The objective plus what is violated, shape (n,), of designs of shape (8, n)."""
    d = in_box(u)
    rows = problem.rows(d)
    count = 1 + len(problem.equalities)
    violated = np.abs(rows[1:count]).sum(axis=0) + np.maximum(-rows[count:], 0.0).sum(axis=0)
    return np.asarray(np.where(assembles(d), rows[0] + PENALTY * violated, FAR))
