"""The geometry and inertia of one body. Points of its plane are complex numbers, x + iy."""

from cmath import acos, exp, phase
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from scenes import Failure, Scene, Status
from scenes.scene import Body

LEAST_INERTIA = 1e-9  # of m l^2: MuJoCo has no body without one


class MujocoBody(NamedTuple):
    """A body in its own frame."""

    points: Mapping[str, complex]  # m
    com: complex  # m
    mass: float  # kg
    inertia: float  # kg m^2, about the centre of mass


def mujoco_body(scene: Scene, body: Body) -> MujocoBody:
    """Return a body of the scene, of 1 kg in a kinematic one.

    Raises:
        Failure: `unsupported`, it has no mass; `cannot_assemble`, its lengths do not meet, or the sketch shows no side
            for one of its points.
    """
    mass = 1.0 if body.mass is None else body.mass
    if mass == 0:
        raise Failure(Status.unsupported, f"'{body.name}' has no mass, and MuJoCo moves no body without")
    points = _local(scene, body)
    places = np.array([points[name] for name in body.corners])
    if body.com is not None and body.inertia is not None:
        return MujocoBody(points, complex(*body.com), mass, body.inertia)
    com = complex(places.mean())
    # About the mean of its corners a bar has 1/6, a triangular plate 1/12 of their squared distances from it.
    about = float((np.abs(places - com) ** 2).sum()) / (6 if len(places) == 2 else 12)
    return MujocoBody(points, com, mass, mass * about)


def _local(scene: Scene, body: Body) -> Mapping[str, complex]:
    """Return the points as given, or by the law of cosines: a triangle's angle at A from its three sides."""
    if body.local is not None:
        return {name: complex(*at) for name, at in body.local.items()}
    assert body.lengths is not None
    first, second, *others = body.points
    points = {first: 0j, second: complex(body.lengths[frozenset((first, second))])}
    drawn = {name: complex(*at) for name, at in (*scene.ground.items(), *scene.sketch.points.items())}
    for apex in others:
        at, to = body.bases(apex)
        b, a = (body.lengths[frozenset((base, apex))] for base in (at, to))
        base = points[to] - points[at]
        cosine = (b**2 + abs(base) ** 2 - a**2) / (2 * b * abs(base))
        side = np.sign(((drawn[to] - drawn[at]).conjugate() * (drawn[apex] - drawn[at])).imag)
        if not (abs(cosine) < 1 and side):
            why = "do not meet" if side else "lie on one line in the sketch"
            raise Failure(Status.cannot_assemble, f"'{body.name}': {at}, {to} and {apex} {why}")
        points[apex] = points[at] + b * exp(1j * (phase(base) + side * acos(cosine).real))
    return points
