"""A body in its own frame, as complex numbers: where its points and its centre of mass lie, what it weighs."""

import cmath
from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt

import numpy as np

from scenes.scene import GROUND, Body, Scene, Vector


def as_complex(vector: Vector) -> complex:
    """Return the plane vector (x, y) as x + iy."""
    return complex(*vector)


def cross(a: complex, b: complex) -> float:
    """Return the z component of a x b."""
    return (a.conjugate() * b).imag


def twice_area(a: float, b: float, c: float) -> float:
    """Return twice the area of a triangle with sides a, b, c.

    Kahan, "Miscalculating area and angles of a needle-like triangle" (2014): with a >= b >= c and these very
    parentheses the relative error is a few roundings, however flat the triangle. Zero when the sides cannot close.
    """
    a, b, c = sorted((a, b, c), reverse=True)
    product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))
    return sqrt(max(product, 0.0)) / 2


@dataclass(frozen=True)
class RigidBody:
    """A body's frame: points and centre of mass as complex numbers, m; mass, kg; inertia about the com, kg m^2."""

    local: Mapping[str, complex]
    com: complex
    mass: float
    inertia: float

    @property
    def first(self) -> complex:
        """Return where the first point lies, body frame, m."""
        return next(iter(self.local.values()))

    def arm(self, foot: str, tip: str) -> complex:
        """Return the vector from one point of the body to another, body frame, m."""
        return self.local[tip] - self.local[foot]

    def com_arm(self, foot: str) -> complex:
        """Return the vector from a point of the body to its centre of mass, body frame, m."""
        return self.com - self.local[foot]


def rigid_body(scene: Scene, body: Body) -> RigidBody:
    """Return a body's frame coordinates and mass properties; the mass is zero in a kinematic scene."""
    if body.local is not None:
        local = {point: as_complex(xy) for point, xy in body.local.items()}
    else:
        local = _from_lengths(scene, body)
    mass = body.mass or 0.0
    if body.com is not None and body.inertia is not None:
        return RigidBody(local, as_complex(body.com), mass, body.inertia)
    corners = list(local.values())
    sides_squared = sum(abs(a - b) ** 2 for i, a in enumerate(corners) for b in corners[i + 1 :])
    # point mass, uniform bar m l^2 / 12, uniform triangular plate m (a^2 + b^2 + c^2) / 36; with more points, no mass
    inertia = mass * sides_squared / {1: 1, 2: 12}.get(len(corners), 36)
    return RigidBody(local, sum(corners) / len(corners), mass, inertia)


def longest_arm(scene: Scene, bodies: Mapping[str, RigidBody]) -> float:
    """Return the largest distance of two points, or of a point from a guide, on one body or the ground, m.

    Turns of guides count as moves at this arm. Where there is none, as of wedges, it is the way of the drive.
    """
    points = {name: list(body.local.values()) for name, body in bodies.items()}
    points[GROUND] = [as_complex(xy) for xy in scene.ground.values()]
    arms = [abs(a - b) for own in points.values() for a in own for b in own]
    for slide in (body.slide for body in scene.bodies.values() if body.slide is not None):
        t, through = as_complex(slide.along), as_complex(slide.through)
        arms += [abs(cross(t, point - through)) for point in points[slide.on]]
    least, most = scene.drive.extent
    return max(arms, default=0.0) or most - least


def _from_lengths(scene: Scene, body: Body) -> dict[str, complex]:
    """Place the first point at the origin, the second on x, every further one on the side where the sketch shows it."""
    assert body.lengths is not None
    lengths, at = body.lengths, sketched(scene)
    first, second, *others = body.points
    local = {first: 0j, second: complex(lengths[frozenset((first, second))])}
    for C in others:
        A, B = body.bases(C)
        a, b = lengths[frozenset((B, C))], lengths[frozenset((A, C))]
        base = local[B] - local[A]
        c = abs(base)
        x = (c + (b - a) * (b + a) / c) / 2
        y = twice_area(a, b, c) / c
        local[C] = local[A] + base / c * complex(x, y if cross(at[B] - at[A], at[C] - at[A]) > 0 else -y)
    return local


def sketched(scene: Scene) -> dict[str, complex]:
    """Return where the sketch shows each point, the ground's points included."""
    return {point: as_complex(xy) for point, xy in {**scene.ground, **scene.sketch.points}.items()}


def sketched_attitude(scene: Scene, body: str, bodies: Mapping[str, RigidBody]) -> complex:
    """Return exp(i angle) of a body in the sketch, by the points of it, or of a body aligned with it, that are shown.

    Of the turns that lay a body's points on the sketched ones, the one with the least squares.
    """
    aligned = scene.aligned[body]
    if GROUND in aligned:
        return 1 + 0j
    if scene.drive.body in aligned:
        return cmath.exp(1j * scene.sketch.drive)
    at = sketched(scene)
    shown = ([point for point in bodies[name].local if point in at] for name in (body, *sorted(aligned)))
    points = next(points for points in shown if len(points) > 1)  # there is one: `scenes.consistency` sees to it
    owner = bodies[next(name for name in (body, *sorted(aligned)) if set(points) <= set(bodies[name].local))].local
    own, drawn = np.array([owner[point] for point in points]), np.array([at[point] for point in points])
    turn = complex(np.vdot(own - own.mean(), drawn - drawn.mean()))
    return turn / abs(turn) if turn else 1 + 0j
