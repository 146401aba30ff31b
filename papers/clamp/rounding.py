"""Double-toggle clamp: what the rounding of table 2 leaves open, and what it does to table 1."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

import numpy as np
from scipy.optimize import minimize

from ..claims import Range, half_unit
from .formulas import UNITS, Array, Design, assembles, closed
from .measures import MEASURES
from .printed import TABLE_2

COUNT = 2**8  # corners of the eight values that take part in the motion
Measured: TypeAlias = Callable[[Design], Array]


@dataclass(frozen=True)
class Corners:
    """A design of table 2 at face value, and at those corners of its rounding at which it can lock."""

    designs: Design  # values of shape (m,), the face value first
    locking: int  # of the `COUNT` corners

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
    # L3 takes no part in the motion: every corner of the others stands here twice.
    return Corners(Design(*(of[locks] for of in d)), int(locks[1:].sum()) // 2)


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
    n = len(centre)

    def clamp(x: Array) -> Design:
        """Return the clamp with other values by x, in half units, but with the L3 that closes it."""
        return closed(Design(*(UNITS * (centre + halves * x[:n]))))

    def room(x: Array) -> Array:
        """Return by how much all stay within the most, the last of x, above and below, in half units."""
        d = clamp(x)
        numbers = np.array([quantity(d) for quantity, _ in wanted])
        off = np.concatenate([(d / UNITS - centre) / halves, (numbers - target) / units])
        return np.concatenate([x[n] - off, x[n] + off])

    start, within = np.append(np.zeros(n), 1.0), {"type": "ineq", "fun": room}
    end = minimize(lambda x: x[n], start, constraints=within, method="SLSQP")
    if not (end.success and end.x[n] <= 1):
        return None
    return dict(zip(Design._fields, (clamp(end.x) / UNITS).tolist(), strict=True))
