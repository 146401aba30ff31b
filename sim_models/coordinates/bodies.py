"""The geometry and inertia of one body, and its motion."""

from collections.abc import Mapping
from itertools import combinations
from typing import Any, NamedTuple

from scenes import Failure, Scene, Status
from scenes.scene import Body


class FramedBody(NamedTuple):
    """A body in its own frame, in the plane of complex numbers."""

    points: Mapping[str, complex]  # m
    com: complex
    mass: float  # kg
    inertia: float  # kg m^2, about the centre of mass


class MovingBody(NamedTuple):
    """The frame of a body, in the plane of complex numbers, at one time or at n, and its derivatives by the time."""

    origin: Any = 0j  # m
    angle: Any = 0.0  # rad
    turn: Any = 1 + 0j  # exp(i angle)
    velocity: Any = 0j
    omega: Any = 0.0
    acceleration: Any = 0j
    alpha: Any = 0.0

    def place(self, arm: Any) -> Any:
        """Return where the body has a place of its frame, m."""
        return self.origin + self.turn * arm

    def at(self, arm: Any) -> tuple[Any, Any, Any]:
        """Return where a place of its frame is, m, and the derivatives by the time, m/s and m/s^2."""
        r = self.turn * arm
        acceleration = self.acceleration + (1j * self.alpha - self.omega**2) * r
        return self.origin + r, self.velocity + 1j * self.omega * r, acceleration

    @property
    def turning(self) -> tuple[Any, Any, Any]:
        """The angle and its derivatives."""
        return self.angle, self.omega, self.alpha


def framed_body(scene: Scene, body: Body) -> FramedBody:
    """Return a body, of 1 kg in a kinematic scene; Failure where its lengths do not meet, or nothing shows the side."""
    points = {name: complex(*place) for name, place in (body.local or {}).items()}
    if body.lengths is not None:
        first, second, *others = body.points
        points = {first: 0j, second: complex(body.lengths[frozenset((first, second))])}
        for apex in others:
            points[apex] = _apex(scene, body, apex, points)
    mass = 1.0 if body.mass is None else body.mass
    if body.com is not None and body.inertia is not None:
        return FramedBody(points, complex(*body.com), mass, body.inertia)
    # A bar's or a triangle's radius of gyration by the squared distances of its corners: 1/12 and 1/36 of their sum.
    corners = [points[name] for name in body.corners]
    inertia = mass * sum(abs(p - q) ** 2 for p, q in combinations(corners, 2)) / (12 if len(corners) == 2 else 36)
    return FramedBody(points, sum(corners, 0j) / len(corners), mass, inertia)


def linkage_size(scene: Scene, bodies: Mapping[str, FramedBody]) -> float:
    """Return the largest distance of two points of one body or of the ground, or a driven slider's travel, m."""
    frames = [
        [complex(*place) for place in scene.ground.values()],
        *([*body.points.values()] for body in bodies.values()),
    ]
    travels = [drive.span for drive in scene.drives if drive.slide is not None]
    return max(0.0, *travels, *(abs(p - q) for points in frames for p, q in combinations(points, 2)))


def _apex(scene: Scene, body: Body, apex: str, points: Mapping[str, complex]) -> complex:
    """C of a triangle ABC by its sides: its height over AB is by Heron's formula, in factors."""
    assert body.lengths is not None
    base = body.bases[apex]
    p, q = (points[name] for name in base)
    b, a = (body.lengths[frozenset((name, apex))] for name in base)
    c = abs(q - p)
    squared = (a + b + c) * (b + c - a) * (a + c - b) * (a + b - c)  # 16 times that of the area
    A, B, C = (scene.drawn[name] for name in (*base, apex))
    side = ((B - A).conjugate() * (C - A)).imag
    if side == 0 or not squared > 0:
        why = "do not meet" if side else "are on no side of it: the sketch shows them on one line"
        reason = f"the lengths of '{body.name}' from {base[0]} and {base[1]} to {apex} {why}"
        raise Failure(Status.cannot_assemble, reason)
    along, across = (b**2 + c**2 - a**2) / (2 * c**2), squared**0.5 / (2 * c**2) * (1 if side > 0 else -1)
    return p + complex(along, across) * (q - p)
