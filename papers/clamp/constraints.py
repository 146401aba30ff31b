"""The source's constraints as slack, which is not negative where they hold, and what had to be read into them.

phi_max is printed twice. In phi_max <= 85 deg it is the largest phi of the stroke, which is at one of its ends. In
alpha_max + gamma + phi_max + theta <= 160 deg, so read, both published designs are far off, with 203 and 210 deg; there
it is phi at alpha_max: the sum is then the angle between AD and DE in the open clamp, which must stay 20 deg short of
the dead point. `OPENING` is that constraint, `LITERAL` the other.

Bounds on the variables are not among them: the optimiser's box has them.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from . import formulas
from .formulas import DEGREE, INITIAL, SCHEME_4, Array, Design
from .printed import LENGTH_RATIO, MAX_OPENING, MAX_PHI, MAX_STROKE_RATIO, PLATEN_STROKE

LENGTH = 100.0  # mm, that slacks of lengths are relative to


@dataclass(frozen=True)
class Clearance:
    """What the pins' diameters and the crosshead's height, which the source does not give, amount to, mm."""

    B: float  # H_s/2 - d_B, the most that L1 - Hb may be
    D: float  # H_s/2 - d_D, the most that L5 - Hb may be
    L3: float  # (d_B + d_D)/2
    L4: float  # (d_D + d_E)/2

    @property
    def sizes(self) -> Mapping[str, float]:
        """The sizes that amount to this, mm."""
        d_B = self.L3 + (self.D - self.B) / 2
        d_D = 2 * self.L3 - d_B
        return {"d_B": d_B, "d_D": d_D, "d_E": 2 * self.L4 - d_D, "H_s": 2 * (self.B + d_B)}


# The sizes of pins and crosshead are not given, so that four constraints have unknown right-hand sides. Each published
# design is assumed to be feasible: the least clearance for which it is so is then a bound that any true sizes satisfy.
def tightest(*designs: Design) -> Clearance:
    """The least clearance of some designs: what meets it does so with any sizes that let them all be."""
    return Clearance(
        float(max(d.L1 - d.Hb for d in designs)),
        float(max(d.L5 - d.Hb for d in designs)),
        float(min(formulas.third_length(d) for d in designs)),
        float(min(d.L4 for d in designs)),
    )


BOTH, ALONE = tightest(INITIAL, SCHEME_4), tightest(SCHEME_4)
LOOSEST = Clearance(1000.0, 1000.0, 0.0, 0.0)  # no design within the bounds comes near

RATIO = "R_S <= 1.12"
OPENING = "alpha_max + gamma + phi + theta <= 160 deg"
LITERAL = "alpha_max + gamma + phi_max + theta <= 160 deg"
SLENDER, STROKE = "L1/L2 <= 0.85", "S_m <= 600 mm"


def opening(d: Design, alpha: float | Array) -> Array:
    """Return alpha_max + gamma + phi + theta, rad, with phi at some alpha: 0 in the lock, alpha_max when open."""
    return np.asarray(formulas.opened(d).ear + formulas.at(d, alpha).phi)


PRINTED: Mapping[str, Callable[[Design, Clearance], Array]] = {
    "L1 + d_B <= Hb + H_s/2": lambda d, clearance: (clearance.B - d.L1 + d.Hb) / LENGTH,
    "L5 + d_D <= Hb + H_s/2": lambda d, clearance: (clearance.D - d.L5 + d.Hb) / LENGTH,
    OPENING: lambda d, _: MAX_OPENING * DEGREE - opening(d, d.alpha_max),
    LITERAL: lambda d, _: MAX_OPENING * DEGREE - opening(d, 0.0),
    "L1/L2 >= 0.7": lambda d, _: d.L1 / d.L2 - LENGTH_RATIO[0],
    SLENDER: lambda d, _: LENGTH_RATIO[1] - d.L1 / d.L2,
    "L4 >= (d_D + d_E)/2": lambda d, clearance: (d.L4 - clearance.L4) / LENGTH,
    "L3 >= (d_B + d_D)/2": lambda d, clearance: (formulas.third_length(d) - clearance.L3) / LENGTH,
    "phi <= 85 deg, locked": lambda d, _: _below(formulas.sine_phi(d, 0.0)),
    "phi <= 85 deg, open": lambda d, _: _below(formulas.sine_phi(d, d.alpha_max)),
    "S_m >= 500 mm": lambda d, _: (formulas.platen_stroke(formulas.opened(d)) - PLATEN_STROKE[0]) / PLATEN_STROKE[1],
    STROKE: lambda d, _: (PLATEN_STROKE[1] - formulas.platen_stroke(formulas.opened(d))) / PLATEN_STROKE[1],
    RATIO: lambda d, _: MAX_STROKE_RATIO - formulas.stroke_ratio(d),
}


def slacks(d: Design, clearance: Clearance) -> dict[str, Array]:
    """The slack of each constraint, dimensionless, each of the shape of the design's values."""
    return {name: slack(d, clearance) for name, slack in PRINTED.items()}


# A first-order equivalent of phi_max - phi, with the same sign. An arcsine would be NaN, without a gradient, as soon as
# DE is too short for its guide; the sine goes on growing there and leads an optimiser back.
def _below(sine: Array) -> Array:
    """How far phi is below its limit, rad where it is near; by the sine, which still grows past 90 deg."""
    largest = MAX_PHI * DEGREE
    return np.asarray((np.sin(largest) - sine) / np.cos(largest))
