"""Loads, springs and gravity of a scene on its Exudyn system.

A press load jumps. In two runs that are extrapolated it must jump at the same instants, so the instants at which it
switches are found beforehand, from poses. A table's force is read off where its slider is in the step at hand.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from scenes.scene import Force, ForceTable, Load, PressForce

from .poses import Poses, State
from .system import System, engine

ForceFunction: TypeAlias = Callable[[Any, float, Any], list[float]]  # of the system, its clock, and a force not used

GRID = 180  # instants of a cycle between which a slider reverses once at most
BISECTIONS = 36  # of the time between two of them: to 1e-13 of a cycle, far within SAME_INSTANT
SAME_INSTANT = 1e-10  # of a cycle; so close before a switch counts as after it, whichever way the clock was rounded


def add_loads(system: System, poses: Poses, start: State) -> None:
    """Add all that acts on the bodies to an assembled system, and assemble it again.

    Raises:
        Failure: the stroke in which a press load acts cannot be followed.
    """
    scene, items = system.scene, engine().itemInterface
    vectors = [_vector(system, poses, start, load) for load in scene.loads]  # no poses while items are being added
    for load, vector in zip(scene.loads, vectors, strict=True):
        system.mbs.AddLoad(items.Force(markerNumber=system.at(load.body, load.at), **vector))
    for spring in scene.springs:
        ends = [system.at(*spring.first), system.at(*spring.second)]
        stiffness = spring.stiffness / system.force_unit
        system.mbs.AddObject(items.SpringDamper(markerNumbers=ends, stiffness=stiffness, referenceLength=spring.length))
    if scene.gravity is not None:
        for name, body in system.bodies.items():
            weight = [body.mass * g for g in scene.gravity]
            system.mbs.AddLoad(items.Force(markerNumber=system.mass_marker(name), loadVector=[*weight, 0]))
    system.mbs.Assemble()


def _vector(system: System, poses: Poses, start: State, load: Load) -> dict[str, Any]:
    """Return the argument that says the force of a load, constant or a function."""
    if isinstance(load, Force):
        return {"loadVector": [*(f / system.force_unit for f in load.force), 0]}
    if isinstance(load, ForceTable):
        return {"loadVectorUserFunction": _tabulated(system, load)}
    return {"loadVectorUserFunction": _switched(system, load, PressStroke(system, poses, start, load).switches())}


def _tabulated(system: System, table: ForceTable) -> ForceFunction:
    along, zero, node = system.along(table.body), system.displaced(table.body, 0j), system.nodes[table.body]
    way, unit = system.way(table.body), system.force_unit
    coordinates = engine().OutputVariableType.Coordinates

    def force(mbs: Any, _clock: float, _unused: Any) -> list[float]:
        f = 1 / unit * float(table.along(zero + float(np.dot(way, mbs.GetNodeOutput(node, coordinates)))))
        return [f * along.real, f * along.imag, 0]

    return force


def _switched(system: System, load: PressForce, switches: Sequence[float]) -> ForceFunction:
    """Return the force that is off until the first of the instants of a cycle, on until the second, and so on."""
    course, cycle, repeats = system.course, system.scene.drive.cycle, system.scene.drive.repeats
    on, off = [*(f / system.force_unit for f in load.force), 0.0], [0.0, 0.0, 0.0]

    def force(_mbs: Any, clock: float, _unused: Any) -> list[float]:
        time = clock - course.lead + SAME_INSTANT * cycle
        return on if bisect_right(switches, time % cycle if repeats else time) % 2 else off

    return force


class PressStroke:
    """A slider's way through a cycle, and when its press load acts on it."""

    def __init__(self, system: System, poses: Poses, start: State, load: PressForce) -> None:
        self.system, self.poses, self.load = system, poses, load
        grid = np.linspace(0, system.scene.drive.cycle, GRID + 1)
        self._states = poses.through(start, system.scene.drive.at(grid).position)
        times: list[float] = grid.tolist()
        self._known = {time: self._of(self._states.rows(number), time) for number, time in enumerate(times)}
        self._times = sorted({*times, *self._reversals(times)})
        self._end = max(self._slider(time)[0] * load.closing for time in self._times) * load.closing

    def switches(self) -> list[float]:
        """Return the instants of a cycle, s, at which the load starts and stops acting, in turn."""
        changes = list(self._changes(self._acts, self._times))
        switches = [after for _, after in changes]
        return [0.0, *switches] if self._acts(0.0) else switches

    def _reversals(self, times: Sequence[float]) -> Iterator[float]:
        for change in self._changes(lambda time: self._slider(time)[1] * self.load.closing > 0, times):
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

    @staticmethod
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
