"""The forces on pymunk's bodies, set before every step for the pose after it, since pymunk clears them."""

from cmath import exp
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenes.scene import GROUND, Force

from .constraints import LinkageConstraints
from .loads import active_presses, forces, varying
from .space import Bodies, pair

if TYPE_CHECKING:
    import pymunk


class AppliedForces:
    """All loads and springs on the bodies that forces move; `active` are the press forces that acted in the last step.

    Plain Python: for a few bodies it is several times faster than numpy.
    """

    def __init__(self, linkage: LinkageConstraints, bodies: Bodies, stroke_ends: Sequence[float], dt: float) -> None:
        scene = linkage.scene
        self._linkage, self._stroke_ends, self._dt = linkage, stroke_ends, dt
        moved = {name: body for name, body in bodies.items() if not linkage.members[name].prescribed}
        self._varying = {name: moved[name] for name in varying(linkage) if name in moved}
        loaded = dict.fromkeys(load.body for load in scene.loads if isinstance(load, Force))
        constant = (name for name in loaded if name in moved and name not in self._varying)
        self._constant = [(moved[name], *_constant(linkage, name, moved[name])) for name in constant]
        involved = {load.body for load in scene.loads}
        involved |= {name for spring in scene.springs for name, _ in (spring.first, spring.second)}
        involved = involved if varying(linkage) else set()
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


def _constant(linkage: LinkageConstraints, name: str, body: "pymunk.Body") -> tuple[tuple[float, float], complex]:
    """Return the sum of a body's constant forces f, and that of conj(arm) f, zero for a body that cannot turn."""
    loads = [load for load in linkage.scene.loads if isinstance(load, Force) and load.body == name]
    force = sum((complex(*load.force) for load in loads), 0j)
    moment = sum((linkage.arm(name, load.at).conjugate() * complex(*load.force) for load in loads), 0j)
    return pair(force), 0j if body.moment == np.inf else moment
