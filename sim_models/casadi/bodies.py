"""The geometry and inertia of one body; its numbers may be symbols, so no formula branches on them."""

from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any, NamedTuple

import casadi

from scenes import Failure, Scene, Status
from scenes.scene import Body


class CasadiBody(NamedTuple):
    """A body in its own frame, whose origin is its place."""

    points: Mapping[str, Any]  # m, columns of two
    com: Any  # m
    mass: Any  # kg
    inertia: Any  # kg m^2, about the centre of mass


def casadi_body(scene: Scene, body: Body) -> CasadiBody:
    """Return a body of the scene, of 1 kg in a kinematic one.

    Raises:
        Failure: `cannot_assemble`, its lengths do not meet, or the sketch shows no side for one of its points.
    """
    local = body.local or dict(_by_lengths(scene, body))
    points = {name: casadi.vertcat(*local[name]) for name in body.points}
    mass = 1.0 if body.mass is None else body.mass
    if body.com is not None and body.inertia is not None:
        return CasadiBody(points, casadi.vertcat(*body.com), mass, body.inertia)
    # A bar's or a triangle's radius of gyration by the squared distances of its corners: 1/12 and 1/36 of their sum.
    corners = [points[name] for name in body.corners]
    squares = sum(casadi.sumsqr(p - q) for p, q in combinations(corners, 2))
    com = sum(corners) / len(corners)
    return CasadiBody(points, com, mass, mass * squares / (12 if len(corners) == 2 else 36))


def _by_lengths(scene: Scene, body: Body) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Yield the points one after the other; x goes from the first to the second."""
    assert body.lengths is not None
    first, second, *others = body.points
    found = {first: (0.0, 0.0), second: (body.lengths[frozenset((first, second))], 0.0)}
    for apex in others:
        found[apex] = _apex(scene, body, apex, found)
    yield from found.items()


def _apex(scene: Scene, body: Body, apex: str, found: Mapping[str, tuple[Any, Any]]) -> tuple[Any, Any]:
    """Return C at the angle A of triangle ABC from AB: tan(A/2)^2 = (s - b) (s - c) / (s (s - a)), s half the sum."""
    assert body.lengths is not None
    at, to = body.bases(apex)
    (x, y), (u, v) = found[at], found[to]
    b, a = (body.lengths[frozenset((base, apex))] for base in (at, to))
    c = casadi.hypot(u - x, v - y)
    s = (a + b + c) / 2
    tangent2 = (s - b) * (s - c) / (s * (s - a))
    if isinstance(tangent2, float) and not tangent2 > 0:
        reason = f"the lengths of '{body.name}' from {at} and {to} to {apex} do not meet"
        raise Failure(Status.cannot_assemble, reason)
    angle = casadi.atan2(v - y, u - x) + _side(scene, body, at, to, apex) * 2 * casadi.atan(casadi.sqrt(tangent2))
    return x + b * casadi.cos(angle), y + b * casadi.sin(angle)


def _side(scene: Scene, body: Body, *corners: str) -> int:
    """Return +1 where the sketch shows a triangle counter-clockwise, -1 where clockwise."""
    drawn = {**scene.ground, **scene.sketch.points}
    (x1, y1), (x2, y2), (x3, y3) = (drawn[corner] for corner in corners)
    area = (x2 - x1) * (y3 - y1) - (x3 - x1) * (y2 - y1)
    if area == 0:
        reason = f"the sketch shows {', '.join(corners)} of '{body.name}' on one line, on no side of it"
        raise Failure(Status.cannot_assemble, reason)
    return 1 if area > 0 else -1
