"""Position and rate of the drive by Exudyn's clock, the input of its constraint: held, or running in time."""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from math import ceil, inf
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes import laws
from scenes.scene import ConstantSpeed, Drive, MotionLaw

Function: TypeAlias = Callable[[float], float]  # of Exudyn's clock, s

SAME_JERK = 1e-9  # of the largest in the law: neighbours of one cubic, as at the ends of a not-a-knot spline


class Cubic(NamedTuple):
    """A drive from one instant to the next piece's: one cubic of the time, s, which is defined before and after too."""

    begin: float  # s
    start: float  # rad or m, at that instant; and its derivatives by the time
    speed: float
    acceleration: float
    jerk: float
    within: float = inf  # s, in which it changes

    def at(self, time: float) -> tuple[float, float, float]:
        """The position, rad or m, and its first two derivatives."""
        t = time - self.begin
        position = self.start + t * (self.speed + t * (self.acceleration / 2 + t * self.jerk / 6))
        return position, self.speed + t * (self.acceleration + t * self.jerk / 2), self.acceleration + t * self.jerk


Part: TypeAlias = Cubic | laws.Piece


def pieces(drive: Drive, end: float) -> Sequence[Part]:
    """Cut a drive, from zero to an instant, s, into pieces: a table at the knots where its jerk jumps, or formulas."""
    if isinstance(drive, ConstantSpeed):
        return [Cubic(0.0, drive.start, drive.speed, 0.0, 0.0)]
    cycles = ceil(end / drive.cycle - 1e-9) or 1
    if not isinstance(drive, MotionLaw):
        return drive.through(cycles)
    knots = np.array([*(k * drive.cycle + t for k in range(cycles) for t in drive.times[:-1]), cycles * drive.cycle])
    position, rate, acceleration = drive.at(knots)
    jerk = np.diff(acceleration) / np.diff(knots)
    jumps = np.abs(np.diff(jerk, prepend=np.inf)) > SAME_JERK * np.abs(jerk).max()
    rows = zip(knots[:-1], position[:-1], rate[:-1], acceleration[:-1], jerk, strict=True)
    return [Cubic(*map(float, row)) for row, jump in zip(rows, jumps, strict=True) if jump]


class ExudynDrive:
    """The drive as functions of Exudyn's clock: held at a position, rad or m, until it runs through pieces.

    While it is held its rate is one: velocities are then derivatives by the position.
    """

    position: Function  # rad or m
    rate: Function

    def __init__(self, held: float = 0.0) -> None:
        self.held = held
        self.zero = 0.0  # s, of the scene's time when Exudyn's clock, which cannot be negative, is zero
        self.position, self.rate = lambda _clock: self.held, lambda _clock: 1.0

    def run(self, parts: Sequence[Part], zero: float) -> None:
        """Begin at an instant, s; the first piece also holds before it begins, and the last one after it ends."""
        self.zero = zero
        if len(parts) > 1 or isinstance(parts[0], laws.Piece):
            self.position, self.rate = (lambda clock, of=of: _at(parts, zero + clock)[of] for of in (0, 1))
            return
        start, speed, acceleration = parts[0].at(zero)  # Exudyn asks seven times a step
        half, sixth = acceleration / 2, parts[0].jerk / 6
        self.position = lambda t: start + t * (speed + t * (half + t * sixth))
        self.rate = lambda t: speed + t * (2 * half + t * 3 * sixth)


def _at(parts: Sequence[Part], time: float) -> Any:
    return parts[max(bisect_right(parts, time, key=lambda part: part.begin), 1) - 1].at(time)
