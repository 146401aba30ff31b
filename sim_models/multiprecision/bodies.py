"""The geometry and inertia of one body, in balls of arbitrary precision, whose radii bound the rounding."""

from collections.abc import Sequence
from itertools import combinations, pairwise

from flint import acb, arb

from scenes import Failure, Scene, Status
from scenes.scene import Body, DrawnBody

FLAT_TOL = 1e-9  # rad; the side of a sketched triangle flatter than this is round-off


def local_points(scene: Scene, body: Body) -> dict[str, acb]:
    """Return the points in the body's own frame, m; those given by lengths one after the other."""
    if body.local is not None:
        return {point: acb(*place) for point, place in body.local.items()}
    assert body.lengths is not None
    first, second, *others = body.points
    local = {first: acb(0), second: acb(body.lengths[frozenset((first, second))])}
    for point in others:
        local[point] = _from_bases(scene, body, local, point)
    return local


def _from_bases(scene: Scene, body: Body, local: dict[str, acb], point: str) -> acb:
    """Return C with |C - A| = a and |C - B| = b: by the law of cosines A + (t + i h) (B - A), c = |B - A|.

    t = (a^2 + c^2 - b^2) / (2 c^2), and |h| c is the height, h^2 = a^2 / c^2 - t^2.
    """
    assert body.lengths is not None
    first, second = body.bases[point]
    a, b = (arb(body.lengths[frozenset((base, point))]) for base in (first, second))
    way = local[second] - local[first]
    c2 = _square(way)
    t = (a * a + c2 - b * b) / (2 * c2)
    h2 = a * a / c2 - t * t
    if not h2 > 0:
        reason = f"'{body.name}' cannot be put together: the lengths from {first} and {second} to {point} do not meet"
        raise Failure(Status.cannot_assemble, reason)
    h = _sketched_side(scene, body, first, second, point) * h2.sqrt()
    return local[first] + acb(t, h) * way


def _sketched_side(scene: Scene, body: Body, first: str, second: str, point: str) -> int:
    """Return +1 where the sketch shows a body's point to the left of the way from its first base to its second."""
    A, B, C = (scene.drawn[name] for name in (first, second, point))
    turn = (B - A).conjugate() * (C - A)
    if not abs(turn.imag) > FLAT_TOL * abs(turn):
        reason = f"the sketch shows {first}, {second}, {point} of '{body.name}' on one line, on no side"
        raise Failure(Status.cannot_assemble, reason)
    return 1 if turn.imag > 0 else -1


def weight(body: Body, local: dict[str, acb]) -> tuple[arb, acb, arb]:
    """Return mass, centre of mass and inertia about it; the mass is 1 kg in a kinematic scene."""
    if isinstance(body, DrawnBody):
        around = [acb(*corner) for corner in body.outline]
        if body.width is not None:
            p, q = (local[point] for point in body.corners)
            aside = acb(0, body.width / 2) * (q - p) / abs(q - p)
            around = [p + aside, p - aside, q - aside, q + aside]
        return _of_triangles(around, arb(body.density) * body.thickness)
    mass, corners = arb(1 if body.mass is None else body.mass), [local[point] for point in body.corners]
    # m l^2/12 of a uniform bar, m (a^2 + b^2 + c^2)/36 of a triangle
    squares = sum((_square(p - q) for p, q in combinations(corners, 2)), arb(0))
    inertia = mass * squares / (12 if len(corners) == 2 else 36) if body.inertia is None else arb(body.inertia)
    com = sum(corners, acb(0)) / len(corners) if body.com is None else acb(*body.com)
    return mass, com, inertia


def _of_triangles(around: Sequence[acb], density: arb) -> tuple[arb, acb, arb]:
    """Return the weight of what corners enclose, kg/m^2 of it, as triangles from the first corner, some negative."""
    first, *others = around
    parts = []
    for p, q in pairwise(others):
        sides = _square(p - first) + _square(q - p) + _square(first - q)
        parts.append((((p - first).conjugate() * (q - first)).imag / 2, (first + p + q) / 3, sides / 36))
    area = sum((part for part, _, _ in parts), arb(0))
    com = sum((part * centre for part, centre, _ in parts), acb(0)) / area
    polar = sum((part * (moment + _square(centre - com)) for part, centre, moment in parts), arb(0))
    return density * abs(area), com, density * abs(polar)


def _square(z: acb) -> arb:
    """Return |z|^2."""
    return z.real * z.real + z.imag * z.imag
