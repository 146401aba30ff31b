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
        return [operand for operand in self.of if isinstance(operand, Expression)]


class Recorder:
    """Makes expressions, each only once, in their simplest form."""

    def __init__(self, *, proven: bool = False) -> None:
        self.made: dict[tuple[Any, ...], Expression] = {}
        self.proven = proven  # whether it is for an arithmetic of bounds, which alone has `within` and choices
        self.choices: dict[str, Expression] = {}  # by input: a whole number, bounds being found for one at a time

    def closed(self, closing: "Closing", arguments: Sequence[Expression]) -> Expression:
        """The coordinates at which a larger group closes, found by Newton's method, NaN where it does not.

        Operands, in this order: the initial guess, the allowed distance from it, the sign of the Jacobian's determinant
        there, the size of the group; then the inputs of the equations. Where there is a closed form, its
        inputs come first instead.
        """
        return self._make("closed", (closing, *arguments), sampled=True)

    def input(self, name: str, *, sampled: bool) -> Expression:
        """Return an input: of each position, or a number."""
        return self._make("input", (name,), sampled=sampled)

    def system(self, A: Iterable[Expression], b: Sequence[Expression]) -> Expression:
        """Return the linear equations A x = b, the m^2 entries of A row by row; zero where all of b is."""
        if all(entry.operation == "constant" and entry.of[0] == 0 for entry in b):
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

    def __call__(self, operation: str, *operands: Expression) -> Expression:
        """Return an operation on expressions, in its simplest form."""
        # Constants are folded, neutral elements dropped, signs moved outwards; x * 0 is 0, whatever x.
        known = [expression.of[0] if expression.operation == "constant" else None for expression in operands]
        if None not in known and operation not in BOUNDS:
            return self.constant(getattr(np, operation)(*known))
        match operation, known:
            case ("add", [0.0, _]) | ("multiply", [1.0, _]):
                return operands[1]
            case "minimum", [float(least), _] if least == inf:
                return operands[1]
            case (("add" | "subtract"), [_, 0.0]) | (("multiply" | "divide"), [_, 1.0]):
                return operands[0]
            case ("multiply", [0.0, _] | [_, 0.0]) | ("divide", [0.0, _]):
                return self.constant(0.0)
            case ("subtract", [0.0, _]) | ("multiply", [-1.0, _]):
                return self("negative", operands[1])
            case (("multiply" | "divide"), [_, -1.0]):
                return self("negative", operands[0])
            case "where", _ if operands[1] is operands[2]:
                return operands[1]
            case "where", [float(condition), *_]:
                return operands[1] if condition else operands[2]
            case _ if any(operand.operation == "negative" for operand in operands):
                return self._signed(operation, *operands)
        return self._ordered(operation, operands)

    def _signed(self, operation: str, *operands: Expression) -> Expression:
        """Return an operation of which some are negative: signs go outwards, where sums take them in."""
        signs = [operand.operation == "negative" for operand in operands]
        bare = [operand.of[0] if sign else operand for operand, sign in zip(operands, signs, strict=True)]
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
        return self._ordered(operation, operands)

    def _ordered(self, operation: str, operands: tuple[Expression, ...]) -> Expression:
        if operation in ("add", "multiply") and operands[0].order > operands[1].order:
            operands = operands[1], operands[0]
        return self._make(operation, operands, sampled=any(operand.sampled for operand in operands))

    def _make(self, operation: str, operands: tuple[Any, ...], *, sampled: bool) -> Expression:
        key = (
            operation,
            *(operand.order if isinstance(operand, Expression) else (operand, str(operand)) for operand in operands),
        )
        if key not in self.made:
            self.made[key] = Expression(len(self.made), operation, operands, sampled)
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
        return [expression for expression in needed(self.start) if expression.operation == "input"]

    @cached_property
    def outer(self) -> list[Expression]:
        """What the rows are of that the coordinates are not in."""
        # What the unknowns enter is evaluated in each iteration; its operands that they do not enter are evaluated once
        # and handed over.
        inner: set[int] = {coordinate.order for coordinate in self.coordinates}
        outer: dict[int, Expression] = {}
        for expression in needed([*self.C, *self.J]):
            if not inner.isdisjoint(operand.order for operand in expression.operands):
                inner.add(expression.order)
                outer |= {operand.order: operand for operand in expression.operands}
        rows = {expression.order: expression for expression in (*self.C, *self.J)}
        return [
            expression
            for order, expression in {**outer, **rows}.items()
            if order not in inner and expression.operation != "constant"
        ]


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


# Forward differentiation (Griewank and Walther, Evaluating Derivatives, 2008): in the order in which expressions were
# made, the change of each follows from its operands' by the operation's rule, or where a group closes by the implicit
# function theorem. What does not depend on the given ones is passed over. The result is a graph again, exact but for
# roundings; where a Jacobian is singular the line that is made of it has no finite value.
def forward(
    make: Recorder, expressions: Sequence[Expression], given: Mapping[Expression, Expression]
) -> list[Expression]:
    """Return the changes of expressions while some that they are made of change as given."""
    zero = make.constant(0.0)
    d = {expression.order: change for expression, change in given.items()}
    for expression in needed(expressions, d):
        if expression.order not in d and any(operand.order in d for operand in expression.operands):
            if expression.operation == "closed":
                change = _closed(make, expression, d)
            else:
                change = _rule(make, expression, [d.get(operand.order, zero) for operand in expression.operands])
            if change is not zero:
                d[expression.order] = change
    return [d.get(expression.order, zero) for expression in expressions]


def jacobian(make: Recorder, rows: Sequence[Expression], variables: Sequence[Expression]) -> list[Expression]:
    """Return the derivatives of expressions by some of what they are made of, row by row; most of them are zero."""
    zero = make.constant(0.0)
    known = {variable.order: {column: make.constant(1.0)} for column, variable in enumerate(variables)}
    d = dict(known)
    for expression in needed(rows, known):
        # Sparse forward mode for many variables: each node keeps the derivatives that are not zero by column.
        rates = [d.get(operand.order, {}) for operand in expression.operands]
        if expression.order not in d and any(rates):
            changes = ((x, _rule(make, expression, [rate.get(x, zero) for rate in rates])) for x in {*chain(*rates)})
            d[expression.order] = {x: change for x, change in changes if change is not zero}
    return [d.get(row.order, {}).get(column, zero) for row in rows for column in range(len(variables))]


def _closed(make: Recorder, closed: Expression, d: Mapping[int, Expression]) -> Expression:
    """Changes of the coordinates that keep C = 0: J dq = -dC, by the implicit function theorem."""
    C, J = closed.of[0].at_zero
    given = {expression: d[expression.order] for expression in needed(C) if expression.order in d} | {
        closed: make.constant(0.0)
    }
    return make.system(J, [make("negative", change) for change in forward(make, C, given)])


def _rule(make: Recorder, y: Expression, d: Sequence[Expression]) -> Expression:
    """Return the derivative of an operation, given those of what it is of."""
    operands = y.of
    match y.operation:
        case "system":
            return _system(make, y, d)
        case "component":
            return make.component(d[0], int(operands[1].of[0])) if d[0].operation == "system" else make.constant(0.0)
        case "add" | "subtract" | "negative":
            return make(y.operation, *d)
        case "multiply":
            return make("add", make("multiply", d[0], operands[1]), make("multiply", operands[0], d[1]))
        case "divide":
            reciprocal = make("divide", make.constant(1.0), operands[1])
            return make("multiply", make("subtract", d[0], make("multiply", y, d[1])), reciprocal)
        case "sqrt":
            return make("multiply", d[0], make("divide", make.constant(0.5), y))
        case "tanh":
            square = make("multiply", y, y)
            return make("multiply", make("subtract", make.constant(1.0), square), d[0])
        case "sin":
            return make("multiply", make("cos", operands[0]), d[0])
        case "cos":
            return make("negative", make("multiply", make("sin", operands[0]), d[0]))
        case "arctan2":
            square = make("add", make("multiply", operands[0], operands[0]), make("multiply", operands[1], operands[1]))
            turn = make("subtract", make("multiply", operands[1], d[0]), make("multiply", operands[0], d[1]))
            return make("multiply", turn, make("divide", make.constant(1.0), square))
        case "absolute":
            return make("where", make("less", operands[0], make.constant(0.0)), make("negative", d[0]), d[0])
        case "minimum":
            return make("where", make("less_equal", *operands), *d)
        case "maximum":
            return make("where", make("less_equal", *operands), d[1], d[0])
        case "where":
            return make("where", operands[0], d[1], d[2])
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
            names[made.order] = write(made, [names[operand.order] for operand in made.operands])
    return names
