"""A body in its own frame, as complex numbers: where its points and its centre of mass lie, what it weighs."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt

from scenes.scene import Body, Scene, Vector


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
    # point mass, uniform bar m l^2 / 12, uniform triangular plate m (a^2 + b^2 + c^2) / 36
    inertia = mass * sides_squared / {1: 1, 2: 12, 3: 36}[len(corners)]
    return RigidBody(local, sum(corners) / len(corners), mass, inertia)


def _from_lengths(scene: Scene, body: Body) -> dict[str, complex]:
    """Place the first point at the origin, the second on x, the third on the side where the sketch shows it."""
    assert body.lengths is not None
    lengths = body.lengths
    A, B, *third = body.points
    c = lengths[frozenset((A, B))]
    local = {A: 0j, B: complex(c)}
    for C in third:
        a, b = lengths[frozenset((B, C))], lengths[frozenset((A, C))]
        x = (c + (b - a) * (b + a) / c) / 2
        y = twice_area(a, b, c) / c
        at = sketched(scene)
        local[C] = complex(x, y if cross(at[B] - at[A], at[C] - at[A]) > 0 else -y)
    return local


def sketched(scene: Scene) -> dict[str, complex]:
    """Return where the sketch shows each point, the ground's points included."""
    return {point: as_complex(xy) for point, xy in {**scene.ground, **scene.sketch.points}.items()}
