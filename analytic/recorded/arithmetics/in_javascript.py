"""Recorded expressions as JavaScript: a loop over positions, with what no position changes before it."""

from collections.abc import Sequence
from typing import NamedTuple

from ..expressions import SIGNS, Expression
from .loops import Language, Loop

OPERATIONS = {**SIGNS, "absolute": "Math.abs({})", "where": "({} ? {} : {})"}
OPERATIONS |= {"arctan2": "Math.atan2({}, {})", "minimum": "Math.min({}, {})", "maximum": "Math.max({}, {})"}
JAVASCRIPT = Language(OPERATIONS, "Math.{name}({})", "number[{}]", "given[{}][i]", "const {} = {};")
FUNCTION = """(number, given, row, count) => {{
const inf = Infinity, nan = NaN;
{of_number}
for (let i = 0; i < count; i++) {{
{of_position}
}}
}}"""


class Script(NamedTuple):
    """A function in JavaScript of numbers, of arrays for each position, of arrays to fill and of their length."""

    text: str
    numbers: list[str]  # the inputs that are numbers, in order
    given: list[str]  # the inputs that differ from position to position, in order


def script(expressions: Sequence[Expression]) -> Script:
    """The function that fills as many arrays with the values of expressions, none of them a larger group's."""
    loop = Loop(expressions, JAVASCRIPT)
    rows = (f"row[{row}][i] = {value};" for row, value in enumerate(loop.values))
    text = FUNCTION.format(of_number="\n".join(loop.of_number), of_position="\n".join([*loop.of_position, *rows]))
    return Script(text, loop.numbers, [one.of[0] for one in loop.given])
