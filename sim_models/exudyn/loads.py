"""Loads, springs and gravity of a scene on its Exudyn system, and when its press loads act.

A press load jumps. In two runs that are extrapolated it must jump at the same instants, so these are found beforehand,
from poses. A table's force depends on where its slider is in the step at hand.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from scenes.scene import Force, ForceTable, PressForce

from .poses import Configuration, PoseSolver
from .system import Array, ExudynSystem, exudyn, items

ForceFunction: TypeAlias = Callable[[Any, float, Any], list[float]]  # of the system, its clock, and a force not used
PressSwitches: TypeAlias = Mapping[PressForce, Sequence[float]]  # s within a cycle: on and off in turn

GRID = 180  # instants of a cycle between which a slider reverses once at most
ACCURACY = 1e-13  # of a cycle, far within the next
SAME_INSTANT = 1e-10  # of a cycle; so close before a switch counts as after it, whichever way the clock was rounded


def add_loads(system: ExudynSystem, switches: PressSwitches) -> None:
    """Add all forces on the bodies to an assembled system, and assemble it again."""
    scene, unit = system.scene, system.force_unit

    def add(marker: Any, **force: Any) -> None:
        system.mbs.AddLoad(items.Force(markerNumber=marker, **force))

    for load in scene.loads:
        at = system.at(load.body, load.at)
        if isinstance(load, Force):
            add(at, loadVector=[*(f / unit for f in load.force), 0])
        elif isinstance(load, ForceTable):
            add(at, loadVectorUserFunction=_tabulated(system, load))
        elif isinstance(load, PressForce):
            add(at, loadVectorUserFunction=_switched(system, load, switches[load]))
    for spring in scene.springs:
        ends, stiffness = [system.at(*spring.first), system.at(*spring.second)], spring.stiffness / unit
        system.mbs.AddObject(items.SpringDamper(markerNumbers=ends, stiffness=stiffness, referenceLength=spring.length))
    if scene.gravity is not None:
        for name, body in system.bodies.items():
            add(system.marker(name, 0j), loadVector=[*(body.mass * g for g in scene.gravity), 0])
    system.mbs.Assemble()


def _tabulated(system: ExudynSystem, table: ForceTable) -> ForceFunction:
    along, zero, node = system.along(table.body), system.displaced(table.body, 0j), system.nodes[table.body]
    factors, unit = system.displacement_factors(table.body), system.force_unit
    coordinates = exudyn.OutputVariableType.Coordinates

    def force(mbs: Any, _clock: float, _unused: Any) -> list[float]:
        f = 1 / unit * float(table.along(zero + float(np.dot(factors, mbs.GetNodeOutput(node, coordinates)))))
        return [f * along.real, f * along.imag, 0]

    return force


def _switched(system: ExudynSystem, load: PressForce, switches: Sequence[float]) -> ForceFunction:
    """The force that is off until the first of the instants of a cycle, on until the second, and so on."""
    drive, cycle, repeats = system.driven_by, system.scene.drive.cycle, system.scene.drive.repeats
    on, off = [*(f / system.force_unit for f in load.force), 0.0], [0.0, 0.0, 0.0]

    def force(_mbs: Any, clock: float, _unused: Any) -> list[float]:
        time = drive.zero + clock + SAME_INSTANT * cycle
        return on if bisect_right(switches, time % cycle if repeats else time) % 2 else off

    return force


def press_switches(poses: PoseSolver, start: Configuration) -> PressSwitches:
    """The instants of a cycle at which each press load starts and stops acting; Failure where no stroke is followed."""
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
        (com, _), (tangent, _) = (system.pose_of(body, q) for q in (state.q, state.tangent))
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
