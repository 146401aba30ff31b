"""The scene's bodies as rigid ones: their points about the centre of mass, mass and inertia.

A point of the plane is a complex number, x + iy.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import copysign, log2, sqrt

import numpy as np

from scenes import Failure, Scene, Status
from scenes.scene import Body

LIGHTER = 2.0**30  # times are the bodies of a kinematic scene than their unit of force suggests


@dataclass(frozen=True)
class ExudynBody:
    """A body with its points measured from its centre of mass, along its own axes."""

    com: complex  # m, in the scene's frame of the body, whose axes are the same
    points: Mapping[str, complex]  # m
    mass: float  # kg
    inertia: float  # kg m^2, about the centre of mass


def rigid_body(scene: Scene, body: Body) -> ExudynBody:
    """Take a body of the scene; without a mass it gets 1 kg, since a driven motion does not depend on it."""
    points = _local_points(scene, body)
    mass = 1.0 if body.mass is None else body.mass
    if body.com is None or body.inertia is None:
        com, inertia = _uniform(mass, [points[point] for point in body.corners])
    else:
        com, inertia = complex(*body.com), body.inertia
    return ExudynBody(com, {name: point - com for name, point in points.items()}, mass, inertia)


def linkage_size(scene: Scene, bodies: Mapping[str, ExudynBody]) -> float:
    """The longest distance of a centre of mass to a point or between ground points, or a driven slider's travel, m."""
    arms = [abs(point) for body in bodies.values() for point in body.points.values()]
    ground = [complex(*point) for point in scene.ground.values()]
    travels = [drive.span for drive in scene.drives if drive.slide is not None]
    return max(0.0, *travels, *arms, *(abs(p - q) for p in ground for q in ground))


def force_unit(scene: Scene, bodies: Mapping[str, ExudynBody], size: float) -> float:
    """Choose about as large a force as any in the linkage, N; a power of two, by which one divides exactly.

    Exudyn ends Newton's method by a norm of forces and of gaps in joints, m, together, and factorises a matrix of
    masses over h^2 and of directions: neither may hide the other, whatever sizes, speeds and masses are. In a kinematic
    scene the gaps alone count: near a singular configuration, the round-off of forces would keep the norm up.
    """
    # Inertia forces of the order mass times size times pace^2, gravity, and what springs and loads can reach; their
    # largest, rounded to a power of two in the logarithm.
    rate = scene.pace
    acceleration = size * rate**2 + float(np.hypot(*(scene.gravity or (0.0, 0.0))))
    forces = [body.mass * acceleration for body in bodies.values()]
    forces += [element.strength(size, rate) for _, element in scene.elements]
    largest = max(forces) * (1.0 if scene.has_masses else LIGHTER)
    return 2.0 ** round(log2(largest)) if largest > 0 else 1.0


def _local_points(scene: Scene, body: Body) -> dict[str, complex]:
    if body.local is not None:
        return {name: complex(*point) for name, point in body.local.items()}
    assert body.lengths is not None
    first, second, *others = body.points
    points = {first: 0j, second: complex(body.lengths[frozenset((first, second))])}
    drawn = scene.drawn
    for apex in others:
        p, q = body.bases[apex]
        a, b = (body.lengths[frozenset((base, apex))] for base in (p, q))
        base = points[q] - points[p]
        # Apex of a triangle by its three sides: x along the base by the cosine law, the height by Pythagoras, with the
        # sign of the sketch's orientation.
        x = (abs(base) ** 2 + a**2 - b**2) / (2 * abs(base))
        if not abs(x) <= a:
            raise Failure(Status.cannot_assemble, f"{body.name}: the lengths '{p}-{apex}' and '{q}-{apex}' do not meet")
        side = ((drawn[q] - drawn[p]).conjugate() * (drawn[apex] - drawn[p])).imag
        points[apex] = points[p] + base / abs(base) * complex(x, copysign(sqrt(a**2 - x**2), side))
    return points


def _uniform(mass: float, points: list[complex]) -> tuple[complex, float]:
    """Find centre and inertia of a point mass, a bar (m l^2 / 12) or a triangle (m (a^2 + b^2 + c^2) / 36)."""
    squares = sum(abs(p - q) ** 2 for i, p in enumerate(points) for q in points[:i])
    share = {1: 1, 2: 12}.get(len(points), 36)  # more points are of a kinematic scene, where any inertia will do
    return sum(points) / len(points), mass * squares / share
