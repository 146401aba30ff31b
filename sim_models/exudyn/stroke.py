"""The instants at which the press loads switch on and off.

A press load jumps. In two runs that are extrapolated it must jump at the same instants, so these are found beforehand,
from poses.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from scenes.scene import PressForce

from .poses import Configuration, PoseSolver
from .system import Array

PressSwitches: TypeAlias = Mapping[PressForce, Sequence[float]]  # s within a cycle: on and off in turn

GRID = 180  # instants of a cycle between which a slider reverses once at most
ACCURACY = 1e-13  # of a cycle, far within loads.SAME_INSTANT


def press_switches(poses: PoseSolver, start: Configuration) -> PressSwitches:
    """Find the instants of a cycle at which each press load starts and stops acting.

    Raises:
        Failure: the stroke in which a press load acts cannot be followed.
    """
    presses = [load for load in poses.system.scene.loads if isinstance(load, PressForce)]
    switches: dict[PressForce, Sequence[float]] = {}
    for body in dict.fromkeys(load.body for load in presses):
        switches |= _switches(poses, start, body, [load for load in presses if load.body == body])
    return switches


def _switches(poses: PoseSolver, start: Configuration, body: str, loads: Sequence[PressForce]) -> PressSwitches:
    """Find the switches of the press loads on a slider, whose dead points they share."""
    system, drive = poses.system, poses.system.scene.drive
    times = np.linspace(0, drive.cycle, GRID + 1)
    states = poses.through(start, drive.at(times).position, curved=False)

    def slider(state: Configuration, rate: Any) -> tuple[Any, Any]:
        """Return displacement, m, and velocity, m/s."""
        com, tangent = (system.com(body, q) for q in (state.q, state.tangent))
        return system.displaced(body, com), (system.along(body).conjugate() * tangent).real * rate

    def at(time: float) -> tuple[float, float]:
        position, rate, _ = map(float, drive.at(time))
        near = round(time / drive.cycle * GRID)
        return slider(poses.follow(poses.state(states.q[near], states.position[near]), position), rate)

    x, v = slider(states, drive.at(times).rate)
    dead = list(_zeros(lambda time: at(time)[1], times, v))
    x, times = np.append(x, [at(time)[0] for time in dead]), np.append(times, dead)
    order = times.argsort()

    def instants(load: PressForce) -> list[float]:
        end = load.closing * (x * load.closing).max()
        meets = end - load.closing * load.last
        met = list(_zeros(lambda time: at(time)[0] - meets, times[order], x[order] - meets))
        parts = list(pairwise([0.0, *sorted(dead + met), drive.cycle]))
        acts = [bool(load.acts(*at((begin + end_of) / 2), end)) for begin, end_of in parts]
        changes = zip(parts[1:], pairwise(acts), strict=True)
        switches = [begin for (begin, _), (was, becomes) in changes if was != becomes]
        return [0.0, *switches] if acts[0] else switches

    return {load: instants(load) for load in loads}


def _zeros(function: Callable[[float], float], times: Array, values: Array) -> Iterator[float]:
    """Yield the instants at which a function is zero that has these values, of either sign or zero, at some others."""
    from scipy.optimize import brentq  # late: few scenes need it, and it is slow to import

    known = dict(zip(times.tolist(), values.tolist(), strict=True))  # a sign there is round-off's at times
    yield from (time for time, value in known.items() if value == 0)
    for before, after in pairwise(known):
        if known[before] * known[after] < 0:
            yield brentq(lambda t: known[t] if t in known else function(t), before, after, xtol=ACCURACY * times[-1])
