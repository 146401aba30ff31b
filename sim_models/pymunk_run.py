"""The linkage in one pymunk space: a kinematic crank, dynamic bodies, joints; every step recorded."""

from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from scenes import Sampling
from scenes.scene import GROUND

from .pymunk_linkage import Linkage, Poses
from .pymunk_start import rates, turn

if TYPE_CHECKING:
    import pymunk

Bodies: TypeAlias = "dict[str, pymunk.Body]"

# Steps before t = 0: the joints' cached impulses start at zero, and the rates half a step early. The toggle press has
# forgotten both after 5 steps of 1000 sweeps; fewer sweeps need more steps.
PREROLL = 50


class Run:
    """The whole time at one step size dt, s.

    Filled by `advance`: row k + 1 of `record`, shape (steps + 2, bodies, 6), holds the pose p_k and the rates v_k, so
    row 0 is one step before t = 0; `impulses`, shape (n, joints), N s, are the engine's own at the n samples.
    """

    def __init__(self, linkage: Linkage, start: Poses, sampling: Sampling, stride: int, iterations: int) -> None:
        import pymunk
        from pymunk.batch import BodyFields, Buffer, get_space_bodies

        drive = linkage.scene.drive
        self.stride = stride
        self.steps = stride * sampling.samples * sampling.turns
        self.dt = float(sampling.times(linkage.scene)[1]) / stride

        self._space = pymunk.Space()  # its damping stays 1, no damping, and without shapes nothing collides
        self._space.iterations = iterations
        self._space.gravity = linkage.scene.gravity or (0, 0)
        self._bodies = _bodies(linkage)
        self._space.add(*self._bodies.values())
        first = drive.start - PREROLL * self.dt * drive.speed
        pose = turn(linkage, start, drive.start, first)
        _place(self._bodies, pose, rates(linkage, pose, drive.speed))
        self.joints = _joints(linkage, self._bodies | {GROUND: self._space.static_body})
        self._space.add(*self.joints.values())
        self.crank_angles = drive.start + drive.speed * self.dt * np.arange(self.steps + 1, dtype=np.float64)
        self._loads = _loads(linkage, self._bodies)

        self._buffer = Buffer()
        get_space_bodies(self._space, BodyFields.BODY_ID, self._buffer)
        listed = [*memoryview(self._buffer.int_buf()).cast("P")]
        self._listed = [listed.index(body.id) for body in self._bodies.values()]
        self.record = np.empty((self.steps + 2, len(self._listed), 6))
        self.impulses = np.empty((sampling.count, len(self.joints)))

    def advance(self) -> None:
        """Step from before t = 0 to the end."""
        from pymunk.batch import BodyFields, get_space_bodies

        fields = BodyFields.POSITION | BodyFields.ANGLE | BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
        space, dt, buffer, joints = self._space, self.dt, self._buffer, [*self.joints.values()]
        for k in range(1 - PREROLL, self.steps + 1):
            for body, force, moment in self._loads:  # pymunk forgets them after every step
                body.force = force
                body.torque = (moment * np.exp(-1j * (body.angle + dt * body.angular_velocity))).imag
            space.step(dt)
            if k >= -1:
                buffer.clear()  # or it would grow by every step
                get_space_bodies(space, fields, buffer)
                self.record[k + 1] = np.frombuffer(buffer.float_buf()).reshape(-1, 6)[self._listed]
            if k >= 0 and k % self.stride == 0:
                self.impulses[k // self.stride] = [joint.impulse for joint in joints]


def _bodies(linkage: Linkage) -> Bodies:
    """Return the bodies about their origins; none turns that slides."""
    import pymunk

    scene = linkage.scene
    return {
        name: pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        if name == scene.drive.body
        else pymunk.Body(member.mass, member.inertia if scene.bodies[name].slide is None else np.inf)
        for name, member in linkage.members.items()
    }


def _place(bodies: Bodies, pose: Poses, rate: Poses) -> None:
    for body, (x, y, theta), (vx, vy, omega) in zip(bodies.values(), pose[0], rate[0], strict=True):
        body.position, body.angle = (x, y), theta
        body.velocity, body.angular_velocity = (vx, vy), omega


def _joints(linkage: Linkage, bodies: Bodies) -> "dict[str, pymunk.Constraint]":
    """Return the joints by the channel of their force, a pin's without `.fx`; the crank needs none on the ground."""
    import pymunk

    scene = linkage.scene
    joints: dict[str, pymunk.Constraint] = {}
    for pin in scene.pins:
        if {pin.first, pin.second} != {GROUND, scene.drive.body}:
            anchors = [_pair(linkage.arm(body, pin.point)) for body in (pin.first, pin.second)]
            joints[pin.channel] = pymunk.PivotJoint(bodies[pin.first], bodies[pin.second], *anchors)
    # No body gets further from the origin than all of them in a row; beyond its end, a groove holds back silently.
    reach = 2 * (len(linkage.members) + 1) * linkage.size
    for body in scene.bodies.values():
        if body.slide is not None:
            # The engine is exact only if the line passes through the centre of mass.
            middle = complex(*body.slide.through) - linkage.arm(body.name, body.points[0])
            half = reach * complex(*body.slide.along)
            ends = _pair(middle - half), _pair(middle + half)
            joints[f"{body.name}.guide_force"] = pymunk.GrooveJoint(bodies[GROUND], bodies[body.name], *ends, (0, 0))
    for joint in joints.values():
        joint.error_bias = 0
    return joints


def _loads(linkage: Linkage, bodies: Bodies) -> "list[tuple[pymunk.Body, tuple[float, float], complex]]":
    """Return, for each loaded body, the force F and the sum of conj(a) F, whose torque is Im(exp(-i theta) sum)."""
    scene = linkage.scene
    loaded = []
    for name in dict.fromkeys(load.body for load in scene.loads if load.body != scene.drive.body):
        loads = [(linkage.arm(name, load.at), complex(*load.force)) for load in scene.loads if load.body == name]
        total = sum(force for _, force in loads)
        loaded.append((bodies[name], _pair(total), sum(arm.conjugate() * force for arm, force in loads)))
    return loaded


def _pair(vector: complex) -> tuple[float, float]:
    return vector.real, vector.imag
