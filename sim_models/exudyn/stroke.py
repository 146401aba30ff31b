"""The instants at which the press loads switch on and off.

A press load jumps. In two runs that are extrapolated it must jump at the same instants, so these are found beforehand,
from poses.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import chain, pairwise
from typing import TypeAlias

import numpy as np

from scenes.scene import PressForce

from .poses import Configuration, PoseSolver

Switches: TypeAlias = Mapping[PressForce, Sequence[float]]  # s within a cycle: on and off in turn

GRID = 180  # instants of a cycle between which a slider reverses once at most
BISECTIONS = 36  # of the time between two of them: to 1e-13 of a cycle, far within loads.SAME_INSTANT


def press_switches(poses: PoseSolver, start: Configuration) -> Switches:
    """Return the instants of a cycle at which each press load starts and stops acting.

    Raises:
        Failure: the stroke in which a press load acts cannot be followed.
    """
    presses = [load for load in poses.system.scene.loads if isinstance(load, PressForce)]
    return {load: _switches(poses, start, load) for load in presses}


def _switches(poses: PoseSolver, start: Configuration, load: PressForce) -> list[float]:
    system, drive = poses.system, poses.system.scene.drive
    grid = np.linspace(0, drive.cycle, GRID + 1)
    states = poses.through(start, drive.at(grid).position)

    @cache
    def slider(time: float) -> tuple[float, float]:
        """Return the slider's displacement, m, and velocity, m/s."""
        position, rate, _ = map(float, drive.at(time))
        state = poses.follow(states.rows(round(time / drive.cycle * GRID)), position)
        com, tangent = (system.com(load.body, q) for q in (state.q, state.tangent))
        return system.displaced(load.body, com), (system.along(load.body).conjugate() * tangent).real * rate

    def closes(time: float) -> bool:
        return slider(time)[1] * load.closing > 0

    def acts(time: float) -> bool:
        return bool(load.acts(*slider(time), end))

    times: list[float] = grid.tolist()
    times = sorted({*times, *chain.from_iterable(_changes(closes, times))})  # with the dead points
    end = max(slider(time)[0] * load.closing for time in times) * load.closing
    switches = [after for _, after in _changes(acts, times)]
    return [0.0, *switches] if acts(0.0) else switches


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
