"""The linkage in one pymunk space: a kinematic driven body, dynamic bodies and joints; extras only if set."""

from typing import TYPE_CHECKING, TypeAlias

from scenes import Failure, Status
from scenes.scene import GROUND, ConstantSpeed

from .constraints import LinkageConstraints, Poses
from .settings import Extra

if TYPE_CHECKING:
    import pymunk

Bodies: TypeAlias = "dict[str, pymunk.Body]"


class Model:
    """The space, its bodies by name and its joints by the channel of their force, a pin's without `.fx`.

    Raises:
        Failure: unsupported, a drive for which pymunk has no motor.
    """

    def __init__(self, linkage: LinkageConstraints, pose: Poses, rate: Poses, error_bias: float, extra: Extra) -> None:
        import pymunk

        self.space = pymunk.Space()  # its damping stays 1, no damping, and without shapes nothing collides
        self.bodies = {name: _body(linkage, name) for name in linkage.members}
        self.space.add(*self.bodies.values())
        for body, (x, y, theta), (vx, vy, omega) in zip(self.bodies.values(), pose[0], rate[0], strict=True):
            body.position, body.angle = (x, y), theta
            body.velocity, body.angular_velocity = (vx, vy), omega

        among = self.bodies | {GROUND: self.space.static_body}
        self.joints = {**_pins(linkage, among), **_grooves(linkage, among)}
        constraints = [*self.joints.values(), *_gears(linkage, among)]
        for constraint in constraints:
            constraint.error_bias = error_bias
        self.space.add(*constraints)
        if extra == "motor":  # the last of all: solved before the joints, the crank lags
            self.space.add(motor(linkage, among))
        elif extra == "shapes":
            self.space.add(*(_shape(linkage, name, body) for name, body in self.bodies.items()))
        elif extra == "callback":
            dynamic = (body for body in self.bodies.values() if body.body_type == pymunk.Body.DYNAMIC)
            next(dynamic).velocity_func = _update_velocity
        self.callbacks = int(extra == "callback")

    @property
    def counters(self) -> dict[str, int]:
        """The number of bodies, constraints, shapes and callbacks in every step."""
        space = self.space
        sizes = {"bodies": space.bodies, "constraints": space.constraints, "shapes": space.shapes}
        return {name: len(members) for name, members in sizes.items()} | {"callbacks": self.callbacks}


def motor(linkage: LinkageConstraints, bodies: Bodies) -> "pymunk.SimpleMotor":
    """Return a motor that turns the crank.

    Raises:
        Failure: unsupported, a drive that is no crank's at a constant speed.
    """
    import pymunk

    drive = linkage.scene.drive
    if not isinstance(drive, ConstantSpeed) or linkage.scene.driven_slide is not None:
        raise Failure(Status.unsupported, "pymunk has motors for cranks at a constant speed only")
    return pymunk.SimpleMotor(bodies[drive.body], bodies[GROUND], drive.speed)


def pair(vector: complex) -> tuple[float, float]:
    """Return a vector as a pair of numbers, as pymunk takes it."""
    return vector.real, vector.imag


def _body(linkage: LinkageConstraints, name: str) -> "pymunk.Body":
    import pymunk

    member = linkage.members[name]
    if member.prescribed:
        return pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    return pymunk.Body(member.moved.mass, member.moved.moment)


def _pins(linkage: LinkageConstraints, bodies: Bodies) -> "dict[str, pymunk.Constraint]":
    """Return the pins; a kinematic crank needs none on the ground."""
    import pymunk

    return {
        pin.channel: pymunk.PivotJoint(
            bodies[pin.first],
            bodies[pin.second],
            pair(linkage.arm(pin.first, pin.point)),
            pair(linkage.arm(pin.second, pin.point)),
        )
        for pin in linkage.scene.pins
        if any(bodies[name].body_type == pymunk.Body.DYNAMIC for name in (pin.first, pin.second))
    }


def _grooves(linkage: LinkageConstraints, bodies: Bodies) -> "dict[str, pymunk.Constraint]":
    """Return the guides; a driven slider needs none.

    The engine projects its 2 x 2 solution on the groove's normal, which is exact only if that is an axis of its mass
    matrix: the groove runs through the carrier's centre of mass, and is met at the foot of the perpendicular from the
    slider's. As both stay parallel, it may be any groove parallel to the true one.
    """
    import pymunk

    # No two bodies get further apart than all of them in a row; the ends of a groove would be stops.
    reach = 2 * (len(linkage.members) + 1) * linkage.size
    grooves: dict[str, pymunk.Constraint] = {}
    for name, slide in linkage.slides.items():
        if bodies[name].body_type == pymunk.Body.DYNAMIC:
            along = complex(*slide.along)
            foot = 1j * along * (along.conjugate() * (linkage.first_arm(name) - linkage.through(name))).imag
            grooves[f"{name}.guide_force"] = pymunk.GrooveJoint(
                bodies[slide.on], bodies[name], pair(-reach * along), pair(reach * along), pair(foot)
            )
    return grooves


def _gears(linkage: LinkageConstraints, bodies: Bodies) -> "list[pymunk.GearJoint]":
    """Return the gears that keep the turning sliders parallel to their carriers."""
    import pymunk

    turning = [name for name in linkage.scene.turning if name in linkage.slides]
    return [pymunk.GearJoint(bodies[linkage.slides[name].on], bodies[name], 0, 1) for name in turning]


def _update_velocity(body: "pymunk.Body", gravity: tuple[float, float], damping: float, dt: float) -> None:
    """Update as the engine does; pymunk would replace its own function by the one in C."""
    type(body).update_velocity(body, gravity, damping, dt)


def _shape(linkage: LinkageConstraints, name: str, body: "pymunk.Body") -> "pymunk.Segment":
    """Return a bar from the body's first point to its last, which does not collide with the others."""
    import pymunk

    first, *_, last = [*linkage.members[name].arms.values()] * 2
    shape = pymunk.Segment(body, pair(first), pair(last), linkage.size / 100)
    shape.filter = pymunk.ShapeFilter(group=1)
    return shape
