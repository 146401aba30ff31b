"""The linkage in one pymunk space: a kinematic driven body, dynamic bodies and joints; extras only if set.

A drive between two moving bodies is a joint that is told before every step where the drive is to be after it. An elbow
is a gear of ratio 1, whose phase is the drive's position. A cylinder is a bar of a changing length, beside the groove:
it leads along the guide to the body's first point, from a point of the carrier so far back on the guide that the length
is never zero. Such a length is not linear in the coordinates, and the engine's steps are; so it is told the one that a
step in all coordinates, by the same linear equations, takes to the drive's position.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import TypeAlias

import numpy as np
import pymunk
from pymunk.batch import BodyFields, Buffer, get_space_bodies

from scenes import Failure, Status
from scenes.scene import GROUND, ConstantSpeed

from .constraints import LinkageConstraints, solved
from .joints import DRIVE, RULES
from .planes import PoseArray, pair
from .settings import PymunkExtra

MAX_AIMS = 6  # at most; each is off by a hundredth of the one before, by how far a step turns the bodies
TARGET_TOL = 1e-14  # of the linkage's size

Bodies: TypeAlias = dict[str, pymunk.Body]


class Model:
    """The space, its bodies by name and its joints by the channel of their force, a pin's without `.fx`."""

    def __init__(
        self, linkage: LinkageConstraints, pose: PoseArray, rate: PoseArray, error_bias: float, extra: PymunkExtra
    ) -> None:
        self._linkage = linkage
        self.space = pymunk.Space()  # its damping stays 1, no damping, and without shapes nothing collides
        inertias = {name: linkage.moved[name] for name in linkage.members}
        self.bodies = {
            name: pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            if inertia.prescribed
            else pymunk.Body(inertia.mass, inertia.moment)
            for name, inertia in inertias.items()
        }
        self.space.add(*self.bodies.values())
        self.place(pose, rate)
        among = self.bodies | {GROUND: self.space.static_body}
        scene = linkage.scene
        held = [each for joint in scene.joints for each in RULES[type(joint)].in_space(joint, linkage, among)]
        held.sort(key=lambda each: each.stage)
        self.joints = {each.channel: each.joint for each in held if each.channel}
        self.drive = next((each.joint for each in held if each.stage == DRIVE), None)
        constraints = [each.joint for each in held]
        for constraint in constraints:
            constraint.error_bias = error_bias
        self.space.add(*constraints)
        if extra == "motor":  # the last of all: solved before the joints, the crank lags
            self.space.add(_motor(linkage, among))
        elif extra == "shapes":
            self.space.add(*(_shape(linkage, name, body) for name, body in self.bodies.items()))
        elif extra == "callback":
            dynamic = [body for body in self.bodies.values() if body.body_type == pymunk.Body.DYNAMIC]
            for body in dynamic[:1]:
                body.velocity_func = _update_velocity
        self.callbacks = int(extra == "callback")

    def place(self, pose: PoseArray, rate: PoseArray) -> None:
        """Put the bodies at a pose with some rates, each of shape (1, bodies, 3)."""
        for body, (x, y, theta), (vx, vy, omega) in zip(self.bodies.values(), pose[0], rate[0], strict=True):
            body.position, body.angle, body.velocity, body.angular_velocity = (x, y), theta, (vx, vy), omega

    def aim(self, position: float, dt: float) -> None:
        """Set the joint of the drive so that the next step, of dt, s, takes the drive to a position, rad or m."""
        if isinstance(self.drive, pymunk.GearJoint):
            self.drive.phase = position
            return
        # The length that a linear step should be told: the engine solves J dq = -C with the length's own linear row.
        # The step's end is predicted by the same equations, the length there is evaluated exactly, and the aim is
        # corrected by what it misses.
        linkage, record = self._linkage, np.array(_present(self.bodies.values()))
        q = (record[:, :3] + dt * record[:, 3:])[None]  # where the step begins
        J, gaps = linkage.jacobian(q), linkage.gaps(q, np.array([position]))
        step, ratio = solved(np.concatenate([J, J]), np.stack([-gaps[0], np.eye(gaps.size)[-1]]))
        aimed, missed = position, np.inf
        for _ in range(MAX_AIMS):
            if abs(missed) > TARGET_TOL * linkage.size:
                missed = float(linkage.drive_position(q + step + (aimed - position) * ratio)[0]) - position
                aimed -= missed
        assert isinstance(self.drive, pymunk.PinJoint)
        self.drive.distance = aimed - linkage.back

    def counters(self, steps: int, sweeps: int) -> dict[str, int]:
        """Count steps, sweeps times constraints, and what is in the space."""
        space = self.space
        sizes = {"bodies": space.bodies, "constraints": space.constraints, "shapes": space.shapes}
        counts = {name: len(members) for name, members in sizes.items()} | {"callbacks": self.callbacks}
        return {"steps": steps, "constraint_iterations": sweeps * counts["constraints"]} | counts


def _motor(linkage: LinkageConstraints, bodies: Bodies) -> pymunk.SimpleMotor:
    drive, law = linkage.drive, linkage.drive.law
    if not isinstance(law, ConstantSpeed) or drive.slide is not None or drive.on != GROUND:
        raise Failure(Status.unsupported, "pymunk has motors for cranks at a constant speed only")
    return pymunk.SimpleMotor(bodies[drive.body], bodies[GROUND], law.speed)


def _update_velocity(body: pymunk.Body, gravity: tuple[float, float], damping: float, dt: float) -> None:
    """Update as the engine does; pymunk would replace its own function by the one in C."""
    type(body).update_velocity(body, gravity, damping, dt)


def _shape(linkage: LinkageConstraints, name: str, body: pymunk.Body) -> pymunk.Segment:
    """A bar from the body's first point to its last, which does not collide with the others."""
    first, *_, last = [*linkage.members[name].points.values()] * 2
    shape = pymunk.Segment(body, pair(first), pair(last), linkage.size / 100)
    shape.filter = pymunk.ShapeFilter(group=1)
    return shape


class BatchRecorder:
    """Records of the poses and rates of all bodies: by one call into a growing buffer in C, faster than copying each.

    `append` records the present ones.
    """

    def __init__(self, space: pymunk.Space, bodies: Iterable[pymunk.Body]) -> None:
        fields = BodyFields.POSITION | BodyFields.ANGLE | BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
        order, self._buffer = Buffer(), Buffer()
        get_space_bodies(space, BodyFields.BODY_ID, order)
        listed = [*memoryview(order.int_buf()).cast("P")]  # the static body too
        self._columns = [listed.index(body.id) for body in bodies]
        self._listed = len(listed)
        self.append: Callable[[], None] = partial(get_space_bodies, space, fields, self._buffer)

    def rows(self) -> PoseArray:
        """All records, shape (records, bodies, 6): x, y, angle and their rates."""
        return np.frombuffer(self._buffer.float_buf()).reshape(-1, self._listed, 6)[:, self._columns]


class PropertyRecorder:
    """The same records by the properties of each body."""

    def __init__(self, bodies: Iterable[pymunk.Body]) -> None:
        self._bodies = [*bodies]
        self._rows: list[list[tuple[float, ...]]] = []

    def append(self) -> None:
        """Record the present poses and rates."""
        self._rows.append(_present(self._bodies))

    def rows(self) -> PoseArray:
        """All records, shape (records, bodies, 6)."""
        return np.array(self._rows)


def _present(bodies: Iterable[pymunk.Body]) -> list[tuple[float, ...]]:
    return [(*body.position, body.angle, *body.velocity, body.angular_velocity) for body in bodies]
