"""A scene as symbols: constraints, energies and work in absolute coordinates, and CasADi's derivatives of them.

The coordinates x of a body are the place of its frame's origin, over the linkage's size, and its angle. With the
constraints C(x) = e s, s the position of the drive in its own unit and e the last unit vector,

    C_x v = e s',    C_x a = e s'' - (C_x v)_x v,    C_x^T l = d/dt (dL/dv) - dL/dx - Q,    L = T - V.

The rows of C are in the order of the scene's joints, each over its unit; their multipliers are the force channels.
"""

from functools import cached_property
from typing import Any

import casadi
from casadi import SX, Function, jacobian, jtimes, vertcat

from scenes.channels import Role
from scenes.elements.springs import PointPair
from scenes.scene import GROUND

from ..coordinates.system import System
from .elements import RULES
from .joints import RULES as JOINTS


class SymbolicLinkage:
    """The symbols of one scene, in the units of its system; nothing is compiled before it is asked for."""

    def __init__(self, system: System) -> None:
        self.scene, self.bodies, self.size, self.row_units = system.scene, system.bodies, system.size, system.row_units
        self._arms, self._guides = system.arms, system.guides
        self.index = {name: number for number, name in enumerate(self.bodies)}
        self.x, self.v, self.a = (SX.sym(name, len(system.units)) for name in "xva")
        self._q = self.x * system.units
        rows = [JOINTS[type(joint)](joint, self) for joint in self.scene.joints]
        self.constraints, self.drive_position = vertcat(*rows) / self.row_units, rows[-1]  # rad or m

    def angle(self, body: str) -> Any:
        """Return the angle of a body's x axis, rad."""
        return 0.0 if body == GROUND else self._q[3 * self.index[body] + 2]

    def turned(self, body: str, vector: complex) -> Any:
        """Return a vector of a body's frame in that of the ground."""
        c, s = casadi.cos(self.angle(body)), casadi.sin(self.angle(body))
        return vertcat(c * vector.real - s * vector.imag, s * vector.real + c * vector.imag)

    def place(self, body: str, local: complex) -> Any:
        """Return where a place in a body's frame is, m."""
        if body == GROUND:
            return vertcat(local.real, local.imag)
        first = 3 * self.index[body]
        return self._q[first : first + 2] + self.turned(body, local)

    def point(self, body: str, name: str) -> Any:
        """Return where a body has a point, m."""
        return self.place(body, self._arms[body, name])

    def way(self, pair: PointPair) -> Any:
        """Return the way from the first of two points to the second, m."""
        return self.point(*pair.second) - self.point(*pair.first)

    def slid(self, body: str, *, across: bool = False) -> Any:
        """Return where a slider's first point is from `through`, along its guide or across it, m."""
        carrier, through, along, first = self._guides[body]
        axis = self.turned(carrier, 1j * along if across else along)
        return casadi.dot(axis, self.place(body, first) - self.place(carrier, through))

    @cached_property
    def required(self) -> Any:
        """d/dt (dT/dv) - d(T - V)/dx - Q: what the multipliers hold, by coordinates."""
        x, v, a = self.x, self.v, self.a
        kinetic, potential, work = SX(0), SX(0), SX.zeros(x.shape)
        for name, body in self.bodies.items():
            com = self.place(name, body.com)
            omega = v[3 * self.index[name] + 2]
            kinetic += (body.mass * casadi.sumsqr(jtimes(com, x, v)) + body.inertia * omega**2) / 2
            if self.scene.gravity is not None:
                potential -= body.mass * casadi.dot(vertcat(*self.scene.gravity), com)
        stored = SX(0)
        for place, element in self.scene.elements:
            of_element = RULES[type(element)](self, element, place)
            stored += of_element.potential
            for end, force in of_element.forces:
                work += jtimes(self.point(*end), x, force, True)
        potential += stored
        # d/dt (dT/dv) by the chain rule: the momentum p(x, v) along x' = v and v' = a. Energies enter by derivatives,
        # so that no inertia force, spring force or Coriolis term is written down.
        momentum = casadi.gradient(kinetic, v) if self.bodies else v
        return jtimes(momentum, x, v) + jtimes(momentum, v, a) - casadi.gradient(kinetic - potential, x) - work

    @cached_property
    def stroke_ends(self) -> Any:
        """Where the strokes of the press forces end, m, in the order of `scene.presses`. To be given to functions."""
        return SX.sym("end", len(self.scene.presses))

    @cached_property
    def functions(self) -> tuple[Function, Function, Function]:
        """C(x), C_x, and (C_x v)_x v."""
        return (
            Function("gaps", [self.x], [self.constraints]),
            Function("jacobian", [self.x], [jacobian(self.constraints, self.x)]),
            Function("bend", [self.x, self.v], [jtimes(jtimes(self.constraints, self.x, self.v), self.x, self.v)]),
        )

    @property
    def shortest_spring(self) -> Any:
        """The length of the shortest spring that needs a direction, over the linkage's size."""
        pairs = [pair for pair in self.scene.of_type(PointPair).values() if pair.needs_direction]
        lengths = (casadi.norm_2(self.way(pair)) / self.size for pair in pairs)
        return casadi.mmin(vertcat(1.0, *lengths))


def channels(linkage: SymbolicLinkage, multipliers: Any) -> dict[str, Any]:
    """All channels but the time, by coordinates, their rates and the multipliers of the constraints."""
    scene, x, v, a = linkage.scene, linkage.x, linkage.v, linkage.a
    known: dict[str, Any] = {scene.channels.drive.position: linkage.drive_position}
    for point, names in scene.channels.points.items():
        place = linkage.point(scene.owners[point][0], point)
        # Directional derivatives: velocity is d place/dx v; acceleration is the same of the velocity, plus its part by
        # v' = a.
        velocity = jtimes(place, x, v)
        vectors = place, velocity, jtimes(velocity, x, v) + jtimes(velocity, v, a)
        for both, vector in zip(names, vectors, strict=True):
            known |= zip(both, casadi.vertsplit(vector), strict=True)
    for body, rates in scene.channels.bodies.items():
        known |= zip(rates, (level[3 * linkage.index[body] + 2] for level in (x, v, a)), strict=True)
    if scene.has_masses:
        known |= zip(scene.channels.names(Role.force), casadi.vertsplit(multipliers / linkage.row_units), strict=True)
    return known
