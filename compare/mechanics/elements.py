"""What acts on each body of a motion: loads and springs, a function a kind, its weight, and its joints and drive.

This is all that the judge knows of them: the balance of forces and moments of each body, and the power of each.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes.elements.friction import Friction, GuideFriction, PinFriction
from scenes.elements.loads import Force, ForceTable, GuideForce, Load, Moment, PressForce, TableForce
from scenes.elements.springs import Spring, TorsionSpring
from scenes.elements.tables import LoadCurve
from scenes.model.motion import Samples
from scenes.scene import GROUND, Body

from .bodies import inertia
from .motion_vectors import MotionVectors, Vectors, press_forces
from .turns import twist

Element: TypeAlias = Load | Spring | TorsionSpring | Friction


class AppliedForce(NamedTuple):
    """A force, where it attacks, and how fast that point of the body moves; shape (n,), N, m, m/s; and a moment."""

    force: Vectors
    at: Vectors
    velocity: Vectors
    name: str
    moment: Samples | float = 0.0  # N m


class LoadedBody(NamedTuple):
    """A body of a motion: what acts on it, and how it moves; arrays of shape (n,)."""

    mass: float  # kg
    inertia: float  # kg m^2, about the centre of mass
    applied: Sequence[AppliedForce]
    pushes: Sequence[tuple[Vectors, Vectors]]  # these and the forces of joints, with their points of attack
    couple: Samples  # N m, of all
    com: Vectors
    velocity: Vectors  # of the centre of mass, as the acceleration
    acceleration: Vectors
    omega: Samples
    alpha: Samples


def applied(state: MotionVectors, body: Body) -> Iterator[AppliedForce]:
    """Yield what acts on a body from without: loads, springs, friction, gravity."""
    scene = state.scene
    for element in (*(own for _, own in scene.elements), *scene.friction):
        yield from of_element(state, element, body.name)
    if scene.gravity is not None:
        z, v, _ = state.com(body)
        weight = np.full(z.shape, (body.mass or 0.0) * complex(*scene.gravity))
        yield AppliedForce(weight, z, v, f"the weight of {body.name}")


def of_element(state: MotionVectors, element: Element, name: str) -> Iterator[AppliedForce]:
    """Yield what a load, a spring or friction does on the body of a name."""
    yield from _KINDS.get(type(element), _of_force)(state, element, name)


def _of_force(state: MotionVectors, load: Load, name: str) -> Iterator[AppliedForce]:
    if load.body == name:
        z, v, _ = state.point(load.at)
        yield AppliedForce(force(state, load), z, v, f"the load at {load.at}")


def _of_guide_force(state: MotionVectors, load: GuideForce, name: str) -> Iterator[AppliedForce]:
    yield from _of_force(state, load, name)
    if name == state.scene.slides[load.body].on:
        z = state.place(load.at)
        yield AppliedForce(-force(state, load), z, state.carried(name, z), f"the reaction of the load at {load.at}")


def _of_moment(state: MotionVectors, load: Moment, name: str) -> Iterator[AppliedForce]:
    if load.body == name:
        yield _turning(state, load.at, f"the moment on {name}", _size(state, load, load.moment))


def _of_spring(state: MotionVectors, spring: Spring, name: str) -> Iterator[AppliedForce]:
    for (body, point), (_, other) in ((spring.first, spring.second), (spring.second, spring.first)):
        if body == name:
            z, v, _ = state.point(point)
            towards = state.place(other) - z
            distance = np.abs(towards)
            unit = towards / np.where(distance > 0, distance, 1.0)
            ends = " and ".join(".".join(end) for end in (spring.first, spring.second))
            pull = spring.stiffness * (distance - spring.length)
            if spring.damping is not None:
                pull = pull + spring.damping * ((state.place(other, "v") - v) * unit.conj()).real
            yield AppliedForce(pull * unit, z, v, f"the spring between {ends}")


def _of_torsion_spring(state: MotionVectors, spring: TorsionSpring, name: str) -> Iterator[AppliedForce]:
    for body, sign in ((spring.first, -1), (spring.second, 1)):
        if body == name:
            rate = state.turning(spring.second)[1] - state.turning(spring.first)[1]
            on_second = spring.moment(twist(state, spring), rate)
            yield _turning(state, spring.at, f"the torsion spring at {spring.at}", sign * on_second)


def _of_pin_friction(state: MotionVectors, one: PinFriction, name: str) -> Iterator[AppliedForce]:
    pin, channel = one.pin(state.scene), one.channel(state.scene)
    for body, sign in ((pin.first, -1), (pin.second, 1)):
        if body == name:
            yield _turning(state, pin.point, f"the friction of {channel}", sign * state.motion[channel])


def _of_guide_friction(state: MotionVectors, one: GuideFriction, name: str) -> Iterator[AppliedForce]:
    slider, channel = state.scene.bodies[one.slider], one.channel(state.scene)
    z, v, _ = state.point(slider.points[0])
    force, called = state.motion[channel] * state.along(slider), f"the friction of {channel}"
    if name == one.slider:
        yield AppliedForce(force, z, v, called)
    elif name == state.scene.slides[one.slider].on:
        yield AppliedForce(-force, z, state.carried(name, z), called)


_KINDS: Mapping[type, Callable[[MotionVectors, Any, str], Iterator[AppliedForce]]] = {
    GuideForce: _of_guide_force,
    Moment: _of_moment,
    Spring: _of_spring,
    TorsionSpring: _of_torsion_spring,
    PinFriction: _of_pin_friction,
    GuideFriction: _of_guide_friction,
}


def _turning(state: MotionVectors, at: str, name: str, moment: Samples | float) -> AppliedForce:
    z, v, _ = state.point(at)
    return AppliedForce(np.zeros_like(z), z, v, name, moment + np.zeros(z.shape))


def force(state: MotionVectors, load: Load) -> Vectors:
    """The force of a load on its body, N, in the ground's frame; not of a moment."""
    body = state.scene.bodies[load.body]
    match load:
        case ForceTable() | GuideForce():
            value: Any = _size(state, load, getattr(load, "force", None)) * state.along(body)
        case TableForce():
            value = _size(state, load) * complex(*load.direction)
        case Force() | PressForce():
            value = complex(*load.force)
        case Moment():
            value = 0j
    vectors: Vectors = np.full(state.motion["time"].shape, value)
    if isinstance(load, PressForce):
        acting = zip(state.acting, press_forces(state.scene), strict=True)
        vectors = next(share for share, one in acting if one is load) * vectors
    return vectors * np.exp(1j * state.angle(load.body)) if getattr(load, "frame", GROUND) == "body" else vectors


def _size(
    state: MotionVectors, load: ForceTable | GuideForce | TableForce | Moment, constant: float | None = None
) -> Any:
    return constant if load.table is None else load.table.at(argument(state, load.body, load.table))


def argument(state: MotionVectors, body: str, table: LoadCurve) -> Samples:
    """What a table on a body is over: the drive's position, the time, or the displacement on the guide."""
    if table.over == "displacement":
        return state.on_guide(state.scene.bodies[body]).real
    return state.motion["time" if table.over == "time" else state.scene.drive_channel]


def loaded_bodies(state: MotionVectors) -> dict[str, LoadedBody]:
    """All bodies of a motion that has every channel, by name."""
    scene, motion, names = state.scene, state.motion, (*state.scene.bodies, GROUND)
    pushes: dict[str, list[tuple[Vectors, Vectors]]] = {name: [] for name in names}
    couples = dict.fromkeys(names, np.zeros(motion["time"].shape))

    def act(on: str, other: str, at: str, force: Vectors, couple: Samples | float = 0.0) -> None:
        for name, sign in ((on, 1), (other, -1)):
            pushes[name].append((sign * force, state.place(at)))
            couples[name] = couples[name] + sign * couple

    for pin in scene.pins:
        act(pin.second, pin.first, pin.point, state.vector(f"{pin.channel}.", "fx", "fy"))
    for name, slide in scene.slides.items():
        force = motion[f"{name}.guide_force"] * 1j * state.along(scene.bodies[name])
        act(name, slide.on, scene.bodies[name].points[0], force, motion[f"{name}.guide_moment"])
    driven, effort = scene.bodies[scene.drive.body], motion[scene.effort_channel]
    push: Vectors = np.zeros(effort.shape, np.complex128) if driven.slide is None else effort * state.along(driven)
    torque = effort if driven.slide is None else 0.0
    act(driven.name, scene.drive_on, driven.points[0], push, torque)
    moving = {}
    for name, body in scene.bodies.items():
        own = [*applied(state, body)]
        every = [*pushes[name], *((push.force, push.at) for push in own)]
        couple = couples[name] + sum(push.moment for push in own)
        weights, turning = (body.mass or 0.0, inertia(body)), state.turning(name)[1:]
        moving[name] = LoadedBody(*weights, own, every, couple, *state.com(body), *turning)
    return moving


def drive_power(state: MotionVectors) -> Samples:
    """The power of the drive, W: its torque or force by the rate of its body against that on which it stands."""
    body, on = state.scene.bodies[state.scene.drive.body], state.scene.drive_on
    rate = state.turning(body.name)[1] - state.turning(on)[1] if body.slide is None else state.sliding(body)
    return state.motion[state.scene.effort_channel] * rate
