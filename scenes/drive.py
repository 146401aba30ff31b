"""A drive: the body it moves, against what, and its law. It is the scene's input, not a result of any model.

The law is where that body is to be at every instant: the angle of a crank, rad, or the displacement of a slider's first
point along its guide from `through`, m. `position` below is the one or the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf, pi, remainder, tau
from typing import Annotated, TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, Strict

from . import limits
from .bodies import GROUND, Slide
from .errors import InputError, nearest
from .fields import Angle, Duration, FileTable, Frequency, Known, Position, Speed, Time
from .laws import LAWS, Driven, HarmonicLaw, Law, Piece, Samples, SegmentedLaw
from .splines import CubicSpline, cubic_spline

__all__ = ["ConstantSpeed", "Drive", "DriveLaw", "DriveTable", "Driven", "HarmonicLaw", "MotionLaw", "Samples"]
__all__ += ["SegmentedLaw"]
ELBOWS, CYLINDERS = "drives between moving bodies", "cylinders that drive"
KINDS = frozenset({ELBOWS, CYLINDERS})  # of drives that not every engine knows


@dataclass(frozen=True)
class ConstantSpeed:
    """A constant speed: turn after turn, or once from `start` to `end`."""

    speed: Speed  # rad/s, positive counter-clockwise, or m/s; never zero
    start: Position  # rad or m, when time is zero
    end: Position | None  # None for a crank that turns for ever

    @property
    def periodic(self) -> bool:
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

    def higher(self, time: ArrayLike) -> tuple[Samples, Samples]:
        """The third and the fourth derivative of the position by the time, at instants of any shape, s."""
        still = np.zeros(np.shape(time))
        return still, still


@dataclass(frozen=True)
class MotionLaw(Law):
    """A cubic spline through a table of positions against time; periodic, or not-a-knot at both ends.

    A periodic law goes on for ever: a crank's may gain whole turns in each period, and its rate and acceleration
    continue smoothly from one period to the next.
    """

    times: tuple[Time, ...] = field(metadata={"path": "law.*.0"})  # s, increasing, from zero
    positions: tuple[Position, ...] = field(metadata={"path": "law.*.1"})  # rad or m
    periodic: bool  # whether a cycle can follow the one before

    @property
    def start(self) -> float:
        """The position when time is zero, rad or m."""
        return self.positions[0]

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""
        return self.times[-1]

    def still(self, order: int) -> ArrayLike:
        """The instants of the rows, s, and all of a cycle where the derivative of an order, 1 or 2, is zero."""
        # The spline's own slope has to be minus the trend where the law stands still. The rows are in the list because
        # the ends of a law that is not periodic are extremes without a zero of any derivative, and because rounding may
        # put a zero at a row just outside both of its cubics.
        return [*self.times, *self._spline.still(order, -self._trend)]

    @property
    def table(self) -> tuple[float, float]:
        """The least and the largest position of the table, rad or m."""
        return min(self.positions), max(self.positions)

    @property
    def beyond(self) -> float:
        """How far the spline goes beyond the positions of its table, as a share of their range."""
        (low, high), (least, most) = self.extent, self.table
        return max(least - low, high - most) / (most - least)

    def at(self, time: ArrayLike) -> Driven:
        """What the drive asks for at instants of any shape, s, before zero and after the end too."""
        time = np.asarray(time, np.float64)
        spline, trend = self._spline, self._trend
        return Driven(spline(time) + trend * time, spline(time, 1) + trend, spline(time, 2))

    def higher(self, time: ArrayLike) -> tuple[Samples, Samples]:
        """The third derivative, which jumps at the rows, and the fourth, which is zero between them."""
        third = self._spline(np.asarray(time, np.float64), 3)
        return third, np.zeros_like(third)

    @property
    def pieces(self) -> Sequence[Piece]:
        """The cubics of a cycle, in the order of the time."""
        trend, cubics = self._trend, zip(self.times, self._spline.c.T, strict=False)  # the last row begins none
        return [Piece(begin, (c[3] + trend * begin, c[2] + trend, c[1], c[0])) for begin, c in cubics]

    @property
    def _trend(self) -> float:
        """What a periodic law gains a second, which the spline leaves out."""
        return (self.positions[-1] - self.positions[0]) / self.cycle if self.periodic else 0.0

    @cached_property
    def _spline(self) -> CubicSpline:
        times = np.array(self.times)
        # A law that gains whole turns in a period is a periodic function and a straight line. The line is taken off
        # before the spline, whose rate and acceleration then continue from one period to the next, and is added again
        # in `at`.
        positions = np.array(self.positions) - self._trend * times
        if self.periodic:
            positions[-1] = positions[0]  # but for a rounding they are the same
        return cubic_spline(times, positions, periodic=self.periodic)


DriveLaw: TypeAlias = ConstantSpeed | MotionLaw | SegmentedLaw | HarmonicLaw


@dataclass(frozen=True)
class Drive:
    """One drive: a crank at its pin on the ground or on another body, or a slider along its guide."""

    body: str  # which it moves
    law: DriveLaw = field(metadata={"path": ""})  # whose keys stand beside the body's in the file
    on: str = GROUND  # the body against which it moves that, by the pin or by the guide
    slide: Slide | None = field(default=None, compare=False, metadata={"path": None})  # of a scene's: the body's guide

    @property
    def channel(self) -> str:
        """The channel of its position: `crank_angle`, or `drive.displacement` of a driven slider."""
        return "crank_angle" if self.slide is None else "drive.displacement"

    @property
    def effort_channel(self) -> str:
        """The channel of what it does: `drive.torque` on a crank, `drive.force` on a driven slider."""
        return "drive.torque" if self.slide is None else "drive.force"

    @property
    def kind(self) -> str | None:
        """What engines call it that need not know it; None of a crank or a slider on the ground."""
        if self.on == GROUND:
            return None
        return ELBOWS if self.slide is None else CYLINDERS

    @property
    def span(self) -> float:
        """How far apart its least and its largest position are, rad or m."""
        least, largest = self.law.extent
        return float(largest - least)

    @property
    def unit(self) -> float:
        """What its errors are shares of: one radian of a crank, the span of a slider, m."""
        return 1.0 if self.slide is None else self.span

    @property
    def turn(self) -> float:
        """How far apart two positions are that are one place, rad: a turn of a crank; infinite of a slider."""
        return tau if self.slide is None else inf

    def in_range(self, position: float) -> float:
        """A position, rad or m; of a crank that by whole turns next to the middle of its range.

        One that turns fully has no end to lock beyond, and may go the shorter way to its start. The 50-digit model and
        the analytic core have this by themselves.
        """
        if self.slide is not None:
            return position
        low, high = self.law.extent
        near = self.law.start if high - low > tau - 1e-6 else (low + high) / 2  # rad; a turn less all roundings
        return near - remainder(near - position, tau)


LawRow = Annotated[tuple[Time, Position], Strict(False)]
HarmonicRow = Annotated[tuple[Position, Frequency, Angle], Strict(False)]
BESIDE = {"speed": ("start", "end"), "law": ("periodic",), "segments": ("start", "periodic"), "harmonics": ("start",)}


class SegmentTable(FileTable):
    """A part of a motion, from rest to rest."""

    to: Position | None = Field(None, description="Where it ends; without it the drive dwells.")
    within: Duration = Field(description="How long it takes, in s.")
    law: Known | None = Field(None, description="By what law: harmonic, cycloidal, polynomial_345 and so on.")

    def segment(self, place: str) -> tuple[float | None, float, str | None]:
        """The end, the duration and the law, as they are; InputError where one of way and law is missing."""
        if (self.to is None) != (self.law is None):
            missing, given = ("to", "law") if self.to is None else ("law", "to")
            raise InputError(f"{place}.{missing}: missing beside '{given}'; a dwell has neither")
        if self.law is not None and self.law not in LAWS:
            raise InputError(f"{place}.law: no law '{self.law}'{nearest(self.law, LAWS)}")
        return self.to, self.within, self.law


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
    segments: Annotated[list[SegmentTable], Field(min_length=1, max_length=limits.SEGMENTS)] | None = Field(
        None, description="Instead of a speed: named laws and dwells in a row, from `start`."
    )
    harmonics: Annotated[list[HarmonicRow], Field(min_length=1, max_length=limits.SEGMENTS)] | None = Field(
        None, description="Instead of a speed: [amplitude, frequency in 1/s, phase] of sines, whose sum `start` gets."
    )
    periodic: bool | None = Field(None, description="Whether the law, or the segments, go on for ever.")

    def drive(self) -> Drive:
        """The drive, its numbers as they are; InputError where the keys do not go together."""
        return Drive(self.body, self._law(), self.on or GROUND)

    def _law(self) -> DriveLaw:
        given = [key for key in BESIDE if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(f"'{key}'" for key in given) or "none"
            raise InputError(f"drive: expected either 'speed', 'law', 'segments' or 'harmonics', found {found}")
        for key in ("start", "end", "periodic"):
            if getattr(self, key) is not None and key not in BESIDE[given[0]]:
                instead = " or ".join(f"a '{kind}'" for kind, keys in BESIDE.items() if key in keys)
                raise InputError(f"drive.{key}: expected none with a '{given[0]}', but with {instead}")
        start, periodic = self.start or 0.0, bool(self.periodic)
        if self.speed is not None:
            return ConstantSpeed(self.speed, start, self.end)
        if self.segments is not None:
            segments = (table.segment(f"drive.segments.{number}") for number, table in enumerate(self.segments))
            ends, durations, laws = zip(*segments, strict=True)
            return SegmentedLaw(start, ends, durations, laws, periodic)
        if self.harmonics is not None:
            return HarmonicLaw(start, *zip(*self.harmonics, strict=True))
        times, positions = zip(*self.law or (), strict=True)
        return MotionLaw(times, positions, periodic)
