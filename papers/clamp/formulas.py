"""Double-toggle clamp: its formulas as they should be, and a_m as printed too; what a design is worth by them.

The rear link A-B-D turns about A, with AB = L1, AD = L5 and the angle gamma between them; the front link BC = L2 pushes
the platen, the link DE = L4 is pushed by the crosshead, whose guide is Hb beside A. AB stands at theta + alpha, alpha
from alpha_max (open) to 0 (locked: A, B and C in line), BC at -beta, DE at -phi. The source's figure is missing; read
so, its formulas for R_V, the rates and M_P hold; `equations` has each as printed. Closing makes w1 and w4 clockwise, w2
counter-clockwise.

Lengths and speeds may have any unit, angles are in rad; all may be arrays that broadcast, and complex for gradients by
complex steps. A clamp that cannot be assembled gives NaN where it is real, and nonsense where it is complex: there
`assembles` decides.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy import arcsin, cos, pi, sin, sqrt
from numpy.typing import NDArray

from .printed import ANGLES, TABLE_2

Array: TypeAlias = NDArray[Any]  # of float64 or complex128

DEGREE = pi / 180
RATED = 2.5 * DEGREE  # the alpha at which M_P is stated


class Design(NamedTuple):
    """The values of table 2, lengths in mm, angles in rad; each a number or an array of one shape."""

    L1: Any
    L2: Any
    L3: Any
    L4: Any
    L5: Any
    Hb: Any
    theta: Any
    gamma: Any
    alpha_max: Any


UNITS = np.array([DEGREE if name in ANGLES else 1.0 for name in Design._fields])  # what mm and deg are multiplied by


@dataclass(frozen=True)
class Pose:
    """A design at alpha, with the angles that follow."""

    d: Design
    alpha: Any
    beta: Any
    phi: Any

    @property
    def bar(self) -> Any:
        """The angle of AB above the guides."""
        return self.d.theta + self.alpha

    @property
    def ear(self) -> Any:
        """The angle of AD above the guides."""
        return self.d.theta + self.d.gamma + self.alpha


def at(d: Design, alpha: Any) -> Pose:
    """A design at alpha, with beta and phi from its closed loops."""
    # Heights in the two loops. C stays at the height of the lock, where A, B and C are in line at theta: L1 sin(theta +
    # alpha) - L2 sin(beta) = (L1 + L2) sin(theta). E stays at Hb: see `sine_phi`. The arcsine takes the branch on which
    # the platen is ahead of B and the crosshead behind D.
    with np.errstate(invalid="ignore"):
        beta = arcsin((d.L1 * sin(d.theta + alpha) - (d.L1 + d.L2) * sin(d.theta)) / d.L2)
        phi = arcsin(sine_phi(d, alpha))
    return Pose(d, alpha, beta, phi)


def opened(d: Design) -> Pose:
    """A design where it starts to close."""
    return at(d, d.alpha_max)


def sine_phi(d: Design, alpha: Any) -> Array:
    """Return sin(phi), which is beyond -1..1 where DE is too short."""
    return np.asarray((d.Hb - d.L5 * sin(d.theta + d.gamma + alpha)) / d.L4)


def assembles(d: Design) -> NDArray[np.bool_]:
    """Whether D and E can be joined over the whole stroke; B and C always can, as L1 < L2 within the bounds."""
    # sin(phi) is least where AD is upright, which it is within every stroke, and largest at an end.
    upright = pi / 2 - d.theta - d.gamma
    return np.asarray(np.all([np.abs(sine_phi(d, alpha)) < 1 for alpha in (0.0, upright, d.alpha_max)], axis=0))


def third_length(d: Design) -> Array:
    """Return L3 = BD by the cosine law."""
    return np.asarray(sqrt(d.L1**2 + d.L5**2 - 2 * d.L1 * d.L5 * cos(d.gamma)))


def closed(d: Design) -> Design:
    """A design whose L3 closes the triangle A-B-D."""
    return d._replace(L3=third_length(d))


def platen(p: Pose) -> Array:
    """Return x of C, from A."""
    return np.asarray(p.d.L1 * cos(p.bar) + p.d.L2 * cos(p.beta))


def crosshead(p: Pose) -> Array:
    """Return x of E, from A; it is behind D, where S_o is printed with it ahead of D."""
    return np.asarray(p.d.L5 * cos(p.ear) - p.d.L4 * cos(p.phi))


def platen_stroke(p: Pose) -> Array:
    """Return S_m, the numerator of R_S, from a pose to the lock."""
    return platen(at(p.d, 0.0)) - platen(p)


def crosshead_stroke(p: Pose) -> Array:
    """Return S_o, the denominator of R_S, from a pose to the lock."""
    return crosshead(at(p.d, 0.0)) - crosshead(p)


def stroke_ratio(d: Design) -> Array:
    """Return R_S = S_m / S_o over the whole stroke, with the signs of the roots that hold."""
    return np.asarray(platen_stroke(opened(d)) / crosshead_stroke(opened(d)))


def velocity_ratio(p: Pose) -> Array:
    """Return R_V = v_m / v_o; its reciprocal is M_P = P_m / P_o, by virtual work."""
    return np.asarray(p.d.L1 * sin(p.bar + p.beta) * cos(p.phi) / (p.d.L5 * sin(p.ear + p.phi) * cos(p.beta)))


def acceleration(p: Pose, Vo: float = 1.0, *, printed: bool = False) -> Array:
    """Return a_m at a constant speed of the crosshead, corrected or as printed; at speed one that is a_m / v_o^2."""
    # Second derivatives of the loops at a constant speed of the crosshead. The height of C is constant, which gives w2
    # from w1 and would give e2; e2 is eliminated by projecting the acceleration of C on the direction of BC, hence the
    # division by cos(beta) of the whole sum, where the source multiplies the last term by it.
    d = p.d
    w1, w4 = (
        Vo * ratio / sin(p.ear + p.phi) for ratio in (cos(p.phi) / d.L5, cos(p.ear) / d.L4)
    )  # of the links at A and E
    w2 = d.L1 * w1 * cos(p.bar) / (d.L2 * cos(p.beta))
    e1 = (d.L5 * w1**2 * cos(p.ear + p.phi) - d.L4 * w4**2) / (d.L5 * sin(p.ear + p.phi))
    of_B = d.L1 * e1 * sin(p.bar + p.beta) - d.L1 * w1**2 * cos(p.bar + p.beta)
    of_C = d.L2 * w2**2
    return np.asarray(of_B - of_C * cos(p.beta) if printed else (of_B - of_C) / cos(p.beta))


# --- the designs of table 2, with the L3 that closes -----------------------------------------------------------------

PUBLISHED: Mapping[str, Design] = {
    name: closed(Design(*(UNITS * [float(text) for text in values.values()]))) for name, values in TABLE_2.items()
}
INITIAL, SCHEME_4 = PUBLISHED.values()


# --- what a design is worth, over its whole stroke at a constant speed of the crosshead -------------------------------

# The source names peak-valley values without a definition. That of R_V is its maximum in the second half of the
# closing stroke less its minimum in the first: so read, it is 0.653 and 0.654 for the two published designs (0.65 in
# print), and R_V at the start is 1.153 and 1.160 (1.16 and 1.17). The printed values of a_m follow from no reading that
# was tried; here it is the range of a_m over the whole stroke, the ends included.

SAMPLES = 401  # of half a stroke: a parabola through the largest three is then good to 1e-7
HALF = 75 * DEGREE  # between the maximum of R_V, near alpha = 50 deg, and its minimum, near 95 deg


def fastest(d: Design) -> Array:
    """The largest R_V."""
    return np.maximum(*(_largest(velocity_ratio(half)) for half in _halves(d)))


def peak_valley(d: Design) -> Array:
    """The peak of R_V less its valley."""
    first, second = (velocity_ratio(half) for half in _halves(d))
    return np.asarray(_largest(second) + _largest(-first))


def range_of_acceleration(d: Design) -> Array:
    """The range of a_m / v_o^2, 1/mm."""
    first, second = (acceleration(half) for half in _halves(d))
    a_m = np.concatenate([first, second[1:]])
    return np.asarray(_largest(a_m) + _largest(-a_m))


def _halves(d: Design) -> tuple[Pose, Pose]:
    """The first and the second half of the closing stroke, samples along the first axis."""
    part = np.linspace(0.0, 1.0, SAMPLES)
    first = d.alpha_max + np.multiply.outer(part, HALF - d.alpha_max)
    second = np.multiply.outer(HALF * (1 - part), np.ones_like(d.alpha_max))
    return at(d, first), at(d, second)


def _largest(values: Array) -> Array:
    """The largest along the first axis, by a parabola through it and its neighbours where it has both."""
    # Vertex of the parabola through three equidistant samples. The row of the largest sample is taken from the real
    # parts: by the envelope theorem a shift of that place does not change the derivative of the largest value, so that
    # a complex step passes through.
    row = values.real.argmax(axis=0)
    middle = np.clip(row, 1, len(values) - 2)
    before, top, after = (np.take_along_axis(values, (middle + step)[None], 0)[0] for step in (-1, 0, 1))
    peak = top + (after - before) ** 2 / (8 * (2 * top - before - after))
    return np.asarray(np.where(row == middle, peak, np.take_along_axis(values, row[None], 0)[0]))


class Measure(NamedTuple):
    """A function of a design; divided by its scale it is of order one."""

    of: Callable[[Design], Array]
    scale: float
    least: bool  # whether less is better


MEASURES: Mapping[str, Measure] = {
    "M_P": Measure(lambda d: 1 / velocity_ratio(at(d, RATED)), 20.0, least=False),
    "R_S": Measure(stroke_ratio, 1.0, least=False),
    "L_sum": Measure(lambda d: d.L1 + d.L2 + d.L4 + d.L5 + d.L3, 1000.0, least=True),
    "R_V start": Measure(lambda d: velocity_ratio(opened(d)), 1.0, least=False),
    "R_V max": Measure(fastest, 1.0, least=False),
    "R_V peak-valley": Measure(peak_valley, 1.0, least=True),
    "a_m range": Measure(range_of_acceleration, 0.01, least=True),
    "S_m": Measure(lambda d: platen_stroke(opened(d)), 600.0, least=False),
    "L1/L2": Measure(lambda d: d.L1 / d.L2, 1.0, least=True),
    "L4": Measure(lambda d: d.L4, 100.0, least=False),
}


def measure(name: str, d: Design) -> float:
    """A measure of one design."""
    return float(MEASURES[name].of(d))
