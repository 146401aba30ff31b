"""The forces of loads and springs on the bodies, in one pose at a step of the engine or in many at the read-out.

A press force acts within its slider's closing stroke, whose end is found beforehand. What each element does is in
`elements`.
"""

from cmath import exp
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache, lru_cache
from itertools import pairwise
from math import ceil, pi, tau

import numpy as np
import pymunk
from numpy.typing import NDArray

from scenes import Scene
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND, Force, TorsionSpring

from .constraints import LinkageConstraints
from .elements import RULES, BodyForce, Instant, Situation
from .masses import fictitious_masses
from .planes import PoseArray, pair, planes, with_ground
from .space import Bodies
from .start import MAX_SCENES, DrivePlace, begun, move, rates, start, way

HALVINGS = 25  # of a continuation step with a dead point in it; leaves round-off of the displacement there
HALF_TURN = pi + 1e-9  # rad: an angle so little beyond half a turn is half a turn, but for rounding


def instants(linkage: LinkageConstraints, time: Samples, q: PoseArray, v: PoseArray) -> Instant:
    """The n instants of poses q and rates v, shape (n, bodies, 3)."""
    q, v = with_ground(q), with_ground(v)
    (z, turn), (velocity, _) = planes(q), planes(v)
    position = inputs_of(linkage.scene, time).driven().position
    return Instant(time, position, z.T, turn.T, q[..., 2].T, velocity.T, v[..., 2].T)


def forces(linkage: LinkageConstraints, instant: Instant, active: Iterable[NDArray[np.bool_]]) -> Iterator[BodyForce]:
    """Yield every force and moment; of press forces, `active` has whether they act."""
    scene = linkage.scene
    now = Situation(linkage, instant, dict(zip(scene.presses, active, strict=True)), whole_turns(linkage))
    for place, element in scene.elements:
        yield from RULES[type(element)](element, place, now)


def applied(linkage: LinkageConstraints, instant: Instant, active: Iterable[NDArray[np.bool_]]) -> PoseArray:
    """Sum up what acts on the bodies at n instants, shape (n, bodies, 3); `active` as in `forces`."""
    total = np.zeros((len(instant.time), len(linkage.members), 3))
    for name, force, moment in forces(linkage, instant, active):
        if name != GROUND:
            for axis, part in enumerate((force.real, force.imag, moment)):
                total[:, linkage.index[name], axis] += part
    return total


@lru_cache(MAX_SCENES)
def whole_turns(linkage: LinkageConstraints) -> Mapping[str, float]:
    """What torsion springs' angles, at time zero within half a turn or the drive's, have beyond the pose's, rad."""
    springs, index = linkage.scene.of_type(TorsionSpring), linkage.index
    if not springs:
        return {}
    angle, turns = with_ground(start(linkage))[0, :, 2], dict[str, float]()
    for place, spring in springs.items():
        phi = float(angle[index[spring.second]] - angle[index[spring.first]])
        turns[place] = 0.0 if spring.drives(linkage.scene) else -tau * ceil((phi - HALF_TURN) / tau)
    return turns


def active_presses(linkage: LinkageConstraints, instant: Instant, ends: Sequence[float]) -> list[NDArray[np.bool_]]:
    """Tell of each press force whether it acts; `ends` are those of their closing strokes, m."""
    active = []
    for load, end in zip(linkage.scene.presses.values(), ends, strict=True):
        i, along = linkage.index[load.body], complex(*linkage.slides[load.body].along)
        rate = (along.conjugate() * instant.velocity[i]).real  # it does not turn
        active.append(load.acts(linkage.displacement(load.body, instant.z, instant.turn), rate, end))
    return active


class AppliedForces:
    """All of them on the bodies that forces move, set before every step for the pose after it: pymunk clears them.

    `active` are the press forces that acted in the last step. Plain Python: for a few bodies it is several times faster
    than numpy.
    """

    def __init__(self, linkage: LinkageConstraints, bodies: Bodies, stroke_ends: Sequence[float], dt: float) -> None:
        scene = linkage.scene
        self._linkage, self._stroke_ends, self._dt = linkage, stroke_ends, dt
        involved = frozenset().union(*(element.bodies(scene) for _, element in scene.elements))
        members = {name: body for name, body in bodies.items() if name in involved}
        moved = {name: body for name, body in members.items() if not linkage.moved[name].prescribed}
        constant = all(type(element) is Force for _, element in scene.elements)
        self._constant = [(body, *_constant(linkage, name, body)) for name, body in moved.items() if constant]
        self._varying = {} if constant else moved
        self._involved = [] if constant else [(linkage.index[name], body) for name, body in members.items()]
        self._before = {i: (complex(*body.velocity), body.angular_velocity) for i, body in self._involved}
        self.active: list[NDArray[np.bool_]] = []

    def apply(self, time: float, position: float) -> None:
        """Set the forces of the next instant, s, where the drive is at that position, rad or m."""
        # Chipmunk moves the bodies first and then updates their rates: forces set before a step act in the pose after
        # the move, p + dt v, in which they are evaluated here. Rates known then are half a step old; those at the
        # instant are extrapolated from the last two.
        dt, ground = self._dt, self._linkage.index[GROUND]
        for body, constant, moment in self._constant:
            body.force = constant
            if moment:
                body.torque = (moment * exp(-1j * (body.angle + dt * body.angular_velocity))).imag
        if not self._involved:
            return
        # Where they are not all constant, by rates extrapolated over half a step.
        instant = Instant(time, position, {ground: 0j}, {ground: 1 + 0j}, {ground: 0.0}, {ground: 0j}, {ground: 0.0})
        for i, body in self._involved:
            velocity, omega = complex(*body.velocity), body.angular_velocity
            instant.z[i] = complex(*body.position) + dt * velocity
            instant.angle[i] = body.angle + dt * omega
            instant.turn[i] = exp(1j * instant.angle[i])
            before, omega_before = self._before[i]
            instant.velocity[i], instant.omega[i] = 1.5 * velocity - 0.5 * before, 1.5 * omega - 0.5 * omega_before
            self._before[i] = velocity, omega
        self.active = active_presses(self._linkage, instant, self._stroke_ends)
        total = dict.fromkeys(self._varying, (0j, 0.0))
        for name, force, moment in forces(self._linkage, instant, self.active):
            if name in total:
                sum_, so_far = total[name]
                total[name] = sum_ + force, so_far + moment
        for name, (force, moment) in total.items():
            self._varying[name].force, self._varying[name].torque = pair(force), moment


def _constant(linkage: LinkageConstraints, name: str, body: pymunk.Body) -> tuple[tuple[float, float], complex]:
    """Sum up a body's constant forces f, and their conj(arm) f, which is zero for a body that cannot turn."""
    loads = [load for load in linkage.scene.of_type(Force).values() if load.body == name]
    force = sum((complex(*load.force) for load in loads), 0j)
    moment = sum((linkage.arm(name, load.at).conjugate() * complex(*load.force) for load in loads), 0j)
    return pair(force), 0j if body.moment == np.inf else moment


@lru_cache(MAX_SCENES)
def stroke_ends(scene: Scene) -> Sequence[float]:
    """Where the closing strokes of the press forces end, m; once a scene, since its whole way is searched."""
    if not scene.presses:
        return []
    linkage, q = begun(scene, fictitious_masses)  # whatever the masses, the way is the same
    law = linkage.drive.law
    paths = [[(law.start, q), *way(linkage, q, law.start, end)] for end in law.extent]
    end = cache(lambda body, closing: closing * max(_furthest(linkage, body, closing, path) for path in paths))
    return [end(load.body, load.closing) for load in scene.presses.values()]


def _furthest(linkage: LinkageConstraints, body: str, closing: int, path: Sequence[DrivePlace]) -> float:
    """A slider's largest displacement in its closing direction, m; between places it has a dead point."""
    i, along = linkage.index[body], linkage.slides[body].along

    def closed(q: PoseArray) -> float:
        return closing * float(linkage.displacement(body, *planes(with_ground(q)[0])))

    def opens(q: PoseArray, forward: float) -> bool:
        return closing * float(rates(linkage, q, forward)[0, i, :2] @ along) < 0

    # Bisection on the sign of the closing rate, in the continuation step before or after the furthest place of the way.
    furthest = max(range(len(path)), key=lambda number: closed(path[number][1]))
    largest = closed(path[furthest][1])
    for (here, q), (there, after) in pairwise(path[max(furthest - 1, 0) : furthest + 2]):
        half = (there - here) / 2
        if opens(after, half) and not opens(q, half):
            for _ in range(HALVINGS):
                middle = move(linkage, q, here, here + half)
                if not opens(middle, half):
                    here, q = here + half, middle
                half /= 2
            largest = max(largest, closed(q))
    return largest
