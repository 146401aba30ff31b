"""The drive: where the driven body is to be at every instant. It is the scene's input, not a result of any model.

A driven crank has an angle, rad, a driven slider the displacement of its first point along its guide from `through`, m.
`position` below is the one or the other.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import pi
from typing import Annotated, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, Strict

from . import limits
from .errors import InputError
from .fields import FileTable, Known, Position, Speed, Time

Samples: TypeAlias = NDArray[np.float64]


class Driven(NamedTuple):
    """What the drive asks for, each of the shape of the instants: rad or m, and its derivatives by the time, s."""

    position: Samples
    rate: Samples
    acceleration: Samples


@dataclass(frozen=True)
class ConstantSpeed:
    """A constant speed: turn after turn, or once from `start` to `end`."""

    body: str
    speed: Speed  # rad/s, positive counter-clockwise, or m/s; never zero
    start: Position  # rad or m, when time is zero
    end: Position | None  # None for a crank that turns for ever

    @property
    def repeats(self) -> bool:
        """Whether a cycle can follow the one before."""
        return self.end is None

    @property
    def advance(self) -> float:
        """How far one cycle takes the body, rad or m: a turn, or the way to the end."""
        return 2 * pi * (self.speed / abs(self.speed)) if self.end is None else self.end - self.start

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""
        return self.advance / self.speed

    @property
    def peak_rate(self) -> float:
        """The largest |rate|, rad/s or m/s."""
        return abs(self.speed)

    @property
    def extent(self) -> tuple[float, float]:
        """The least and the largest position of a cycle, rad or m."""
        ends = self.start, self.start + self.advance
        return np.minimum(*ends), np.maximum(*ends)

    def after(self, cycles: ArrayLike) -> Samples:
        """The positions, rad or m, after numbers of cycles, whole or not, of any shape."""
        return self.start + np.asarray(cycles, np.float64) * self.advance

    def at(self, time: ArrayLike) -> Driven:
        """What the drive asks for at instants of any shape, s, before zero and after the end too."""
        time, still = np.asarray(time, np.float64), np.zeros(np.shape(time))
        return Driven(self.start + self.speed * time, np.asarray(self.speed) + still, still)


@dataclass(frozen=True)
class MotionLaw:
    """A cubic spline through a table of positions against time; periodic, or not-a-knot at both ends.

    A periodic law goes on for ever: a crank's may gain whole turns in each period, and its rate and acceleration
    continue smoothly from one period to the next.
    """

    body: str
    times: tuple[Time, ...] = field(metadata={"path": "law.*.0"})  # s, increasing, from zero
    positions: tuple[Position, ...] = field(metadata={"path": "law.*.1"})  # rad or m
    periodic: bool

    @property
    def repeats(self) -> bool:
        """Whether a cycle can follow the one before."""
        return self.periodic

    @property
    def start(self) -> float:
        """The position when time is zero, rad or m."""
        return self.positions[0]

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""
        return self.times[-1]

    @cached_property
    def peak_rate(self) -> float:
        """The largest |rate|, rad/s or m/s: of a spline's parabolas, at an end or where one peaks."""
        peaks = self._spline.derivative(2).roots(extrapolate=False)
        inside = peaks[np.isfinite(peaks) & (peaks > 0) & (peaks < self.cycle)]
        return float(np.abs(self.at([*self.times, *inside]).rate).max())

    @cached_property
    def extent(self) -> tuple[float, float]:
        """The least and the largest position of a cycle, rad or m: of a row, or where the rate is zero."""
        turning = self._spline.derivative().solve(-self._trend, extrapolate=False)
        positions = self.at([*self.times, *turning[np.isfinite(turning)]]).position
        return float(positions.min()), float(positions.max())

    @property
    def table(self) -> tuple[float, float]:
        """The least and the largest position of the table, rad or m."""
        return min(self.positions), max(self.positions)

    @property
    def beyond(self) -> float:
        """How far the spline goes beyond the positions of its table, as a share of their range."""
        (low, high), (least, most) = self.extent, self.table
        return max(least - low, high - most) / (most - least)

    def after(self, cycles: ArrayLike) -> Samples:
        """The positions, rad or m, after numbers of cycles, whole or not, of any shape."""
        return self.at(np.asarray(cycles, np.float64) * self.cycle).position

    def at(self, time: ArrayLike) -> Driven:
        """What the drive asks for at instants of any shape, s, before zero and after the end too."""
        time = np.asarray(time, np.float64)
        spline, trend = self._spline, self._trend
        return Driven(spline(time) + trend * time, spline(time, 1) + trend, spline(time, 2))

    @property
    def _trend(self) -> float:
        """What a periodic law gains a second, which the spline leaves out."""
        return (self.positions[-1] - self.positions[0]) / self.cycle if self.periodic else 0.0

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import CubicSpline  # late: few scenes need it, and it is slow to import

        times = np.array(self.times)
        positions = np.array(self.positions) - self._trend * times
        if self.periodic:
            positions[-1] = positions[0]  # but for a rounding they are the same
            return CubicSpline(times, positions, bc_type="periodic")
        return CubicSpline(times, positions)


Drive: TypeAlias = ConstantSpeed | MotionLaw
LawRow = Annotated[tuple[Time, Position], Strict(False)]


class DriveTable(FileTable):
    """The driven body, a crank or a slider, and its speed or its motion law."""

    body: Known = Field(description="A body with one pin on the ground, or on the body `on`, or one that slides.")
    on: Known | None = Field(
        None, description="Another body, against which it turns at a pin of both; the ground where absent."
    )
    speed: Speed | None = Field(None, description="The constant speed; negative clockwise, or against `along`.")
    start: Position | None = Field(
        None, description="At time zero: the angle of its x axis, or its displacement from `through`."
    )
    end: Position | None = Field(None, description="Where it stops; without it a crank turns for ever.")
    law: Annotated[list[LawRow], Field(min_length=4, max_length=limits.ROWS)] | None = Field(
        None, description="Instead of a speed: [time in s, angle or displacement], for a cubic spline."
    )
    periodic: bool | None = Field(None, description="Whether the law goes on for ever.")

    def drive(self) -> Drive:
        """The drive, its numbers as they are; InputError where the keys do not go together."""
        if (self.law is None) == (self.speed is None):
            raise InputError("drive: expected either 'speed' or 'law'")
        if self.speed is not None:
            if self.periodic is not None:
                raise InputError("drive.periodic: expected a 'law' with it")
            return ConstantSpeed(self.body, self.speed, self.start or 0.0, self.end)
        for key, given in (("start", self.start), ("end", self.end)):
            if given is not None:
                raise InputError(f"drive.{key}: expected none with a 'law'")
        times, positions = zip(*self.law or (), strict=True)
        return MotionLaw(self.body, times, positions, bool(self.periodic))
