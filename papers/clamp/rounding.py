"""Double-toggle clamp: what the rounding of table 2 does to table 1."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..claims import half_unit
from .corners import Quantity, values_and_halves
from .formulas import UNITS, Array, Design, third_length
from .measures import MEASURES

STEPS, DIFFERENCE = 5, 1e-3  # towards the clamp behind table 1; the latter in half units
ROUNDS = 20  # of weights: within 2 % of the least


def sensitivity(name: str) -> Mapping[str, float]:
    """Return by how much half a unit more of each value of table 2 changes M_P, relative, the strongest first."""
    values, halves = values_and_halves(name)
    ratio, *more = MEASURES["M_P"].of(Design(*(UNITS * np.vstack([values, values + np.diag(halves)])).T))
    changes = {variable: float(of / ratio - 1) for variable, of in zip(Design._fields, more, strict=True)}
    return dict(sorted(changes.items(), key=lambda change: -abs(change[1])))


def one_for_all(name: str, wanted: Sequence[tuple[Quantity, str]]) -> dict[str, float] | None:
    """Return a clamp within the rounding of table 2, L3 included, that has all wanted numbers to their last digits.

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
    """Return an x that nearly has the least of max |matrix x + level|, among those with row x + at = 0.

    By least squares whose weights grow where much is left (Lawson 1961).
    """
    known, free = -at * row / (row @ row), np.linalg.svd(row[None])[2][1:].T
    inside, left = matrix @ free, matrix @ known + level
    weights = np.ones(len(level))
    for _ in range(ROUNDS):
        root = np.sqrt(weights)
        change = np.linalg.lstsq(root[:, None] * inside, -root * left, rcond=None)[0]
        weights *= np.abs(inside @ change + left)
        weights /= weights.max()
    return np.asarray(known + free @ change)
