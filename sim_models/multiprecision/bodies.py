"""The geometry and inertia of one body, in balls of arbitrary precision, whose radii bound the rounding."""

from collections.abc import Sequence
from itertools import combinations, pairwise

from flint import arb

from scenes import Failure, Scene, Status
from scenes.scene import Body, DrawnBody

from .rows import PlaneVector, vector

FLAT = 1e-9  # rad; the side of a sketched triangle flatter than this is round-off


def local_points(scene: Scene, body: Body) -> dict[str, PlaneVector]:
    """Return the points in the body's own frame, m; those given by lengths one after the other."""
    if body.local is not None:
        return {point: (arb(x), arb(y)) for point, (x, y) in body.local.items()}
    assert body.lengths is not None
    first, second, *others = body.points
    local = {first: (arb(0), arb(0)), second: (arb(body.lengths[frozenset((first, second))]), arb(0))}
    for point in others:
        local[point] = _from_bases(scene, body, local, point)
    return local


def _from_bases(scene: Scene, body: Body, local: dict[str, PlaneVector], point: str) -> PlaneVector:
    """Return C with |C - A| = a and |C - B| = b: by the law of cosines A + (t + i h) (B - A), c = |B - A|.

    t = (a^2 + c^2 - b^2) / (2 c^2), and |h| c is the height, h^2 = a^2 / c^2 - t^2.
    """
    assert body.lengths is not None
    first, second = body.bases[point]
    a, b = (arb(body.lengths[frozenset((base, point))]) for base in (first, second))
    (x, y), (u, v) = local[first], local[second]
    u, v = u - x, v - y
    c2 = u * u + v * v
    t = (a * a + c2 - b * b) / (2 * c2)
    h2 = a * a / c2 - t * t
    if not h2 > 0:
        reason = f"'{body.name}' cannot be put together: the lengths from {first} and {second} to {point} do not meet"
        raise Failure(Status.cannot_assemble, reason)
    h = _sketched_side(scene, body, first, second, point) * h2.sqrt()
    return x + t * u - h * v, y + t * v + h * u


def _sketched_side(scene: Scene, body: Body, first: str, second: str, point: str) -> int:
    """Return +1 where the sketch shows a body's point to the left of the way from its first base to its second."""
    A, B, C = (scene.drawn[name] for name in (first, second, point))
    size = abs(B - A) * abs(C - A)
    sine = ((B - A).conjugate() * (C - A)).imag / size if size > 0 else 0.0
    if not abs(sine) > FLAT:
        reason = f"the sketch shows {first}, {second}, {point} of '{body.name}' on one line, on no side"
        raise Failure(Status.cannot_assemble, reason)
    return 1 if sine > 0 else -1


def weight(body: Body, local: dict[str, PlaneVector]) -> tuple[arb, PlaneVector, arb]:
    """Return mass, centre of mass and inertia about it; the mass is 1 kg in a kinematic scene."""
    if isinstance(body, DrawnBody):
        around = [(arb(x), arb(y)) for x, y in body.outline]
        if body.width is not None:
            (x, y), (u, v) = (local[point] for point in body.corners)
            aside = body.width / (2 * _square(u - x, v - y).sqrt())
            dx, dy = (y - v) * aside, (u - x) * aside
            around = [(x + dx, y + dy), (x - dx, y - dy), (u - dx, v - dy), (u + dx, v + dy)]
        return _of_triangles(around, arb(body.density) * body.thickness)
    mass, corners = arb(1 if body.mass is None else body.mass), [local[point] for point in body.corners]
    x, y = (sum(axis, arb(0)) / len(corners) for axis in zip(*corners, strict=True))
    # m l^2/12 of a uniform bar, m (a^2 + b^2 + c^2)/36 of a triangle
    squares = sum(((x - u) ** 2 + (y - v) ** 2 for (x, y), (u, v) in combinations(corners, 2)), arb(0))
    inertia = mass * squares / (12 if len(corners) == 2 else 36) if body.inertia is None else arb(body.inertia)
    return mass, (x, y) if body.com is None else vector(body.com), inertia


def _of_triangles(around: Sequence[PlaneVector], density: arb) -> tuple[arb, PlaneVector, arb]:
    """Return the weight of what corners enclose, kg/m^2 of it, as triangles from the first corner, some negative."""
    (x, y), *others = around
    parts = []
    for (s, t), (u, v) in pairwise(others):
        sides = _square(s - x, t - y) + _square(u - s, v - t) + _square(x - u, y - v)
        parts.append((((s - x) * (v - y) - (u - x) * (t - y)) / 2, ((x + s + u) / 3, (y + t + v) / 3), sides / 36))
    area = sum((part for part, _, _ in parts), arb(0))
    X, Y = (sum((part * centre[axis] for part, centre, _ in parts), arb(0)) / area for axis in (0, 1))
    own = sum((part * (about + _square(u - X, v - Y)) for part, (u, v), about in parts), arb(0))
    return density * abs(area), (X, Y), density * abs(own)


def _square(x: arb, y: arb) -> arb:
    """Return x^2 + y^2; a power of a ball that holds zero is none."""
    return x * x + y * y
