"""Loads, springs and gravity of a scene on its Exudyn system, and when its press loads act.

A press load jumps. In two runs that are extrapolated it must jump at the same instants, so these are found beforehand,
from poses. A table's value depends on where its slider or the drive is in the step at hand.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from math import ceil, pi, tau
from typing import Any, TypeAlias

import numpy as np

from scenes.elements.loads import TabledLoad
from scenes.scene import GROUND, Force, GuideForce, Load, Moment, PressForce, TableForce

from .poses import Configuration, PoseSolver
from .system import TURN, Array, ExudynSystem, exudyn, items

LoadValue: TypeAlias = Callable[[Any, float], float]  # of the system, as it is then, and its clock
PressSwitches: TypeAlias = Mapping[PressForce, Sequence[float]]  # s within a cycle: on and off in turn

GRID = 180  # instants of a cycle between which a slider reverses once at most
HALF_TURN = pi + 1e-9  # rad: half a turn is that, whichever way it was rounded
ACCURACY = 1e-13  # of a cycle, far within the next
SAME_INSTANT = 1e-10  # of a cycle; so close before a switch counts as after it, whichever way the clock was rounded


def add_loads(system: ExudynSystem, switches: PressSwitches, start: Configuration) -> None:
    """Add all that acts on the bodies to an assembled system, given the state at time zero, and assemble it again."""
    scene, unit = system.scene, system.force_unit
    for load in scene.loads:
        _add_load(system, load, switches)
    for spring in scene.springs:
        ends = {"markerNumbers": [system.at(*spring.first), system.at(*spring.second)]}
        values = {"stiffness": spring.stiffness / unit, "damping": (spring.damping or 0.0) / unit}
        system.mbs.AddObject(items.SpringDamper(**ends, **values, referenceLength=spring.length))
    for twisted in scene.torsion_springs:
        bodies = twisted.first, twisted.second
        ends = {"markerNumbers": [system.coordinate(body, TURN) for body in bodies]}
        values = {"stiffness": twisted.stiffness / unit, "damping": (twisted.damping or 0.0) / unit}
        first, second = (system.pose_of(body, start.q)[1] for body in bodies)
        turns = 0 if twisted.drives(scene) else ceil((second - first - HALF_TURN) / tau)  # else within half a turn
        system.mbs.AddObject(items.CoordinateSpringDamper(**ends, **values, offset=twisted.angle + turns * tau))
    if scene.gravity is not None:
        for name, body in system.bodies.items():
            weight = [*(body.mass * g for g in scene.gravity), 0]
            system.mbs.AddLoad(items.Force(markerNumber=system.marker(name, 0j), loadVector=weight))
    system.mbs.Assemble()


def _add_load(system: ExudynSystem, load: Load, switches: PressSwitches) -> None:
    """Add a load; one in its body's frame, or along a guide that turns, is fixed to the body that it acts on."""
    turns, at = load.body in system.scene.turning, system.bodies[load.body].points[load.at]
    value = None if isinstance(load, Force) else _value(system, load, switches)

    def given(*vector: float) -> dict[str, Any]:
        parts = [part / system.force_unit for part in vector]
        return {"loadVector": parts} if value is None else {"loadVectorUserFunction": _scaled(parts, value)}

    def add(x: float, y: float, body: str = load.body, place: complex = at, *, fixed: bool = False) -> None:
        marker = system.marker(body, place, "Rigid" if fixed else "Position")
        system.mbs.AddLoad(items.Force(markerNumber=marker, bodyFixed=fixed, **given(x, y, 0.0)))

    match load:
        case PressForce():
            add(*load.force)
        case Force():
            add(*load.force, fixed=turns and load.frame == "body")
        case TableForce():
            add(*load.direction, fixed=turns and load.frame == "body")
        case Moment():
            marker = system.marker(load.body, 0j, "Rigid")
            moment = given(0.0, 0.0, 1.0 if load.moment is None else load.moment)
            system.mbs.AddLoad(items.Torque(markerNumber=marker, **moment))
        case GuideForce():
            slide, size = system.scene.slides[load.body], 1.0 if load.force is None else load.force
            x, y = (size * part for part in slide.along)
            add(x, y, fixed=turns)
            if slide.on != GROUND:  # on the carrier the line on which both act stays where it is
                add(-x, -y, slide.on, system.through(load.body) + at - system.lever(load.body), fixed=turns)


def _scaled(parts: Sequence[float], value: LoadValue) -> Callable[[Any, float, Any], list[float]]:
    def vector(mbs: Any, clock: float, _unused: Any) -> list[float]:
        size = value(mbs, clock)
        return [size * part for part in parts]

    return vector


def _value(system: ExudynSystem, load: PressForce | TabledLoad, switches: PressSwitches) -> LoadValue | None:
    """What a load's vector is to be multiplied by; None for a constant one."""
    scene, drive, coordinates = system.scene, system.driven_by, exudyn.OutputVariableType.Coordinates
    if isinstance(load, PressForce):  # off until the first of the instants of a cycle, on until the second, and so on
        instants, cycle, repeats = switches[load], scene.cycle, scene.periodic

        def acts(_mbs: Any, clock: float) -> float:
            time = drive.zero + clock + SAME_INSTANT * cycle
            return float(bisect_right(instants, time % cycle if repeats else time) % 2)

        return acts
    table = load.table
    if table is None:
        return None
    if table.over == "time":
        return lambda _, clock: float(table.at(drive.zero + clock))
    if table.over == "displacement" or scene.drive.slide is not None:
        markers = [(system.gauge(load.body if table.over == "displacement" else scene.drive.body), 1)]
    else:
        turned = (scene.drive.body, 1), (scene.drive.on, -1)
        markers = [(system.coordinate(body, TURN), sign) for body, sign in turned]
    return lambda mbs, _: float(table.at(sum(sign * mbs.GetMarkerOutput(at, coordinates)[0] for at, sign in markers)))


def press_switches(poses: PoseSolver, start: Configuration) -> PressSwitches:
    """The instants of a cycle at which each press load starts and stops acting; Failure where no stroke is followed."""
    return {load: _switches(poses, start, load) for load in poses.system.scene.presses.values()}


def _switches(poses: PoseSolver, start: Configuration, load: PressForce) -> Sequence[float]:
    """The instants of a cycle, s, at which a press load starts and stops acting in turn."""
    system, law = poses.system, poses.system.scene.drive.law
    times = np.linspace(0, law.cycle, GRID + 1)
    states = poses.through(start, law.at(times).position, curved=False)

    def slider(state: Configuration, rate: Any) -> tuple[Any, Any]:
        """Return displacement, m, and velocity, m/s."""
        tangent, _ = system.pose_of(load.body, state.tangent)
        return system.displacement(load.body, state.q), (system.along(load.body).conjugate() * tangent).real * rate

    def at(time: float) -> tuple[float, float]:
        position, rate, _ = map(float, law.at(time))
        near = round(time / law.cycle * GRID)
        return slider(poses.follow(poses.state(states.q[near], states.position[near]), position), rate)

    x, v = slider(states, law.at(times).rate)
    dead = list(_zeros(lambda time: at(time)[1], times, v))
    x, times = np.append(x, [at(time)[0] for time in dead]), np.append(times, dead)
    order = times.argsort()
    end = load.closing * (x * load.closing).max()
    meets = end - load.closing * load.last
    met = list(_zeros(lambda time: at(time)[0] - meets, times[order], x[order] - meets))
    parts = list(pairwise([0.0, *sorted(dead + met), law.cycle]))
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
            yield brentq(lambda t: known[t] if t in known else function(t), before, after, xtol=ACCURACY * times[-1])
