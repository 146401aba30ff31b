"""Position and rate of the drive by Exudyn's clock, the input of its constraint: held, or running in time."""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from math import ceil
from typing import NamedTuple, TypeAlias

import numpy as np

from scenes.scene import ConstantSpeed, Drive

Function: TypeAlias = Callable[[float], float]  # of Exudyn's clock, s

SAME_JERK = 1e-9  # of the largest in the law: neighbours of one cubic, as at the ends of a not-a-knot spline


class HeldDrive:
    """The drive held at a position, rad or m, with a rate of one: velocities are then derivatives by the position."""

    zero = 0.0  # s

    def __init__(self, held: float) -> None:
        self.held = held

    def position(self, _clock: float) -> float:
        """Where it is held, rad or m."""
        return self.held

    def rate(self, _clock: float) -> float:
        """One."""
        return 1.0


class Piece(NamedTuple):
    """A drive from one instant to the next piece's: one cubic of the time, s, which is defined before and after too."""

    begin: float  # s
    start: float  # rad or m, at that instant; and its derivatives by the time
    speed: float
    acceleration: float
    jerk: float

    def position(self, time: float) -> float:
        """The position, rad or m."""
        t = time - self.begin
        return self.start + t * (self.speed + t * (self.acceleration / 2 + t * self.jerk / 6))

    def rate(self, time: float) -> float:
        """Its first derivative."""
        t = time - self.begin
        return self.speed + t * (self.acceleration + t * self.jerk / 2)

    def second(self, time: float) -> float:
        """Its second derivative."""
        return self.acceleration + (time - self.begin) * self.jerk


def pieces(drive: Drive, end: float) -> list[Piece]:
    """Cut a drive, from zero to an instant, s, into pieces: a law at the knots where its jerk jumps."""
    if isinstance(drive, ConstantSpeed):
        return [Piece(0.0, drive.start, drive.speed, 0.0, 0.0)]
    cycles = ceil(end / drive.cycle - 1e-9) or 1
    knots = np.array([*(k * drive.cycle + t for k in range(cycles) for t in drive.times[:-1]), cycles * drive.cycle])
    position, rate, acceleration = drive.at(knots)
    jerk = np.diff(acceleration) / np.diff(knots)
    jumps = np.abs(np.diff(jerk, prepend=np.inf)) > SAME_JERK * np.abs(jerk).max()
    rows = zip(knots[:-1], position[:-1], rate[:-1], acceleration[:-1], jerk, strict=True)
    return [Piece(*map(float, row)) for row, jump in zip(rows, jumps, strict=True) if jump]


class RunningDrive:
    """The drive in time, by some of its pieces; Exudyn's clock, which cannot be negative, begins at an instant of it.

    The first piece also holds before it begins, and the last one after it ends.
    """

    zero = 0.0  # s, of the scene's time when Exudyn's clock is zero
    position: Function  # rad or m
    rate: Function

    def run(self, parts: Sequence[Piece], zero: float) -> None:
        """Begin at an instant, s."""
        self.zero = zero
        if len(parts) > 1:
            self.position = lambda clock: _at(parts, zero + clock).position(zero + clock)
            self.rate = lambda clock: _at(parts, zero + clock).rate(zero + clock)
            return
        (part,) = parts  # Exudyn asks seven times a step
        start, speed, half, sixth = part.position(zero), part.rate(zero), part.second(zero) / 2, part.jerk / 6
        self.position = lambda t: start + t * (speed + t * (half + t * sixth))
        self.rate = lambda t: speed + t * (2 * half + t * 3 * sixth)


def _at(parts: Sequence[Piece], time: float) -> Piece:
    return parts[max(bisect_right(parts, time, key=lambda part: part.begin), 1) - 1]


ExudynDrive: TypeAlias = HeldDrive | RunningDrive
