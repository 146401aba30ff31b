"""Printed equations as they are read: the text that the page shows is what is evaluated."""

import re
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import tau
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Symbols: TypeAlias = dict[str, Any]  # what an equation is about, as printed: each of one shape or a number
Difference: TypeAlias = NDArray[np.float64] | NDArray[np.complex128]  # of an equation's two sides
FUNCTIONS: Mapping[str, Callable[[Any], Any]] = {
    **{"sin": np.sin, "cos": np.cos, "atan": np.arctan, "arccos": np.arccos, "√": np.sqrt},
    "e^i": lambda angle: np.exp(1j * angle),
}
NUMBERS: Mapping[str, Any] = {"0": 0.0, "1": 1.0, "2": 2.0, "i": 1j}
INERTIA = r"m[₁-₅]? S̈[xy₁-₅]+|J[₀-₅]α[₁-₅]?|m₅[αg][₅ₛ]?"  # products with an acceleration
# Longer alternatives come first: a product such as m₅αₛ, a force or a function is one token before its first letter
# could be a token of its own. Blanks and commas match nothing and drop out.
TOKEN = re.compile(rf"{INERTIA}|F_R\w+|\w_\w|Ls[₁-₅]?|{'|'.join(map(re.escape, FUNCTIONS))}|[+−/()²]|\w[₀-₅ₛ]?")


@dataclass(frozen=True)
class Equation:
    """A printed equation: of each form the difference of its sides is what its text is read as.

    A text has two sides, sums of products of factors that stand side by side, before a colon a remark, and after commas
    abbreviations or remarks. A function is of the factor after it.
    """

    kind: str  # of quantity, which gives the scale
    claim: str
    text: str
    correction: str = ""
    note: str = ""
    read: str = ""  # in place of the text
    meant: str = ""  # in place of the correction
    given: str = ""  # abbreviations of other equations
    branch: tuple[str, str, str] = ("", "", "")  # its name, and what it exchanges for what in the text that is read

    def printed(self, symbols: Symbols) -> Difference:
        """The left side less the right one, as printed; but for whole turns of an angle."""
        return self._difference(self.read or self.text, symbols)

    def corrected(self, symbols: Symbols) -> Difference:
        """The left side less the right one, as corrected or as meant."""
        return self._difference(self.meant or self.correction, symbols)

    def branched(self, symbols: Symbols) -> Difference:
        """The same with another sign of a root or an inverse function, where there is such a branch."""
        _, part, other = self.branch
        return self._difference((self.read or self.text).replace(part, other), symbols)

    def _difference(self, text: str, symbols: Symbols) -> Difference:
        # The text is cut at ", ": the first part with an equals sign is the equation, later ones are abbreviations.
        # These are evaluated in their order, so that each may use those before it; parts without an equals sign are
        # remarks.
        text = f"{text}, {self.given}".translate(str.maketrans("[]", "()")).rpartition(": ")[2]
        parts = [part.split("=") for part in text.split(", ") if "=" in part]
        (left, right), *abbreviations = ([TOKEN.findall(side) for side in sides] for sides in parts)
        values = symbols.copy()
        for (name,), meaning in abbreviations:
            values[name] = _sum(deque(meaning), values)
        difference = _sum(deque(left), values) - _sum(deque(right), values)
        # An inverse function gives an angle modulo a turn: the difference is wrapped to -pi..pi.
        return np.asarray(np.remainder(difference + tau / 2, tau) - tau / 2 if self.kind == "angle" else difference)


# Recursive descent over the grammar
# sum     = [sign] product {sign product}
# product = factor {["/"] factor}
# factor  = function factor | ("(" sum ")" | symbol) ["²"]
# Multiplication is juxtaposition. A slash divides by the next factor alone, and a function takes the next factor alone,
# as in print: sin θ₂ l₂ is l₂ sin θ₂. A symbol without a value is a KeyError, so that a misspelled equation cannot pass
# for one that was checked.
def _sum(tokens: deque[str], values: Symbols) -> Any:
    """The value of tokens up to a closing bracket or the end, which are used up."""
    total = 0.0
    while tokens and tokens[0] != ")":
        sign = tokens.popleft() if tokens[0] in "+−" else "+"
        product = 1.0
        while tokens and tokens[0] not in "+−)":
            divided = tokens[0] == "/" and tokens.popleft()
            product = product / _factor(tokens, values) if divided else product * _factor(tokens, values)
        total = total - product if sign == "−" else total + product
    return total


def _factor(tokens: deque[str], values: Symbols) -> Any:
    token = tokens.popleft()
    if token in FUNCTIONS:
        return FUNCTIONS[token](_factor(tokens, values))
    if token == "(":
        value = _sum(tokens, values)
        tokens.popleft()  # the closing one
    else:
        value = NUMBERS[token] if token in NUMBERS else values[token]
    if tokens and tokens[0] == "²":
        tokens.popleft()
        return value**2
    return value
