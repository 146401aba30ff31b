"""Where the drive is to be, as Exudyn's constraint asks for it: at a time of Exudyn's clock, or held."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes.scene import ConstantSpeed, Drive

Function: TypeAlias = Callable[[float], float]  # of Exudyn's clock, s

SAME_INSTANT = 1e-9  # of a step; what rounding leaves between two ways of counting the clock


class Course:
    """The drive's position and rate by Exudyn's clock, which cannot start below zero: it runs ahead by `lead`, s."""

    def __init__(self, drive: Drive) -> None:
        self.drive, self.lead = drive, 0.0
        self.position: Function
        self.rate: Function
        self.hold(drive.start)

    def hold(self, position: float) -> None:
        """Keep the drive at one position, rad or m, with a rate of one, so that velocities are by the position."""
        self.position = lambda _clock: position
        self.rate = lambda _clock: 1.0

    def run(self, lead: float, step: float, steps: int) -> None:
        """Follow the drive in time, for a number of steps of the same size, s."""
        self.lead = lead
        if isinstance(self.drive, ConstantSpeed):
            speed, zero = self.drive.speed, self.drive.start - self.drive.speed * lead
            self.position = lambda clock: zero + speed * clock
            self.rate = lambda _clock: speed
        else:
            # A law takes 20 us to evaluate, half as long as Exudyn's whole step, but not much longer for all at once.
            position, rate, _ = self.drive.at(np.arange(steps + 1) * step - lead)
            self.position = self._tabulated(position, step, lambda time: float(self.drive.at(time).position))
            self.rate = self._tabulated(rate, step, lambda time: float(self.drive.at(time).rate))

    def _tabulated(self, table: NDArray[np.float64], step: float, at: Function) -> Function:
        lead, values = self.lead, [float(value) for value in table]

        def value(clock: float) -> float:
            number = round(clock / step)
            if 0 <= number < len(values) and abs(clock - number * step) <= SAME_INSTANT * step:
                return values[number]
            return at(clock - lead)

        return value
