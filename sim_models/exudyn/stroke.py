"""The instants at which the press loads switch on and off.

A press load jumps. In two runs that are extrapolated it must jump at the same instants, so these are found beforehand,
from poses.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from scenes.scene import PressForce

from .poses import Poses, State

Switches: TypeAlias = Mapping[PressForce, Sequence[float]]  # s within a cycle: on and off in turn

GRID = 180  # instants of a cycle between which a slider reverses once at most
BISECTIONS = 36  # of the time between two of them: to 1e-13 of a cycle, far within loads.SAME_INSTANT


def press_switches(poses: Poses, start: State) -> Switches:
    """Return the instants of a cycle at which each press load starts and stops acting.

    Raises:
        Failure: the stroke in which a press load acts cannot be followed.
    """
    presses = [load for load in poses.system.scene.loads if isinstance(load, PressForce)]
    return {load: PressStroke(poses, start, load).switches() for load in presses}


class PressStroke:
    """A slider's motion through a cycle, and when its press load acts on it."""

    def __init__(self, poses: Poses, start: State, load: PressForce) -> None:
        self.system, self.poses, self.load = poses.system, poses, load
        grid = np.linspace(0, self.system.scene.drive.cycle, GRID + 1)
        self._states = poses.through(start, self.system.scene.drive.at(grid).position)
        times: list[float] = grid.tolist()
        self._known = {time: self._of(self._states.rows(number), time) for number, time in enumerate(times)}
        self._times = sorted({*times, *self._reversals(times)})
        self._end = max(self._slider(time)[0] * load.closing for time in self._times) * load.closing

    def switches(self) -> list[float]:
        """Return the instants of a cycle, s, at which the load starts and stops acting, in turn."""
        switches = [after for _, after in _changes(self._acts, self._times)]
        return [0.0, *switches] if self._acts(0.0) else switches

    def _reversals(self, times: Sequence[float]) -> Iterator[float]:
        """Yield the instants just before and after each dead point."""
        for change in _changes(lambda time: self._slider(time)[1] * self.load.closing > 0, times):
            yield from change

    def _acts(self, time: float) -> bool:
        return bool(self.load.acts(*self._slider(time), self._end))

    def _slider(self, time: float) -> tuple[float, float]:
        """Return displacement, m, and velocity, m/s, of the slider at an instant of the scene's clock."""
        if time not in self._known:
            drive = self.system.scene.drive
            near = self._states.rows(round(time / drive.cycle * GRID))
            self._known[time] = self._of(self.poses.follow(near, float(drive.at(time).position)), time)
        return self._known[time]

    def _of(self, state: State, time: float) -> tuple[float, float]:
        place, tangent = (self.system.com(self.load.body, q) for q in (state.q, state.tangent))
        along = self.system.along(self.load.body)
        return (
            self.system.displaced(self.load.body, place),
            (along.conjugate() * tangent).real * float(self.system.scene.drive.at(time).rate),
        )


def _changes(holds: Callable[[float], bool], times: Sequence[float]) -> Iterator[tuple[float, float]]:
    """Yield the instants just before and after which a statement changes its truth, found by bisection."""
    held = [holds(time) for time in times]
    for (before, after), (was, becomes) in zip(pairwise(times), pairwise(held), strict=True):
        if was == becomes:
            continue
        for _ in range(BISECTIONS):
            middle = (before + after) / 2
            before, after = (middle, after) if holds(middle) == was else (before, middle)
        yield before, after
