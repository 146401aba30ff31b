"""Tables of a load: its values against where the drive is, the time, or a slider's displacement along its guide."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Literal, TypeAlias

import numpy as np

from ..fields import Coordinate, NewtonMetres, Newtons, Position, Time

Over: TypeAlias = Literal["drive", "time", "displacement"]
COLUMN = {"drive": "positions", "time": "times", "displacement": "displacements"}  # by what it is over: its field
SEAM = 1e-9  # of the largest value: by how much the last of a periodic table may be off the first, by rounding


@dataclass(frozen=True)
class Table:
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

    def within(self, argument: Any) -> Any:
        """Arguments of any shape; of a periodic table those in its period that they stand for."""
        if not self.periodic:
            return argument
        first, period = self.arguments[0], self.arguments[-1] - self.arguments[0]
        return argument - period * np.floor((argument - first) / period)

    def at(self, argument: Any) -> Any:
        """The values at arguments of any shape."""
        return interpolated(self.within(argument), self.arguments, self.values)


def interpolated(argument: Any, arguments: Sequence[Any], values: Sequence[Any]) -> Any:
    """The value on straight lines between entries, constant beyond; these may be of many machines, shape (m, 1)."""
    if not any(np.ndim(number) for number in (*arguments, *values)):
        return np.interp(argument, arguments, values)
    value = values[0]
    for (x0, f0), (x1, f1) in pairwise(zip(arguments, values, strict=True)):
        value = value + (f1 - f0) / (x1 - x0) * np.clip(argument - x0, 0, x1 - x0)
    return value
