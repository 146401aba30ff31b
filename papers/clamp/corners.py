"""Double-toggle clamp: its designs at face value and at the corners of what the rounding of table 2 leaves open."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import TypeAlias

import numpy as np

from ..claims import Range, half_unit
from .formulas import UNITS, Array, Design, assembles
from .printed import TABLE_2

Quantity: TypeAlias = Callable[[Design], Array]


@dataclass(frozen=True)
class Corners:
    """A design of table 2 at face value, and at those corners of its rounding at which it can lock."""

    designs: Design  # values of shape (m,), the face value first
    count: int  # of all corners, of the eight values that take part in the motion
    locking: int

    def over(self, quantity: Quantity) -> tuple[float, Range]:
        """Return a quantity at face value, and its range over the rounding."""
        found = quantity(self.designs)
        return float(found[0]), (float(found.min()), float(found.max()))


def values_and_halves(name: str) -> tuple[Array, Array]:
    """Return the values of a design of table 2, mm and deg, and half a unit of the last digit of each."""
    texts = TABLE_2[name].values()
    return np.array([float(text) for text in texts]), np.array([half_unit(text) for text in texts])


def corners(name: str) -> Corners:
    """Return a design of table 2 with the corners of its rounding."""
    values, halves = values_and_halves(name)
    signs = np.array([np.zeros(len(values)), *product((-1, 1), repeat=len(values))])
    d = Design(*(UNITS * (values + halves * signs)).T)
    locks = assembles(d)
    half = len(signs) // 2  # L3 takes no part in the motion: every corner of the others stands here twice
    return Corners(Design(*(of[locks] for of in d)), half, int(locks[1:].sum()) // 2)
