"""Loads, springs and gravity of a scene on its Exudyn system, and when its press loads act.

A press load jumps. In two runs that are extrapolated it must jump at the same instants, so these are found beforehand,
from poses. A table's value depends on where its slider or the drive is in the step at hand.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from math import ceil, tau
from typing import Any, TypeAlias

import numpy as np

from scenes.elements.tables import Over, Table
from scenes.scene import (
    GROUND,
    Force,
    ForceTable,
    GuideForce,
    Load,
    Moment,
    PressForce,
    TableForce,
    TorsionSpring,
)

from .poses import Configuration, PoseSolver
from .system import TURN, Array, ExudynSystem, exudyn, items

ForceFunction: TypeAlias = Callable[[Any, float, Any], list[float]]  # of the system, its clock, and a force not used
PressSwitches: TypeAlias = Mapping[PressForce, Sequence[float]]  # s within a cycle: on and off in turn

GRID = 180  # instants of a cycle between which a slider reverses once at most
SAME_ANGLE = 1e-9  # of a turn: half a turn is that, whichever way it was rounded
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
        ends = {"markerNumbers": [system.coordinate(body, TURN) for body in (twisted.first, twisted.second)]}
        values = {"stiffness": twisted.stiffness / unit, "damping": (twisted.damping or 0.0) / unit}
        turns = 0 if twisted.drives(scene) else _turns(system, twisted, start)
        system.mbs.AddObject(items.CoordinateSpringDamper(**ends, **values, offset=twisted.angle + turns * tau))
    if scene.gravity is not None:
        for name, body in system.bodies.items():
            weight = [*(body.mass * g for g in scene.gravity), 0]
            system.mbs.AddLoad(items.Force(markerNumber=system.marker(name, 0j), loadVector=weight))
    system.mbs.Assemble()


def _add_load(system: ExudynSystem, load: Load, switches: PressSwitches) -> None:
    """Add a load; one in its body's frame, or along a guide that turns, is fixed to the body that it acts on."""
    turns, at = load.body in system.scene.turning, system.bodies[load.body].points[load.at]

    def force(given: Mapping[str, Any], body: str = load.body, place: complex = at, *, fixed: bool = False) -> None:
        marker = system.marker(body, place, "Rigid" if fixed else "Position")
        system.mbs.AddLoad(items.Force(markerNumber=marker, bodyFixed=fixed, **given))

    match load:
        case Force():
            force(_given(system, (*load.force, 0.0)), fixed=turns and load.frame == "body")
        case ForceTable():
            force({"loadVectorUserFunction": _tabulated(system, load)})
        case PressForce():
            force({"loadVectorUserFunction": _switched(system, load, switches[load])})
        case TableForce():
            given = _given(system, (*load.direction, 0.0), load.table, load.body)
            force(given, fixed=turns and load.frame == "body")
        case Moment():
            given = _given(system, (0.0, 0.0, 1.0 if load.moment is None else load.moment), load.table, load.body)
            system.mbs.AddLoad(items.Torque(markerNumber=system.marker(load.body, 0j, "Rigid"), **given))
        case GuideForce():
            slide, size = system.scene.slides[load.body], 1.0 if load.force is None else load.force
            x, y = (size * part for part in slide.along)
            force(_given(system, (x, y, 0.0), load.table, load.body), fixed=turns)
            if slide.on != GROUND:  # on the carrier the line on which both act stays where it is
                place = system.through(load.body) + at - system.lever(load.body)
                force(_given(system, (-x, -y, 0.0), load.table, load.body), slide.on, place, fixed=turns)


def _given(
    system: ExudynSystem, vector: tuple[float, float, float], table: Table | None = None, body: str = ""
) -> dict[str, Any]:
    """A vector in N or N m, or times the value of a table of a load on a body, as an argument of Exudyn's loads."""
    parts = [part / system.force_unit for part in vector]
    if table is None:
        return {"loadVector": parts}
    argument = _argument(system, table.over, body)

    def scaled(mbs: Any, clock: float, _unused: Any) -> list[float]:
        value = float(table.at(argument(mbs, clock)))
        return [value * part for part in parts]

    return {"loadVectorUserFunction": scaled}


def _argument(system: ExudynSystem, over: Over, body: str) -> Callable[[Any, float], float]:
    """What a table of a load on a body is over, as a function of the system, as it is then, and its clock."""
    scene, drive, coordinates = system.scene, system.driven_by, exudyn.OutputVariableType.Coordinates
    if over == "time":
        return lambda _mbs, clock: drive.zero + clock
    if over == "displacement" or scene.driven_slide is not None:
        gauge = system.gauge(body if over == "displacement" else scene.drive.body)
        return lambda mbs, _clock: float(mbs.GetMarkerOutput(gauge, coordinates)[0])
    base, crank = (system.coordinate(name, TURN) for name in (scene.drive_on, scene.drive.body))
    return lambda mbs, _clock: float(
        mbs.GetMarkerOutput(crank, coordinates)[0] - mbs.GetMarkerOutput(base, coordinates)[0]
    )


def _turns(system: ExudynSystem, twisted: TorsionSpring, start: Configuration) -> int:
    """The whole turns by which the coordinates' angle exceeds the one that lies within half a turn of zero."""
    first, second = (
        0.0 if name == GROUND else system.pose_of(name, start.q)[1] for name in (twisted.first, twisted.second)
    )
    return ceil((second - first) / tau - 0.5 - SAME_ANGLE)


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
