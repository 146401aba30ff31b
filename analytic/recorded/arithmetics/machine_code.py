"""Recorded expressions as machine code, by numba: a loop over positions that vector instructions can do.

The code is kept on disk by its own text, which has a topology's numbers as arguments. Before the loop are sines and
cosines of what the drive asks for, after it the arcs that nothing else is of: NumPy has vector instructions for them.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache, cached_property
from hashlib import sha256
from importlib.util import find_spec
from os import environ, getpid
from pathlib import Path
from types import ModuleType
from typing import TypeAlias, cast

import numpy as np

from scenes.model.motion import Samples

from ..expressions import SIGNS, Expression, Inputs, needed
from .in_numpy import blocks, function_of, part
from .loops import Language, Loop

CHUNK = 256  # positions: their results stay in the second cache, and go to memory in long rows
LANES = 8  # positions in a vector instruction, or a multiple of theirs
COMPILES = find_spec("numba") is not None

OPERATIONS = {**SIGNS, "absolute": "abs({})", "floor": "np.floor({})", "where": "({1} if {0} else {2})"}
OPERATIONS |= {"arctan2": "atan2({}, {})", "minimum": "min({}, {})", "maximum": "max({}, {})"}
PYTHON = Language(OPERATIONS, "{name}({})", "number[m, {}]", "drive[{}, own, first + i]", "{} = {}")

# numbers, drive, and what is filled: rows, what arcs are of besides, from which machine and position on
Kernel: TypeAlias = Callable[[Samples, Samples, Samples, Samples, int, int], None]


MODULE = """from math import atan2, cos, inf, nan, sin, sqrt, tanh

import numpy as np
from numba import njit


@njit(cache=True, error_model="numpy")
def kernel(number, drive, row, arc, top, left):
    rows, arcs, count = row.shape[0], arc.shape[0], arc.shape[2]
    buffer = np.empty(({buffers}, {width}))  # of a size that is known; rows apart in the cache
    for m in range(number.shape[0]):
        own = m if drive.shape[1] > 1 else 0
        {of_number}
        for first in range(0, count, {chunk}):
            most = min({chunk}, count - first)
            for i in range((most + {lanes} - 1) // {lanes} * {lanes}):
                {of_position}
            for r in range(rows):
                for i in range(most):
                    row[r, top + m, left + first + i] = buffer[r, i]
            for r in range(arcs):
                for i in range(most):
                    arc[r, m, first + i] = buffer[rows + r, i]
"""


class MachineCode:
    """The values of expressions, for many calls: an `expressions.Line`."""

    def __init__(self, expressions: Sequence[Expression], known: Mapping[str, float]) -> None:
        """Write the code, and make it unless it was made before, of numbers that are `known` where no others come."""
        used = {operand.order for made in needed(expressions) for operand in made.operands}
        arcs = [expression.operation == "arctan2" and expression.order not in used for expression in expressions]
        self._rows, self._arcs = len(expressions), np.flatnonzero(arcs).tolist()
        # Rows of arcs that are next to each other are a slice, a view into which NumPy writes; else a list, by which it
        # copies.
        together = [*range(self._arcs[0], self._arcs[-1] + 1)] if self._arcs else []
        self._together = slice(together[0], together[-1] + 1) if together == self._arcs != [] else self._arcs
        rows = [expression.of[0] if arc else expression for expression, arc in zip(expressions, arcs, strict=True)]
        loop = Loop([*rows, *(expressions[row].of[1] for row in self._arcs)], PYTHON, early=("sin", "cos"))
        self._drive, self._early, self._numbers = len(loop.given), function_of(loop.given), loop.numbers
        self.driven = {expression.of[0] for expression in needed(loop.given) if expression.operation == "input"}
        self._known = np.array([[known[name] for name in loop.numbers]])
        kept = [f"buffer[{row}, i] = {value}" for row, value in enumerate(loop.values)]
        source = MODULE.format(
            of_number="\n        ".join(loop.of_number),
            of_position="\n                ".join([*loop.of_position, *kept]),
            **{"buffers": len(kept), "chunk": CHUNK, "width": CHUNK + LANES, "lanes": LANES},
        )
        self._source = source

    @cached_property
    def _kernel(self) -> Kernel:
        return kernel_of(self._source)

    @property
    def at_hand(self) -> bool:
        """Whether it was made before, on this computer."""
        with suppress(OSError, RuntimeError):
            return kept_in(self._source).is_file()
        return False

    def __len__(self) -> int:
        """How many expressions there are."""
        return self._rows

    def of_known(self, given: Inputs, filled: Samples) -> None:
        """Fill in the values, shape (rows, 1, n), of the machine of known numbers at few positions, by one call."""
        n = filled.shape[2]
        drive, arcs = np.zeros((self._drive, 1, -(-n // LANES) * LANES)), np.empty((len(self._arcs), 1, n))
        self._early(given, drive[..., :n])
        self._kernel(self._known, drive, filled, arcs, 0, 0)
        if self._arcs:
            filled[self._together] = np.arctan2(filled[self._together], arcs)

    def __call__(self, given: Inputs) -> Samples:
        """The values."""
        m, n = np.broadcast_shapes((1, 1), *(np.shape(values) for values in given.values()))
        numbers = np.repeat(self._known, m, axis=0)
        for column, name in enumerate(self._numbers):
            if name in given:
                numbers[:, column] = np.ravel(given[name])
        driven = {name: given[name] for name in self.driven}
        varied = any(len(values) > 1 for values in map(np.atleast_2d, driven.values()))
        filled = np.empty((self._rows, m, n))
        for rows, columns in blocks(m, n):  # so that sines, cosines and arcs stay in cache
            machines, count = numbers[rows], columns.stop - columns.start
            # Positions are padded to whole vectors of LANES: the compiled loop has no remainder, which would be scalar
            # code.
            drive = np.zeros((self._drive, len(machines) if varied else 1, -(-count // LANES) * LANES))
            self._early({name: part(values, rows, columns) for name, values in driven.items()}, drive[..., :count])
            arcs = np.empty((len(self._arcs), len(machines), count))
            self._kernel(machines, drive, filled, arcs, rows.start, columns.start)
            for row, x in zip(self._arcs, arcs, strict=True):
                y = filled[row, rows, columns]
                np.arctan2(y, x, out=y)
        return filled


def operations(expressions: Sequence[Expression]) -> int | None:
    """The number of operations in expressions; None where machine code lacks one of them."""
    made = {expression.operation for expression in needed(expressions)}
    return None if made & {"system", "closed"} else len(needed(expressions))


def named(source: str) -> str:
    """The name of the module of a text."""
    return f"kernel_{sha256(source.encode()).hexdigest()[:24]}"


def kept_in(source: str) -> Path:
    """The file of a text that was made into machine code; RuntimeError where there is no home."""
    return Path(environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "linkage-crosscheck" / f"{named(source)}.py"


# numba keeps compiled functions by the file they come from. The text is written to a file in the user's cache, named by
# its hash and put in place in one step, as other processes may do the same. A file of that name with another text is
# written again.
@cache
def kernel_of(source: str) -> Kernel:
    """Return the function of a text as machine code, from the disk where it was made before."""
    module = ModuleType(named(source))
    try:
        file = kept_in(source)
        if not file.is_file() or file.read_text(encoding="utf-8") != source:
            file.parent.mkdir(parents=True, exist_ok=True)
            aside = file.with_suffix(f".{getpid()}")
            aside.write_text(source, encoding="utf-8")
            aside.replace(file)
        sys.modules[module.__name__] = module  # where numba looks for what it kept beside the file
        exec(compile(source, file, "exec"), vars(module))
    except (OSError, RuntimeError, UnicodeDecodeError):  # no home, or none that can be written: made by each process
        exec(source.replace("cache=True, ", ""), vars(module))
    return cast("Kernel", module.kernel)
