"""The forces on pymunk's bodies: it forgets them after every step, and gets them again for where the next will be."""

from cmath import exp
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes.scene import GROUND, Force

from .constraints import Linkage
from .loads import acting, forces, varying
from .space import Bodies, pair

if TYPE_CHECKING:
    import pymunk

Push: TypeAlias = Callable[[], None]


class VaryingForces:
    """All forces on the bodies of which some are not constant; `acts` says which press forces acted in the last step.

    Plain Python: for a few bodies it is several times faster than numpy.
    """

    def __init__(self, linkage: Linkage, bodies: Bodies, stroke_ends: Sequence[float], dt: float) -> None:
        scene = linkage.scene
        self._linkage, self._stroke_ends, self._dt = linkage, stroke_ends, dt
        attacked = {load.body for load in scene.loads}
        attacked |= {name for spring in scene.springs for name, _ in (spring.first, spring.second)}
        self._attacked = [(linkage.index[name], body) for name, body in bodies.items() if name in attacked]
        self._pushed = {name: bodies[name] for name in varying(linkage) if not linkage.members[name].prescribed}
        self._before = {i: complex(*body.velocity) for i, body in self._attacked}
        self.acts: list[NDArray[np.bool_]] = []

    def push(self) -> None:
        """Apply the forces of the next instant, by rates carried on from half a step ago."""
        dt, ground = self._dt, self._linkage.index[GROUND]
        z, turn, rate = {ground: 0j}, {ground: 1 + 0j}, {}
        for i, body in self._attacked:
            velocity = complex(*body.velocity)
            z[i] = complex(*body.position) + dt * velocity
            turn[i] = exp(1j * (body.angle + dt * body.angular_velocity))
            rate[i] = 1.5 * velocity - 0.5 * self._before[i]
            self._before[i] = velocity
        self.acts = acting(self._linkage, z, turn, rate, self._stroke_ends)
        total = dict.fromkeys(self._pushed, (0j, 0.0))
        for name, r, force in forces(self._linkage, z, turn, self.acts):
            if name in total:
                sum_, moment = total[name]
                total[name] = sum_ + force, moment + (r.conjugate() * force).imag
        for name, (force, moment) in total.items():
            self._pushed[name].force, self._pushed[name].torque = pair(force), moment


def constant_forces(linkage: Linkage, bodies: Bodies, dt: float) -> Iterator[Push]:
    """Yield what applies the forces on each body that moves under constant ones alone."""
    loads = [load for load in linkage.scene.loads if isinstance(load, Force)]
    left_out = {*varying(linkage), *(name for name in bodies if linkage.members[name].prescribed)}
    for name in dict.fromkeys(load.body for load in loads if load.body not in left_out):
        own = [(linkage.arm(name, load.at), complex(*load.force)) for load in loads if load.body == name]
        force = sum((force for _, force in own), 0j)
        moment = sum((arm.conjugate() * force for arm, force in own), 0j)  # turned by the body's angle
        yield _constant_force(bodies[name], pair(force), moment, dt)


def _constant_force(body: "pymunk.Body", force: tuple[float, float], moment: complex, dt: float) -> Push:
    def push() -> None:
        body.force = force

    def push_and_turn() -> None:
        body.force = force
        body.torque = (moment * exp(-1j * (body.angle + dt * body.angular_velocity))).imag

    return push_and_turn if moment and body.moment != np.inf else push
