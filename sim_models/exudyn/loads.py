"""Loads, springs and gravity of a scene on its Exudyn system, and when its press loads act.

A press load jumps. In two runs that are extrapolated it must jump at the same instants, so these are found beforehand,
from poses.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from scenes.model.inputs import inputs_of
from scenes.scene import PressForce

from .elements import RULES, PressSwitches, Target
from .poses import Configuration, PoseSolver
from .system import Array, ExudynSystem, items

GRID = 180  # instants of a cycle between which a slider reverses once at most
SWITCH_TOL = 1e-13  # of a cycle, far within the next


def add_loads(system: ExudynSystem, switches: PressSwitches, start: Configuration) -> None:
    """Add all that acts on the bodies to an assembled system, given the state at time zero, and assemble it again."""
    scene, to = system.scene, Target(system, switches, start)
    for place, element in scene.elements:
        RULES[type(element)](element, place, to)
    if scene.gravity is not None:
        for name, body in system.bodies.items():
            weight = [*(body.mass * g for g in scene.gravity), 0]
            system.mbs.AddLoad(items.Force(markerNumber=system.marker(name, 0j), loadVector=weight))
    system.mbs.Assemble()


def press_switches(poses: PoseSolver, start: Configuration) -> PressSwitches:
    """The instants of a cycle at which each press load starts and stops acting; Failure where no stroke is followed."""
    return {place: _switches(poses, start, load) for place, load in poses.system.scene.presses.items()}


def _switches(poses: PoseSolver, start: Configuration, load: PressForce) -> Sequence[float]:
    """The instants of a cycle, s, at which a press load starts and stops acting in turn."""
    system, scene = poses.system, poses.system.scene
    times = np.linspace(0, scene.cycle, GRID + 1)
    states = poses.through(start, inputs_of(scene, times).driven().position, curved=False)

    def slider(state: Configuration, rate: Any) -> tuple[Any, Any]:
        """Return displacement, m, and velocity, m/s."""
        tangent, _ = system.pose_of(load.body, state.tangent)
        return system.displacement(load.body, state.q), (system.along(load.body).conjugate() * tangent).real * rate

    def at(time: float) -> tuple[float, float]:
        position, rate, _ = map(float, inputs_of(scene, time).driven())
        near = round(time / scene.cycle * GRID)
        return slider(poses.follow(poses.state(states.q[near], states.position[near]), position), rate)

    # The stroke's parts: a press force may come or go at dead points (v = 0), and where the slider comes within the
    # last part of its stroke (x = meets). Between two of these instants it acts all along or not at all, so that the
    # middle decides.
    x, v = slider(states, inputs_of(scene, times).driven().rate)
    dead = list(_zeros(lambda time: at(time)[1], times, v))
    x, times = np.append(x, [at(time)[0] for time in dead]), np.append(times, dead)
    order = times.argsort()
    end = load.closing * (x * load.closing).max()
    meets = end - load.closing * load.last
    met = list(_zeros(lambda time: at(time)[0] - meets, times[order], x[order] - meets))
    parts = list(pairwise([0.0, *sorted(dead + met), scene.cycle]))
    acts = [bool(load.acts(*at((begin + end_of) / 2), end)) for begin, end_of in parts]
    changes = zip(parts[1:], pairwise(acts), strict=True)
    switches = [begin for (begin, _), (was, becomes) in changes if was != becomes]
    return [0.0, *switches] if acts[0] else switches


def _zeros(function: Callable[[float], float], times: Array, values: Array) -> Iterator[float]:
    """Yield the instants at which a function is zero that has these values, of either sign or zero, at some others."""
    from scipy.optimize import brentq  # late: few scenes need it, and it is slow to import

    known = dict(zip(times.tolist(), values.tolist(), strict=True))  # a sign there is round-off's at times
    yield from (time for time, value in known.items() if value == 0)
    for before, after in pairwise(known):
        if known[before] * known[after] < 0:
            yield brentq(lambda t: known[t] if t in known else function(t), before, after, xtol=SWITCH_TOL * times[-1])
