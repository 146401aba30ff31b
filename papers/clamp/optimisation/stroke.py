"""What a design does over the whole stroke at a constant speed of the crosshead.

The source names peak-valley values without saying what they are. That of R_V is its maximum in the second half of the
closing stroke less its minimum in the first: so read, it is 0.653 and 0.654 for the two published designs (0.65 in
print), and R_V at the start is 1.153 and 1.160 (1.16 and 1.17). The printed values of a_m follow from no reading that
was tried; here it is the range of a_m over the whole stroke, the ends included.
"""

import numpy as np

from ..formulas import DEGREE, Array, acceleration, velocity_ratio

SAMPLES = 61  # of half a stroke: a parabola through the largest three is then good to 5e-6,
FINE = 1001  # and to 1e-9 here
HALF = 75 * DEGREE  # between the maximum of R_V, near alpha = 50 deg, and its minimum, near 95 deg


def start(X: Array) -> Array:
    """Return R_V of the open clamp."""
    return velocity_ratio(X, X[6])


def fastest(X: Array) -> Array:
    """Return the largest R_V."""
    halves = (_largest(velocity_ratio(X, half(X, FINE))) for half in (_first_half, _second_half))
    return np.maximum(*halves)


def peak_valley(X: Array) -> Array:
    """Return the peak of R_V less its valley."""
    return np.asarray(_largest(velocity_ratio(X, _second_half(X))) + _largest(-velocity_ratio(X, _first_half(X))))


def range_of_acceleration(X: Array) -> Array:
    """Return the range of a_m / v_o^2, 1/mm."""
    a_m = acceleration(X, np.concatenate([_first_half(X), _second_half(X)[1:]]))
    return np.asarray(_largest(a_m) + _largest(-a_m))


def _first_half(X: Array, samples: int = SAMPLES) -> Array:
    return np.asarray(X[6] + np.multiply.outer(np.linspace(0.0, 1.0, samples), HALF - X[6]))


def _second_half(X: Array, samples: int = SAMPLES) -> Array:
    return np.asarray(np.multiply.outer(np.linspace(HALF, 0.0, samples), np.ones_like(X[6])))


def _largest(values: Array) -> Array:
    """Return the largest along the first axis, by a parabola through it and its neighbours where it has both.

    Of complex steps: where the largest is does not change its derivative.
    """
    at = values.real.argmax(axis=0)
    middle = np.clip(at, 1, len(values) - 2)
    before, top, after = (np.take_along_axis(values, (middle + step)[None], 0)[0] for step in (-1, 0, 1))
    peak = top + (after - before) ** 2 / (8 * (2 * top - before - after))
    return np.asarray(np.where(at == middle, peak, np.take_along_axis(values, at[None], 0)[0]))
