"""The geometry and inertia of one body; its numbers may be symbols, so no formula branches on them."""

from collections.abc import Mapping
from itertools import combinations
from math import dist
from typing import Any, NamedTuple, TypeAlias

from scenes import Failure, Scene, Status
from scenes.scene import Body

Place: TypeAlias = tuple[Any, Any]  # x and y, m


class FramedBody(NamedTuple):
    """A body in its own frame."""

    points: Mapping[str, Place]
    com: Place
    mass: Any  # kg
    inertia: Any  # kg m^2, about the centre of mass


def framed_body(scene: Scene, body: Body) -> FramedBody:
    """Return a body of the scene, of 1 kg in a kinematic one.

    Raises:
        Failure: `cannot_assemble`, its lengths do not meet, or the sketch shows no side for one of its points.
    """
    points = dict(body.local or {})
    if body.lengths is not None:
        first, second, *others = body.points
        points = {first: (0.0, 0.0), second: (body.lengths[frozenset((first, second))], 0.0)}
        for apex in others:
            points[apex] = _apex(scene, body, apex, points)
    mass = 1.0 if body.mass is None else body.mass
    if body.com is not None and body.inertia is not None:
        return FramedBody(points, body.com, mass, body.inertia)
    # A bar's or a triangle's radius of gyration by the squared distances of its corners: 1/12 and 1/36 of their sum.
    corners = [points[name] for name in body.corners]
    squares = sum((p - r) ** 2 + (q - s) ** 2 for (p, q), (r, s) in combinations(corners, 2))
    com = tuple(sum(axis) / len(corners) for axis in zip(*corners, strict=True))
    return FramedBody(points, com, mass, mass * squares / (12 if len(corners) == 2 else 36))


def linkage_size(scene: Scene, bodies: Mapping[str, FramedBody]) -> float:
    """Return the largest distance of two points of one body or of the ground, or a driven slider's travel, m."""
    frames = [[*scene.ground.values()], *([*body.points.values()] for body in bodies.values())]
    least, most = scene.drive.extent if scene.driven_slide is not None else (0.0, 0.0)
    return max(most - least, *(dist(p, q) for points in frames for p, q in combinations(points, 2)), 0.0)


def _apex(scene: Scene, body: Body, apex: str, points: Mapping[str, Place]) -> Place:
    """Return C of a triangle ABC by its sides: its height over AB is by Heron's formula, in factors."""
    assert body.lengths is not None
    base = body.bases(apex)
    (x, y), (u, v) = (points[name] for name in base)
    b, a = (body.lengths[frozenset((name, apex))] for name in base)
    c = ((u - x) ** 2 + (v - y) ** 2) ** 0.5
    squared = (a + b + c) * (b + c - a) * (a + c - b) * (a + b - c)  # 16 times that of the area
    drawn = {name: complex(*at) for name, at in (*scene.ground.items(), *scene.sketch.points.items())}
    A, B, C = (drawn[name] for name in (*base, apex))
    side = ((B - A).conjugate() * (C - A)).imag
    if side == 0 or (isinstance(squared, float) and not squared > 0):
        why = "do not meet" if side else "are on no side of it: the sketch shows them on one line"
        raise Failure(
            Status.cannot_assemble, f"the lengths of '{body.name}' from {base[0]} and {base[1]} to {apex} {why}"
        )
    along, across = (b**2 + c**2 - a**2) / (2 * c**2), squared**0.5 / (2 * c**2) * (1 if side > 0 else -1)
    return x + along * (u - x) - across * (v - y), y + along * (v - y) + across * (u - x)
