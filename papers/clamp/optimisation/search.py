"""One optimisation: what is sought under which limits; many local searches with exact gradients, one without any."""

from dataclasses import dataclass
from functools import cache, cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution, minimize

from ..constraints import LITERAL, PRINTED, RATIO, Clearance
from ..formulas import MEASURES, UNITS, Array, Design, assembles, closed
from ..printed import BOUNDS

STEP = 1e-30  # of the complex step: its error is STEP^2, and nothing cancels (Squire and Trapp 1998)
INFEASIBLE_OBJECTIVE = 1e3  # where a design does not assemble; a feasible one has about one

VARIABLES = tuple(BOUNDS)
LOWER, UPPER = np.transpose([np.multiply(UNITS[Design._fields.index(name)], ends) for name, ends in BOUNDS.items()])

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Limit:
    """A measure between two values; the same value twice for an equality, an infinite one for no limit."""

    measure: str
    low: float
    high: float

    def slacks(self, d: Design) -> list[Array]:
        """How far above the one and below the other value the measure is, those that are finite, scaled."""
        measured, scale, _ = MEASURES[self.measure]
        value = measured(d)
        ends = ((1, self.low), (-1, self.high))
        return [np.asarray(sign * (value - end) / scale) for sign, end in ends if np.isfinite(end)]


@dataclass(frozen=True)
class Problem:
    """The best value of a measure within the bounds, the printed constraints and some limits.

    With a `rival`, whatever M_P gains on it relatively, R_S and L_sum gain as much or more: the largest M_P is then the
    largest gain that all three have at once, and a negative one where no design is better than the rival in all.
    """

    objective: str  # a measure
    clearance: Clearance
    limits: tuple[Limit, ...] = ()
    waived: frozenset[str] = frozenset({LITERAL})  # printed constraints that are not asked for
    rival: Design | None = None

    @property
    def scale(self) -> float:
        """What the measure is divided by for a quantity of order one whose least is sought."""
        _, scale, least = MEASURES[self.objective]
        return scale if least else -scale

    @cached_property
    def equalities(self) -> tuple[Limit, ...]:
        """The limits that are equalities."""
        return tuple(limit for limit in self.limits if limit.low == limit.high)

    def rows(self, d: Design) -> Array:
        """The objective, then what shall vanish, then what shall not be negative; shape (rows, ...)."""
        waived = self.waived
        # An equality R_S = 1.12 and the active inequality R_S <= 1.12 have parallel gradients. The quadratic subproblem
        # of SLSQP is then singular (no linear independence of active constraints), so the inequality is left out.
        if any(limit.measure == "R_S" for limit in self.equalities):
            waived = waived | {RATIO}  # at 1.12 a second gradient of the same direction is no help
        rows = [MEASURES[self.objective].of(d) / self.scale, *(limit.slacks(d)[0] for limit in self.equalities)]
        rows += [slack(d, self.clearance) for name, slack in PRINTED.items() if name not in waived]
        rows += [slack for limit in self.limits if limit not in self.equalities for slack in limit.slacks(d)]
        if self.rival is not None:
            # Maximin in epigraph form: the largest of min(gains) is not smooth, "the largest first gain that the others
            # reach too" is.
            force, ratio, length = gains(d, self.rival)
            rows += [ratio - force, length - force]
        return np.stack(rows)

    def violations(self, rows: Array) -> Array:
        """By how much each limit is missed, dimensionless, zero if it is not; by `rows`, of the shape (limits, ...)."""
        count = 1 + len(self.equalities)
        return np.concatenate([np.abs(rows[1:count]), np.maximum(-rows[count:], 0.0)])

    # Gradients by complex steps, f'(u) = Im f(u + i h) / h (Squire and Trapp 1998): column 0 is the point itself,
    # column 1 + j has the step in variable j, and one broadcast evaluation gives all nine. It takes formulas that are
    # analytic where they are evaluated; a complex root does not fail where a design cannot be assembled, so `assembles`
    # decides on the real point and the objective is replaced there.
    def with_gradients(self, u: Vector) -> tuple[Vector, Vector]:
        """The rows at a point of the unit box and their gradients there, shapes (rows,) and (rows, 8)."""
        steps = np.hstack([np.zeros((len(u), 1)), 1j * STEP * np.eye(len(u))])
        rows = self.rows(in_box(u[:, None] + steps))
        values, gradients = rows[:, 0].real.copy(), rows[:, 1:].imag / STEP
        if not assembles(in_box(u)):
            values[0] = INFEASIBLE_OBJECTIVE
        return values, gradients


def gains(d: Design, rival: Design) -> tuple[Array, Array, Array]:
    """How much better than a rival a design is in M_P, R_S and L_sum, relatively."""
    force, ratio, length = (MEASURES[name].of(d) / MEASURES[name].of(rival) for name in ("M_P", "R_S", "L_sum"))
    return force - 1, ratio - 1, 1 - length


def in_box(u: Array) -> Design:
    """The designs at points of the unit box, shape (8, ...), in the order of `VARIABLES`."""
    values = (low + (high - low) * part for low, high, part in zip(LOWER, UPPER, u, strict=True))
    return closed(Design(L3=np.nan, **dict(zip(VARIABLES, values, strict=True))))


FEASIBLE_TOL = 1e-9  # the largest violation, dimensionless
OPTIMUM_TOL = 1e-6  # relative to the best: well above where a search stops, well below the distance of two optima
SEED = 2023
MAX_STARTS = 2**12

GENERATIONS = 1000
POPULATION_TOL = 1e-8  # relative: a whole population within it has converged, far below `OPTIMUM_TOL`
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


# Multistart: sequential quadratic programming from a Sobol sequence (Kraft 1988; Sobol 1967). The problem is smooth
# with eight variables and has several local optima. No bound on the global optimum is known; how many starts end at the
# best value (`agree`) is the evidence for it. A single agreeing start is a warning, none feasible gives NaN.
def search(problem: Problem, starts: int) -> Optimum:
    """Search from that many points of a Sobol sequence, those at which a design assembles."""
    d = in_box(np.stack([_descend(problem, start) for start in _starts(starts)], axis=1))
    value, violation = MEASURES[problem.objective].of(d), problem.violations(problem.rows(d)).max(axis=0)
    feasible = assembles(d) & (violation <= FEASIBLE_TOL)
    if not feasible.any():
        return Optimum(Design(*[np.nan] * len(d)), np.nan, np.nan, starts, 0, 0)
    best = int(np.argmin(np.where(feasible, value / problem.scale, np.inf)))
    agree = feasible & (np.abs(value - value[best]) <= OPTIMUM_TOL * abs(value[best]))
    design = Design(*(values[best] for values in d))
    return Optimum(design, float(value[best]), float(violation[best]), starts, int(feasible.sum()), int(agree.sum()))


def restart(problem: Problem, optimum: Optimum, seed: int) -> float:
    """By how much differential evolution falls short of an optimum, relatively; negative if it is better."""
    # It starts from nothing and minimises the objective with what is violated added to it (Storn and Price 1997).
    # A method without gradients, starts or active sets in common with the search: what both miss is unlikely to be
    # there.
    evolved = differential_evolution(
        _penalised,
        [(0.0, 1.0)] * 8,
        args=(problem,),
        maxiter=GENERATIONS,
        popsize=POPULATION,
        recombination=0.9,
        init="sobol",
        tol=POPULATION_TOL,
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

    points = Sobol(8, rng=np.random.default_rng(SEED)).random(MAX_STARTS)
    return tuple(points[assembles(in_box(points.T))][:count])


def _descend(problem: Problem, start: Vector) -> Vector:
    """Where sequential quadratic programming ends (Kraft 1988), in the unit box."""
    rows = lru_cache(1)(lambda point: problem.with_gradients(np.frombuffer(point)))  # each point is asked for again
    count = 1 + len(problem.equalities)
    constraints = [
        {"type": kind, "fun": lambda u, p=p: rows(u.tobytes())[0][p], "jac": lambda u, p=p: rows(u.tobytes())[1][p]}
        # SLSQP asks for each constraint group and its Jacobian separately at the same point; the cache of one entry
        # evaluates them once.
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
    penalty = PENALTY * problem.violations(rows).sum(axis=0)
    return np.asarray(np.where(assembles(d), rows[0] + penalty, INFEASIBLE_OBJECTIVE))
