"""Printed equations as they are read: the text that the page shows is what is evaluated."""

import re
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np

from .claims import Difference, Equation

FUNCTIONS: Mapping[str, Callable[[Any], Any]] = {"sin": np.sin, "cos": np.cos, "e^i": lambda angle: np.exp(1j * angle)}
NUMBERS: Mapping[str, Any] = {"0": 0.0, "i": 1j}
INERTIA = r"m[₁-₅]? S̈[xy₁-₅]+|J[₀-₅]α[₁-₅]?|m₅[αg][₅ₛ]?"  # products with an acceleration
TOKEN = re.compile(rf"{INERTIA}|F_R\w+|M_d|Ls[₁-₅]?|e\^i|sin|cos|[+−()²]|\w[₀-₅ₛ]?")


class Symbols(Protocol):
    """What an equation is about."""

    @property
    def symbols(self) -> Mapping[str, Any]:
        """The values of the printed symbols, each of one shape or a number."""


def equation(
    kind: str, claim: str, text: str, corrected: str = "", *, note: str = "", after: str = ""
) -> Equation[Any]:
    """An equation of which every form is what its text is read as, the printed one `after` a few words.

    A text has two sides, sums of products of factors that stand side by side, and a remark after a comma. A function
    is of the factor after it.
    """
    form = _difference(corrected) if corrected else None
    return Equation(kind, claim, text, _difference(text.removeprefix(after)), corrected, form, note=note)


def _difference(text: str) -> Callable[[Symbols], Difference]:
    """The left side less the right one."""
    left, right = (TOKEN.findall(side) for side in text.partition(",")[0].split("="))

    def difference(of: Symbols) -> Difference:
        return np.asarray(_sum(deque(left), of.symbols) - _sum(deque(right), of.symbols))

    return difference


def _sum(tokens: deque[str], values: Mapping[str, Any]) -> Any:
    """The value of tokens up to a closing bracket or the end, which are used up."""
    total = 0.0
    while tokens and tokens[0] != ")":
        sign = tokens.popleft() if tokens[0] in "+−" else "+"
        product = 1.0
        while tokens and tokens[0] not in "+−)":
            product = product * _factor(tokens, values)
        total = total - product if sign == "−" else total + product
    return total


def _factor(tokens: deque[str], values: Mapping[str, Any]) -> Any:
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
