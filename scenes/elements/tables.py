"""Tables of a load: its values against where the drive is, the time, or a slider's displacement along its guide."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from ..demand import Demand
from ..fields import Coordinate, NewtonMetres, Newtons, Position, Time

if TYPE_CHECKING:
    from ..scene import Scene

Over: TypeAlias = Literal["drive", "time", "displacement"]
COLUMN = {"drive": "positions", "time": "times", "displacement": "displacements"}  # by what it is over: its field
DIMENSION = {"positions": "position", "times": "time", "displacements": "length"}  # by column


@dataclass(frozen=True)
class LoadCurve:
    """Straight lines between its entries; constant beyond them, or periodic. One argument and one value are given."""

    positions: tuple[Position, ...] = field(default=(), metadata={"path": "*.0"})  # of the drive, rad or m, increasing
    times: tuple[Time, ...] = field(default=(), metadata={"path": "*.0"})  # s
    displacements: tuple[Coordinate, ...] = field(default=(), metadata={"path": "*.0"})  # m
    forces: tuple[Newtons, ...] = field(default=(), metadata={"path": "*.1"})  # N
    moments: tuple[NewtonMetres, ...] = field(default=(), metadata={"path": "*.1"})  # N m
    periodic: bool = False

    @property
    def over(self) -> Over:
        """What its values are given against."""
        return "drive" if self.positions else "time" if self.times else "displacement"

    @property
    def arguments(self) -> tuple[Any, ...]:
        """Its first column, SI."""
        return self.positions or self.times or self.displacements

    @property
    def values(self) -> tuple[Any, ...]:
        """Its second column, SI."""
        return self.forces or self.moments

    @property
    def largest(self) -> Any:
        """The value that is furthest from zero."""
        return max(self.values, key=abs)

    def within(self, argument: Any) -> Any:
        """Arguments of any shape; of a periodic table those in its period that they stand for."""
        if not self.periodic:
            return argument
        first, period = self.arguments[0], self.arguments[-1] - self.arguments[0]
        return argument - period * np.floor((argument - first) / period)

    def at(self, argument: Any) -> Any:
        """The values at arguments of any shape."""
        lines = straight_lines if self._of_many else np.interp
        return lines(self.within(argument), self.arguments, self.values)

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield what of a periodic table does not fit; `place` is its own in the file."""
        if self.periodic:
            first, *_, last = self.values
            if not abs(last - first) <= 1e-9 * max(map(abs, self.values)):  # what a unit's conversion leaves
                unit, size = scene.all_units["force" if self.forces else "moment"]
                off = f"{first / size:.6g} {unit}, found {last / size:.6g} {unit}"
                yield f"{place}: periodic: expected the last value to be the first, {off}"

    def demands(self, scene: "Scene", place: str) -> Iterator[Demand]:
        """Yield that its arguments increase; `place` is its own in the file."""
        name = COLUMN[self.over]
        unit, size = scene.all_units[DIMENSION[name]]
        for row, (before, after) in enumerate(pairwise(self.arguments), start=1):
            text = f"{place}.{row}.0: expected increasing {name}, found {{:.4g}} {unit}"
            yield Demand(text, before < after, (after / size,))

    @cached_property
    def _of_many(self) -> bool:
        """Whether the entries are those of many machines, shape (m, 1)."""
        return any(np.ndim(number) for number in (*self.arguments, *self.values))


def straight_lines(x: Any, arguments: Sequence[Any], values: Sequence[Any]) -> Any:
    """The values at x, of any shape, as `np.interp` has them; entries of many machines have the shape (m, 1)."""
    # A piecewise linear function as a sum of ramps, each clipped to its own step: constant beyond both ends, no search
    # for the step, and so no index, which machines with different arguments would not share. `np.interp` takes one
    # table alone.
    value = values[0]
    for (x0, f0), (x1, f1) in pairwise(zip(arguments, values, strict=True)):
        value = value + (f1 - f0) / (x1 - x0) * np.clip(x - x0, 0, x1 - x0)
    return value
