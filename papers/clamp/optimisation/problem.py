"""One optimisation: what is sought and under which limits, as rows of numbers with exact gradients."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..constraints import LITERAL, PRINTED, RATIO, Clearance
from ..formulas import UNITS, Array, Design, assembles, closed
from ..measures import MEASURES
from ..printed import BOUNDS

STEP = 1e-30  # of the complex step: its error is STEP^2, and nothing cancels (Squire and Trapp 1998)
FAR = 1e3  # the objective where a design does not assemble; a feasible one has about one

VARIABLES = tuple(BOUNDS)
LOWER, UPPER = (
    np.array([limits[end] * UNITS[Design._fields.index(name)] for name, limits in BOUNDS.items()]) for end in (0, 1)
)

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Limit:
    """A measure between two values; the same value twice for an equality, an infinite one for no limit."""

    measure: str
    low: float
    high: float

    def slacks(self, d: Design) -> list[Array]:
        """How far above the one and below the other value the measure is, those that are finite, scaled."""
        of, scale, _ = MEASURES[self.measure]
        value = of(d)
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
        offsets = [beyond for limit in self.equalities for beyond in limit.slacks(d)[:1]]
        return np.stack([MEASURES[self.objective].of(d) / self.scale, *offsets, *self._slacks(d)])

    def _slacks(self, d: Design) -> list[Array]:
        waived = self.waived
        if any(limit.measure == "R_S" for limit in self.equalities):
            waived = waived | {RATIO}  # at 1.12 a second gradient of the same direction is no help
        rows = [slack(d, self.clearance) for name, slack in PRINTED.items() if name not in waived]
        for limit in self.limits:
            rows += [] if limit in self.equalities else limit.slacks(d)
        if self.rival is not None:
            force, ratio, length = gains(d, self.rival)
            rows += [ratio - force, length - force]
        return rows

    def violation(self, d: Design) -> Array:
        """By how much a design misses the worst of its limits, dimensionless, zero if it misses none."""
        rows = self.rows(d)[1:]
        count = len(self.equalities)
        return np.asarray(np.max([np.zeros_like(rows[0]), *np.abs(rows[:count]), *-rows[count:]], axis=0))

    def with_gradients(self, u: Vector) -> tuple[Vector, Vector]:
        """The rows at a point of the unit box and their gradients there, shapes (rows,) and (rows, 8)."""
        steps = np.hstack([np.zeros((len(u), 1)), 1j * STEP * np.eye(len(u))])
        rows = self.rows(in_box(u[:, None] + steps))
        values, gradients = rows[:, 0].real.copy(), rows[:, 1:].imag / STEP
        if not assembles(in_box(u)):
            values[0] = FAR
        return values, gradients


def gains(d: Design, rival: Design) -> tuple[Array, Array, Array]:
    """How much better than a rival a design is in M_P, R_S and L_sum, relatively."""
    force, ratio, length = (MEASURES[name].of(d) / MEASURES[name].of(rival) for name in ("M_P", "R_S", "L_sum"))
    return force - 1, ratio - 1, 1 - length


def in_box(u: Array) -> Design:
    """The designs at points of the unit box, shape (8, ...), in the order of `VARIABLES`."""
    values = (low + (high - low) * part for low, high, part in zip(LOWER, UPPER, u, strict=True))
    return closed(Design(L3=np.nan, **dict(zip(VARIABLES, values, strict=True))))
