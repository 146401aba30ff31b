"""Expression graph over real numbers: hash-consed, so that equal expressions are one, with constants folded.

`forward` differentiates a graph by one rule an operation. `walk` writes it in an arithmetic, which is a file in
`arithmetics` and says how each operation is spelled.
"""

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import inf, isqrt
from typing import Any, TypeAlias

import numpy as np

from scenes.model.motion import Samples

Inputs: TypeAlias = Mapping[str, Samples | float]  # by name: numbers, (m, 1) of m machines, samples (n,) or (m, n)
Line: TypeAlias = Callable[[Inputs], Samples]  # that runs: the values of its expressions, shape (expressions, m, n)

SIGNS: Mapping[str, str] = {  # spelled alike wherever there are signs; the others are functions
    "add": "({} + {})",
    "subtract": "({} - {})",
    "multiply": "({} * {})",
    "divide": "({} / {})",
    "negative": "(-{})",
    "less": "({} < {})",
    "less_equal": "({} <= {})",
}


BOUNDS = ("within", "middle")  # operations that an arithmetic of bounds alone has


@dataclass(frozen=True, eq=False, slots=True)
class Expression:
    """An operation on others by the name of NumPy's function; or a number, an input by its name, and the like."""

    order: int  # of making: what an expression needs comes before it
    operation: str
    of: tuple[Any, ...]
    sampled: bool  # whether it differs from position to position

    @property
    def operands(self) -> list["Expression"]:
        """The operands that are expressions."""
        return [one for one in self.of if isinstance(one, Expression)]


class Recorder:
    """Makes expressions, each only once, in their simplest form."""

    def __init__(self, *, proven: bool = False) -> None:
        self.made: dict[tuple[Any, ...], Expression] = {}
        self.proven = proven  # whether it is for an arithmetic of bounds, which alone has `within` and choices
        self.choices: dict[str, Expression] = {}  # by input: a whole number, bounds being found for one at a time

    def closed(self, closing: "Closing", of: Sequence[Expression]) -> Expression:
        """The coordinates at which a larger group closes, found by Newton's method, NaN where it does not.

        Operands, in this order: the initial guess, the allowed distance from it, the sign of the Jacobian's determinant
        there, the size of the group; then the inputs of the equations. Where there is a closed form, its
        inputs come first instead.
        """
        return self._make("closed", (closing, *of), sampled=True)

    def input(self, name: str, *, sampled: bool) -> Expression:
        """Return an input: of each position, or a number."""
        return self._make("input", (name,), sampled=sampled)

    def system(self, A: Iterable[Expression], b: Sequence[Expression]) -> Expression:
        """Return the linear equations A x = b, the m^2 entries of A row by row; zero where all of b is."""
        if all(one.operation == "constant" and one.of[0] == 0 for one in b):
            return self.constant(0.0)
        return self._make("system", (*A, *b), sampled=True)

    def choice(self, number: Expression) -> Expression:
        """A whole number as an input."""
        name = f"choice {number.order}"
        self.choices[name] = number
        return self.input(name, sampled=True)

    def component(self, system: Expression, i: int) -> Expression:
        """Return one of the unknowns of linear equations."""
        if system.operation == "constant":
            return system
        return self._make("component", (system, self.constant(i)), sampled=True)

    def constant(self, value: float) -> Expression:
        """Return a number."""
        return self._make("constant", (float(value),), sampled=False)

    def __call__(self, operation: str, *of: Expression) -> Expression:
        """Return an operation on expressions, in its simplest form."""
        known = [expression.of[0] if expression.operation == "constant" else None for expression in of]
        if None not in known and operation not in BOUNDS:
            return self.constant(getattr(np, operation)(*known))
        match operation, known:
            case ("add", [0.0, _]) | ("multiply", [1.0, _]):
                return of[1]
            case "minimum", [float(least), _] if least == inf:
                return of[1]
            case (("add" | "subtract"), [_, 0.0]) | (("multiply" | "divide"), [_, 1.0]):
                return of[0]
            case ("multiply", [0.0, _] | [_, 0.0]) | ("divide", [0.0, _]):
                return self.constant(0.0)
            case ("subtract", [0.0, _]) | ("multiply", [-1.0, _]):
                return self("negative", of[1])
            case (("multiply" | "divide"), [_, -1.0]):
                return self("negative", of[0])
            case "where", _ if of[1] is of[2]:
                return of[1]
            case "where", [float(condition), *_]:
                return of[1] if condition else of[2]
            case _ if any(one.operation == "negative" for one in of):
                return self._signed(operation, *of)
        return self._ordered(operation, of)

    def _signed(self, operation: str, *of: Expression) -> Expression:
        """Return an operation of which some are negative: signs go outwards, where sums take them in."""
        signs = [one.operation == "negative" for one in of]
        bare = [one.of[0] if sign else one for one, sign in zip(of, signs, strict=True)]
        if operation in ("negative", "absolute"):
            return bare[0] if operation == "negative" else self("absolute", *bare)
        if operation in ("multiply", "divide"):
            share = self(operation, *bare)
            return self("negative", share) if signs[0] != signs[1] else share
        if operation in ("add", "subtract"):
            less = signs[1] != (operation == "subtract")
            if signs[0] != less:
                return self("subtract", *(bare if less else bare[::-1]))
            return self("negative", self("add", *bare)) if less else self("add", *bare)
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


@dataclass(eq=False, repr=False)  # by identity: written out, the expressions in it would be all that they are of
class Closing:
    """A larger group's constraints C, of m coordinates and of what else there is, and their Jacobian J, row by row."""

    coordinates: Sequence[Expression]  # inputs, in whose place Newton's method puts numbers
    C: Sequence[Expression]
    J: Sequence[Expression]
    at_zero: tuple[Sequence[Expression], Sequence[Expression]] = ((), ())  # both at the coordinates that were found
    start: Sequence[Expression] = ()  # of inputs: the coordinates in closed form, where there is one

    @cached_property
    def begun(self) -> list[Expression]:
        """The inputs that the closed form is of."""
        return [one for one in needed(self.start) if one.operation == "input"]

    @cached_property
    def outer(self) -> list[Expression]:
        """What the rows are of that the coordinates are not in."""
        inner: set[int] = {one.order for one in self.coordinates}
        outer: dict[int, Expression] = {}
        for one in needed([*self.C, *self.J]):
            if not inner.isdisjoint(of.order for of in one.operands):
                inner.add(one.order)
                outer |= {of.order: of for of in one.operands}
        rows = {one.order: one for one in (*self.C, *self.J)}
        return [one for order, one in {**outer, **rows}.items() if order not in inner and one.operation != "constant"]


def needed(expressions: Iterable[Expression], known: Container[int] = ()) -> list[Expression]:
    """Expressions and all that they are made of, but for what those `known` are of, in an order of evaluation."""
    order: dict[int, Expression] = {}
    ahead = list(expressions)
    while ahead:
        expression = ahead.pop()
        if expression.order not in order:
            order[expression.order] = expression
            ahead += expression.operands if expression.order not in known else ()
    return [order[place] for place in sorted(order)]


def forward(make: Recorder, of: Sequence[Expression], given: Mapping[Expression, Expression]) -> list[Expression]:
    """Return the changes of expressions while some that they are made of change as given."""
    zero = make.constant(0.0)
    d = {expression.order: change for expression, change in given.items()}
    for expression in needed(of, d):
        if expression.order not in d and any(one.order in d for one in expression.operands):
            if expression.operation == "closed":
                change = _closed(make, expression, d)
            else:
                change = _rule(make, expression, [d.get(one.order, zero) for one in expression.operands])
            if change is not zero:
                d[expression.order] = change
    return [d.get(expression.order, zero) for expression in of]


def jacobian(make: Recorder, rows: Sequence[Expression], of: Sequence[Expression]) -> list[Expression]:
    """Return the derivatives of expressions by some of what they are made of, row by row; most of them are zero."""
    zero, known = make.constant(0.0), {one.order: {column: make.constant(1.0)} for column, one in enumerate(of)}
    d = dict(known)
    for expression in needed(rows, known):
        by = [d.get(one.order, {}) for one in expression.operands]
        if expression.order not in d and any(by):
            changes = ((x, _rule(make, expression, [one.get(x, zero) for one in by])) for x in {*chain(*by)})
            d[expression.order] = {x: change for x, change in changes if change is not zero}
    return [d.get(row.order, {}).get(column, zero) for row in rows for column in range(len(of))]


def _closed(make: Recorder, closed: Expression, d: Mapping[int, Expression]) -> Expression:
    """What coordinates change by at which C = 0 stays so: J dq = -dC, by the implicit function theorem."""
    C, J = closed.of[0].at_zero
    given = {one: d[one.order] for one in needed(C) if one.order in d} | {closed: make.constant(0.0)}
    return make.system(J, [make("negative", change) for change in forward(make, C, given)])


def _rule(make: Recorder, y: Expression, d: Sequence[Expression]) -> Expression:
    """Return the derivative of an operation, given those of what it is of."""
    of = y.of
    match y.operation:
        case "system":
            return _system(make, y, d)
        case "component":
            return make.component(d[0], int(of[1].of[0])) if d[0].operation == "system" else make.constant(0.0)
        case "add" | "subtract" | "negative":
            return make(y.operation, *d)
        case "multiply":
            return make("add", make("multiply", d[0], of[1]), make("multiply", of[0], d[1]))
        case "divide":
            over = make("divide", make.constant(1.0), of[1])
            return make("multiply", make("subtract", d[0], make("multiply", y, d[1])), over)
        case "sqrt":
            return make("multiply", d[0], make("divide", make.constant(0.5), y))
        case "tanh":
            square = make("multiply", y, y)
            return make("multiply", make("subtract", make.constant(1.0), square), d[0])
        case "sin":
            return make("multiply", make("cos", of[0]), d[0])
        case "cos":
            return make("negative", make("multiply", make("sin", of[0]), d[0]))
        case "arctan2":
            square = make("add", make("multiply", of[0], of[0]), make("multiply", of[1], of[1]))
            turn = make("subtract", make("multiply", of[1], d[0]), make("multiply", of[0], d[1]))
            return make("multiply", turn, make("divide", make.constant(1.0), square))
        case "absolute":
            return make("where", make("less", of[0], make.constant(0.0)), make("negative", d[0]), d[0])
        case "minimum":
            return make("where", make("less_equal", *of), *d)
        case "maximum":
            return make("where", make("less_equal", *of), d[1], d[0])
        case "where":
            return make("where", of[0], d[1], d[2])
    return make.constant(0.0)  # of a comparison, or of whole turns


def _system(make: Recorder, system: Expression, d: Sequence[Expression]) -> Expression:
    """Return the system of the change of A x = b: A dx = db - dA x."""
    m = isqrt(len(d))  # of m^2 + m
    x = [make.component(system, i) for i in range(m)]
    change = list(d[m * m :])
    for i in range(m):
        for j in range(m):
            change[i] = make("subtract", change[i], make("multiply", d[m * i + j], x[j]))
    return make.system(system.of[: m * m], change)


def walk(
    order: Iterable[Expression], write: Callable[[Expression, Sequence[str]], str], known: Mapping[int, str]
) -> dict[int, str]:
    """The names or spellings of expressions by order of making, each written after what it is of unless known."""
    names = dict(known)
    for made in order:
        if made.order not in names:
            names[made.order] = write(made, [names[one.order] for one in made.operands])
    return names
