"""What acts on each body of a motion: loads and springs, a rule for each type, its weight, and its joints and drive.

This is all that the judge knows of them: the balance of forces and moments of each body, and the power of each.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache
from math import ceil, pi
from typing import Any, NamedTuple

import numpy as np

from scenes import Failure, Motion, Scene
from scenes.elements.constant_force_springs import ConstantForceSpring
from scenes.elements.element import Element
from scenes.elements.friction import GuideFriction, PinFriction
from scenes.elements.loads import (
    Force,
    ForceTable,
    GuideForce,
    Load,
    Moment,
    PressForce,
    TabledLoad,
    TableForce,
    TurningForce,
)
from scenes.elements.springs import Damper, PointPair, Spring, TorsionSpring
from scenes.elements.tables import LoadCurve
from scenes.joints import Joint
from scenes.model.inputs import inputs_of, passing
from scenes.model.motion import Samples
from scenes.scene import GROUND, Body

from ..engines import registry
from .bodies import inertia
from .joints import RULES as JOINTS
from .mechanics import Mechanics
from .motion_vectors import MotionVectors, Vectors

STEPS = 3600  # of a cycle: from one to the next no angle comes near to half a turn
HALF_TURN_TOL = 1e-9  # rad: what rounding makes of half a turn, which counts as that, not as its opposite


class Push(NamedTuple):
    """A force on a body, N, where it attacks, m, and a moment, N m; arrays of shape (n,)."""

    body: str
    force: Vectors
    at: Vectors
    moment: Samples | float = 0.0
    velocity: Vectors | float = 0.0  # of that point of the body, m/s
    name: str = ""


def applied(state: MotionVectors) -> Iterator[Push]:
    """Yield what acts on the bodies from without: loads, springs, friction, gravity."""
    scene = state.scene
    for _, element in scene.listed:
        if not isinstance(element, Joint):
            yield from of_element(state, element)
    if scene.gravity is not None:
        yield from (weight(state, body) for body in scene.bodies.values())


def weight(state: MotionVectors, body: Body) -> Push:
    """What gravity does on a body, if there is any."""
    z, v, _ = state.com(body)
    force = np.full(z.shape, (body.mass or 0.0) * complex(*(state.scene.gravity or ())))
    return Push(body.name, force, z, 0.0, v, f"the weight of {body.name}")


def of_element(state: MotionVectors, element: Element) -> Iterator[Push]:
    """Yield what a load, a spring or friction does on the bodies; what it does on the ground is left out."""
    yield from (push for push in RULES[type(element)](state, element) if push.body != GROUND)


def generalised(state: MotionVectors, pushes: Iterable[Push], arm: float) -> Samples:
    """The generalised forces of pushes, shape (n, 3 bodies): of each body its force by an arm, m, and its moment, N m.

    Moments are about the first points of the bodies; what is on the ground does nothing.
    """
    order = {name: number for number, name in enumerate(state.scene.bodies)}
    forces = np.zeros((len(state.motion["time"]), len(order), 3))
    for push in (push for push in pushes if push.body in order):
        # Moment about the first point: z-component of lever x force, as conj(lever) force has it in its imaginary part.
        lever = push.at - state.place(state.scene.bodies[push.body].points[0])
        turning = (lever.conjugate() * push.force).imag + push.moment
        acting = np.broadcast_arrays(arm * push.force.real, arm * push.force.imag, turning)
        forces[:, order[push.body]] += np.stack(acting, axis=1)
    return forces.reshape(len(forces), -1)


def force(state: MotionVectors, load: Load) -> Vectors:
    """The force of a load on its body, N, in the ground's frame."""
    return next(of_element(state, load)).force


def _of_load(state: MotionVectors, load: Load, value: Any) -> Push:
    """A force at the point of a load, N, constant or of shape (n,)."""
    z, v, _ = state.point(load.at)
    return Push(load.body, np.full(z.shape, value), z, 0.0, v, load.label)


def _of_force(state: MotionVectors, load: Force) -> Iterator[Push]:
    yield _of_load(state, load, complex(*load.force))


def _of_turning_force(state: MotionVectors, load: TurningForce) -> Iterator[Push]:
    yield _of_load(state, load, complex(*load.force) * np.exp(1j * state.angle(load.body)))


def _of_press(state: MotionVectors, load: PressForce) -> Iterator[Push]:
    acting = zip(state.acting, state.scene.presses.values(), strict=True)
    yield _of_load(state, load, next(share for share, press in acting if press is load) * complex(*load.force))


def _of_guide_force(state: MotionVectors, load: GuideForce) -> Iterator[Push]:
    push = _of_load(state, load, _size(state, load, load.force) * state.along(state.scene.bodies[load.body]))
    yield push
    on, name = state.scene.slides[load.body].on, f"the reaction of {load.label}"
    yield Push(on, -push.force, push.at, 0.0, state.carried(on, push.at), name)


def _by_table(state: MotionVectors, load: TableForce) -> Iterator[Push]:
    value = _size(state, load) * complex(*load.direction)
    yield _of_load(state, load, value * np.exp(1j * state.angle(load.body)) if load.frame == "body" else value)


def _of_moment(state: MotionVectors, load: Moment) -> Iterator[Push]:
    yield _turning(state, load.body, load.at, load.label, _size(state, load, load.moment))


def _of_spring(state: MotionVectors, spring: Spring) -> Iterator[Push]:
    def pull(distance: Samples, rate: Samples) -> Samples:
        pull = spring.stiffness * (distance - spring.length)
        return pull if spring.damping is None else pull + spring.damping * rate

    return pulled(state, spring, pull)


def pulled(
    state: MotionVectors, pair: PointPair, pull: Callable[[Samples, Samples], Samples | float]
) -> Iterator[Push]:
    """Yield what pulls two points together: by their distance, m, and its rate, m/s, each of shape (n,)."""
    for (body, point), (_, other) in (pair.ends, pair.ends[::-1]):
        # The pull is along the line between the points; at zero distance it has no direction and is taken as none.
        z, v, _ = state.point(point)
        towards = state.place(other) - z
        distance = np.abs(towards)
        unit = towards / np.where(distance > 0, distance, 1.0)
        rate = ((state.place(other, 1) - v) * unit.conj()).real
        yield Push(body, pull(distance, rate) * unit, z, 0.0, v, pair.label)


def _of_torsion_spring(state: MotionVectors, spring: TorsionSpring) -> Iterator[Push]:
    rate = state.turning(spring.second)[1] - state.turning(spring.first)[1]
    on_second = spring.moment(twist(state, spring), rate)
    for body, sign in ((spring.first, -1), (spring.second, 1)):
        yield _turning(state, body, spring.at, spring.label, sign * on_second)


def twist(state: MotionVectors, spring: TorsionSpring) -> Samples:
    """The angle of a torsion spring, rad, shape (n,), on over whole turns: these count, and no pose shows them."""
    scene, position = state.scene, state.motion[state.scene.channels.drive.position]
    within = state.angle(spring.second) - state.angle(spring.first)
    if sign := spring.drives(scene):
        near = sign * position
    else:
        try:
            # A pose shows the angle modulo a turn. Which turn it is follows from the course of the angle over one cycle
            # of the reference, continued by what a cycle gains; the motion's own angle then only corrects within half a
            # turn.
            places, angles = _course(scene, spring)
        except Failure:  # no other motion is known than this one
            return np.unwrap(np.remainder(within + pi, 2 * pi) - pi)
        once = 2 * pi * round(float(scene.drive.law.after(1.0) - scene.drive.law.after(0.0)) / (2 * pi))
        cycles = np.floor((position - places[0]) / abs(once)) if scene.periodic and once else 0.0
        gain = np.interp(places[0] + abs(once), places, angles) - angles[0]  # whole turns
        near = np.interp(position - cycles * abs(once), places, angles) + cycles * gain
    return np.asarray(near + np.remainder(within - near + pi, 2 * pi) - pi)


@lru_cache(maxsize=16)
def _course(scene: Scene, spring: TorsionSpring) -> tuple[Samples, Samples]:
    """Positions of the drive over one cycle, increasing, and the angles there, from - pi to pi at time zero."""
    places, signs = np.linspace(*scene.drive.law.extent, STEPS + 1), {spring.second: 1, spring.first: -1}
    names = {scene.channels.bodies[body].angle: sign for body, sign in signs.items() if body in scene.turning}
    motion = registry.reference(scene, frozenset(names))(passing(scene, places, np.zeros_like(places)))
    turning = (sign * motion[name] for name, sign in names.items())
    # Samples are dense enough that no angle moves by half a turn between two. The start is put within (-pi, pi].
    angles = np.unwrap(sum(turning, np.zeros_like(places)))
    start = float(np.interp(inputs_of(scene, 0.0).driven().position, places, angles))
    return places, angles - 2 * pi * ceil((start - pi - HALF_TURN_TOL) / (2 * pi))


def _of_pin_friction(state: MotionVectors, friction: PinFriction) -> Iterator[Push]:
    channel = friction.channel(state.scene)
    for body, sign in zip(friction.joined(state.scene), (-1, 1), strict=True):
        yield _turning(state, body, friction.at, f"the friction of {channel}", sign * state.motion[channel])


def _of_guide_friction(state: MotionVectors, friction: GuideFriction) -> Iterator[Push]:
    (on, slider), channel = friction.joined(state.scene), friction.channel(state.scene)
    body = state.scene.bodies[slider]
    z, v, _ = state.point(body.points[0])
    force, called = state.motion[channel] * state.along(body), f"the friction of {channel}"
    yield Push(slider, force, z, 0.0, v, called)
    yield Push(on, -force, z, 0.0, state.carried(on, z), called)


def _of_constant_force_spring(state: MotionVectors, spring: ConstantForceSpring) -> Iterator[Push]:
    return pulled(state, spring, lambda _distance, _rate: spring.force)


RULES: Mapping[type[Element], Callable[[MotionVectors, Any], Iterator[Push]]] = {
    Force: _of_force,
    TurningForce: _of_turning_force,
    PressForce: _of_press,
    GuideForce: _of_guide_force,
    ForceTable: _of_guide_force,
    TableForce: _by_table,
    Moment: _of_moment,
    Spring: _of_spring,
    Damper: _of_spring,
    TorsionSpring: _of_torsion_spring,
    PinFriction: _of_pin_friction,
    GuideFriction: _of_guide_friction,
    ConstantForceSpring: _of_constant_force_spring,
}


def _turning(state: MotionVectors, body: str, point: str, name: str, moment: Samples | float) -> Push:
    z, v, _ = state.point(point)
    return Push(body, np.zeros_like(z), z, moment + np.zeros(z.shape), v, name)


def _size(state: MotionVectors, load: TabledLoad, constant: float | None = None) -> Any:
    return constant if load.table is None else load.table.at(argument(state, load.body, load.table))


def argument(state: MotionVectors, body: str, table: LoadCurve) -> Samples:
    """What a table on a body is over: the drive's position, the time, or the displacement on the guide."""
    if table.over == "displacement":
        return state.on_guide(state.scene.bodies[body]).real
    return state.motion["time" if table.over == "time" else state.scene.channels.drive.position]


def inertial(state: MotionVectors) -> Iterator[Push]:
    """Yield the inertia of each body as a force and a couple on it, against its accelerations (d'Alembert)."""
    for name, body in state.scene.bodies.items():
        # d'Alembert: with the inertia as a push, each body's forces and moments add up to zero.
        about_com = inertia(body)
        z, v, a = state.com(body)
        couple = -about_com * state.angle(name, 2)
        yield Push(name, -(body.mass or 0.0) * a, z, couple, v, f"the inertia of {name}")


def magnitudes(mechanics: Mechanics, motion: Motion) -> dict[str, Samples]:
    """By name the magnitude of each load, spring, weight and inertia, N, shape (n,); none in a scene without forces.

    They are what the joints' forces and the drive's effort are the sums of. Moments are by an arm of the linkage's
    largest length. Press forces count as acting.
    """
    if not mechanics.forces:
        return {}
    everywhere = [np.ones(motion["time"].shape, bool) for _ in mechanics.presses]
    state = MotionVectors(mechanics.scene, motion, everywhere)
    pushes = (*applied(state), *inertial(state))
    return {push.name: np.abs(push.force) + np.abs(push.moment) / mechanics.size for push in pushes}


def of_joints(state: MotionVectors) -> Iterator[Push]:
    """Yield what pins, guides and the drive do on the bodies that they are between."""
    for joint in state.scene.joints:
        for body, other, place, force, moment in JOINTS[type(joint)].acts(joint, state):
            both = Push(body, force, place, moment), Push(other, -force, place, -moment)
            yield from (push for push in both if push.body != GROUND)


def power_of(state: MotionVectors, push: Push) -> Samples:
    """The power of what acts on a body from without, or of its inertia, W."""
    return (push.velocity.conjugate() * push.force).real + push.moment * state.angle(push.body, 1)


def drive_power(state: MotionVectors) -> Samples:
    """The power of the drives, W: a torque or force by the rate of its body against that on which it stands."""
    known = (JOINTS[type(joint)].power(joint, state) for joint in state.scene.joints)
    return np.asarray(np.sum([power for power in known if power is not None], axis=0), np.float64)
