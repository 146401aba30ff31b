"""Double-toggle clamp: what the rounding of table 2 does to table 1."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy import pi
from numpy.typing import NDArray

from ..claims import half_unit
from . import equations as formulas
from .designs import Design, Quantity, force_ratio, third_length
from .variables import DESIGNS, assembled

STEPS, DIFFERENCE = 5, 1e-3  # towards the clamp behind table 1; the latter in half units
ROUNDS = 20  # of weights: within 2 % of the least

Vectors: TypeAlias = NDArray[np.float64]


def sensitivity(name: str) -> dict[str, float]:
    """Return by how much half a unit more of each value of table 2 changes M_P, relative, the strongest first."""
    printed = DESIGNS[name]
    face = {variable: np.array([[float(text)]]) for variable, text in printed.items()}
    ratio = force_ratio(Design(face))
    changes = {}
    for variable in (variable for variable in printed if variable not in ("L3", "alpha_max")):  # M_P needs neither
        more = face | {variable: face[variable] + half_unit(printed[variable])}
        changes[variable] = float((force_ratio(Design(more)) / ratio - 1)[0])
    return dict(sorted(changes.items(), key=lambda change: -abs(change[1])))


def alpha_of(name: str, ratio: float) -> float:
    """Return the alpha, deg, at which M_P is so large with table 2 at face value."""
    design = {variable: float(text) for variable, text in DESIGNS[name].items()}
    alphas = np.linspace(1, 5, 4001)
    inverse = 1 / formulas.force_ratio(assembled(design, pi / 180 * alphas))
    return float(np.interp(1 / ratio, inverse, alphas))


def one_for_all(name: str, wanted: Sequence[tuple[Quantity, str]]) -> dict[str, float] | None:
    """Return a clamp within the rounding of table 2, L3 included, that has all wanted numbers to their last digits.

    Of its values and its numbers the one that is off most, in half units, is off least. None where that search leads
    nowhere, which proves nothing.
    """
    printed = DESIGNS[name]
    halves, units = np.array([half_unit(t) for t in printed.values()]), np.array([half_unit(t) for _, t in wanted])
    centre, target = np.array([float(t) for t in printed.values()]), np.array([float(t) for _, t in wanted])

    def off(changes: Vectors) -> Vectors:
        """Return, in half units, how far all are off for changes of shape (m, values); last, by which L3 is, mm."""
        values = centre + halves * changes
        d = Design({variable: column[:, None] for variable, column in zip(printed, values.T, strict=True)})
        quantities = [(quantity(d) - t) / u for (quantity, _), t, u in zip(wanted, target, units, strict=True)]
        return np.stack([*quantities, third_length(d) - d.values["L3"][:, 0]], axis=1)

    n = len(printed)
    change = np.zeros(n)
    for _ in range(STEPS):
        here, *there = off(np.vstack([change, change + DIFFERENCE * np.eye(n)]))
        slopes = (np.array(there) - here).T / DIFFERENCE
        level = here - slopes @ change
        change = _least_largest(
            np.vstack([np.eye(n), slopes[:-1]]), np.append(np.zeros(n), level[:-1]), slopes[-1], level[-1]
        )
    fits = np.abs(off(change[None])[0])
    if not (fits[:-1].max() <= 1 and fits[-1] <= 1e-6 and np.abs(change).max() <= 1):
        return None
    return dict(zip(printed, (centre + halves * change).tolist(), strict=True))


def _least_largest(matrix: Vectors, level: Vectors, row: Vectors, at: float) -> Vectors:
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
