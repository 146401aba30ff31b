"""The spanning tree of a linkage's joints as Pinocchio's model, and what its recursions give of every body.

A body's joint frame has its origin where the joint holds the body, and the axes of the body's own frame. In the plane a
place or a vector is a complex number, x + iy. Rows are by body in file order, the ground last; columns of Jacobians
are by joint coordinate: the angle between two bodies, rad, or the displacement along a guide, m.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import pinocchio
from numpy.typing import NDArray

from scenes import Scene
from scenes.motion import Samples
from scenes.scene import GROUND

from ..coordinates.bodies import framed_body

Plane: TypeAlias = NDArray[np.complex128]
WORLD = pinocchio.LOCAL_WORLD_ALIGNED


class Joint(NamedTuple):
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


class Bodies(NamedTuple):
    """All bodies at one time: the origins of their joint frames, m, and what these do."""

    at: Plane
    turn: Plane  # exp(i angle)
    rate: Plane
    spin: Samples
    change: Plane
    spin_rate: Samples

    def place(self, row: int, arm: complex) -> complex:
        """Return where a point of a body is, m, `arm` from its origin along its axes."""
        return complex(self.at[row] + self.turn[row] * arm)

    def velocity(self, row: int, arm: complex) -> complex:
        """Return the velocity of a point, m/s."""
        return complex(self.rate[row] + 1j * self.spin[row] * self.turn[row] * arm)

    def acceleration(self, row: int, arm: complex) -> complex:
        """Return the acceleration of a point, m/s^2."""
        return complex(self.change[row] + (1j * self.spin_rate[row] - self.spin[row] ** 2) * self.turn[row] * arm)


class Tree:
    """The tree of one scene; it holds Pinocchio's buffers."""

    def __init__(self, scene: Scene) -> None:
        """Span the tree.

        Raises:
            Failure: see `bodies`.
        """
        self.scene = scene
        self.bodies = {name: framed_body(scene, body) for name, body in scene.bodies.items()}
        self.index = {name: row for row, name in enumerate((*scene.bodies, GROUND))}
        self.joints = list(self._spanned())
        self.anchors = {GROUND: 0j} | {joint.child: joint.anchor for joint in self.joints}
        self.model: Any = pinocchio.Model()
        self.model.gravity = pinocchio.Motion(_space(complex(*(scene.gravity or (0, 0)))), np.zeros(3))
        self.number = {GROUND: 0}  # of a body's joint in Pinocchio
        self.turns = np.zeros((len(self.index), len(self.joints)))  # of every body by coordinate: 0 or 1
        for column, joint in enumerate(self.joints):
            self.number[joint.child] = self._add(joint)
            self.turns[self.index[joint.child]] = self.turns[self.index[joint.parent]]
            self.turns[self.index[joint.child], column] = joint.turns
        self.data: Any = self.model.createData()
        self._order = [self.number[name] for name in self.index]

    def local(self, body: str, point: str) -> complex:
        """Return a point in the frame of its body or of the ground, m."""
        return complex(*(self.scene.ground[point] if body == GROUND else self.bodies[body].points[point]))

    def moved(self, q: Samples, v: Samples | None = None, a: Samples | None = None) -> Bodies:
        """Return what the bodies do at joint coordinates and their rates, each of shape (n,); without, at rest."""
        rate = change = np.zeros(len(self.index), np.complex128)
        spin = spin_rate = np.zeros(len(self.index))
        if v is None:
            pinocchio.forwardKinematics(self.model, self.data, q)
        else:
            a = np.zeros(len(q)) if a is None else a
            pinocchio.forwardKinematics(self.model, self.data, q, v, a)
            rate, change = (self._linear(of) for of in (pinocchio.getVelocity, pinocchio.getClassicalAcceleration))
            spin, spin_rate = self.turns @ v, self.turns @ a
        places = [self.data.oMi[number] for number in self._order]
        at = np.array([complex(*place.translation[:2]) for place in places])
        turn = np.array([complex(*place.rotation[:2, 0]) for place in places])
        return Bodies(at, turn, rate, spin, change, spin_rate)

    def jacobians(self, q: Samples) -> Plane:
        """Return the derivatives of the joint frames' origins by the coordinates, shape (bodies + 1, n)."""
        pinocchio.computeJointJacobians(self.model, self.data, q)
        J = np.array([pinocchio.getJointJacobian(self.model, self.data, number, WORLD) for number in self._order])
        return np.asarray(J[:, 0] + 1j * J[:, 1])

    def _linear(self, rate: Any) -> Plane:
        linear = (rate(self.model, self.data, number, WORLD).linear for number in self._order)
        return np.array([complex(x, y) for x, y, _ in linear])

    def _spanned(self) -> Iterator[Joint]:
        """Yield joints that reach every body once, those nearest to the ground first."""
        reached = [GROUND]
        for body in reached:
            for joint in self._from(body):
                if joint.child not in reached:
                    reached.append(joint.child)
                    yield joint

    def _from(self, body: str) -> Iterator[Joint]:
        """Yield the joints of a body with others, the body as the parent."""
        for pin in self.scene.pins:
            if body in (pin.first, pin.second):
                other = pin.second if body == pin.first else pin.first
                yield Joint(pin.channel, body, other, self.local(body, pin.point), self.local(other, pin.point), 0j)
        for name, slider in self.scene.bodies.items():
            if slider.slide is not None and body in (name, slider.slide.on):
                through, along = complex(*slider.slide.through), complex(*slider.slide.along)
                first = self.local(name, slider.points[0])
                if body == name:
                    yield Joint(name, body, slider.slide.on, first, through, -along)
                else:
                    yield Joint(name, body, name, through, first, along)

    def _add(self, joint: Joint) -> int:
        """Add a joint with its child, and return its number."""
        kind = pinocchio.JointModelRZ() if joint.turns else pinocchio.JointModelPrismaticUnaligned(_space(joint.along))
        place = pinocchio.SE3(np.eye(3), _space(joint.at - self.anchors[joint.parent]))
        number: int = self.model.addJoint(self.number[joint.parent], kind, place, joint.name)
        body = self.bodies[joint.child]
        about = np.diag([body.inertia / 2, body.inertia / 2, body.inertia])  # only the last matters in the plane
        inertia = pinocchio.Inertia(body.mass, _space(complex(*body.com) - joint.anchor), about)
        self.model.appendBodyToJoint(number, inertia, pinocchio.SE3.Identity())
        return number


def _space(vector: complex) -> Samples:
    """Return a vector of the plane in space."""
    return np.array([vector.real, vector.imag, 0.0])
