"""Recorded expressions as Python code: one NumPy call an operation, its results in few arrays that stay in cache."""

from collections.abc import Iterator, Mapping, Sequence
from math import atan2, cos, inf, isqrt, nan, sin, sqrt
from typing import Any

import numpy as np

from scenes.motion import Samples

from .expressions import Expression, needed
from .newton_group import solved

BLOCK = 4000  # positions: a few hundred arrays of them are at hand at a time

PLAIN = {
    "add": "({} + {})",
    "subtract": "({} - {})",
    "multiply": "({} * {})",
    "divide": "({} / {})",
    "negative": "(-{})",
    "absolute": "abs({})",
    "minimum": "min({}, {})",
    "maximum": "max({}, {})",
    "less": "({} < {})",
    "less_equal": "({} <= {})",
    "where": "({1} if {0} else {2})",
    "arctan2": "atan2({}, {})",
}


class StraightLine:
    """The values of expressions at positions of the drive, for many calls."""

    def __init__(self, expressions: Sequence[Expression]) -> None:
        functions = {"sqrt": sqrt, "sin": sin, "cos": cos, "atan2": atan2, "solutions": solutions}
        run: dict[str, Any] = {"np": np, "inf": inf, "nan": nan, **functions}
        exec(compile("\n".join(code(expressions)), "<straight line>", "exec"), run)  # of names made here alone
        self._evaluate, self._count = run["evaluate"], len(expressions)

    def __call__(self, numbers: Mapping[str, float], samples: Mapping[str, Samples]) -> Samples:
        """Return the values, shape (expressions, n), given the inputs: numbers, and samples of shape (n,) or ()."""
        n = len(samples["position"])
        rows = np.zeros((self._count, n))  # whose pages, where nothing is written, cost nothing
        with np.errstate(all="ignore"):
            for start in range(0, n, BLOCK):
                block = slice(start, min(start + BLOCK, n))
                given = {name: np.broadcast_to(values, n)[block] for name, values in samples.items()}
                self._evaluate(numbers, given, rows[:, block])
        return rows


def solutions(n: int, entries: Sequence[Samples | float]) -> Samples:
    """Return x of A x = b, shape (m, n), given the entries of A, row by row, and of b."""
    m = (isqrt(1 + 4 * len(entries)) - 1) // 2
    rows = np.empty((n, m * m + m))
    for column, entry in enumerate(entries):
        rows[:, column] = entry
    return np.ascontiguousarray(solved(rows[:, : m * m].reshape(n, m, m), rows[:, m * m :]).T)


def code(expressions: Sequence[Expression]) -> Iterator[str]:
    """Yield the lines of a function that writes the values of expressions into the rows of an array."""
    order = needed(expressions)
    last = {one.order: place for place, made in enumerate(order) for one in made.of if isinstance(one, Expression)}
    rows: dict[int, int] = {}
    for row, expression in enumerate(expressions):
        rows.setdefault(expression.order, row)
    name: dict[int, str] = {}
    free: list[str] = []
    arrays = 0
    yield "def evaluate(number, sample, row):"
    yield "    n = row.shape[1]"
    for place, made in enumerate(order):
        of = [name[one.order] for one in made.of if isinstance(one, Expression)]
        own = rows.get(made.order)
        if made.operation == "constant":
            name[made.order] = repr(made.of[0])
        elif made.operation == "input":
            name[made.order] = f"{'sample' if made.sampled else 'number'}[{made.of[0]!r}]"
        elif made.operation == "component":
            name[made.order] = f"{of[0]}[{int(made.of[1].of[0])}]"
        elif not made.sampled:
            name[made.order] = f"n{made.order}"
            form = PLAIN.get(made.operation, made.operation + "({})")
            yield f"    n{made.order} = {form.format(*of)}"
        elif made.operation == "system":
            name[made.order] = f"x{made.order}"
            yield f"    x{made.order} = solutions(n, [{', '.join(of)}])"
        elif made.operation in ("where", "less", "less_equal"):
            name[made.order] = f"s{made.order}"
            yield f"    s{made.order} = np.{made.operation}({', '.join(of)})"
        else:
            if own is not None:
                target = f"row[{own}]"
            elif free:
                target = free.pop()
            else:
                target, arrays = f"a{arrays}", arrays + 1
                yield f"    {target} = np.empty(n)"
            name[made.order] = target
            yield f"    np.{made.operation}({', '.join(of)}, out={target})"
        if own is not None and name[made.order] not in (f"row[{own}]", "0.0"):
            yield f"    row[{own}] = {name[made.order]}"
        ended = {one.order for one in made.of if isinstance(one, Expression) and last.get(one.order) == place}
        free += sorted({name[one] for one in ended if name[one].startswith("a") and name[one][1:].isdecimal()})
    for row, expression in enumerate(expressions):
        if rows[expression.order] != row and name[expression.order] != "0.0":
            yield f"    row[{row}] = row[{rows[expression.order]}]"
