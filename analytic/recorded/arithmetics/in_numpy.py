"""Recorded expressions as NumPy calls, one an operation, whose results are in few arrays that stay in cache."""

from collections.abc import Iterator, Mapping, Sequence
from math import inf, isqrt, nan
from types import MappingProxyType
from typing import Any

import numpy as np

from scenes.model.motion import Samples

from ...core.groups.newton_group import Correction, length_of, refine, solved
from ..expressions import SIGNS, Closing, Expression, Inputs, needed, walk

BLOCK = 8000  # positions: a few hundred arrays of them are at hand at a time
OF_FEWER = ("where", "less", "less_equal", "sin", "cos")  # results may be shared by all machines: not written in place


class StraightLine:
    """The values of expressions, for many calls: an `expressions.Line`."""

    def __init__(self, expressions: Sequence[Expression]) -> None:
        self._evaluate, self._count = function_of(expressions), len(expressions)

    def __call__(self, given: Inputs) -> Samples:
        """The values."""
        m, n = np.broadcast_shapes((1, 1), *(np.shape(values) for values in given.values()))
        rows = np.zeros((self._count, m, n))  # whose pages, where nothing is written, cost nothing
        with np.errstate(all="ignore"):
            for place in blocks(m, n):
                here = {name: part(values, *place) for name, values in given.items()}
                self._evaluate(here, rows[:, *place])
        return rows


class NewtonsMethod:
    """A larger group's coordinates at many positions, each corrected as `core.groups.newton_group` does."""

    def __init__(self, closing: Closing) -> None:
        self.names = [coordinate.of[0] for coordinate in closing.coordinates]
        self.outer = {expression.order: f"outer {expression.order}" for expression in closing.outer}
        self._evaluate = function_of([*closing.C, *closing.J], self.outer)

    def __call__(self, shape: tuple[int, ...], *given: Any) -> Samples:
        """The coordinates, shape (k, m, n), NaN where none are near enough, given what `Recorder.closed` has."""
        k = len(self.names)
        begin = np.stack([np.broadcast_to(values, shape) for values in given[:k]], axis=-1)
        (allowed, branch, size), outer = given[k : k + 3], given[k + 3 :]
        # Newton's method may converge to another assembly. A pose is taken only if it is within the allowed distance of
        # the guess and the Jacobian's determinant has the sign of the branch, which changes where two assemblies meet.
        q, closes = refine(self.correction(outer), begin, size)
        closes &= length_of(q - begin, size) <= allowed
        closes &= np.linalg.slogdet(self._equations(q, outer)[1])[0].reshape(shape) == branch
        return np.moveaxis(np.where(closes[..., np.newaxis], q, np.nan), -1, 0)

    def correction(self, outer: Sequence[Any] | Samples) -> Correction:
        """Newton's correction of the coordinates, shape (m, n, k), by their equations."""
        return lambda q: solved(*reversed(self._equations(q, outer))).reshape(q.shape)

    def _equations(self, q: Samples, outer: Sequence[Any] | Samples) -> tuple[Samples, Samples]:
        """C and J of every position, shape (m n, k) and (m n, k, k)."""
        *shape, k = q.shape
        rows = np.zeros((k + k * k, *shape))
        names = *self.names, *self.outer.values()
        self._evaluate(dict(zip(names, (*np.moveaxis(q, -1, 0), *outer), strict=True)), rows)
        flat = rows.reshape(k + k * k, -1).T
        return flat[:, :k], flat[:, k:].reshape(-1, k, k)


def function_of(expressions: Sequence[Expression], known: Mapping[int, str] = MappingProxyType({})) -> Any:
    """Compile expressions: a function of inputs by name (those `known`, by order) that fills an array's rows."""
    code = _Code(expressions, known)
    run: dict[str, Any] = {"np": np, "inf": inf, "nan": nan, "solutions": solutions, **code.methods}
    exec(compile("\n".join(code.lines), "<straight line>", "exec"), run)  # of names made here alone
    return run["evaluate"]


# Register allocation for a straight line: an operation writes into the array of an operand whose last use it is, so
# that a block needs about as many arrays as values are alive at once, and they stay in cache. Results of the operations
# in OF_FEWER, and of what no sample changes, may be smaller than a block and get a name instead of an array.
class _Code:
    """The text of a function: results that end are written over, those wanted are written where they go."""

    def __init__(self, expressions: Sequence[Expression], known: Mapping[int, str]) -> None:
        order = needed(expressions, known)
        self.last = {
            operand.order: made.order for made in order if made.order not in known for operand in made.operands
        }
        self.rows = {expression.order: row for row, expression in reversed([*enumerate(expressions)])}
        self.lines = ["def evaluate(given, row):", "    shape = row.shape[1:]"]
        self.methods: dict[str, NewtonsMethod] = {}
        self.free: list[str] = []  # arrays
        names = walk(order, self.write, {place: f"given[{name!r}]" for place, name in known.items()})
        wanted = ((row, names[expression.order]) for row, expression in enumerate(expressions))
        self.lines += [f"    row[{row}] = {name}" for row, name in wanted if name not in (f"row[{row}]", "0.0")]

    def write(self, made: Expression, texts: Sequence[str]) -> str:
        """Write an operation, whose result may take the place of what it is the last to need."""
        ended = (
            text for operand, text in zip(made.operands, texts, strict=True) if self.last[operand.order] == made.order
        )
        self.free += sorted({text for text in ended if text.startswith("a") and text[1:].isdecimal()})
        arguments, operation, name = ", ".join(texts), made.operation, f"v{made.order}"
        match operation:
            case "constant":
                return repr(made.of[0])
            case "input":
                return f"given[{made.of[0]!r}]"
            case "component":
                return f"{texts[0]}[{int(made.of[1].of[0])}]"
            case "system":
                return self._kept(name, f"solutions(shape, [{arguments}])")
            case "closed":
                self.methods[f"newton{made.order}"] = NewtonsMethod(made.of[0])
                return self._kept(name, f"newton{made.order}(shape, {arguments})")
        spelled = SIGNS.get(operation, f"np.{operation}({arguments})").format(*texts)
        if not made.sampled or operation in OF_FEWER:
            return self._kept(name, spelled)
        if made.order in self.rows:
            target = f"row[{self.rows[made.order]}]"
        else:
            target = self.free.pop() if self.free else self._kept(f"a{made.order}", "np.empty(shape)")
        self.lines.append(f"    np.{operation}({arguments}, out={target})")
        return target

    def _kept(self, name: str, text: str) -> str:
        self.lines.append(f"    {name} = {text}")
        return name


def solutions(shape: tuple[int, ...], entries: Sequence[Samples | float]) -> Samples:
    """The x of A x = b, shape (k, m, n), given the entries of A, row by row, and of b."""
    k = isqrt(len(entries))  # of k^2 + k
    rows = np.empty((*shape, k * k + k))
    for column, entry in enumerate(entries):
        rows[..., column] = entry
    x = solved(rows[..., : k * k].reshape(*shape, k, k), rows[..., k * k :])
    return np.ascontiguousarray(np.moveaxis(x, -1, 0))


def blocks(m: int, n: int, most: int = BLOCK) -> Iterator[tuple[slice, slice]]:
    """Yield places of machines and positions, about as many samples, whose temporaries stay in cache."""
    height = max(1, most // max(n, 1))
    for first in range(0, m, height):
        for start in range(0, n, BLOCK):
            yield slice(first, min(first + height, m)), slice(start, min(start + BLOCK, n))


def part(values: Any, rows: slice, columns: slice) -> Any:
    """The values of some machines and positions, of shape (m, n) or 1 for either, or a plain number."""
    if np.ndim(values) == 0:
        return float(values)
    m, n = np.shape(values) if np.ndim(values) == 2 else (1, len(values))
    return values.reshape(m, n)[rows if m > 1 else slice(None), columns if n > 1 else slice(None)]
