"""Position and rate of the drive by Exudyn's clock, the input of its constraint: held, or running in time."""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from math import ceil, inf
from typing import Any

import numpy as np

from scenes.laws import Piece
from scenes.scene import ConstantSpeed, DriveLaw, HarmonicLaw, SegmentedLaw

CUBED = 3  # in a cubic's polynomial, the place of what the jerk is six times of
SAME_JERK_TOL = 1e-9  # of the largest in the law: neighbours of one cubic, as at the ends of a not-a-knot spline


def pieces(law: DriveLaw, end: float) -> Sequence[Piece]:
    """Cut a law, from zero to an instant, s, into pieces: a table at the knots where its jerk jumps, or formulas."""
    if isinstance(law, ConstantSpeed):
        return [Piece(0.0, (law.start, law.speed, 0.0, 0.0), within=inf)]
    if isinstance(law, HarmonicLaw):
        return law.pieces
    cycles, gain = ceil(end / law.cycle - 1e-9) or 1, law.positions[-1] - law.positions[0]
    every = [piece.moved(k * law.cycle, k * gain) for k in range(cycles + 1) for piece in law.pieces]
    count = cycles * len(law.pieces)
    if isinstance(law, SegmentedLaw):
        return every[: count + law.periodic]  # to the next cycle's first one belongs the end of the last
    # A spline's neighbouring pieces may be parts of one cubic, as at the second knot of a not-a-knot spline. Only a
    # jump of the jerk (third derivative) disturbs the integration; pieces without one are joined.
    cubics = [cubic._replace(polynomial=[*map(float, cubic.polynomial)], within=inf) for cubic in every[:count]]
    cubed = np.array([cubic.polynomial[CUBED] for cubic in cubics])
    jumps = np.abs(np.diff(cubed, prepend=np.inf)) > SAME_JERK_TOL * np.abs(cubed).max()
    return [cubic for cubic, jump in zip(cubics, jumps, strict=True) if jump]


class ExudynDrive:
    """The drive as functions of Exudyn's clock: held at a position, rad or m, until it runs through pieces.

    While it is held its rate is one: velocities are then derivatives by the position.
    """

    position: Callable[[float], float]  # rad or m, of Exudyn's clock, s
    rate: Callable[[float], float]

    def __init__(self, held: float = 0.0) -> None:
        self.held = held
        self.zero = 0.0  # s, of the scene's time when Exudyn's clock, which cannot be negative, is zero
        self.position, self.rate = lambda _clock: self.held, lambda _clock: 1.0

    def run(self, parts: Sequence[Piece], zero: float) -> None:
        """Begin at an instant, s; the first piece also holds before it begins, and the last one after it ends."""
        self.zero, polynomial = zero, parts[0].polynomial
        if len(parts) > 1 or parts[0].sines or len(polynomial) != CUBED + 1:
            self.position, self.rate = (lambda clock, order=order: _at(parts, zero + clock)[order] for order in (0, 1))
            return
        start, speed, acceleration = map(float, parts[0].at(zero))  # Exudyn asks seven times a step
        half, sixth = acceleration / 2, polynomial[CUBED]
        self.position = lambda t: start + t * (speed + t * (half + t * sixth))
        self.rate = lambda t: speed + t * (2 * half + t * 3 * sixth)


def _at(parts: Sequence[Piece], time: float) -> Any:
    piece = parts[max(bisect_right(parts, time, key=lambda part: part.begin), 1) - 1]
    if piece.sines:
        return piece.at(time)
    t, position, rate = time - (piece.begin + piece.lag), 0.0, 0.0
    # Horner's scheme for the value and, alongside, its derivative.
    for c in reversed(piece.polynomial):  # with plain numbers a tenth of the time of arrays
        position, rate = position * t + c, rate * t + position
    return position, rate
