"""Position and rate of the drive by Exudyn's clock, the input of its constraint: held, or running in time."""

from bisect import bisect_right
from collections.abc import Sequence
from math import ceil
from typing import NamedTuple, TypeAlias

import numpy as np

from scenes.scene import ConstantSpeed, Drive

SAME_JERK = 1e-9  # of the largest in the law: neighbours of one cubic, as at the ends of a not-a-knot spline


class HeldDrive:
    """The drive held at a position, rad or m, with a rate of one: velocities are then derivatives by the position."""

    zero = 0.0  # s

    def __init__(self, held: float) -> None:
        self.held = held

    def position(self, _clock: float) -> float:
        """Return the position, rad or m."""
        return self.held

    def rate(self, _clock: float) -> float:
        """Return one."""
        return 1.0


class Piece(NamedTuple):
    """A drive from one instant to the next piece's: one cubic, which is defined before and after these too."""

    begin: float  # s
    start: float  # rad or m, at that instant; and its derivatives by the time
    speed: float
    acceleration: float
    jerk: float

    def position(self, time: float) -> float:
        """Return the position, rad or m, at an instant, s."""
        t = time - self.begin
        return self.start + t * (self.speed + t * (self.acceleration / 2 + t * self.jerk / 6))

    def rate(self, time: float) -> float:
        """Return its first derivative."""
        t = time - self.begin
        return self.speed + t * (self.acceleration + t * self.jerk / 2)

    def second(self, time: float) -> float:
        """Return its second derivative."""
        return self.acceleration + (time - self.begin) * self.jerk


def pieces(drive: Drive, end: float) -> list[Piece]:
    """Return the pieces of a drive from zero to an instant, s: of a law, between the knots where its jerk jumps."""
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

    The first piece also tells what is before it, and the last one what is after it.
    """

    def __init__(self) -> None:
        self.zero = 0.0  # s, of the scene's time when Exudyn's clock is zero
        self.pieces: Sequence[Piece] = ()

    def position(self, clock: float) -> float:
        """Return the position, rad or m."""
        return self._piece(self.zero + clock).position(self.zero + clock)

    def rate(self, clock: float) -> float:
        """Return its first derivative."""
        return self._piece(self.zero + clock).rate(self.zero + clock)

    def _piece(self, time: float) -> Piece:
        first = self.pieces[0]
        if len(self.pieces) == 1:
            return first
        return self.pieces[max(bisect_right(self.pieces, time, key=lambda piece: piece.begin), 1) - 1]


ExudynDrive: TypeAlias = HeldDrive | RunningDrive
