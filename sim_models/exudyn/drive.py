"""Position and rate of the drive by Exudyn's clock, the input of its constraint: held, or running in time."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes.scene import ConstantSpeed, Drive

Function: TypeAlias = Callable[[float], float]  # of Exudyn's clock, s

SAME_INSTANT = 1e-9  # of a step; what rounding leaves between two ways of counting the clock


class HeldDrive:
    """The drive held at a position, rad or m, with a rate of one: velocities are then derivatives by the position."""

    pre_roll = 0.0  # s

    def __init__(self, held: float) -> None:
        self.held = held

    def position(self, _clock: float) -> float:
        """Return the position, rad or m."""
        return self.held

    def rate(self, _clock: float) -> float:
        """Return one."""
        return 1.0


class RunningDrive:
    """The drive in time, for a number of steps of one size, s, the first `pre_roll` s before the scene's time zero.

    Exudyn's clock cannot be negative: it is `pre_roll` ahead of the scene's.
    """

    def __init__(self, drive: Drive, pre_roll: float, step: float, steps: int) -> None:
        self.pre_roll = pre_roll
        self.position: Function
        self.rate: Function
        if isinstance(drive, ConstantSpeed):
            speed, zero = drive.speed, drive.start - drive.speed * pre_roll
            self.position = lambda clock: zero + speed * clock
            self.rate = lambda _clock: speed
        else:
            # A law takes 20 us to evaluate, half as long as Exudyn's whole step, but not much longer for all at once.
            position, rate, _ = drive.at(np.arange(steps + 1) * step - pre_roll)
            self.position = _tabulated(position, step, lambda clock: float(drive.at(clock - pre_roll).position))
            self.rate = _tabulated(rate, step, lambda clock: float(drive.at(clock - pre_roll).rate))


ExudynDrive: TypeAlias = HeldDrive | RunningDrive


def _tabulated(table: NDArray[np.float64], step: float, between: Function) -> Function:
    """Return the function with these values at the steps."""
    values = table.tolist()

    def value(clock: float) -> float:
        number = round(clock / step)
        if 0 <= number < len(values) and abs(clock - number * step) <= SAME_INSTANT * step:
            return float(values[number])
        return between(clock)

    return value
