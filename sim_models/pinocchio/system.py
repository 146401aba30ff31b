"""A linkage as Pinocchio's model: a spanning tree of its joints, and what holds the tree's coordinates.

A body moves with the frame of its joint, which has the axes of the body's own frame, and its origin where the joint
holds the body. In the plane a place or a vector is a complex number, x + iy. Columns of Jacobians are by joint
coordinate: the angle between two bodies, rad, or the displacement along a guide, m.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
import pinocchio

from scenes import Scene
from scenes.joints import Guide, Joint, Pin
from scenes.model.motion import Samples
from scenes.scene import GROUND

from ..coordinates.bodies import MovingBody
from ..coordinates.joints import RULES
from ..coordinates.loads import Wrench
from ..coordinates.system import System

WORLD = pinocchio.LOCAL_WORLD_ALIGNED


class TreeJoint(NamedTuple):
    """A joint of the tree, by the channel of its pin, or by its slider."""

    name: str
    parent: str
    child: str
    at: complex  # in the parent's frame, m
    anchor: complex  # in the child's, m
    along: complex  # of a guide, in both frames: which way the child moves; zero of a pin
    sense: int  # 1 where the child is the pin's later body or the slider, else -1

    @property
    def turns(self) -> bool:
        """Whether it is a pin."""
        return self.along == 0


class PinocchioSystem(System):
    """The constraints of one tree, as many as coordinates, or there is no one motion: loops' joints and the drive.

    It holds Pinocchio's buffers.
    """

    def __init__(self, scene: Scene) -> None:
        """Span the tree."""
        super().__init__(scene)
        self._joints = list(_spanned(self))
        self._model: Any = pinocchio.Model()
        self._model.gravity = pinocchio.Motion(_space(complex(*(scene.gravity or (0, 0)))), np.zeros(3))
        self._number, self._anchors = {GROUND: 0}, {GROUND: 0j}  # of bodies' joints, and where these are in bodies
        turns = {GROUND: np.zeros(len(self._joints))}
        for joint, axis in zip(self._joints, np.eye(len(self._joints)), strict=True):
            self._number[joint.child] = self._add(joint)
            self._anchors[joint.child] = joint.anchor
            turns[joint.child] = turns[joint.parent] + joint.turns * axis
        self._turns = np.array([*turns.values()])  # of every body by coordinate: 0 or 1
        self._data: Any = self._model.createData()
        in_tree = {(Pin if joint.turns else Guide, joint.name) for joint in self._joints}
        self.arms = {end: arm - self._anchors[end[0]] for end, arm in self.arms.items()}
        for name, guide in self.guides.items():
            through, first = guide.through - self._anchors[guide.carrier], guide.first - self._anchors[name]
            self.guides[name] = guide._replace(through=through, first=first)
        self.joints = [joint for joint in scene.joints if (type(joint), _name(joint)) not in in_tree]
        self.units = np.array([1.0 if joint.turns else self.size for joint in self._joints])

    def placed(self, bodies: Mapping[str, MovingBody]) -> Samples:
        """Return the coordinates of bodies in these places, shape (n,); joints that close loops stay open."""
        bodies = {name: body._replace(origin=body.place(self._anchors[name])) for name, body in bodies.items()}
        q = list[float]()
        for joint in self._joints:
            turned = bodies[joint.child].angle - bodies[joint.parent].angle
            q.append(turned if joint.turns else self.slid(bodies, joint.name)[0].real)
        return np.asarray(np.array(q) / self.units)

    def moved(self, x: Samples, v: Samples | None = None, a: Samples | None = None) -> dict[str, MovingBody]:
        """Return how bodies move, by Pinocchio's recursions."""
        q, *rates = (np.zeros(len(self.units)) if level is None else self.units * level for level in (x, v, a))
        rates = rates if v is not None else []
        pinocchio.forwardKinematics(self._model, self._data, q, *rates)
        levels = self._places(q)
        for rate, rate_of in zip(rates, (pinocchio.getVelocity, pinocchio.getClassicalAcceleration), strict=False):
            linear = (rate_of(self._model, self._data, number, WORLD).linear for number in self._number.values())
            levels += [complex(*vector[:2]) for vector in linear], (self._turns @ rate).tolist()
        return dict(zip(self._number, map(MovingBody, *levels), strict=True))

    def jacobian(self, x: Samples) -> Samples:
        """Return C_x, shape (m, n), by Pinocchio's Jacobians: the velocities at a rate of 1 of each coordinate."""
        q = self.units * x
        pinocchio.computeJointJacobians(self._model, self._data, q)
        jacobians = (pinocchio.getJointJacobian(self._model, self._data, n, WORLD) for n in self._number.values())
        velocities = (J[0] + 1j * J[1] for J in jacobians)
        bodies = dict(zip(self._number, map(MovingBody, *self._places(q), velocities, self._turns), strict=True))
        return np.asarray(self.rows_of(bodies, 1) * self.units)

    def forces(
        self, motion: Sequence[Samples], J: Samples, bodies: Mapping[str, MovingBody], ends: Mapping[str, float]
    ) -> dict[str, float]:
        """Return the force channels: of closed loops by their multipliers, of the tree's joints by the recursion.

        `motion` has the coordinates and their two derivatives, each of shape (n,); J is the Jacobian there.
        """
        motion = [self.units * level for level in motion]
        loads = [*self.applied(bodies, ends)]
        # Twice through the recursion: first without loops, which gives the generalised forces that multipliers must
        # supply, J^T lambda = tau; then with the loops' forces acting, so that each joint of the tree shows what it
        # carries.
        needed = self.units * self._inverse_dynamics(bodies, motion, loads)
        multipliers = np.linalg.solve(J.T, needed) / self.row_units
        self._inverse_dynamics(bodies, motion, [*loads, *self._held(bodies, multipliers)])
        known = self.scene.channels
        names = (channel.name for joint in self.joints for channel in joint.channels(self.scene))
        channels = dict(zip(names, multipliers, strict=True))
        for joint in self._joints:
            exerted = self._data.f[self._number[joint.child]]  # by the parent, in the child's frame
            force = joint.sense * complex(*exerted.linear[:2]) * bodies[joint.child].turn
            if joint.turns:
                channels |= zip(known.pins[joint.name], (force.real, force.imag), strict=True)
                continue
            carrier, _, along, first = self.guides[joint.name]
            way = bodies[joint.child].origin - bodies[joint.name].place(first)
            across, moment = 1j * bodies[carrier].turn * along, joint.sense * exerted.angular[2]
            normal, about_first = (across.conjugate() * force).real, moment + (way.conjugate() * force).imag
            channels |= zip(known.guides[joint.name], (normal, about_first), strict=True)
        return channels

    def _held(self, bodies: Mapping[str, MovingBody], multipliers: Samples) -> Iterator[Wrench]:
        """Yield what the joints that close loops and the drive do, by their multipliers in the order of the rows."""
        rows = iter(multipliers.tolist())
        for joint in self.joints:
            yield from RULES[type(joint)].holds(joint, self, bodies, [*islice(rows, joint.equations)])

    def _inverse_dynamics(
        self, bodies: Mapping[str, MovingBody], motion: Sequence[Samples], wrenches: Iterable[Wrench]
    ) -> Samples:
        """Return the generalised forces that a motion q, v, a needs besides wrenches; Pinocchio keeps the joints'."""
        linear, angular = dict.fromkeys(self._number, 0j), dict.fromkeys(self._number, 0.0)
        for wrench in wrenches:
            linear[wrench.body] += wrench.force
            angular[wrench.body] += wrench.about(bodies[wrench.body].origin)
        forces: Any = pinocchio.StdVec_Force()
        forces.extend([pinocchio.Force.Zero()] * self._model.njoints)
        for body, number in self._number.items():
            in_body = linear[body] * bodies[body].turn.conjugate()
            forces[number] = pinocchio.Force(_space(in_body), np.array([0.0, 0.0, angular[body]]))
        return np.asarray(pinocchio.rnea(self._model, self._data, *motion, forces))

    def _places(self, q: Samples) -> tuple[list[Any], ...]:
        """Return origins, angles and exp(i angle) of the joints' frames."""
        places = [self._data.oMi[number] for number in self._number.values()]
        origins = [complex(*place.translation[:2]) for place in places]
        return origins, (self._turns @ q).tolist(), [complex(*place.rotation[:2, 0]) for place in places]

    def _add(self, joint: TreeJoint) -> int:
        """Add a joint with its child, and return its number."""
        kind = pinocchio.JointModelRZ() if joint.turns else pinocchio.JointModelPrismaticUnaligned(_space(joint.along))
        place = pinocchio.SE3(np.eye(3), _space(joint.at - self._anchors[joint.parent]))
        number: int = self._model.addJoint(self._number[joint.parent], kind, place, joint.child)  # one joint a body
        body = self.bodies[joint.child]
        tensor = np.diag([body.inertia / 2, body.inertia / 2, body.inertia])  # only the last matters in the plane
        inertia = pinocchio.Inertia(body.mass, _space(body.com - joint.anchor), tensor)
        self._model.appendBodyToJoint(number, inertia, pinocchio.SE3.Identity())
        return number


def _spanned(linkage: System) -> Iterator[TreeJoint]:
    """Yield joints that reach every body once, those nearest to the ground first."""
    arms = linkage.arms
    joints = [
        TreeJoint(pin.channel, pin.first, pin.second, arms[pin.first, pin.point], arms[pin.second, pin.point], 0j, 1)
        for pin in linkage.scene.pins
    ]
    guides = linkage.guides.items()
    joints += (
        TreeJoint(name, guide.carrier, name, guide.through, guide.first, guide.along, 1) for name, guide in guides
    )
    # Breadth-first search from the ground: the tree's branches are short, and so is the error that accumulates along
    # them.
    reached = [GROUND]
    for body in reached:
        for candidate in joints:
            other_way = TreeJoint(
                candidate.name, candidate.child, candidate.parent, candidate.anchor, candidate.at, -candidate.along, -1
            )
            joint = candidate if candidate.parent == body else other_way
            if joint.parent == body and joint.child not in reached:
                reached.append(joint.child)
                yield joint


def _name(joint: Joint) -> str:
    """What a joint would be called in the tree; nothing of one that cannot be there."""
    match joint:
        case Pin():
            return joint.channel
        case Guide():
            return joint.slider
    return ""


def _space(vector: complex) -> Samples:
    """Return a vector of the plane in space."""
    return np.array([vector.real, vector.imag, 0.0])
