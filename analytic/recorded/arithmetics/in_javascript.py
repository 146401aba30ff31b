"""Recorded expressions as JavaScript: a loop over positions, with what no position changes before it."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from ..expressions import SIGNS, Expression, needed, walk

SPELLINGS = {**SIGNS, "absolute": "Math.abs({})", "where": "({} ? {} : {})"}
SPELLINGS |= {"arctan2": "Math.atan2({}, {})", "minimum": "Math.min({}, {})", "maximum": "Math.max({}, {})"}
LONGEST = 400  # characters of an expression that stands where it is used, rather than having a name
FUNCTION = """(number, given, row, count) => {{
{of_machine}for (let i = 0; i < count; i++) {{
{of_position}}}
}}"""


class Script(NamedTuple):
    """A function in JavaScript of numbers, of arrays for each position, of arrays to fill and of their length."""

    text: str
    numbers: list[str]  # the inputs that are numbers, in order
    given: list[str]  # the inputs that differ from position to position, in order


def script(expressions: Sequence[Expression]) -> Script:
    """The function that fills as many arrays with the values of expressions, none of them a larger group's."""
    return _Writer(expressions).script()


class _Writer:
    def __init__(self, expressions: Sequence[Expression]) -> None:
        order, rows = needed(expressions), {one.order for one in expressions}
        uses = Counter(of.order for one in order for of in one.operands)
        pairs = ((of, one) for one in order for of in one.operands)
        once = (of.order for of, one in pairs if uses[of.order] == 1 and of.sampled == one.sampled)
        self.inside = {*once} - rows  # what stands where it is used
        self.numbers: list[str] = []
        self.given: list[str] = []
        self.lines: dict[bool, list[str]] = {False: [], True: []}  # by whether they are of each position
        names = walk(order, self.write, {})
        self.lines[True] += [f"row[{row}][i] = {names[one.order]};" for row, one in enumerate(expressions)]

    def write(self, made: Expression, of: Sequence[str]) -> str:
        """Write an operation: by a name, or where the only other one of it is."""
        match made.operation:
            case "constant":
                return repr(made.of[0]).replace("inf", "Infinity").replace("nan", "NaN")
            case "input":
                inputs = self.given if made.sampled else self.numbers
                inputs.append(made.of[0])
                text = f"given[{len(inputs) - 1}][i]" if made.sampled else f"number[{len(inputs) - 1}]"
            case operation:
                text = SPELLINGS.get(operation, f"Math.{operation}({{}})").format(*of)
                if made.order in self.inside and len(text) < LONGEST:
                    return text
        self.lines[made.sampled].append(f"const e{made.order} = {text};")
        return f"e{made.order}"

    def script(self) -> Script:
        """All that was written."""
        of_machine, of_position = ("".join(f"{line}\n" for line in self.lines[sampled]) for sampled in (False, True))
        return Script(FUNCTION.format(of_machine=of_machine, of_position=of_position), self.numbers, self.given)
