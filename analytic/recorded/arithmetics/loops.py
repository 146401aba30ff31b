"""Recorded expressions as statements of a loop over positions, with what no position changes before it."""

from collections import Counter
from collections.abc import Container, Mapping, Sequence
from typing import NamedTuple

from ..expressions import Expression, needed, walk

MAX_LENGTH = 400  # characters of an expression that stands where it is used, rather than having a name


class Language(NamedTuple):
    """How statements are spelled."""

    operations: Mapping[str, str]  # by name
    function: str  # an operation without a spelling of its own, by name and operand
    number: str  # an input that is a number, by its place among them
    given: str  # what is given for each position, by its place
    statement: str  # what has a name, by both


class Loop:
    """The statements of expressions, none of them a larger group's; what is used once stands where it is used."""

    def __init__(self, expressions: Sequence[Expression], language: Language, early: Container[str] = ()) -> None:
        """Write them; `early` are functions of inputs that are given as these are."""
        self.language = language
        of_inputs = (
            (expression, expression.of[0] if expression.operation in early else expression)
            for expression in needed(expressions)
            if expression.sampled
        )
        self.given = [expression for expression, argument in of_inputs if argument.operation == "input"]
        known = {expression.order: f"e{expression.order}" for expression in self.given}
        order = needed(expressions, known)
        # An expression with a single use stands in the text of its user, which keeps statements few; not if it moves
        # from before the loop into it, where it would be worked out again at each position.
        uses = Counter(operand.order for expression in order for operand in expression.operands)
        pairs = ((operand, expression) for expression in order for operand in expression.operands)
        once = {
            operand.order
            for operand, expression in pairs
            if uses[operand.order] == 1 and operand.sampled == expression.sampled
        }
        self.inside = once - {expression.order for expression in expressions}
        self.numbers: list[str] = []  # the inputs that are numbers, in order
        self.of_number: list[str] = []
        given = map(language.given.format, range(len(known)))
        self.of_position = [*map(language.statement.format, known.values(), given)]
        names = walk(order, self.write, known)
        self.values = [names[expression.order] for expression in expressions]

    def write(self, made: Expression, texts: Sequence[str]) -> str:
        """Write an operation: by a name, or where the only other one of it is."""
        name = f"e{made.order}"
        match made.operation:
            case "constant":
                text = repr(made.of[0])
            case "input":
                text = self.language.number.format(len(self.numbers))
                self.numbers.append(made.of[0])
            case operation:
                spelling = self.language.operations.get(operation, self.language.function)
                text = spelling.format(*texts, name=operation)
                if made.order in self.inside and len(text) < MAX_LENGTH:
                    return text
        (self.of_position if made.sampled else self.of_number).append(self.language.statement.format(name, text))
        return name
