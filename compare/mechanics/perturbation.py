"""What goes into the solution of a scene, and the scene with all of it a little off."""

from collections.abc import Callable, Iterator
from itertools import groupby
from typing import NamedTuple

import numpy as np

from scenes import Failure, Scene
from scenes.numbers import At, put, walk

from ..engines import registry

ULPS = 4  # of every number, up or down at random
DRAWS = 4  # scenes; their worst is within a factor of three of the worst of many more, see the tests
SEED = 20261121
LEFT_OUT = {("drive", name) for name in ("start", "end", "times", "positions")} | {
    ("loads", name) for name in ("last", "displacements")
}


class Input(NamedTuple):
    """A number of a scene, SI, or several that belong together: a vector, or the forces of a table."""

    at: At
    value: float | tuple[float, ...]
    dimension: str  # `length` of lengths and places

    def each(self, other: Callable[[float], float]) -> float | tuple[float, ...]:
        """The value with another number in the place of each."""
        return tuple(map(other, self.value)) if isinstance(self.value, tuple) else other(self.value)


def inputs(scene: Scene) -> Iterator[Input]:
    """Yield the inputs of a scene but for those that say where the drive is, and where a load changes."""
    for at, together in groupby(walk(scene), lambda n: n.at[:-1] if isinstance(n.at[-1], int) else n.at):
        first, *others = together
        if at[0] != "sketch" and (at[0], at[-1]) not in LEFT_OUT:
            value = (first.value, *(other.value for other in others)) if isinstance(first.at[-1], int) else first.value
            yield Input(at, value, first.quantity.dimension)


def neighbours(scene: Scene) -> tuple[registry.Solve, ...]:
    """Solvers of the scene with its lengths and places off by a few last places; none if one cannot be solved."""
    draw, off = np.random.default_rng(SEED), ULPS * np.finfo(float).eps
    lengths = [one for one in inputs(scene) if one.dimension == "length"]

    def jittered(value: float) -> float:
        return value * (1 + off * float(draw.choice((-1.0, 1.0))))

    try:
        others = [put(scene, {one.at: one.each(jittered) for one in lengths}) for _ in range(DRAWS)]
        return tuple(map(registry.reference, others))
    except Failure:
        return ()
