"""Recorded expressions as statements of a loop over positions, with what no position changes before it."""

from collections import Counter
from collections.abc import Container, Mapping, Sequence
from typing import NamedTuple

from ..expressions import Expression, needed, walk

LONGEST = 400  # characters of an expression that stands where it is used, rather than having a name


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
        of_inputs = ((one, one.of[0] if one.operation in early else one) for one in needed(expressions) if one.sampled)
        self.given = [one for one, of in of_inputs if of.operation == "input"]
        known = {one.order: f"e{one.order}" for one in self.given}
        order = needed(expressions, known)
        uses = Counter(of.order for one in order for of in one.operands)
        pairs = ((of, one) for one in order for of in one.operands)
        once = {of.order for of, one in pairs if uses[of.order] == 1 and of.sampled == one.sampled}
        self.inside = once - {one.order for one in expressions}
        self.numbers: list[str] = []  # the inputs that are numbers, in order
        self.of_number: list[str] = []
        given = map(language.given.format, range(len(known)))
        self.of_position = [*map(language.statement.format, known.values(), given)]
        names = walk(order, self.write, known)
        self.values = [names[one.order] for one in expressions]

    def write(self, made: Expression, of: Sequence[str]) -> str:
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
                text = spelling.format(*of, name=operation)
                if made.order in self.inside and len(text) < LONGEST:
                    return text
        (self.of_position if made.sampled else self.of_number).append(self.language.statement.format(name, text))
        return name
