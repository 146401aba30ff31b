"""The forces of loads and springs on the bodies, in one pose at a step of the engine or in many at the read-out.

A press force acts within its slider's closing stroke, whose end is found beforehand.

A pose is the places z of the bodies' origins and the turns exp(i theta) of their frames, by number of the body: complex
numbers, or arrays of them of shape (n,). Single numbers are plain Python's, which are much faster than numpy's.
"""

from cmath import exp
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
import pymunk
from numpy.typing import NDArray

from scenes import Scene
from scenes.scene import GROUND, Force, ForceTable, PlainLoad, PressForce

from .constraints import LinkageConstraints, PlaneVector, PoseArray, planes
from .masses import fictitious_masses
from .space import Bodies, pair
from .start import SCENES, DrivePlace, begun, move, rates, way

HALVINGS = 25  # of a continuation step with a dead point in it; leaves round-off of the displacement there

Active: TypeAlias = NDArray[np.bool_]  # (n, press forces), whether each acts
Planes: TypeAlias = Any  # one number or array for each body and the ground
# A body or the ground, the arm from its origin, m, the force, N.
BodyForce: TypeAlias = tuple[str, PlaneVector, PlaneVector]


def forces(
    linkage: LinkageConstraints, z: Planes, turn: Planes, active: Iterable[NDArray[np.bool_]]
) -> Iterator[BodyForce]:
    """Yield every force; of press forces, `active` has whether they act."""
    presses, index = iter(active), linkage.index
    for load in linkage.scene.loads:
        assert isinstance(load, PlainLoad)
        i = index[load.body]
        r = linkage.arm(load.body, load.at) * turn[i]
        if isinstance(load, ForceTable):
            force = load.along(linkage.displacement(load.body, z[i], turn[i]))
            yield load.body, r, force * complex(*linkage.slides[load.body].along)
        elif isinstance(load, PressForce):
            yield load.body, r, next(presses) * complex(*load.force)
        else:
            yield load.body, r, complex(*load.force)
    for spring in linkage.scene.springs:
        (first, p), (second, q) = spring.first, spring.second
        r, s = linkage.arm(first, p) * turn[index[first]], linkage.arm(second, q) * turn[index[second]]
        d = z[index[second]] + s - z[index[first]] - r
        # At zero length there is no direction: the result is not finite, unless the free length is zero.
        relaxed = spring.length * d / np.abs(d) if spring.length else 0
        pull = spring.stiffness * (d - relaxed)
        yield first, r, pull
        yield second, s, -pull


def active_presses(
    linkage: LinkageConstraints, z: Planes, turn: Planes, velocity: Planes, ends: Sequence[float]
) -> list[NDArray[np.bool_]]:
    """Tell of each press force whether it acts; `ends` are those of their closing strokes, m."""
    active = []
    presses = (load for load in linkage.scene.loads if isinstance(load, PressForce))
    for load, end in zip(presses, ends, strict=True):
        i, along = linkage.index[load.body], complex(*linkage.slides[load.body].along)
        rate = (along.conjugate() * velocity[i]).real  # it does not turn
        active.append(load.acts(linkage.displacement(load.body, z[i], turn[i]), rate, end))
    return active


class AppliedForces:
    """All of them on the bodies that forces move, set before every step for the pose after it: pymunk clears them.

    `active` are the press forces that acted in the last step. Plain Python: for a few bodies it is several times faster
    than numpy.
    """

    def __init__(self, linkage: LinkageConstraints, bodies: Bodies, stroke_ends: Sequence[float], dt: float) -> None:
        scene = linkage.scene
        self._linkage, self._stroke_ends, self._dt = linkage, stroke_ends, dt
        moved = {name: body for name, body in bodies.items() if not linkage.moved[name].prescribed}
        loaded = {load.body for load in scene.loads}
        sprung = {name for spring in scene.springs for name, _ in (spring.first, spring.second)}
        varying = sprung | {load.body for load in scene.loads if not isinstance(load, Force)}
        self._varying = {name: body for name, body in moved.items() if name in varying}
        constant = {name: body for name, body in moved.items() if name in loaded - varying}
        self._constant = [(body, *_constant(linkage, name, body)) for name, body in constant.items()]
        involved = loaded | sprung if varying else set()
        self._involved = [(linkage.index[name], body) for name, body in bodies.items() if name in involved]
        self._before = {i: complex(*body.velocity) for i, body in self._involved}
        self.active: list[NDArray[np.bool_]] = []

    def apply(self) -> None:
        """Set the forces of the next instant."""
        dt = self._dt
        for body, force, moment in self._constant:
            body.force = force
            if moment:
                body.torque = (moment * exp(-1j * (body.angle + dt * body.angular_velocity))).imag
        if self._involved:
            self._apply_varying()

    def _apply_varying(self) -> None:
        """Set those of bodies under forces that are not all constant, by rates extrapolated over half a step."""
        dt, ground = self._dt, self._linkage.index[GROUND]
        z, turn, rate = {ground: 0j}, {ground: 1 + 0j}, {}
        for i, body in self._involved:
            velocity = complex(*body.velocity)
            z[i] = complex(*body.position) + dt * velocity
            turn[i] = exp(1j * (body.angle + dt * body.angular_velocity))
            rate[i] = 1.5 * velocity - 0.5 * self._before[i]
            self._before[i] = velocity
        self.active = active_presses(self._linkage, z, turn, rate, self._stroke_ends)
        total = dict.fromkeys(self._varying, (0j, 0.0))
        for name, r, force in forces(self._linkage, z, turn, self.active):
            if name in total:
                sum_, moment = total[name]
                total[name] = sum_ + force, moment + (r.conjugate() * force).imag
        for name, (force, moment) in total.items():
            self._varying[name].force, self._varying[name].torque = pair(force), moment


def _constant(linkage: LinkageConstraints, name: str, body: pymunk.Body) -> tuple[tuple[float, float], complex]:
    """Sum up a body's constant forces f, and their conj(arm) f, which is zero for a body that cannot turn."""
    loads = [load for load in linkage.scene.loads if isinstance(load, Force) and load.body == name]
    force = sum((complex(*load.force) for load in loads), 0j)
    moment = sum((linkage.arm(name, load.at).conjugate() * complex(*load.force) for load in loads), 0j)
    return pair(force), 0j if body.moment == np.inf else moment


@lru_cache(SCENES)
def stroke_ends(scene: Scene) -> Sequence[float]:
    """Where the closing strokes of the press forces end, m; once a scene, since its whole way is searched."""
    drive = scene.drive
    presses = [load for load in scene.loads if isinstance(load, PressForce)]
    if not presses:
        return []
    linkage, q = begun(scene, fictitious_masses)  # whatever the masses, the way is the same
    paths = [[(drive.start, q), *way(linkage, q, drive.start, end)] for end in drive.extent]
    strokes = {(load.body, load.closing): load for load in presses}
    ends = {s: load.closing * max(_furthest(linkage, load, path) for path in paths) for s, load in strokes.items()}
    return [ends[load.body, load.closing] for load in presses]


def _furthest(linkage: LinkageConstraints, load: PressForce, path: Sequence[DrivePlace]) -> float:
    """The slider's largest displacement in its closing direction, m; between places it has a dead point."""
    i, along = linkage.index[load.body], linkage.slides[load.body].along

    def closing(q: PoseArray) -> float:
        z, turn = planes(q[0, i])
        return load.closing * float(linkage.displacement(load.body, z, turn))

    def opens(q: PoseArray, forward: float) -> bool:
        return load.closing * float(rates(linkage, q, forward)[0, i, :2] @ along) < 0

    furthest = max(range(len(path)), key=lambda number: closing(path[number][1]))
    largest = closing(path[furthest][1])
    for (here, q), (there, after) in pairwise(path[max(furthest - 1, 0) : furthest + 2]):
        half = (there - here) / 2
        if opens(after, half) and not opens(q, half):
            for _ in range(HALVINGS):
                middle = move(linkage, q, here, here + half)
                if not opens(middle, half):
                    here, q = here + half, middle
                half /= 2
            largest = max(largest, closing(q))
    return largest
