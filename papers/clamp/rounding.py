"""Double-toggle clamp: what the rounding of table 2 leaves open, and what it does to table 1."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

import numpy as np

from ..claims import Range, half_unit
from .formulas import UNITS, Array, Design, assembles, third_length
from .measures import MEASURES
from .printed import TABLE_2

STEPS, DIFFERENCE = 5, 1e-3  # towards the clamp behind table 1; the latter in half units
ROUNDS = 20  # of weights: within 2 % of the least

Measured: TypeAlias = Callable[[Design], Array]


@dataclass(frozen=True)
class Corners:
    """A design of table 2 at face value, and at those corners of its rounding at which it can lock."""

    designs: Design  # values of shape (m,), the face value first
    count: int  # of all corners, of the eight values that take part in the motion
    locking: int

    def over(self, quantity: Measured) -> tuple[float, Range]:
        """A quantity at face value, and its range over the rounding."""
        values = quantity(self.designs)
        return float(values[0]), (float(values.min()), float(values.max()))


def values_and_halves(name: str) -> tuple[Array, Array]:
    """The values of a design of table 2, mm and deg, and half a unit of the last digit of each."""
    texts = TABLE_2[name].values()
    return np.array([float(text) for text in texts]), np.array([half_unit(text) for text in texts])


def corners(name: str) -> Corners:
    """A design of table 2 with the corners of its rounding."""
    values, halves = values_and_halves(name)
    signs = np.array([np.zeros(len(values)), *product((-1, 1), repeat=len(values))])
    d = Design(*(UNITS * (values + halves * signs)).T)
    locks = assembles(d)
    half = len(signs) // 2  # L3 takes no part in the motion: every corner of the others stands here twice
    return Corners(Design(*(of[locks] for of in d)), half, int(locks[1:].sum()) // 2)


def sensitivity(name: str) -> Mapping[str, float]:
    """By how much half a unit more of each value of table 2 changes M_P, relative, the strongest first."""
    values, halves = values_and_halves(name)
    ratio, *more = MEASURES["M_P"].of(Design(*(UNITS * np.vstack([values, values + np.diag(halves)])).T))
    changes = {variable: float(of / ratio - 1) for variable, of in zip(Design._fields, more, strict=True)}
    return dict(sorted(changes.items(), key=lambda change: -abs(change[1])))


def one_for_all(name: str, wanted: Sequence[tuple[Measured, str]]) -> dict[str, float] | None:
    """A clamp within the rounding of table 2, L3 included, that has all wanted numbers to their last digits.

    Of its values and its numbers the one that is off most, in half units, is off least. None where that search leads
    nowhere, which proves nothing.
    """
    centre, halves = values_and_halves(name)
    target, units = (np.array([of(text) for _, text in wanted]) for of in (float, half_unit))

    def off(changes: Array) -> Array:
        """Return, in half units, how far all are off for changes of shape (m, values); last, by which L3 is, mm."""
        d = Design(*(UNITS * (centre + halves * changes)).T)
        quantities = [(quantity(d) - t) / u for (quantity, _), t, u in zip(wanted, target, units, strict=True)]
        return np.stack([*quantities, third_length(d) - d.L3], axis=1)

    n = len(centre)
    change = np.zeros(n)
    for _ in range(STEPS):
        here, *there = off(np.vstack([change, change + DIFFERENCE * np.eye(n)]))
        slopes = (np.array(there) - here).T / DIFFERENCE
        level = here - slopes @ change
        rows = np.vstack([np.eye(n), slopes[:-1]])
        change = _least_largest(rows, np.append(np.zeros(n), level[:-1]), slopes[-1], level[-1])
    fits = np.abs(off(change[None])[0])
    if not (fits[:-1].max() <= 1 and fits[-1] <= 1e-6 and np.abs(change).max() <= 1):
        return None
    return dict(zip(Design._fields, (centre + halves * change).tolist(), strict=True))


def _least_largest(matrix: Array, level: Array, row: Array, at: float) -> Array:
    """An x that nearly has the least of max |matrix x + level|, among those with row x + at = 0."""
    # By least squares whose weights grow where much is left (Lawson 1961).
    known, free = -at * row / (row @ row), np.linalg.svd(row[None])[2][1:].T
    inside, left = matrix @ free, matrix @ known + level
    weights = np.ones(len(level))
    for _ in range(ROUNDS):
        root = np.sqrt(weights)
        change = np.linalg.lstsq(root[:, None] * inside, -root * left, rcond=None)[0]
        weights *= np.abs(inside @ change + left)
        weights /= weights.max()
    return np.asarray(known + free @ change)
