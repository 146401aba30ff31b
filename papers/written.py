"""Printed equations as they are read: the text that the page shows is what is evaluated."""

import re
from collections import deque
from collections.abc import Callable, Mapping
from math import tau
from typing import Any

import numpy as np

from .claims import Difference, Equation, Symbols

FUNCTIONS: Mapping[str, Callable[[Any], Any]] = {
    **{"sin": np.sin, "cos": np.cos, "atan": np.arctan, "arccos": np.arccos, "√": np.sqrt},
    "e^i": lambda angle: np.exp(1j * angle),
}
NUMBERS: Mapping[str, Any] = {"0": 0.0, "1": 1.0, "2": 2.0, "i": 1j}
INERTIA = r"m[₁-₅]? S̈[xy₁-₅]+|J[₀-₅]α[₁-₅]?|m₅[αg][₅ₛ]?"  # products with an acceleration
TOKEN = re.compile(rf"{INERTIA}|F_R\w+|\w_\w|Ls[₁-₅]?|{'|'.join(map(re.escape, FUNCTIONS))}|[+−/()²]|\w[₀-₅ₛ]?")


def equation(
    kind: str,
    claim: str,
    text: str,
    corrected: str = "",
    *,
    note: str = "",
    read: str = "",
    meant: str = "",
    given: str = "",
    branch: tuple[str, str, str] = ("", "", ""),
) -> Equation:
    """An equation of which every form is what its text is read as, unless that is `read` or `meant` as another text.

    A text has two sides, sums of products of factors that stand side by side, before a colon a remark, and after commas
    abbreviations or remarks. A function is of the factor after it. Abbreviations of other equations are `given`. A
    `branch` has a name, and what it exchanges for what in the text that is read.
    """

    def form(text: str) -> Callable[[Symbols], Difference]:
        return _difference(f"{text}, {given}", modulo=tau if kind == "angle" else 0.0)

    name, one, other = branch
    branches = {name: form((read or text).replace(one, other))} if name else {}
    right = form(meant or corrected) if corrected else None
    return Equation(kind, claim, text, form(read or text), corrected, right, branches, note)


def _difference(text: str, *, modulo: float) -> Callable[[Symbols], Difference]:
    """The left side less the right one, perhaps but for multiples of something."""
    brackets = str.maketrans("[]", "()")
    parts = [part.split("=") for part in text.translate(brackets).rpartition(": ")[2].split(", ") if "=" in part]
    (left, right), *abbreviations = ([TOKEN.findall(side) for side in sides] for sides in parts)

    def difference(of: Symbols) -> Difference:
        values = of.copy()
        for (name,), meaning in abbreviations:
            values[name] = _sum(deque(meaning), values)
        off = _sum(deque(left), values) - _sum(deque(right), values)
        return np.asarray(np.remainder(off + modulo / 2, modulo) - modulo / 2 if modulo else off)

    return difference


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
