"""Real expressions, each made once, and plane vectors of two of them that NumPy's functions take like samples.

What the core computes with these in place of samples is the straight line of its own formulas.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import atan2, cos, isqrt, sin, sqrt
from typing import Any, TypeAlias

import numpy as np

Operation: TypeAlias = Callable[..., float]

OPERATIONS: Mapping[str, Operation] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "negative": lambda a: -a,
    "absolute": abs,
    "sqrt": sqrt,
    "sin": sin,
    "cos": cos,
    "arctan2": atan2,
    "minimum": min,
    "maximum": max,
    "less": lambda a, b: float(a < b),
    "less_equal": lambda a, b: float(a <= b),
    "where": lambda condition, yes, no: yes if condition else no,
}


@dataclass(frozen=True, eq=False, slots=True)
class Expression:
    """An operation on others; or a number in the place of the operation's name, or an input by its name and kind."""

    order: int  # of making: what an expression needs comes before it
    operation: str
    of: tuple[Any, ...]
    sampled: bool  # whether it differs from position to position


class Recorder:
    """Makes expressions, each only once, and none whose value is known."""

    def __init__(self) -> None:
        self.made: dict[tuple[Any, ...], Expression] = {}

    def input(self, name: str, *, sampled: bool) -> "Traced":
        """Return an input: of each position, or a number."""
        return Traced(self, self._make("input", (name,), sampled=sampled), self.constant(0.0))

    def system(self, A: Iterable[Expression], b: Sequence[Expression]) -> Expression:
        """Return the linear equations A x = b, the m^2 entries of A row by row; zero where all of b is."""
        if all(one.operation == "constant" and one.of[0] == 0 for one in b):
            return self.constant(0.0)
        return self._make("system", (*A, *b), sampled=True)

    def component(self, system: Expression, i: int) -> Expression:
        """Return one of the unknowns of linear equations."""
        if system.operation == "constant":
            return system
        return self._make("component", (system, self.constant(i)), sampled=True)

    @staticmethod
    def unknowns(system: Expression) -> int:
        """Return how many unknowns linear equations have."""
        return (isqrt(1 + 4 * len(system.of)) - 1) // 2

    def constant(self, value: float) -> Expression:
        """Return a number."""
        return self._make("constant", (float(value),), sampled=False)

    def __call__(self, operation: str, *of: Expression) -> Expression:
        """Return an operation on expressions, in its simplest form."""
        known = [expression.of[0] if expression.operation == "constant" else None for expression in of]
        if None not in known:
            return self.constant(OPERATIONS[operation](*known))
        match operation, known:
            case "add", [0.0, _]:
                return of[1]
            case (("add" | "subtract"), [_, 0.0]):
                return of[0]
            case "subtract", [0.0, _]:
                return self("negative", of[1])
            case "multiply", [0.0, _] | [_, 0.0]:
                return self.constant(0.0)
            case "divide", [0.0, _]:
                return self.constant(0.0)
            case "multiply", [1.0, _]:
                return of[1]
            case (("multiply" | "divide"), [_, 1.0]):
                return of[0]
            case "multiply", [-1.0, _]:
                return self("negative", of[1])
            case (("multiply" | "divide"), [_, -1.0]):
                return self("negative", of[0])
            case "where", _ if of[1] is of[2]:
                return of[1]
            case _ if any(one.operation == "negative" for one in of):
                return self._signed(operation, *of)
        return self._ordered(operation, of)

    def _signed(self, operation: str, *of: Expression) -> Expression:
        """Return an operation of which some are negative: signs go outwards, where sums take them in."""
        signs = [one.operation == "negative" for one in of]
        bare = [one.of[0] if sign else one for one, sign in zip(of, signs, strict=True)]
        match operation, signs:
            case "negative", _:
                return bare[0]
            case (("multiply" | "divide"), _):
                return self("negative", self(operation, *bare)) if signs[0] != signs[1] else self(operation, *bare)
            case "add", [True, True]:
                return self("negative", self("add", *bare))
            case "add", [True, False]:
                return self("subtract", bare[1], bare[0])
            case "add", [False, True]:
                return self("subtract", *bare)
            case "subtract", [True, True]:
                return self("subtract", bare[1], bare[0])
            case "subtract", [True, False]:
                return self("negative", self("add", *bare))
            case "subtract", [False, True]:
                return self("add", *bare)
            case "absolute", _:
                return self("absolute", *bare)
        return self._ordered(operation, of)

    def _ordered(self, operation: str, of: tuple[Expression, ...]) -> Expression:
        if operation in ("add", "multiply") and of[0].order > of[1].order:
            of = of[1], of[0]
        return self._make(operation, of, sampled=any(one.sampled for one in of))

    def _make(self, operation: str, of: tuple[Any, ...], *, sampled: bool) -> Expression:
        key = (operation, *(one.order if isinstance(one, Expression) else (one, str(one)) for one in of))
        if key not in self.made:
            self.made[key] = Expression(len(self.made), operation, of, sampled)
        return self.made[key]

    def traced(self, value: Any) -> "Traced":
        """Return a number as NumPy and Python have them, real or complex, as what the core computes with."""
        if isinstance(value, Traced):
            return value
        number = complex(value)
        return Traced(self, self.constant(number.real), self.constant(number.imag))


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
        return FUNCTIONS[ufunc.__name__](*map(self.make.traced, inputs))

    def __array_function__(self, function: Any, types: Iterable[type], args: Any, kwargs: Any) -> "Traced":
        """Take a place among the samples of a NumPy function that is none of its universal ones."""
        return FUNCTIONS[function.__name__](self.make, *args)

    def __add__(self, other: Any) -> "Traced":
        b = self.make.traced(other)
        return self._with(self.make("add", self.x, b.x), self.make("add", self.y, b.y))

    def __sub__(self, other: Any) -> "Traced":
        b = self.make.traced(other)
        return self._with(self.make("subtract", self.x, b.x), self.make("subtract", self.y, b.y))

    def __mul__(self, other: Any) -> "Traced":
        make, b = self.make, self.make.traced(other)
        x = make("subtract", make("multiply", self.x, b.x), make("multiply", self.y, b.y))
        return self._with(x, make("add", make("multiply", self.x, b.y), make("multiply", self.y, b.x)))

    def __truediv__(self, other: Any) -> "Traced":
        make, b = self.make, self.make.traced(other)
        if b.y.operation == "constant" and b.y.of[0] == 0:
            return self._with(make("divide", self.x, b.x), make("divide", self.y, b.x))
        return self * b.conjugate() / (b.real * b.real + b.imag * b.imag)

    def __radd__(self, other: Any) -> "Traced":
        return self.make.traced(other) + self

    def __rsub__(self, other: Any) -> "Traced":
        return self.make.traced(other) - self

    def __rmul__(self, other: Any) -> "Traced":
        return self.make.traced(other) * self

    def __rtruediv__(self, other: Any) -> "Traced":
        return self.make.traced(other) / self

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
        return self._with(self.make("less", self.x, self.make.traced(other).x))

    def __le__(self, other: Any) -> "Traced":
        return self._with(self.make("less_equal", self.x, self.make.traced(other).x))

    def __gt__(self, other: Any) -> "Traced":
        return self.make.traced(other) < self

    def __ge__(self, other: Any) -> "Traced":
        return self.make.traced(other) <= self

    def __eq__(self, other: object) -> Any:
        return (self <= other) & (self >= other)

    def __and__(self, other: Any) -> "Traced":
        both: Traced = self * other
        return both

    __hash__ = None  # type: ignore[assignment]


def needed(expressions: Iterable[Expression]) -> list[Expression]:
    """Return expressions and all that they are made of, in an order in which they can be evaluated."""
    found: dict[int, Expression] = {}
    ahead = list(expressions)
    while ahead:
        expression = ahead.pop()
        if expression.order not in found:
            found[expression.order] = expression
            ahead += [one for one in expression.of if isinstance(one, Expression)]
    return [found[order] for order in sorted(found)]


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
    c, a, b = map(make.traced, (condition, yes, no))
    return Traced(make, make("where", c.x, a.x, b.x), make("where", c.x, a.y, b.y))


def _interpolated(make: Recorder, x: Any, xs: Any, fs: Any) -> Traced:
    f: Any = make.traced(fs[0])
    for n in range(len(xs) - 1):
        beyond = np.minimum(np.maximum(x - xs[n], 0.0), xs[n + 1] - xs[n])
        f = f + (fs[n + 1] - fs[n]) / (xs[n + 1] - xs[n]) * beyond
    return make.traced(f)


FUNCTIONS: Mapping[str, Callable[..., Traced]] = {
    **{name: _real(name) for name in ("sqrt", "arctan2", "minimum", "maximum")},
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "divide": lambda a, b: a / b,
    "negative": lambda a: -a,
    "absolute": abs,
    "hypot": lambda a, b: abs(a + 1j * b),
    "less": lambda a, b: a < b,
    "less_equal": lambda a, b: a <= b,
    "greater": lambda a, b: a > b,
    "greater_equal": lambda a, b: a >= b,
    "equal": lambda a, b: a == b,
    "bitwise_and": lambda a, b: a & b,
    "square": lambda a: a * a,
    "power": lambda a, b: a * a,  # noqa: ARG005 - squares alone
    "exp": _exponential,
    "conjugate": lambda a: a.conjugate(),
    "sign": lambda a: _where(a.make, a > 0, 1.0, _where(a.make, a < 0, -1.0, 0.0)),
    "where": _where,
    "ndim": lambda _, a: a.ndim,
    "interp": _interpolated,
    "real": lambda _, a: a.real,
    "clip": lambda make, x, low, high: make.traced(np.minimum(np.maximum(x, low), high)),
}
