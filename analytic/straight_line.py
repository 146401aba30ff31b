"""Recorded expressions as Python code: one NumPy call an operation, its results in few arrays that stay in cache."""

from collections.abc import Iterator, Mapping, Sequence
from math import inf, isqrt, nan
from typing import Any

import numpy as np

from scenes.motion import Samples

from .expressions import Expression, needed
from .newton_group import solved
from .numbers import Number, row_by_row

BLOCK = 8000  # positions: a few hundred arrays of them are at hand at a time

SIGNS = {  # of operations; the others are functions of NumPy
    "add": "({} + {})",
    "subtract": "({} - {})",
    "multiply": "({} * {})",
    "divide": "({} / {})",
    "negative": "(-{})",
    "absolute": "abs({})",
    "less": "({} < {})",
    "less_equal": "({} <= {})",
}


class StraightLine:
    """The values of expressions at positions of the drive, for many calls."""

    def __init__(self, expressions: Sequence[Expression]) -> None:
        run: dict[str, Any] = {"np": np, "inf": inf, "nan": nan, "solutions": solutions}
        exec(compile("\n".join(code(expressions)), "<straight line>", "exec"), run)  # of names made here alone
        self._evaluate, self._count = run["evaluate"], len(expressions)

    def __call__(self, numbers: Mapping[str, Number], samples: Mapping[str, Samples]) -> Samples:
        """Return the values, shape (expressions, m, n).

        Args:
            numbers: the inputs that are numbers: plain ones, or of m machines, shape (m, 1).
            samples: the others, each of shape (n,), (m, n) or ().
        """
        given = {**numbers, **samples}
        m, n = np.broadcast_shapes((1, 1), *(np.shape(values) for values in given.values()))
        rows = np.zeros((self._count, m, n))  # whose pages, where nothing is written, cost nothing
        height = max(1, BLOCK // n) if n else m
        with np.errstate(all="ignore"), row_by_row(n):
            for first in range(0, m, height):
                for start in range(0, n, BLOCK):
                    place = slice(first, first + height), slice(start, start + BLOCK)
                    here = {name: _part(values, *place) for name, values in given.items()}
                    self._evaluate(here, rows[:, *place])
        return rows


def _part(values: Number, rows: slice, columns: slice) -> Number:
    """Return the values of some machines and positions, of shape (m, n) or 1 for either, or a plain number."""
    if np.ndim(values) == 0:
        return float(values)
    m, n = np.shape(values) if np.ndim(values) == 2 else (1, len(values))
    return values.reshape(m, n)[rows if m > 1 else slice(None), columns if n > 1 else slice(None)]


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
    yield "def evaluate(given, row):"
    yield "    shape = row.shape[1:]"
    for place, made in enumerate(order):
        of = [name[one.order] for one in made.of if isinstance(one, Expression)]
        arguments, own = ", ".join(of), rows.get(made.order)
        if made.operation == "constant":
            name[made.order] = repr(made.of[0])
        elif made.operation == "input":
            name[made.order] = f"given[{made.of[0]!r}]"
        elif made.operation == "component":
            name[made.order] = f"{of[0]}[{int(made.of[1].of[0])}]"
        elif not made.sampled:
            name[made.order] = f"n{made.order}"
            form = SIGNS.get(made.operation)
            yield f"    n{made.order} = {form.format(*of) if form else f'np.{made.operation}({arguments})'}"
        elif made.operation == "system":
            name[made.order] = f"x{made.order}"
            yield f"    x{made.order} = solutions(shape[1], [{arguments}])"
        elif made.operation in ("where", "less", "less_equal", "sin", "cos"):  # angles are those of all machines
            name[made.order] = f"s{made.order}"
            yield f"    s{made.order} = np.{made.operation}({arguments})"
        else:
            if own is not None:
                target = f"row[{own}]"
            elif free:
                target = free.pop()
            else:
                target, arrays = f"a{arrays}", arrays + 1
                yield f"    {target} = np.empty(shape)"
            name[made.order] = target
            yield f"    np.{made.operation}({arguments}, out={target})"
        if own is not None and name[made.order] not in (f"row[{own}]", "0.0"):
            yield f"    row[{own}] = {name[made.order]}"
        ended = {one.order for one in made.of if isinstance(one, Expression) and last.get(one.order) == place}
        free += sorted({name[one] for one in ended if name[one].startswith("a") and name[one][1:].isdecimal()})
    for row, expression in enumerate(expressions):
        if rows[expression.order] != row and name[expression.order] != "0.0":
            yield f"    row[{row}] = row[{rows[expression.order]}]"
