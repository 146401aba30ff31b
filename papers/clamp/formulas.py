"""The double-toggle clamp of a die casting machine as formulas of its design variables; lengths in mm, angles in rad.

The rear link A-B-D turns about A, with AB = L1, AD = L5 and the angle gamma between them; the front link BC = L2 pushes
the platen, the link DE = L4 is pushed by the crosshead, whose guide is Hb beside A. AB stands at theta + alpha, alpha
from alpha_max (open) to 0 (locked: A, B and C in line). BC slopes down by beta, DE up by phi, towards the tail.

A design is an array X of shape (8, ...) in the order of `VARIABLES`, real, or complex for gradients by complex steps;
alpha broadcasts against X[0]. A design that does not assemble gives NaN where X is real, and nonsense where X is
complex: ask `assembles`.

Source: zhycasting.com, Multi-Objective Optimization of Clamping Unit for 4000 kN Die Casting Machine.
"""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[Any]  # of float64 or complex128

DEGREE = np.pi / 180

VARIABLES = ("L1", "L2", "L4", "L5", "theta", "gamma", "alpha_max", "Hb")
UNITS = np.array([1, 1, 1, 1, DEGREE, DEGREE, DEGREE, 1])  # what a table's mm and deg are multiplied by
LOWER = UNITS * [320, 415, 100, 280, 4, 18, 90, 210]
UPPER = UNITS * [410, 505, 150, 330, 6, 25, 110, 250]

INITIAL = UNITS * [352, 457, 120, 305, 4.5, 19.4, 110, 235.5]  # the columns of the source's table 2
SCHEME_4 = UNITS * [368, 430, 135, 280, 4, 18, 105, 239]

RATED = 2.5 * DEGREE  # the alpha at which M_P is stated


def bar(X: Array, alpha: ArrayLike) -> Array:
    """Return the angle of AB above the guides."""
    return np.asarray(X[4] + alpha)


def ear(X: Array, alpha: ArrayLike) -> Array:
    """Return the angle of AD above the guides."""
    return np.asarray(X[4] + X[5] + alpha)


def beta(X: Array, alpha: ArrayLike) -> Array:
    """Return beta."""
    L1, L2, theta = X[0], X[1], X[4]
    return np.asarray(np.arcsin((L1 * np.sin(theta + alpha) - (L1 + L2) * np.sin(theta)) / L2))


def phi(X: Array, alpha: ArrayLike) -> Array:
    """Return phi."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.arcsin(sine_phi(X, alpha)))


def sine_phi(X: Array, alpha: ArrayLike) -> Array:
    """Return sin(phi), which is beyond -1..1 where DE is too short."""
    return np.asarray((X[7] - X[3] * np.sin(ear(X, alpha))) / X[2])


def assembles(X: Array) -> NDArray[np.bool_]:
    """Return whether D and E can be joined over the whole stroke; B and C always can, as L1 < L2 within the bounds.

    sin(phi) is least where AD is upright, which it is within every stroke, and largest at an end.
    """
    theta, gamma, alpha_max = X[4:7]
    upright = np.pi / 2 - theta - gamma
    return np.asarray(np.all([np.abs(sine_phi(X, alpha)) < 1 for alpha in (0.0, upright, alpha_max)], axis=0))


def crosshead(X: Array, alpha: ArrayLike) -> Array:
    """Return x of E, from A."""
    return np.asarray(X[3] * np.cos(ear(X, alpha)) - X[2] * np.cos(phi(X, alpha)))


def platen(X: Array, alpha: ArrayLike) -> Array:
    """Return x of C, from A."""
    return np.asarray(X[0] * np.cos(bar(X, alpha)) + X[1] * np.cos(beta(X, alpha)))


def platen_stroke(X: Array) -> Array:
    """Return S_m, as printed."""
    return np.asarray((X[0] + X[1]) * np.cos(X[4]) - platen(X, X[6]))


def crosshead_stroke(X: Array) -> Array:
    """Return S_o; in print both roots have the wrong sign."""
    return crosshead(X, 0.0) - crosshead(X, X[6])


def stroke_ratio(X: Array) -> Array:
    """Return R_S = S_m / S_o."""
    return np.asarray(platen_stroke(X) / crosshead_stroke(X))


def velocity_ratio(X: Array, alpha: ArrayLike) -> Array:
    """Return R_V = v_m / v_o, as printed."""
    b, p = beta(X, alpha), phi(X, alpha)
    return np.asarray(X[0] * np.sin(bar(X, alpha) + b) * np.cos(p) / (X[3] * np.sin(ear(X, alpha) + p) * np.cos(b)))


def force_ratio(X: Array) -> Array:
    """Return M_P = P_m / P_o at alpha = 2.5 deg, as printed: 1 / R_V, by virtual work."""
    return np.asarray(1 / velocity_ratio(X, RATED))


def acceleration(X: Array, alpha: ArrayLike) -> Array:
    """Return a_m / v_o^2 = d R_V / d x_E, 1/mm, at a constant speed of the crosshead.

    With ' for d/d alpha: R_V = x_C' / x_E', and so a_m / v_o^2 = (x_C'' - R_V x_E'') / x_E'^2.
    """
    L1, L2, L4, L5 = X[:4]
    AB, AD, b, p = bar(X, alpha), ear(X, alpha), beta(X, alpha), phi(X, alpha)
    C, C2 = _slider(L1, AB, b, L1 * np.cos(AB) / (L2 * np.cos(b)))
    E, E2 = _slider(L5, AD, p, -L5 * np.cos(AD) / (L4 * np.cos(p)))
    return np.asarray((C2 - C / E * E2) / E**2)


def _slider(crank: Array, turned: Array, slope: Array, rate: Array) -> tuple[Array, Array]:
    """Return the derivatives x' and x'' of a slider by the crank's angle; `rate` is that of the rod's slope."""
    first = -crank * np.sin(turned + slope) / np.cos(slope)
    turning = np.cos(turned + slope) * (1 + rate) + np.sin(turned + slope) * np.tan(slope) * rate
    return first, -crank * turning / np.cos(slope)


def third_length(X: Array) -> Array:
    """Return L3 = BD, by the cosine law."""
    return np.asarray(np.sqrt(X[0] ** 2 + X[3] ** 2 - 2 * X[0] * X[3] * np.cos(X[5])))


def total_length(X: Array) -> Array:
    """Return L_sum = L1 + .. + L5."""
    return np.asarray(X[:4].sum(axis=0) + third_length(X))
