"""Recorded expressions as machine code, by numba: a loop over positions that vector instructions can do.

The code is kept on disk by its own text, which has a topology's numbers as arguments. Before the loop are sines and
cosines of what the drive asks for, after it the arcs that nothing else is of: NumPy has vector instructions for them.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from hashlib import sha256
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from os import environ, getpid
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np

from scenes.model.motion import Samples

from ..expressions import SIGNS, Expression, Inputs, needed, walk
from .in_numpy import blocks, part

CHUNK = 256  # positions: their results stay in the second cache, and go to memory in long rows
LANES = 8  # positions in a vector instruction, or a multiple of theirs
COMPILES = find_spec("numba") is not None

SPELLINGS = {
    **SIGNS,
    "absolute": "abs({})",
    "minimum": "min({}, {})",
    "maximum": "max({}, {})",
    "where": "({1} if {0} else {2})",
    "arctan2": "atan2({}, {})",
    "floor": "np.floor({})",
}

# numbers, drive, and what is filled: rows, what arcs are of besides, from which machine and position on
Kernel: TypeAlias = Callable[[Samples, Samples, Samples, Samples, int, int], None]


MODULE = """from math import atan2, cos, inf, nan, sin, sqrt, tanh

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy")
def kernel(number, drive, row, arc, top, left):
    buffer = np.empty(({buffers}, {width}))  # of a size that is known; rows apart in the cache
    for m in range(number.shape[0]):
        own = m if drive.shape[0] > 1 else 0
{of_machine}        for first in range(0, arc.shape[2], {chunk}):
            count = min({chunk}, arc.shape[2] - first)
            whole = (count + {more}) // {lanes} * {lanes}
            for i in range(whole):
{of_position}            for r in range({rows}):
                for i in range(count):
                    row[r, top + m, left + first + i] = buffer[r, i]
            for r in range({arcs}):
                for i in range(count):
                    arc[r, m, first + i] = buffer[{rows} + r, i]
"""


class MachineCode:
    """The values of expressions, for many calls: an `expressions.Line`."""

    def __init__(self, expressions: Sequence[Expression], known: Mapping[str, float]) -> None:
        """Write the code, and make it unless it was made before, of numbers that are `known` where no others come."""
        self._code = _Code(expressions)
        self._known = np.array([[known[name] for name in self._code.numbers]])
        self._kernel = kernel_of(self._code.text())

    def __call__(self, given: Inputs) -> Samples:
        """The values."""
        code = self._code
        m, n = np.broadcast_shapes((1, 1), *(np.shape(values) for values in given.values()))
        numbers = np.repeat(self._known, m, axis=0)
        for column, name in enumerate(code.numbers):
            if name in given:
                numbers[:, column] = np.ravel(given[name])
        driven = [(function, np.atleast_2d(given[name])) for function, name in code.drive]
        own = any(len(values) > 1 for _, values in driven)
        filled = np.empty((code.rows, m, n))
        for rows, columns in blocks(m, n):  # so that sines, cosines and arcs stay in cache
            machines, count = numbers[rows], columns.stop - columns.start
            drive = np.zeros((len(machines) if own else 1, len(driven), -(-count // LANES) * LANES))
            for column, (function, values) in enumerate(driven):
                here = part(values, rows, columns)
                drive[:, column, :count] = getattr(np, function)(here) if function else here
            arcs = np.empty((len(code.arcs), len(machines), count))
            self._kernel(machines, drive, filled, arcs, rows.start, columns.start)
            for (row, _, _), x in zip(code.arcs, arcs, strict=True):
                y = filled[row, rows, columns]
                np.arctan2(y, x, out=y)
        for row, same in code.same.items():
            filled[row] = filled[same]
        return filled


def operations(expressions: Sequence[Expression]) -> int | None:
    """How many operations expressions are; None where some are none of machine code."""
    made = {one.operation for one in needed(expressions)}
    return None if made & {"system", "closed"} else len(needed(expressions))


class _Code:
    """The text of a module whose kernel fills rows with expressions for machines and positions, up to whole vectors."""

    def __init__(self, expressions: Sequence[Expression]) -> None:
        order = needed(expressions)
        self.rows = len(expressions)
        self.row = {made.order: row for row, made in enumerate(expressions)}
        self.same = {row: self.row[one.order] for row, one in enumerate(expressions) if self.row[one.order] != row}
        self.used = {one.order for made in order for one in made.operands}
        self.numbers: list[str] = []  # inputs that each machine has
        self.drive: list[tuple[str, str]] = []  # inputs of positions, as they are, or a NumPy function of them
        self.of_machine: list[str] = []
        self.of_position: list[str] = []
        self.arcs: list[tuple[int, str, str]] = []  # row, and what it is the arc of
        names = walk(order, self.write, {})
        late = {row for row, _, _ in self.arcs} | self.same.keys()
        self.outputs = [(row, names[made.order]) for row, made in enumerate(expressions) if row not in late]

    def write(self, made: Expression, of: Sequence[str]) -> str:
        """Write an operation."""
        name, form = f"e{made.order}", SPELLINGS.get(made.operation, made.operation + "({})")
        match made.operation:
            case "constant":
                return repr(made.of[0])
            case "input" if made.sampled:
                return self._driven("", made.of[0])
            case "input":
                self.numbers.append(made.of[0])
                self.of_machine.append(f"{name} = number[m, {len(self.numbers) - 1}]")
                return name
            case "sin" | "cos" if made.sampled and made.of[0].operation == "input":
                return self._driven(made.operation, made.of[0].of[0])
            case "arctan2" if made.order in self.row and made.order not in self.used:
                self.arcs.append((self.row[made.order], of[0], of[1]))
                return name
        (self.of_position if made.sampled else self.of_machine).append(f"{name} = {form.format(*of)}")
        return name

    def _driven(self, function: str, name: str) -> str:
        if (function, name) not in self.drive:
            self.drive.append((function, name))
        return f"drive[own, {self.drive.index((function, name))}, first + i]"

    def text(self) -> str:
        """The text of the module."""
        places = [*self.outputs]
        for beside, (row, y, x) in enumerate(self.arcs, self.rows):  # rows for what the arcs are of
            places += [(row, y), (beside, x)]
        kept = [f"buffer[{row}, i] = {text}" for row, text in places]
        return MODULE.format(
            of_machine="".join(f"        {text}\n" for text in self.of_machine),
            of_position="".join(f"                {text}\n" for text in (*self.of_position, *kept, "pass")),
            **{"rows": self.rows, "arcs": len(self.arcs), "buffers": self.rows + len(self.arcs)},
            **{"chunk": CHUNK, "lanes": LANES, "width": CHUNK + LANES, "more": LANES - 1},
        )


@cache
def kernel_of(source: str) -> Kernel:
    """Return the function of a text as machine code, from the disk where it was made before."""
    try:
        folder = Path(environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "linkage-crosscheck"
        file = folder / f"kernel_{sha256(source.encode()).hexdigest()[:24]}.py"
        if not file.is_file() or file.read_text(encoding="utf-8") != source:
            folder.mkdir(parents=True, exist_ok=True)
            aside = file.with_suffix(f".{getpid()}")
            aside.write_text(source, encoding="utf-8")
            aside.replace(file)
        spec = spec_from_file_location(file.stem, file)
        assert spec is not None
        assert spec.loader is not None
        module = sys.modules[file.stem] = module_from_spec(spec)  # where numba looks for what it kept
        spec.loader.exec_module(module)
    except (OSError, RuntimeError, UnicodeDecodeError):  # no home, or none that can be written: made by each process
        run: dict[str, Any] = {}
        exec(source.replace("cache=True, ", ""), run)
        return cast("Kernel", run["kernel"])
    return cast("Kernel", module.kernel)
