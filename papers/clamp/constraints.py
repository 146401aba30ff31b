"""The source's constraints as slack, which is not negative where they hold, and what had to be read into them.

phi_max is printed twice. In phi_max <= 85 deg it is the largest phi of the stroke, which is at one of its ends. In
alpha_max + gamma + phi_max + theta <= 160 deg, so read, both published designs are far off, with 203 and 210 deg; there
it is phi at alpha_max: the sum is then the angle between AD and DE in the open clamp, which must stay 20 deg short of
the dead point. `OPENING` is that constraint, `LITERAL` the other.

Bounds on X are not among them: the optimiser's box has them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .formulas import DEGREE, Array, ear, phi, platen_stroke, sine_phi, stroke_ratio, third_length

LARGEST_PHI = 85 * DEGREE
LARGEST_OPENING = 160 * DEGREE
LENGTH = 100.0  # mm, that slacks of lengths are relative to
STROKE = 600.0  # mm


class Sizes(NamedTuple):
    """The pins' diameters and the crosshead's height, mm; the source does not give them."""

    B: float
    D: float
    E: float
    H: float


@dataclass(frozen=True)
class Clearance:
    """What the sizes amount to in the constraints: four numbers, mm, from which the sizes follow."""

    B: float  # H_s/2 - d_B, the most that L1 - Hb may be
    D: float  # H_s/2 - d_D, the most that L5 - Hb may be
    L3: float  # (d_B + d_D)/2
    L4: float  # (d_D + d_E)/2

    @property
    def sizes(self) -> Sizes:
        """Return the sizes that amount to this."""
        d_B = self.L3 + (self.D - self.B) / 2
        d_D = 2 * self.L3 - d_B
        return Sizes(d_B, d_D, 2 * self.L4 - d_D, 2 * (self.B + d_B))


def tightest(*designs: Array) -> Clearance:
    """Return the least clearance of some designs: what meets it does so with any sizes that let them all be."""
    X = np.stack(designs, axis=1)
    return Clearance(
        float((X[0] - X[7]).max()), float((X[3] - X[7]).max()), float(third_length(X).min()), float(X[2].min())
    )


LOOSEST = Clearance(1000.0, 1000.0, 0.0, 0.0)  # no design within the bounds comes near


RATIO = "R_S <= 1.12"
OPENING = "alpha_max + gamma + phi + theta <= 160 deg"
LITERAL = "alpha_max + gamma + phi_max + theta <= 160 deg"

PRINTED: Mapping[str, Callable[[Array, Clearance], Array]] = {
    "L1 + d_B <= Hb + H_s/2": lambda X, clearance: (clearance.B - X[0] + X[7]) / LENGTH,
    "L5 + d_D <= Hb + H_s/2": lambda X, clearance: (clearance.D - X[3] + X[7]) / LENGTH,
    OPENING: lambda X, _: LARGEST_OPENING - ear(X, X[6]) - phi(X, X[6]),
    LITERAL: lambda X, _: LARGEST_OPENING - ear(X, X[6]) - phi(X, 0.0),
    "L1/L2 >= 0.7": lambda X, _: X[0] / X[1] - 0.7,
    "L1/L2 <= 0.85": lambda X, _: 0.85 - X[0] / X[1],
    "L4 >= (d_D + d_E)/2": lambda X, clearance: (X[2] - clearance.L4) / LENGTH,
    "L3 >= (d_B + d_D)/2": lambda X, clearance: (third_length(X) - clearance.L3) / LENGTH,
    "phi <= 85 deg, locked": lambda X, _: _below(sine_phi(X, 0.0)),
    "phi <= 85 deg, open": lambda X, _: _below(sine_phi(X, X[6])),
    "S_m >= 500 mm": lambda X, _: (platen_stroke(X) - 500) / STROKE,
    "S_m <= 600 mm": lambda X, _: (600 - platen_stroke(X)) / STROKE,
    RATIO: lambda X, _: 1.12 - stroke_ratio(X),
}


def slacks(X: Array, clearance: Clearance) -> dict[str, Array]:
    """Return the slack of each constraint, dimensionless, each of the shape of X[0]."""
    return {name: slack(X, clearance) for name, slack in PRINTED.items()}


def _below(sine: Array) -> Array:
    """Return how far phi is below its limit, rad where it is near; by the sine, which says so past 90 deg too."""
    return np.asarray((np.sin(LARGEST_PHI) - sine) / np.cos(LARGEST_PHI))
