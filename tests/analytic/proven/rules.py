"""What each rule of Taylor models stands for, in exact arithmetic, and the operands that it is tried with."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from flint import arb

from analytic.recorded.arithmetics.taylor_models import RULES, TaylorModel, point
from scenes.model.motion import Samples

from .exact_values import LIKE, Escape, around, drawn, drawn_places, escapes

TRUE: Mapping[str, Callable[..., Any]] = {
    "add": lambda x, y: x + y,
    "subtract": lambda x, y: x - y,
    "multiply": lambda x, y: x * y,
    "divide": lambda x, y: x / y if y != 0 else None,
    "negative": lambda x: -x,
    "absolute": abs,
    "sqrt": lambda x: x.sqrt() if x >= 0 else None,
    "sin": lambda x: x.sin(),
    "cos": lambda x: x.cos(),
    "tanh": lambda x: x.tanh(),
    "floor": lambda x: x.floor() if x.floor().is_exact() else None,
    "arctan2": lambda y, x: None if x == 0 and y == 0 else arb.atan2(y, x),
    "maximum": lambda x, y: x if x > y else y,
    "minimum": lambda x, y: x if x < y else y,
    "less": lambda x, y: arb(1 if x < y else 0) if x < y or x >= y else None,
    "less_equal": lambda x, y: arb(1 if x <= y else 0) if x <= y or x > y else None,
    "where": lambda condition, x, y: x if condition > 0.5 else y,
    "within": lambda x, off: x + off,  # of either sign
}
PLACES = 5  # of each box


def operands(name: str, chance: np.random.Generator, count: int) -> list[TaylorModel]:
    """Models for a rule: among them arguments about its zeros, kinks and branch cuts."""
    x, y = drawn(chance, count), drawn(chance, count)
    third: Samples = np.arange(count) % 3 == 0
    match name:
        case "where":
            kind = chance.integers(0, 3, count) / 2  # false, not decided, true
            return [point(kind, LIKE, np.where(kind == 0.5, 0.5, 0.0)), x, y]
        case "sqrt":
            return [around(x, np.where(third, x.radius * chance.uniform(0.9, 3, count), np.abs(x.c[0])))]
        case "tanh":
            return [around(x, np.where(third, chance.uniform(-40, 40, count), x.c[0]))]
        case "floor":
            return [around(x, np.clip(x.c[0], -1e9, 1e9))]
        case "sin" | "cos":
            quarter = np.pi / 2 * np.round(x.c[0])
            return [around(x, np.where(third, quarter, x.c[0]))]
        case "divide":
            return [x, around(y, np.where(third, y.radius * chance.uniform(0.9, 4, count), y.c[0]))]
        case "arctan2":
            behind = np.where(third, -np.abs(y.c[0]), y.c[0])  # where the angle jumps by a turn
            return [
                around(x, np.where(third, chance.choice([0.0, 1.0, -1.0], count) * x.radius, x.c[0])),
                around(y, behind),
            ]
        case "maximum" | "minimum" | "less" | "less_equal":
            return [x, around(y, np.where(third, x.c[0] + y.radius * chance.choice([-1, 0, 1], count), y.c[0]))]
        case "subtract" | "add" | "multiply" | "within":
            return [x, y]
    return [x]


def found(name: str, count: int, seed: int = 0) -> list[Escape]:
    """The escapes of a rule from so many boxes."""
    chance = np.random.default_rng([seed, *name.encode()])
    given = operands(name, chance, count)
    places = {box: drawn_places(chance, len(given), PLACES) for box in range(count)}
    if name == "where":  # a condition is true or false
        places = {box: [one._replace(e=[np.sign(one.e[0]), *one.e[1:]]) for one in own] for box, own in places.items()}
    with np.errstate(all="ignore"):
        made = RULES[name](*given)
    return [*escapes(made, TRUE[name], given, places)]


def known(name: str, given: Sequence[TaylorModel]) -> Any:
    """In which boxes a rule knows a rest."""
    with np.errstate(all="ignore"):
        return np.isfinite(RULES[name](*given).rest)
