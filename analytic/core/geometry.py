"""A body in its own frame, as complex numbers: where its points and its centre of mass lie, what it weighs."""

import cmath
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

from scenes import InputError
from scenes.scene import GROUND, Body, Scene

from .dyads import cross
from .numbers import Number, Vector, chosen, largest, least, root, samples


def as_complex(vector: tuple[Number, Number]) -> Vector:
    """Return the plane vector (x, y) as x + iy."""
    x, y = vector
    return x + 1j * y


def twice_area(a: Number, b: Number, c: Number) -> Number:
    """Return twice the area of a triangle with sides a, b, c."""
    # Kahan, "Miscalculating area and angles of a needle-like triangle" (2014): with a >= b >= c and these very
    # parentheses the relative error is a few roundings, however flat the triangle. Zero when the sides cannot close.
    a, b, c = largest(a, b, c), largest(least(a, b), least(largest(a, b), c)), least(a, b, c)
    return root((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))) / 2


@dataclass(frozen=True)
class RigidBody:
    """A body's frame: points and centre of mass as complex numbers, m; mass, kg; inertia about the com, kg m^2."""

    local: Mapping[str, Vector]
    com: Vector
    mass: Number
    inertia: Number

    @property
    def first(self) -> Vector:
        """Return where the first point lies, body frame, m."""
        return next(iter(self.local.values()))


def rigid_body(scene: Scene, body: Body) -> RigidBody:
    """Return a body's frame coordinates and mass properties; the mass is zero in a kinematic scene."""
    if body.local is not None:
        local = {point: as_complex(xy) for point, xy in body.local.items()}
    else:
        local = _from_lengths(scene, body)
    mass = 0.0 if body.mass is None else body.mass
    if body.com is not None and body.inertia is not None:
        return RigidBody(local, as_complex(body.com), mass, body.inertia)
    corners = [local[point] for point in body.corners]
    sides_squared = sum(abs(a - b) ** 2 for i, a in enumerate(corners) for b in corners[i + 1 :])
    # point mass, uniform bar m l^2 / 12, uniform triangular plate m (a^2 + b^2 + c^2) / 36; with more points, no mass
    inertia = mass * sides_squared / {1: 1, 2: 12}.get(len(corners), 36)
    return RigidBody(local, sum(corners) / len(corners), mass, inertia)


def longest_arm(scene: Scene, bodies: Mapping[str, RigidBody]) -> Number:
    """Return the largest distance of two points, or of a point from a guide, on one body or the ground, m.

    Turns of guides count as moves at this arm. Where there is none, as of wedges, it is the way of the drive.
    """
    points = {name: list(body.local.values()) for name, body in bodies.items()}
    points[GROUND] = [as_complex(xy) for xy in scene.ground.values()]
    arms = [abs(a - b) for own in points.values() for a, b in combinations(own, 2)]
    for slide in scene.slides.values():
        t, through = as_complex(slide.along), as_complex(slide.through)
        arms += [abs(cross(t, point - through)) for point in points[slide.on]]
    extents = [drive.law.extent for drive in scene.drives]
    arm = largest(*arms) if arms else 0.0
    return chosen(arm > 0, arm, largest(*(end - start for start, end in extents)))


def _from_lengths(scene: Scene, body: Body) -> dict[str, Vector]:
    """Place the first point at the origin, the second on x, every further one on the side where the sketch shows it."""
    lengths = body.lengths or {}
    first, second, *others = body.points
    drawn = scene.drawn
    local = {first: 0j, second: lengths[frozenset((first, second))] + 0j}
    for C in others:
        A, B = body.bases[C]
        a, b = lengths[frozenset((B, C))], lengths[frozenset((A, C))]
        base = local[B] - local[A]
        c = abs(base)
        # Cosine law as a product of sum and difference, which keeps the digits that b^2 - a^2 would lose; the height by
        # the triangle's area, which keeps those that a root of b^2 - x^2 would lose.
        x = (c + (b - a) * (b + a) / c) / 2
        y = twice_area(a, b, c) / c
        side = chosen(cross(drawn[B] - drawn[A], drawn[C] - drawn[A]) > 0, y, -y)
        local[C] = local[A] + base / c * as_complex((x, side))
    return local


def guide_of(scene: Scene, point: str) -> tuple[Vector, Vector]:
    """The direction, and a point, of the guide on the ground along which a point runs, or InputError."""
    if (guided := scene.guided(point)) is None:
        raise InputError(f"{point} is on no body that slides on the ground")
    return samples(as_complex(guided[1].along)), as_complex(guided[1].through)


def sketched_attitude(scene: Scene, body: str, bodies: Mapping[str, RigidBody]) -> Vector:
    """Return exp(i angle) of a body in the sketch, by the points of it, or of a body aligned with it, that are shown.

    Of the turns that lay a body's points on the sketched ones, the one with the least squares. Where no body shows two,
    a cylinder and its rod are turned by one of each, and two bodies with the drive between them by each other.
    """
    aligned = scene.aligned[body]
    if GROUND in aligned:
        return 1 + 0j
    if any(drive.on == GROUND and drive.body in aligned for drive in scene.drives):
        return cmath.exp(1j * scene.sketch.drive)
    drawn = scene.drawn
    names = (body, *sorted(aligned))
    shown = {name: [point for point in bodies[name].local if point in drawn] for name in names}
    owner = next((name for name in names if len(shown[name]) > 1), None)
    if owner is not None:
        # Orthogonal Procrustes problem in the plane: the turn is that of sum conj(s) z, both about their means.
        local, points = bodies[owner].local, shown[owner]
        local_middle, middle = (sum(place[point] for point in points) / len(points) for place in (local, drawn))
        return _unit(sum((local[point] - local_middle).conjugate() * (drawn[point] - middle) for point in points))
    for name in (name for name in names if name in scene.slides):
        on = scene.slides[name].on
        if shown[name] and shown[on]:
            a, b = shown[on][0], shown[name][0]
            return _unit(
                (drawn[b] - drawn[a]) * _way(scene, bodies, (on, a), (name, b), abs(drawn[b] - drawn[a])).conjugate()
            )
    turned = cmath.exp(1j * scene.sketch.drive)
    (drive,) = scene.drives
    if drive.body in aligned:
        return sketched_attitude(scene, drive.on, bodies) * turned
    return sketched_attitude(scene, drive.body, bodies) * turned.conjugate()


def _way(
    scene: Scene, bodies: Mapping[str, RigidBody], start: tuple[str, str], end: tuple[str, str], apart: Number
) -> Vector:
    """The way in the carrier's frame, m, from a point of it to one of its slider that is so far apart in the sketch."""
    (on, a), (name, b) = start, end
    slide = scene.slides[name]
    along = as_complex(slide.along)
    way = as_complex(slide.through) + bodies[name].local[b] - bodies[name].first - bodies[on].local[a]
    if name in scene.driven:
        return way + along * scene.sketch.drive
    across = cross(along, way)
    return along * as_complex((root((apart - across) * (apart + across)), across))  # the rod is pushed out


def _unit(vector: Vector) -> Vector:
    known = abs(vector) > 0
    return chosen(known, vector, 1 + 0j) / chosen(known, abs(vector), 1.0)
