"""Loads, springs and gravity of a scene on its Exudyn system.

A press load switches at instants found beforehand. A table's force depends on where its slider is in the step at hand.
"""

from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from scenes.scene import Force, ForceTable, Load, PressForce, Spring

from .stroke import PressSwitches
from .system import ExudynSystem, exudyn, items

ForceFunction: TypeAlias = Callable[[Any, float, Any], list[float]]  # of the system, its clock, and a force not used

SAME_INSTANT = 1e-10  # of a cycle; so close before a switch counts as after it, whichever way the clock was rounded


def add_loads(system: ExudynSystem, switches: PressSwitches) -> None:
    """Add all forces on the bodies to an assembled system, and assemble it again."""
    scene = system.scene
    for load in scene.loads:
        system.mbs.AddLoad(items.Force(markerNumber=system.at(load.body, load.at), **_vector(system, load, switches)))
    for spring in scene.springs:
        _add_spring(system, spring)
    if scene.gravity is not None:
        for name, body in system.bodies.items():
            weight = [body.mass * g for g in scene.gravity]
            system.mbs.AddLoad(items.Force(markerNumber=system.mass_marker(name), loadVector=[*weight, 0]))
    system.mbs.Assemble()


def _add_spring(system: ExudynSystem, spring: Spring) -> None:
    ends = [system.at(*spring.first), system.at(*spring.second)]
    stiffness = spring.stiffness / system.force_unit
    system.mbs.AddObject(items.SpringDamper(markerNumbers=ends, stiffness=stiffness, referenceLength=spring.length))


def _vector(system: ExudynSystem, load: Load, switches: PressSwitches) -> dict[str, Any]:
    """The argument for the force of a load, constant or a function."""
    if isinstance(load, Force):
        return {"loadVector": [*(f / system.force_unit for f in load.force), 0]}
    if isinstance(load, ForceTable):
        return {"loadVectorUserFunction": _tabulated(system, load)}
    return {"loadVectorUserFunction": _switched(system, load, switches[load])}


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
