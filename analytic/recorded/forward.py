"""Forward differentiation of expressions: what each changes by, while some of them change as given."""

from collections.abc import Mapping, Sequence
from math import isqrt

from .expressions import Expression, Recorder, needed


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
