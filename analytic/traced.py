"""Plane vectors of two expressions, which take the place of samples in the core and in NumPy's functions.

What the core computes with them is the straight line of its own formulas.
"""

from collections.abc import Callable, Iterable, Mapping
from operator import add, and_, eq, ge, gt, le, lt, mul, neg, sub, truediv
from typing import Any

import numpy as np

from .expressions import Expression, Recorder


def given(make: Recorder, name: str, *, sampled: bool) -> "Traced":
    """Return a real input: of each position, or a number."""
    return Traced(make, make.input(name, sampled=sampled), make.constant(0.0))


def traced(make: Recorder, value: Any) -> "Traced":
    """Return a number as NumPy and Python have them, real or complex, as what the core computes with."""
    if isinstance(value, Traced):
        return value
    number = complex(value)
    return Traced(make, make.constant(number.real), make.constant(number.imag))


class Traced:
    """A real number, a plane vector or a condition in the place of samples."""

    ndim, shape, dtype = 1, (1,), np.dtype(np.float64)

    def __init__(self, make: Recorder, x: Expression, y: Expression) -> None:
        self.make, self.x, self.y = make, x, y

    def _with(self, x: Expression, y: Expression | None = None) -> "Traced":
        return Traced(self.make, x, self.make.constant(0.0) if y is None else y)

    @property
    def real(self) -> "Traced":
        """Return the part along x."""
        return self._with(self.x)

    @property
    def imag(self) -> "Traced":
        """Return the part along y."""
        return self._with(self.y)

    def conjugate(self) -> "Traced":
        """Return the vector mirrored in the x axis."""
        return self._with(self.x, self.make("negative", self.y))

    conj = conjugate

    def astype(self, _: object) -> "Traced":
        """Return the same: there is one precision."""
        return self

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any) -> "Traced":
        """Take a place among the samples of a NumPy function."""
        assert method == "__call__"
        return FUNCTIONS[ufunc.__name__](*(traced(self.make, one) for one in inputs))

    def __array_function__(self, function: Any, types: Iterable[type], args: Any, kwargs: Any) -> "Traced":
        """Take a place among the samples of a NumPy function that is none of its universal ones."""
        return FUNCTIONS[function.__name__](self.make, *args)

    def __add__(self, other: Any) -> "Traced":
        b = traced(self.make, other)
        return self._with(self.make("add", self.x, b.x), self.make("add", self.y, b.y))

    def __sub__(self, other: Any) -> "Traced":
        b = traced(self.make, other)
        return self._with(self.make("subtract", self.x, b.x), self.make("subtract", self.y, b.y))

    def __mul__(self, other: Any) -> "Traced":
        make, b = self.make, traced(self.make, other)
        x = make("subtract", make("multiply", self.x, b.x), make("multiply", self.y, b.y))
        return self._with(x, make("add", make("multiply", self.x, b.y), make("multiply", self.y, b.x)))

    def __truediv__(self, other: Any) -> "Traced":
        make, b = self.make, traced(self.make, other)
        if b.y.operation == "constant" and b.y.of[0] == 0:
            return self._with(make("divide", self.x, b.x), make("divide", self.y, b.x))
        return self * b.conjugate() / (b.real * b.real + b.imag * b.imag)

    def __radd__(self, other: Any) -> "Traced":
        return traced(self.make, other) + self

    def __rsub__(self, other: Any) -> "Traced":
        return traced(self.make, other) - self

    def __rmul__(self, other: Any) -> "Traced":
        return traced(self.make, other) * self

    def __rtruediv__(self, other: Any) -> "Traced":
        return traced(self.make, other) / self

    def __pow__(self, exponent: int) -> "Traced":
        assert exponent == 2
        return self * self

    def __neg__(self) -> "Traced":
        return self._with(self.make("negative", self.x), self.make("negative", self.y))

    def __abs__(self) -> "Traced":
        if self.y.operation == "constant" and self.y.of[0] == 0:
            return self._with(self.make("absolute", self.x))
        return self._with(self.make("sqrt", (self.real * self.real + self.imag * self.imag).x))

    def __lt__(self, other: Any) -> "Traced":
        return self._with(self.make("less", self.x, traced(self.make, other).x))

    def __le__(self, other: Any) -> "Traced":
        return self._with(self.make("less_equal", self.x, traced(self.make, other).x))

    def __gt__(self, other: Any) -> "Traced":
        return traced(self.make, other) < self

    def __ge__(self, other: Any) -> "Traced":
        return traced(self.make, other) <= self

    def __eq__(self, other: object) -> Any:
        return (self <= other) & (self >= other)

    def __and__(self, other: Any) -> "Traced":
        both: Traced = self * other
        return both

    __hash__ = None  # type: ignore[assignment]


def _real(name: str) -> Callable[..., Traced]:
    """Return a function of real numbers."""

    def function(*of: Traced) -> Traced:
        first = of[0]
        return Traced(first.make, first.make(name, *(one.x for one in of)), first.make.constant(0.0))

    return function


def _exponential(of: Traced) -> Traced:
    """Return exp(i angle)."""
    assert of.x.operation == "constant"
    assert of.x.of[0] == 0
    return Traced(of.make, of.make("cos", of.y), of.make("sin", of.y))


def _where(make: Recorder, condition: Any, yes: Any, no: Any) -> Traced:
    c, a, b = (traced(make, one) for one in (condition, yes, no))
    return Traced(make, make("where", c.x, a.x, b.x), make("where", c.x, a.y, b.y))


def _interpolated(make: Recorder, x: Any, xs: Any, fs: Any) -> Traced:
    f: Any = traced(make, fs[0])
    for n in range(len(xs) - 1):
        beyond = np.minimum(np.maximum(x - xs[n], 0.0), xs[n + 1] - xs[n])
        f = f + (fs[n + 1] - fs[n]) / (xs[n + 1] - xs[n]) * beyond
    return traced(make, f)


FUNCTIONS: Mapping[str, Callable[..., Traced]] = {
    **{name: _real(name) for name in ("sqrt", "arctan2", "minimum", "maximum")},
    "add": add,
    "subtract": sub,
    "multiply": mul,
    "divide": truediv,
    "negative": neg,
    "absolute": abs,
    "hypot": lambda a, b: abs(a + 1j * b),
    "less": lt,
    "less_equal": le,
    "greater": gt,
    "greater_equal": ge,
    "equal": eq,
    "bitwise_and": and_,
    "square": lambda a: a * a,
    "power": lambda a, b: a * a,  # noqa: ARG005 - squares alone
    "exp": _exponential,
    "conjugate": lambda a: a.conjugate(),
    "sign": lambda a: _where(a.make, a > 0, 1.0, _where(a.make, a < 0, -1.0, 0.0)),
    "where": _where,
    "ndim": lambda _, a: a.ndim,
    "interp": _interpolated,
    "real": lambda _, a: a.real,
    "clip": lambda make, x, low, high: traced(make, np.minimum(np.maximum(x, low), high)),
}
