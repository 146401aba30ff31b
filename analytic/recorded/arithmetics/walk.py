"""A straight line of expressions, walked in order: what all arithmetics that run it have in common.

An arithmetic is one file: how operations are spelled, and what is written for each. NumPy (`in_numpy`) and machine code
(`machine_code`) are Python; another language, or another kind of numbers, has a table and a place for its text too.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

from scenes.model.motion import Samples

from ..expressions import Expression

SIGNS: Mapping[str, str] = {  # spelled alike wherever there are signs; the others are functions
    "add": "({} + {})",
    "subtract": "({} - {})",
    "multiply": "({} * {})",
    "divide": "({} / {})",
    "negative": "(-{})",
    "less": "({} < {})",
    "less_equal": "({} <= {})",
}


class Arithmetic(Protocol):
    """What is written for a straight line, operation after operation."""

    def write(self, made: Expression, of: Sequence[str]) -> str:
        """Write an operation on named values; the name of its value, or its spelling, is returned."""


class Line(Protocol):
    """A straight line that runs: the values of some expressions at positions of the drive."""

    def __call__(self, numbers: Mapping[str, Samples | float], samples: Mapping[str, Samples]) -> Samples:
        """The values, shape (expressions, m, n).

        Args:
            numbers: the inputs that are numbers: plain ones, or of m machines, shape (m, 1).
            samples: the others, each of shape (n,), (m, n) or ().
        """


def walk(order: Iterable[Expression], arithmetic: Arithmetic, known: Mapping[int, str] | None = None) -> dict[int, str]:
    """Write expressions, each after what it is of, but for those that have a name by their order of making."""
    names = dict(known or {})
    for made in order:
        if made.order not in names:
            names[made.order] = arithmetic.write(made, [names[one.order] for one in made.operands])
    return names
