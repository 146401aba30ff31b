"""Plane vectors of two expressions, which take the place of samples in the core and in NumPy's functions.

What the core computes with them is the straight line of its own formulas.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from scenes.elements.tables import straight_lines

from .expressions import Expression, Recorder


def traced(make: Recorder, value: Any) -> "Traced":
    """A number as NumPy and Python have them, real or complex, as what the core computes with."""
    if isinstance(value, Traced):
        return value
    number = complex(value)
    return Traced(make, make.constant(number.real), make.constant(number.imag))


class Traced(NDArrayOperatorsMixin):
    """A real number, a plane vector or a condition in the place of samples; its signs are NumPy's functions."""

    ndim, shape, dtype = 1, (1,), np.dtype(np.float64)

    def __init__(self, make: Recorder, x: Expression, y: Expression | None = None) -> None:
        self.make, self.x, self.y = make, x, make.constant(0.0) if y is None else y

    @property
    def real(self) -> "Traced":
        """The part along x."""
        return Traced(self.make, self.x)

    @property
    def imag(self) -> "Traced":
        """The part along y."""
        return Traced(self.make, self.y)

    @property
    def whole(self) -> "Traced":
        """A whole number, as an arithmetic of bounds takes it."""
        return Traced(self.make, self.make.choice(self.x) if self.make.proven and self.x.sampled else self.x)

    @property
    def is_real(self) -> bool:
        """Whether there is no part along y."""
        return bool(self.y.operation == "constant" and self.y.of[0] == 0)

    def conjugate(self) -> "Traced":
        """The vector mirrored in the x axis."""
        return Traced(self.make, self.x, self.make("negative", self.y))

    def astype(self, _: object) -> "Traced":
        """The number itself: a recorded line has one precision."""
        return self

    # NumPy's own dispatch records the core: its functions call these instead of computing, so that the formulas are
    # written once. A function that is not in FUNCTIONS is a KeyError, never a silent wrong value.
    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any) -> Any:
        """Take a place among the samples of a NumPy function."""
        assert method == "__call__"
        return FUNCTIONS[ufunc.__name__](*(traced(self.make, argument) for argument in inputs))

    def __array_function__(self, function: Any, types: Iterable[type], args: Any, kwargs: Any) -> Any:
        """Take a place among the samples of a NumPy function that is none of its universal ones."""
        return FUNCTIONS[function.__name__](self.make, *args)


def _real(name: str, *arguments: Traced) -> Traced:
    """A function of real numbers."""
    return Traced(arguments[0].make, arguments[0].make(name, *(argument.x for argument in arguments)))


def _each(name: str, *arguments: Traced) -> Traced:
    """A function of either part by itself."""
    make = arguments[0].make
    return Traced(
        make, make(name, *(argument.x for argument in arguments)), make(name, *(argument.y for argument in arguments))
    )


def _product(a: Traced, b: Traced) -> Traced:
    make = a.make
    x = make("subtract", make("multiply", a.x, b.x), make("multiply", a.y, b.y))
    return Traced(make, x, make("add", make("multiply", a.x, b.y), make("multiply", a.y, b.x)))


def _quotient(a: Any, b: Any) -> Any:
    if b.is_real:
        return Traced(a.make, a.make("divide", a.x, b.x), a.make("divide", a.y, b.x))
    return a * b.conjugate() / (b.real * b.real + b.imag * b.imag)


def _size(a: Any) -> Traced:
    return _real("absolute", a) if a.is_real else _real("sqrt", a.real * a.real + a.imag * a.imag)


def _exponential(exponent: Traced) -> Traced:
    """exp(i angle) of an imaginary number, by cosine and sine."""
    assert exponent.x.operation == "constant"
    assert exponent.x.of[0] == 0
    return Traced(exponent.make, exponent.make("cos", exponent.y), exponent.make("sin", exponent.y))


def _square(a: Traced, exponent: Traced) -> Traced:
    assert exponent.x.of[0] == 2
    return _product(a, a)


def _where(make: Recorder, condition: Any, yes: Any, no: Any) -> Traced:
    c, a, b = (traced(make, value) for value in (condition, yes, no))
    return Traced(make, make("where", c.x, a.x, b.x), make("where", c.x, a.y, b.y))


FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    **{name: partial(_real, name) for name in ("sqrt", "tanh", "arctan2", "minimum", "maximum", "less", "less_equal")},
    **{name: partial(_each, name) for name in ("add", "subtract", "negative")},
    "floor": lambda a: _real("floor", a).whole,
    "multiply": _product,
    "bitwise_and": _product,
    "divide": _quotient,
    "absolute": _size,
    "hypot": lambda a, b: _size(a + 1j * b),
    "greater": lambda a, b: b < a,
    "power": _square,
    "exp": _exponential,
    "sign": lambda a: _where(a.make, a > 0, 1.0, _where(a.make, a < 0, -1.0, 0.0)),
    "where": _where,
    "ndim": lambda _, a: a.ndim,
    "interp": lambda _, x, xs, fs: straight_lines(x, xs, fs),
    "clip": lambda make, x, low, high: traced(make, np.minimum(np.maximum(x, low), high)),
}
