"""Recorded expressions as Taylor models: parabolas with a proven rest, over many boxes at once.

Over a box the drive's position, or the time, is its middle and s times half its width, |s| <= 1; a number of the scene
that is not quite as drawn is its value and t_i times what it may be off by, |t_i| <= 1. A value is then

    c_0 + c_1 s + c_2 s^2 + sum_i c_2+i t_i + rest,   |rest| <= r,                                               (1)

with the coefficients in doubles. All else goes into the rest: products that (1) has no place for, what a function has
beyond its parabola (Taylor's theorem), and roundings. Where nothing is known the rest is NaN: a divisor that may be
zero, or a root of what may be negative. Makino and Berz, "Taylor models and other validated functional inclusion
methods" (2003). Moore, Kearfott, Cloud, Introduction to Interval Analysis (2009).
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from scenes.model.motion import Samples

ROUNDED = 2.0**-50  # of a result: one to three roundings, in whatever order, are 2^-53 each
FUNCTION = 2.0**-49  # of a function's value: NumPy's are off by less than one unit in the last place, 2^-52
UP = 1 + 2.0**-48  # a rest is a sum of a dozen terms: its own roundings
UNDERFLOW = 1e-290  # what underflows, and what a rest loses by that
EXACT = 4096  # a constant is meant as it is where it is a whole number of parts of one by this


class TaylorModel:
    """Values over n boxes: coefficients, shape (m, n) or (m, 1), and what bounds the rest, shape (n,) or (1,)."""

    def __init__(self, c: Samples, rest: Samples) -> None:
        self.c, self.rest = c, rest

    @cached_property
    def bounds(self) -> tuple[Samples, Samples, Samples, Samples]:
        """The sizes of the coefficients; the most of all terms but the first two, of all but the first, and of all."""
        sizes = np.abs(self.c)
        bent = sizes[2:].sum(axis=0) if len(sizes) > 3 else sizes[2]
        moving = sizes[1] + bent
        return sizes, bent, moving, sizes[0] + moving

    @property
    def sizes(self) -> Samples:
        """The sizes of the coefficients."""
        return self.bounds[0]

    @property
    def moving(self) -> Samples:
        """The most of all terms but the first."""
        return self.bounds[2]

    @property
    def most(self) -> Samples:
        """The most of all terms."""
        return self.bounds[3]

    @property
    def radius(self) -> Samples:
        """By how much it differs at most from its first term."""
        return np.asarray((self.moving + self.rest) * UP)

    @property
    def range(self) -> tuple[Samples, Samples]:
        """Bounds of the values, shape (n,), which no rounding leaves within them."""
        error = self.radius + ROUNDED * self.sizes[0]
        return self.c[0] - error, self.c[0] + error

    def __getitem__(self, place: Any) -> "TaylorModel":
        """Those of some boxes, or some of several that are stacked, shape (k, n)."""
        return TaylorModel(self.c[(slice(None), *np.index_exp[place])], self.rest[place])

    def __neg__(self) -> "TaylorModel":
        return TaylorModel(-self.c, self.rest)

    def __add__(self, other: "TaylorModel") -> "TaylorModel":
        return _rounded(self.c + other.c, self.rest + other.rest)

    def __sub__(self, other: "TaylorModel") -> "TaylorModel":
        return _rounded(self.c - other.c, self.rest + other.rest)

    def __mul__(self, other: "TaylorModel") -> "TaylorModel":
        a, b = self.c, other.c
        c = a[0] * b
        c[1:] += b[0] * a[1:]
        c[2] += a[1] * b[1]
        # The product has no place for s^3, s^4, s t_i and t_i t_j: the first model's slope times all bent terms of the
        # other, and its bent terms times all moving terms of the other, with |s|, |t_i| <= 1.
        (sizes, bent, _, most), (_, other_bent, other_moving, other_most) = self.bounds, other.bounds
        dropped = sizes[1] * other_bent + bent * other_moving
        rest = dropped + most * (other.rest + ROUNDED * other_most) + self.rest * (other_most + other.rest)
        return TaylorModel(c, rest * UP + UNDERFLOW)

    def __rmul__(self, factor: float) -> "TaylorModel":
        return point(factor, len(self.c)) * self

    def __truediv__(self, other: "TaylorModel") -> "TaylorModel":
        return self * _reciprocal(other)

    def sin(self) -> "TaylorModel":
        """The sine of an angle, rad, as NumPy's function calls it."""
        s, c = np.sin(self.c[0]), np.cos(self.c[0])
        return _composed(self, (s, c, -s / 2), np.array(1 / 6))

    def cos(self) -> "TaylorModel":
        """The cosine of an angle, rad, as NumPy's function calls it."""
        s, c = np.sin(self.c[0]), np.cos(self.c[0])
        return _composed(self, (c, -s, -c / 2), np.array(1 / 6))


def _rounded(c: Samples, rest: Samples) -> TaylorModel:
    """A model with a coefficient's rounding more in its rest."""
    made = TaylorModel(c, rest)
    made.rest = (rest + ROUNDED * made.most) * UP
    return made


def point(value: Any, like: int, error: Any = 0.0) -> TaylorModel:
    """A constant over each box, with a bound on its error; as many coefficients as the other models have."""
    value = np.atleast_1d(np.asarray(value, np.float64))
    c = np.zeros((like, len(value)))
    c[0] = value
    return TaylorModel(c, np.zeros(value.shape) + error)


def joined(models: Sequence[TaylorModel]) -> TaylorModel:
    """One model of the boxes of several, in their order."""
    return TaylorModel(*(np.concatenate([getattr(model, x) for model in models], axis=-1) for x in ("c", "rest")))


def parabola_most(c: Samples) -> Samples:
    """The largest values of parabolas for |s| <= 1, of coefficients of shape (m, ..., n)."""
    slope = np.abs(c[1])
    with np.errstate(invalid="ignore", divide="ignore"):
        s = np.where(c[2] < 0, np.minimum(slope / (-2 * c[2]), 1.0), 1.0)
    return np.asarray(c[0] + s * (slope + s * c[2]))


def hull(low: Samples, high: Samples, like: int) -> TaylorModel:
    """What lies between bounds, shape (n,)."""
    middle = (low + high) / 2
    radius = np.maximum(high - middle, middle - low) * UP + UNDERFLOW
    return point(np.where(np.isfinite(middle), middle, 0.0), like, radius)


# Taylor's theorem around c_0, with h = x - c_0 of size D: f0 + f1 h + f2 h^2 + f'''(xi)/6 h^3. Of h^2 only c_1^2 s^2
# has a place in the model, all other products go into the rest. `third` bounds |f'''|/6 over the whole range of x, not
# only at its middle.
def _composed(x: TaylorModel, f: Sequence[Samples], third: Samples) -> TaylorModel:
    """A function of x by Taylor's theorem: its value at c_0, the derivative, half the second, and a sixth's bound."""
    f0, f1, f2 = f
    c = f1 * x.c
    c[0] = f0
    c[2] += f2 * (x.c[1] * x.c[1])
    (sizes, k, moving, _), rest, D = x.bounds, x.rest, x.radius
    square = k * (2 * sizes[1] + k) + rest * (2 * moving + rest)  # of x less its first term, beside c_1^2 s^2
    error = np.abs(f1) * (rest + FUNCTION * D) + np.abs(f2) * (square + FUNCTION * D * D) + third * D**3
    return TaylorModel(c, (error + FUNCTION * np.abs(f0)) * UP + UNDERFLOW)


def _either(where: Any, yes: TaylorModel, no: TaylorModel) -> TaylorModel:
    """One of two, box by box."""
    return TaylorModel(np.where(where, yes.c, no.c), np.where(where, yes.rest, no.rest))


def _reciprocal(x: TaylorModel) -> TaylorModel:
    c0 = x.c[0]
    # |f'''|/6 = 1/x^4 is largest where |x| is least. If that is not above zero the divisor may be zero and nothing is
    # known.
    least = (np.abs(c0) - x.radius) * (2 - UP)
    f0 = 1 / c0
    inverse = _composed(x, (f0, -f0 * f0, f0 * f0 * f0), 1 / least**4)
    return _either(least > 0, inverse, point(0.0, len(x.c), np.nan))


def _sqrt(x: TaylorModel) -> TaylorModel:
    """The root of what is not negative; how far a group reaches is asked elsewhere."""
    low, high = x.range
    f0 = np.sqrt(x.c[0])
    smooth = low > 0
    # |f'''|/6 = x^(-5/2)/16 at the lower end. Near zero that grows without bound: there the plain hull of both ends'
    # roots is narrower, as for a dyad that is nearly stretched out.
    root = _composed(x, (f0, 0.5 / f0, -0.125 / (f0 * x.c[0])), 1 / (16 * low**2 * np.sqrt(low)))
    if smooth.all():
        return root
    rough = hull(np.sqrt(np.maximum(low, 0)), np.sqrt(high) * UP, len(x.c))
    return _either(smooth & (root.rest < rough.rest), root, rough)


def _tanh(x: TaylorModel) -> TaylorModel:
    t = np.tanh(x.c[0])
    return _composed(x, (t, 1 - t * t, -t * (1 - t * t)), np.array(1 / 3))


def _arctan2(y: TaylorModel, x: TaylorModel) -> TaylorModel:
    """The angle at the middle, and the angle from there: the arctangent of a quotient that is about zero."""
    like, (x0, y0) = len(x.c), (x.c[0], y.c[0])
    # Turned by minus the angle of the middle, (x, y) is near the positive axis: w is the tangent of the angle from
    # there, and arctan has |f'''|/6 <= 1/3. A box whose angle may pass +-pi has both ends of the cut, hence the whole
    # turn.
    X, Y = point(x0, like), point(y0, like)
    w = (y * X - x * Y) / (x * X + y * Y)
    w0 = w.c[0]
    slope = 1 / (1 + w0 * w0)
    turned = _composed(w, (np.arctan(w0), slope, -w0 * slope * slope), np.array(1 / 3))
    middle = np.arctan2(y0, x0)
    angle = turned + point(middle, like, FUNCTION * np.abs(middle))
    low, high = angle.range
    return _either((low > -np.pi) & (high < np.pi), angle, point(0.0 * middle, like, np.pi * UP))


def _absolute(x: TaylorModel) -> TaylorModel:
    low, high = x.range
    return _either(low >= 0, x, _either(high <= 0, -x, hull(0 * high, np.maximum(high, -low), len(x.c))))


def _largest(x: TaylorModel, y: TaylorModel) -> TaylorModel:
    """The larger one: half the sum and half the distance, where that is not known from a zero to its most."""
    apart = x - y
    low, high = apart.range
    most = np.maximum(high, -low) / 4
    half = point([0.5], len(x.c))
    middle = (x + y) * half + point(most, len(x.c), most)
    return _either(low >= 0, x, _either(high <= 0, y, middle))


def _floor(x: TaylorModel) -> TaylorModel:
    low, high = (np.floor(bound) for bound in x.range)
    return hull(low, high, len(x.c))


def _truth(yes: Any, no: Any, like: int) -> TaylorModel:
    """A condition: one, or zero, or between them where it is not decided."""
    return point(np.where(yes, 1.0, np.where(no, 0.0, 0.5)), like, np.where(yes | no, 0.0, 0.5))


def _less(x: TaylorModel, y: TaylorModel) -> TaylorModel:
    low, high = (y - x).range
    return _truth(low > 0, high <= 0, len(x.c))


def _less_equal(x: TaylorModel, y: TaylorModel) -> TaylorModel:
    if x is y:
        return _truth(np.isfinite(x.rest), np.isinf(x.rest), len(x.c))
    low, high = (y - x).range
    return _truth(low >= 0, high < 0, len(x.c))


def _where(condition: TaylorModel, yes: TaylorModel, no: TaylorModel) -> TaylorModel:
    """One of two; where the condition is not decided the middle of both, off by half of what they are apart.

    Two forms of one number are apart by roundings alone. Where there is a jump all between their bounds may be nearer.
    """
    low, high = condition.range
    (a, b), (c, d) = yes.range, no.range
    both, apart = hull(np.minimum(a, c), np.maximum(b, d), len(yes.c)), no - yes
    middle = yes + point([0.5], len(yes.c)) * apart
    middle = TaylorModel(middle.c, (middle.rest + (apart.most + apart.rest) / 2) * UP)
    either = _either(middle.radius < both.radius, middle, both)
    return _either(low > 0.5, yes, _either(high < 0.5, no, either))


def _middle(x: TaylorModel) -> TaylorModel:
    """The polynomial without its rest, or zero where nothing is known: some number near x, of what need not be x."""
    known = np.isfinite(x.rest) & np.isfinite(x.c).all(axis=0)
    return TaylorModel(np.where(known, x.c, 0.0), np.zeros(x.rest.shape))


RULES: Mapping[str, Callable[..., TaylorModel]] = {
    "add": TaylorModel.__add__,
    "subtract": TaylorModel.__sub__,
    "multiply": TaylorModel.__mul__,
    "divide": TaylorModel.__truediv__,
    "negative": TaylorModel.__neg__,
    "absolute": _absolute,
    "sqrt": _sqrt,
    "sin": TaylorModel.sin,
    "cos": TaylorModel.cos,
    "tanh": _tanh,
    "floor": _floor,
    "arctan2": _arctan2,
    "maximum": _largest,
    "minimum": lambda x, y: -_largest(-x, -y),
    "less": _less,
    "less_equal": _less_equal,
    "where": _where,
    "middle": _middle,
    "within": lambda x, distance: TaylorModel(x.c, (x.rest + distance.most + distance.rest) * UP),
}
