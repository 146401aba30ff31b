"""Cubic splines through a table, by the tridiagonal equations of their slopes: without SciPy, which is slow to import.

With the step h, the chord's slope m and the slopes s at its ends, the cubic of a step is

    y + s0 t + (3 m - 2 s0 - s1) / h t^2 + (s0 + s1 - 2 m) / h^2 t^3,        t from 0 to h.

The second derivatives at both sides of an inner entry are equal where h1 s0 + 2 (h0 + h1) s1 + h0 s2 is
3 (h1 m0 + h0 m1):
de Boor, "A Practical Guide to Splines" (1978), chapter 4. Those of a periodic spline are a ring, which is solved as a
chain with its last slope open; else the first two cubics are one, and the last two (not-a-knot). The chain is solved
with pivots, so that steps of very different lengths do no harm.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .laws import Samples


@dataclass(frozen=True)
class CubicSpline:
    """A spline of n - 1 cubics; a periodic one goes on for ever, the others by their first and last cubics."""

    x: Samples  # (n,), increasing
    c: Samples  # (4, n - 1), from the cube's on, of the way from where each cubic begins
    periodic: bool

    def __call__(self, x: Samples, order: int = 0) -> Samples:
        """The values, or derivatives of an order from 1 to 3, at any places."""
        if self.periodic:
            x = self.x[0] + (x - self.x[0]) % (self.x[-1] - self.x[0])
        row = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self.x) - 2)
        t = x - self.x[row]
        value, power = np.zeros(np.shape(x)), np.ones(np.shape(x))
        for degree in range(order, 4):
            factor = float(np.prod(range(degree - order + 1, degree + 1)))
            value, power = value + self.c[3 - degree][row] * power * factor, power * t
        return value

    def still(self, order: int, slope: float = 0.0) -> NDArray[np.float64]:
        """Where the first derivative is a slope, or the second zero, within the cubics and at their ends."""
        found = []
        for begin, end, (c3, c2, c1, _) in zip(self.x, self.x[1:], self.c.T, strict=False):
            terms = [3 * c3, 2 * c2, c1 - slope] if order == 1 else [6 * c3, 2 * c2]
            ways = np.roots(np.trim_zeros(terms, "f"))
            found += [begin + way.real for way in ways if way.imag == 0 and 0 <= way.real <= end - begin]
        return np.array(found)


def cubic_spline(x: Samples, y: Samples, *, periodic: bool) -> CubicSpline:
    """The spline through n >= 2 points; of a periodic one the last y is the first."""
    h, m = np.diff(x), np.diff(y) / np.diff(x)
    s = _of_ring(h, m) if periodic else _of_chain(h, m)
    t = (s[:-1] + s[1:] - 2 * m) / h
    return CubicSpline(x, np.array([t / h, (m - s[:-1]) / h - t, s[:-1], y[:-1]]), periodic)


def _of_chain(h: Samples, m: Samples) -> Samples:
    """The slopes of a spline whose ends are not-a-knot; of three points a parabola's, of two a line's."""
    if len(h) == 1:
        return np.array([m[0], m[0]])
    if len(h) == 2:  # the slope of a parabola half way is that of the chord
        middle = (h[1] * m[0] + h[0] * m[1]) / (h[0] + h[1])
        return np.array([2 * m[0] - middle, middle, 2 * m[1] - middle])
    # Not-a-knot: the third derivative does not jump at the second knot. The third slope is eliminated from that
    # condition by the continuity of the second derivative there, which leaves an equation of the first two slopes, so
    # that the matrix stays tridiagonal; at the other end likewise.
    first, last = h[0] + h[1], h[-1] + h[-2]
    lower, upper = [*h[1:], last], [first, *h[:-1]]
    middle = [h[1], *(2 * (h[:-1] + h[1:])), h[-2]]
    begin = ((h[0] + 2 * first) * h[1] * m[0] + h[0] ** 2 * m[1]) / first
    end = (h[-1] ** 2 * m[-2] + (2 * last + h[-1]) * h[-2] * m[-1]) / last
    return _tridiagonal(lower, middle, upper, [begin, *(3 * (h[1:] * m[:-1] + h[:-1] * m[1:])), end])


def _of_ring(h: Samples, m: Samples) -> Samples:
    """The slopes of a periodic spline, the last the first one again."""
    # With two steps or one both neighbours of a knot are the same knot, and the equations of the ring have one
    # solution: all slopes are the mean of the chords' slopes, weighted by 1 / h.
    if len(h) < 3:
        return np.full(len(h) + 1, float((m / h).sum() / (1 / h).sum()))
    right = 3 * (h * np.roll(m, 1) + np.roll(h, 1) * m)  # of all slopes but the last, which is the first
    diagonal, before = 2 * (h + np.roll(h, 1)), np.roll(h, 1)
    # The last slope stands in the first and in the last equation of the chain too, by which the ring closes. The chain
    # is solved twice: for the right sides, with that slope zero, and for what a slope of one adds. The equation of the
    # ring that is left then gives the slope itself (Sherman and Morrison's idea, without a modified matrix).
    chain = [*h[1:-1]], [*diagonal[:-1]], [*before[:-2]]
    fixed = _tridiagonal(*chain, [*right[:-1]])
    moved = _tridiagonal(*chain, [-h[0], *[0.0] * (len(h) - 3), -h[-3]])
    ends = right[-1] - h[-2] * fixed[0] - h[-1] * fixed[-1]
    last = ends / (diagonal[-1] + h[-2] * moved[0] + h[-1] * moved[-1])
    slopes = fixed + last * moved
    return np.array([*slopes, last, slopes[0]])


def _tridiagonal(
    lower: Sequence[float], middle: Sequence[float], upper: Sequence[float], right: Sequence[float]
) -> Samples:
    """The solution of n equations, diagonals of n - 1, n and n - 1 entries; the larger of two rows is the pivot."""
    low, mid, up, b = (list(map(float, entries)) for entries in (lower, middle, upper, right))
    n, far = len(mid), [0.0] * len(mid)  # the second upper diagonal, which pivots fill
    for i in range(n - 1):
        # Gaussian elimination with partial pivoting, as LAPACK's dgtsv does it. An exchange of row i and the next one
        # moves an entry two places right of the diagonal, hence the third upper list. The rows are diagonally dominant
        # as they stand; but the not-a-knot row leaves h0 + h1 on the next diagonal, and a third step that is longer
        # needs the exchange.
        if abs(mid[i]) >= abs(low[i]):
            factor = low[i] / mid[i]
            mid[i + 1] -= factor * up[i]
            b[i + 1] -= factor * b[i]
            continue
        factor, mid[i] = mid[i] / low[i], low[i]
        up[i], mid[i + 1] = mid[i + 1], up[i] - factor * mid[i + 1]
        if i < n - 2:
            far[i], up[i + 1] = up[i + 1], -factor * up[i + 1]
        b[i], b[i + 1] = b[i + 1], b[i] - factor * b[i + 1]
    for i in reversed(range(n)):
        known = up[i] * b[i + 1] if i < n - 1 else 0.0
        beyond = far[i] * b[i + 2] if i < n - 2 else 0.0
        b[i] = (b[i] - known - beyond) / mid[i]
    return np.array(b)
