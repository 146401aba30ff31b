"""What a design of the clamp is worth, over its whole stroke at a constant speed of the crosshead.

The source names peak-valley values without a definition. That of R_V is its maximum in the second half of the closing
stroke less its minimum in the first: so read, it is 0.653 and 0.654 for the two published designs (0.65 in print), and
R_V at the start is 1.153 and 1.160 (1.16 and 1.17). The printed values of a_m follow from no reading that was tried;
here it is the range of a_m over the whole stroke, the ends included.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from . import formulas
from .formulas import DEGREE, RATED, Array, Design, Pose

SAMPLES = 401  # of half a stroke: a parabola through the largest three is then good to 1e-7
HALF = 75 * DEGREE  # between the maximum of R_V, near alpha = 50 deg, and its minimum, near 95 deg


def fastest(d: Design) -> Array:
    """The largest R_V."""
    return np.maximum(*(_largest(formulas.velocity_ratio(half)) for half in _halves(d)))


def peak_valley(d: Design) -> Array:
    """The peak of R_V less its valley."""
    first, second = (formulas.velocity_ratio(half) for half in _halves(d))
    return np.asarray(_largest(second) + _largest(-first))


def range_of_acceleration(d: Design) -> Array:
    """The range of a_m / v_o^2, 1/mm."""
    first, second = (formulas.acceleration(half) for half in _halves(d))
    a_m = np.concatenate([first, second[1:]])
    return np.asarray(_largest(a_m) + _largest(-a_m))


def _halves(d: Design) -> tuple[Pose, Pose]:
    """The first and the second half of the closing stroke, samples along the first axis."""
    part = np.linspace(0.0, 1.0, SAMPLES)
    first = d.alpha_max + np.multiply.outer(part, HALF - d.alpha_max)
    second = np.multiply.outer(HALF * (1 - part), np.ones_like(d.alpha_max))
    return formulas.at(d, first), formulas.at(d, second)


def _largest(values: Array) -> Array:
    """The largest along the first axis, by a parabola through it and its neighbours where it has both."""
    # Of complex steps: where the largest is does not change its derivative.
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
    "M_P": Measure(lambda d: 1 / formulas.velocity_ratio(formulas.at(d, RATED)), 20.0, least=False),
    "R_S": Measure(formulas.stroke_ratio, 1.0, least=False),
    "L_sum": Measure(lambda d: d.L1 + d.L2 + d.L4 + d.L5 + d.L3, 1000.0, least=True),
    "R_V start": Measure(lambda d: formulas.velocity_ratio(formulas.opened(d)), 1.0, least=False),
    "R_V max": Measure(fastest, 1.0, least=False),
    "R_V peak-valley": Measure(peak_valley, 1.0, least=True),
    "a_m range": Measure(range_of_acceleration, 0.01, least=True),
    "S_m": Measure(lambda d: formulas.platen_stroke(formulas.opened(d)), 600.0, least=False),
    "L1/L2": Measure(lambda d: d.L1 / d.L2, 1.0, least=True),
    "L4": Measure(lambda d: d.L4, 100.0, least=False),
}


def measure(name: str, d: Design) -> float:
    """A measure of one design."""
    return float(MEASURES[name].of(d))
