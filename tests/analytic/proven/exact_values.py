"""Taylor models drawn at random, the exact values that they stand for, and what no model's rest bounds.

All is worked out in balls of 200 bits from the models' doubles, so that no rounding of a double hides an escape.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from flint import arb, ctx

from analytic.recorded.arithmetics.taylor_models import TaylorModel
from scenes.model.motion import Samples

BITS = 200
SLACK = 2.0**-180  # of the terms of a check: what the balls' own roundings may be, with bits to spare
LIKE = 5  # coefficients of a drawn model: three of the parabola, and two numbers that may be off

Model = TaylorModel
Rule = Callable[..., TaylorModel]


class Place(NamedTuple):
    """A place in a box: -1 to 1 along it, of each number, and of each operand's rest."""

    s: float
    t: Sequence[float]
    e: Sequence[float]


class Escape(NamedTuple):
    """A true value outside its enclosure."""

    box: int
    place: Place
    beyond: float  # of the largest term


def drawn(chance: np.random.Generator, count: int) -> TaylorModel:
    """So many boxes of every kind: wide and tiny, with rests and parameters and without, of all sizes."""
    size = 10.0 ** chance.uniform(-6, 6, count)
    share = 10.0 ** chance.uniform(-12, 0.3, count)
    c = chance.uniform(-1, 1, (LIKE, count)) * size * share ** np.array([[0], [1], [2], [1], [1]])
    c[3:] *= 10.0 ** chance.uniform(-6, 0, count) * chance.integers(0, 2, count)
    rest = size * share * 10.0 ** chance.uniform(-9, 0.3, count) * chance.integers(0, 2, count)
    kind = np.arange(count) % 8
    points, rests, around, tiny, whole, narrow = (kind == number for number in range(6))  # the others stay as they are
    c[1:, points], rest[points] = 0.0, 0.0
    c[:, rests], rest[rests] = 0.0, np.abs(c[0, rests])
    c[0, around] *= share[around] * 1e-3
    c[:, tiny] *= 1e-157
    rest[tiny] *= 1e-157
    c[0, whole] = np.round(c[0, whole])
    c[1:, whole], rest[whole] = 0.0, rest[whole] * 1e-12
    c[1:, narrow] *= 1e-10
    rest[narrow] *= 1e-12
    return TaylorModel(c, rest)


def around(model: TaylorModel, values: Samples) -> TaylorModel:
    """The same with other middles."""
    return TaylorModel(np.concatenate([values[np.newaxis], model.c[1:]]), model.rest)


def drawn_places(chance: np.random.Generator, operands: int, count: int) -> list[Place]:
    """Places within a box, most of them at some of its ends."""

    def some(number: int) -> list[float]:
        inside = chance.uniform(-1, 1, number)
        return [*map(float, np.where(chance.random(number) < 0.6, np.sign(inside), inside))]

    return [Place(some(1)[0], some(LIKE - 3), some(operands)) for _ in range(count)]


def parabola(c: Sequence[float], place: Place) -> Any:
    """The exact value of a model's terms."""
    s = arb(place.s)
    value = arb(c[0]) + arb(c[1]) * s + arb(c[2]) * s * s
    for number, t in zip(c[3:], place.t, strict=True):
        value += arb(number) * arb(t)
    return value


def of_box(model: TaylorModel, box: int) -> tuple[list[float], float]:
    """The coefficients and the rest of a box."""
    return model.c[:, box % model.c.shape[1]].tolist(), float(model.rest[box % len(model.rest)])


def escapes(
    made: TaylorModel,
    true: Callable[..., Any],
    operands: Sequence[TaylorModel],
    places: Mapping[int, Sequence[Place]] | Sequence[Place],
) -> Iterator[Escape]:
    """Yield each true value that a known model does not have, box by box; `true` returns None where there is none."""
    with ctx.workprec(BITS):
        for box in range(max(len(one.rest) for one in operands)):
            c, rest = of_box(made, box)
            if np.isnan(rest):
                continue
            given = [of_box(one, box) for one in operands]
            for place in places[box] if isinstance(places, Mapping) else places:
                values = [
                    parabola(own, place) + arb(off) * arb(e) for (own, off), e in zip(given, place.e, strict=True)
                ]
                value = true(*values)
                if value is None:
                    continue
                apart = abs(value - parabola(c, place))
                size = max([rest, *map(abs, c), float(abs(value).upper())])
                if not apart - arb(rest) <= arb(SLACK * size):
                    yield Escape(box, place, float((apart - arb(rest)) / arb(size or 1.0)))
