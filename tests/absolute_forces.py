"""Forces of `absolute_coordinates`: what acts on the bodies, and what holds and drives them."""

from collections.abc import Iterator, Mapping
from math import hypot, pi
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from scenes.elements.tables import LoadCurve
from scenes.scene import GROUND, Force, GuideForce, Load, Moment, PressForce, Spring, TableForce, TorsionSpring

from .absolute_bodies import TURNED, Floats, mass_properties
from .absolute_friction import resistances, resisted

if TYPE_CHECKING:
    from .absolute_coordinates import Absolute


class Wrench(NamedTuple):
    """A force, N, at a place, m, and a moment, N m, on a body or the ground."""

    body: str
    force: Floats
    at: Floats
    moment: float = 0.0


class Instant(NamedTuple):
    """A pose and its rates, where the drive is, when, and how far the torsion springs are twisted, rad."""

    Q: Floats
    dQ: Floats  # noqa: N815
    ddQ: Floats  # noqa: N815
    position: float
    time: float
    twists: Mapping[TorsionSpring, float]


def reactions(model: "Absolute", now: Instant) -> dict[str, float]:
    """Return what holds the bodies and drives them: three equations a body, force, force, moment about its com."""
    scene, names, (Q, dQ, ddQ, *_) = model.scene, list(model.scene.bodies), now
    unknown = [
        name for name in scene.channels.names() if name.endswith((".fx", ".fy", ".guide_force", ".guide_moment"))
    ]
    unknown.append("drive.torque" if scene.drive.slide is None else "drive.force")
    A, b = np.zeros((3 * len(names), len(unknown))), np.zeros(3 * len(names))
    com = {}
    for number, body in enumerate(scene.bodies.values()):
        mass, local, inertia = mass_properties(body, model.local[body.name])
        matrix = model.place(body.name, local)
        com[body.name] = matrix @ Q
        b[3 * number : 3 * number + 2] = mass * (matrix @ ddQ)
        b[3 * number + 2] = inertia * model.turning(body.name, Q, dQ, ddQ)[2]
        if scene.gravity is not None:
            b[3 * number : 3 * number + 2] -= mass * np.asarray(scene.gravity)

    def wrench(body: str, force: Floats, at: Floats, moment: float = 0.0) -> Floats:
        rows = np.zeros(3 * len(names))
        if body != GROUND:
            first, arm = 3 * names.index(body), at - com[body]
            rows[first : first + 3] = *force, arm[0] * force[1] - arm[1] * force[0] + moment
        return rows

    for load in applied(model, now):
        b -= wrench(*load)
    for pin in scene.pins:
        at = model.point(pin.second, pin.point) @ Q
        for axis, of in ((np.array([1.0, 0.0]), "fx"), (np.array([0.0, 1.0]), "fy")):
            column = unknown.index(f"{pin.channel}.{of}")
            A[:, column] = wrench(pin.second, axis, at) - wrench(pin.first, axis, at)
    for name, body in scene.bodies.items():
        if body.slide is not None:
            at, on = model.point(name, body.points[0]) @ Q, body.slide.on
            normal = TURNED @ (model.vector(on, body.slide.along) @ Q)
            A[:, unknown.index(f"{name}.guide_force")] = wrench(name, normal, at) - wrench(on, normal, at)
            couple = wrench(name, np.zeros(2), at, 1.0) - wrench(on, np.zeros(2), at, 1.0)
            A[:, unknown.index(f"{name}.guide_moment")] = couple
    driven = scene.bodies[scene.drive.body]
    at = model.point(driven.name, driven.points[0]) @ Q
    on, slide, push, turn = scene.drive.on, driven.slide, np.zeros(2), 1.0
    if slide is not None:
        push, turn = model.vector(slide.on, slide.along) @ Q, 0.0
    A[:, -1] = wrench(driven.name, push, at, turn) - wrench(on, push, at, turn)

    def between(first: str, second: str, *acts: Any) -> Floats:
        return wrench(second, *acts) - wrench(first, *acts)

    x, friction = resisted(A, b, resistances(model, now, unknown, between))
    return dict(zip(unknown, x.tolist(), strict=True)) | friction


def twists(model: "Absolute", poses: Mapping[float, Floats]) -> dict[TorsionSpring, dict[float, float]]:
    """Return phi of every torsion spring by the position of the drive, continuous, from what it is at the start."""
    start, found = [*poses].index(model.scene.drive.law.start), {}
    for spring in model.scene.torsion_springs:
        u, v = (
            np.array([model.vector(body, (1.0, 0.0)) @ Q for Q in poses.values()]) @ (1, 1j)
            for body in (spring.first, spring.second)
        )
        phi = np.unwrap(np.angle(v / u))
        near = spring.drives(model.scene) * model.scene.drive.law.start
        off = phi[start] - near
        turns = np.ceil(off / (2 * pi) - 0.5) if near == 0 else np.round(off / (2 * pi))
        found[spring] = dict(zip(poses, (phi - 2 * pi * turns).tolist(), strict=True))
    return found


def applied(model: "Absolute", now: Instant) -> Iterator[Wrench]:
    """Yield what every load and spring does, on both bodies between which it acts."""
    for load in model.scene.loads:
        yield from _load(model, load, now)
    for pulling in model.scene.springs:
        yield from _spring(model, pulling, now)
    for spring, phi in now.twists.items():
        rate = spin(model, spring.second, now) - spin(model, spring.first, now)
        moment = spring.stiffness * (spring.angle - phi) - (spring.damping or 0.0) * rate
        for body, sense in ((spring.first, -1), (spring.second, 1)):
            yield Wrench(body, np.zeros(2), np.zeros(2), sense * moment)


def spin(model: "Absolute", body: str, now: Instant) -> float:
    x_axis = model.vector(body, (1.0, 0.0))
    return 0.0 if body == GROUND else float((TURNED @ x_axis @ now.Q) @ (x_axis @ now.dQ))


def _load(model: "Absolute", load: Load, now: Instant) -> Iterator[Wrench]:
    at = model.point(load.body, load.at) @ now.Q
    if isinstance(load, Moment):
        size = float(load.moment or 0.0) if load.table is None else _tabled(model, load.body, load.table, now)
        yield Wrench(load.body, np.zeros(2), at, size)
    elif isinstance(load, Force | TableForce):
        frame = load.body if load.frame == "body" else GROUND
        if isinstance(load, Force):
            vector, size = load.force, 1.0
        else:
            vector, size = load.along, _tabled(model, load.body, load.table, now) / hypot(*load.along)
        yield Wrench(load.body, size * (model.vector(frame, vector) @ now.Q), at)
    elif isinstance(load, PressForce):
        x, v = model.displaced(load.body, now.Q, now.dQ)
        yield Wrench(load.body, float(load.acts(x, v, model.stroke_ends[load])) * np.array(load.force), at)
    else:
        assert isinstance(load, GuideForce)
        slide = model.scene.slides[load.body]
        size = float(load.force or 0.0) if load.table is None else _tabled(model, load.body, load.table, now)
        force = size * (model.vector(slide.on, slide.along) @ now.Q)
        yield Wrench(load.body, force, at)
        yield Wrench(slide.on, -force, at)


def _tabled(model: "Absolute", body: str, table: LoadCurve, now: Instant) -> float:
    match table.over:
        case "drive":
            argument = now.position
        case "time":
            argument = now.time
        case "displacement":
            (argument,) = model.displaced(body, now.Q)
    x, values = table.arguments, table.values
    return float(np.interp(argument, x, values, period=x[-1] - x[0] if table.periodic else None))


def _spring(model: "Absolute", spring: Spring, now: Instant) -> Iterator[Wrench]:
    ends = [model.point(*end) for end in (spring.first, spring.second)]
    way, rate = ((ends[1] - ends[0]) @ of for of in (now.Q, now.dQ))
    free = spring.length / hypot(*way) if spring.length else 0.0
    pull = spring.stiffness * (1 - free) * way
    if spring.damping is not None:
        pull = pull + spring.damping * (way @ rate) / (way @ way) * way
    yield Wrench(spring.first[0], pull, ends[0] @ now.Q)
    yield Wrench(spring.second[0], -pull, ends[1] @ now.Q)
