"""The spanning tree of a linkage's joints as Pinocchio's model, and what its recursions give of every body.

A body moves with the frame of its joint, which has the axes of the body's own frame, and its origin where the joint
holds the body. In the plane a place or a vector is a complex number, x + iy. Columns of Jacobians are by joint
coordinate: the angle between two bodies, rad, or the displacement along a guide, m.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pinocchio

from scenes.model.motion import Samples
from scenes.scene import GROUND

from ..coordinates.bodies import MovingBody
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

    @property
    def turns(self) -> bool:
        """Whether it is a pin."""
        return self.along == 0


class Tree:
    """The tree of one scene; it holds Pinocchio's buffers."""

    def __init__(self, linkage: System) -> None:
        gravity = linkage.scene.gravity or (0, 0)
        self.bodies, self.joints = linkage.bodies, list(_spanned(linkage))
        self.model: Any = pinocchio.Model()
        self.model.gravity = pinocchio.Motion(_space(complex(*gravity)), np.zeros(3))
        self.number, self.anchors = {GROUND: 0}, {GROUND: 0j}  # of bodies' joints, and where these are in bodies
        turns = {GROUND: np.zeros(len(self.joints))}
        for joint, own in zip(self.joints, np.eye(len(self.joints)), strict=True):
            self.number[joint.child] = self._add(joint)
            self.anchors[joint.child] = joint.anchor
            turns[joint.child] = turns[joint.parent] + joint.turns * own
        self.turns = np.array([*turns.values()])  # of every body by coordinate: 0 or 1
        self.data: Any = self.model.createData()

    def moved(self, q: Samples, *rates: Samples) -> dict[str, MovingBody]:
        """Return how bodies move, by joint coordinates, and by their rates and accelerations or none, of shape (n,)."""
        pinocchio.forwardKinematics(self.model, self.data, q, *rates)
        levels = self._places(q)
        for rate, of in zip(rates, (pinocchio.getVelocity, pinocchio.getClassicalAcceleration), strict=False):
            linear = (of(self.model, self.data, number, WORLD).linear for number in self.number.values())
            levels += [complex(*vector[:2]) for vector in linear], (self.turns @ rate).tolist()
        return dict(zip(self.number, map(MovingBody, *levels), strict=True))

    def by_coordinate(self, q: Samples) -> dict[str, MovingBody]:
        """Return the bodies with the velocities, shape (n,), that each coordinate gives them at a rate of 1."""
        pinocchio.computeJointJacobians(self.model, self.data, q)
        jacobians = (pinocchio.getJointJacobian(self.model, self.data, n, WORLD) for n in self.number.values())
        velocities = (J[0] + 1j * J[1] for J in jacobians)
        return dict(zip(self.number, map(MovingBody, *self._places(q), velocities, self.turns), strict=True))

    def inverse_dynamics(
        self, bodies: Mapping[str, MovingBody], motion: Sequence[Samples], wrenches: Iterable[Wrench]
    ) -> Samples:
        """Return the generalised forces that a motion q, v, a needs besides wrenches; Pinocchio keeps the joints'."""
        linear, angular = dict.fromkeys(self.number, 0j), dict.fromkeys(self.number, 0.0)
        for wrench in wrenches:
            linear[wrench.body] += wrench.force
            angular[wrench.body] += wrench.about(bodies[wrench.body].origin)
        forces: Any = pinocchio.StdVec_Force()
        forces.extend([pinocchio.Force.Zero()] * self.model.njoints)
        for body, number in self.number.items():
            own = linear[body] * bodies[body].turn.conjugate()
            forces[number] = pinocchio.Force(_space(own), np.array([0.0, 0.0, angular[body]]))
        return np.asarray(pinocchio.rnea(self.model, self.data, *motion, forces))

    def _places(self, q: Samples) -> tuple[list[Any], ...]:
        """Return origins, angles and exp(i angle) of the joints' frames."""
        places = [self.data.oMi[number] for number in self.number.values()]
        origins = [complex(*place.translation[:2]) for place in places]
        return origins, (self.turns @ q).tolist(), [complex(*place.rotation[:2, 0]) for place in places]

    def _add(self, joint: TreeJoint) -> int:
        """Add a joint with its child, and return its number."""
        kind = pinocchio.JointModelRZ() if joint.turns else pinocchio.JointModelPrismaticUnaligned(_space(joint.along))
        place = pinocchio.SE3(np.eye(3), _space(joint.at - self.anchors[joint.parent]))
        number: int = self.model.addJoint(self.number[joint.parent], kind, place, joint.name)
        body = self.bodies[joint.child]
        about = np.diag([body.inertia / 2, body.inertia / 2, body.inertia])  # only the last matters in the plane
        inertia = pinocchio.Inertia(body.mass, _space(body.com - joint.anchor), about)
        self.model.appendBodyToJoint(number, inertia, pinocchio.SE3.Identity())
        return number


def _spanned(linkage: System) -> Iterator[TreeJoint]:
    """Yield joints that reach every body once, those nearest to the ground first."""
    arms = linkage.arms
    joints = [
        TreeJoint(pin.channel, pin.first, pin.second, arms[pin.first, pin.point], arms[pin.second, pin.point], 0j)
        for pin in linkage.scene.pins
    ]
    guides = linkage.guides.items()
    joints += (TreeJoint(name, of.carrier, name, of.through, of.first, of.along) for name, of in guides)
    reached = [GROUND]
    for body in reached:
        for own in joints:
            other_way = TreeJoint(own.name, own.child, own.parent, own.anchor, own.at, -own.along)
            joint = own if own.parent == body else other_way
            if joint.parent == body and joint.child not in reached:
                reached.append(joint.child)
                yield joint


def _space(vector: complex) -> Samples:
    """Return a vector of the plane in space."""
    return np.array([vector.real, vector.imag, 0.0])
