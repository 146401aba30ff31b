"""A scene's bodies: their points, masses and moments of inertia. Plane vectors are complex numbers x + iy."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
import pymunk

from scenes import Failure, Scene, Status
from scenes.scene import Body


@dataclass(frozen=True)
class PymunkBody:
    """A moving body: points and centre of mass in a frame of its own, m; in a kinematic scene it has no mass."""

    points: Mapping[str, complex]
    com: complex
    mass: float  # kg
    inertia: float  # kg m^2, about the centre of mass

    @property
    def size(self) -> float:
        """The largest distance of two points, m."""
        return max(abs(p - q) for p in self.points.values() for q in self.points.values())

    def about(self, origin: complex) -> "PymunkBody":
        """The body in a frame with another origin, m."""
        points = {point: place - origin for point, place in self.points.items()}
        return replace(self, points=points, com=self.com - origin)


def rigid(scene: Scene, body: Body) -> PymunkBody:
    """A body of the scene, in its frame there; Failure where its lengths do not close, or nothing shows how."""
    points = {point: complex(*place) for point, place in (body.local or {}).items()}
    if body.lengths is not None:  # each point by its distances from two before it
        first, second, *others = body.points
        points = {first: 0j, second: complex(body.lengths[frozenset((first, second))])}
        for point in others:
            points[point] = _apex(scene, body, point, points)
    return PymunkBody(points, *_mass_properties(body, points))


def _apex(scene: Scene, body: Body, c: str, frame: Mapping[str, complex]) -> complex:
    """Place c, m, at its distances from its bases a and b, on the side of a -> b that the sketch shows."""
    assert body.lengths is not None
    a, b = body.bases[c]
    base = frame[b] - frame[a]
    ab, ac, bc = abs(base), body.lengths[frozenset((a, c))], body.lengths[frozenset((b, c))]
    A, B, C = (scene.drawn[point] for point in (a, b, c))
    side = np.sign((np.conj(B - A) * (C - A)).imag)
    if side == 0:
        reason = f"the sketch shows {a}, {b}, {c} of '{body.name}' in line, not which way round"
        raise Failure(Status.cannot_assemble, reason)
    # Sixteen times the squared area by Heron's formula, which stays accurate for a flat triangle.
    heron = (ab + ac + bc) * (ab + ac - bc) * (ab - ac + bc) * (-ab + ac + bc)
    if not (heron > 0 and ab > 0):
        raise Failure(Status.cannot_assemble, f"the lengths from {a} and {b} to {c} of '{body.name}' do not meet")
    return frame[a] + base / ab * complex((ab**2 + ac**2 - bc**2) / (2 * ab), side * sqrt(heron) / (2 * ab))


def _mass_properties(body: Body, points: Mapping[str, complex]) -> tuple[complex, float, float]:
    """The centre of mass, m, the mass, kg, and the moment of inertia about the centre, kg m^2."""
    places = np.array([points[point] for point in body.corners])
    centroid = complex(places.mean())
    if body.mass is None:
        return centroid, 0.0, 0.0
    if body.com is not None and body.inertia is not None:
        return complex(*body.com), body.mass, body.inertia
    match [(float(arm.real), float(arm.imag)) for arm in places - centroid]:
        case [_]:
            inertia = 0.0
        case [a, b]:
            inertia = pymunk.moment_for_segment(body.mass, a, b, 0)
        case triangle:
            inertia = pymunk.moment_for_poly(body.mass, triangle)
    return centroid, body.mass, inertia
