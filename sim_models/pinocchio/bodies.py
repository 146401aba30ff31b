"""The geometry and inertia of one body. Points of its plane are complex numbers, x + iy."""

from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np

from scenes import Failure, Scene, Status
from scenes.scene import Body

ITERATIONS = 60  # for a point by two distances; a flat triangle gains one bit in each
CLOSED = 1e-15  # of a squared distance


class PinocchioBody(NamedTuple):
    """A body in its own frame."""

    points: Mapping[str, complex]  # m
    com: complex  # m
    mass: float  # kg
    inertia: float  # kg m^2, about the centre of mass


def pinocchio_body(scene: Scene, body: Body) -> PinocchioBody:
    """Return a body of the scene, of 1 kg in a kinematic one.

    Raises:
        Failure: `cannot_assemble`, its lengths do not meet, or the sketch shows no side for one of its points.
    """
    if body.local is not None:
        points = {name: complex(*at) for name, at in body.local.items()}
    else:
        assert body.lengths is not None
        first, second, *others = body.points
        points = {first: 0j, second: complex(body.lengths[frozenset((first, second))])}
        for apex in others:
            points[apex] = _met(scene, body, apex, points)
    mass = 1.0 if body.mass is None else body.mass
    if body.com is not None and body.inertia is not None:
        return PinocchioBody(points, complex(*body.com), mass, body.inertia)
    corners = np.array([points[name] for name in body.corners])
    squares = sum(abs(p - q) ** 2 for p, q in combinations(corners, 2))
    return PinocchioBody(points, complex(corners.mean()), mass, mass * squares / (12 if len(corners) == 2 else 36))


def _met(scene: Scene, body: Body, apex: str, points: Mapping[str, complex]) -> complex:
    """Return the point at two distances from others, by Newton's method from the side on which the sketch shows it."""
    assert body.lengths is not None
    drawn = {name: complex(*at) for name, at in (*scene.ground.items(), *scene.sketch.points.items())}
    names = body.bases(apex)
    A, B = (points[name] for name in names)
    a, b = (body.lengths[frozenset((name, apex))] for name in names)
    side = np.sign((np.conj(drawn[names[1]] - drawn[names[0]]) * (drawn[apex] - drawn[names[0]])).imag)
    if side == 0:
        reason = f"the sketch shows {names[0]}, {names[1]}, {apex} of '{body.name}' on one line, on no side of it"
        raise Failure(Status.cannot_assemble, reason)
    C = (A + B) / 2 + side * 1j * (B - A)
    for _ in range(ITERATIONS):
        p, q = C - A, C - B
        gaps = np.array([abs(p) ** 2 - a**2, abs(q) ** 2 - b**2])
        C -= complex(*np.linalg.solve(2 * np.array([[p.real, p.imag], [q.real, q.imag]]), gaps))
        if np.abs(gaps).max() <= CLOSED * max(a, b) ** 2:
            return complex(C)
    reason = f"the lengths of '{body.name}' from {names[0]} and {names[1]} to {apex} do not meet"
    raise Failure(Status.cannot_assemble, reason)
