"""What the numbers of bodies say: where their points are, how far apart, and what they weigh."""

from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from scenes import Scene
from scenes.scene import GROUND, Body, DrawnBody


class Weights(NamedTuple):
    """What a body's inertia is."""

    mass: float  # kg
    com: complex  # m, from the body's first point, along the axes of its frame
    inertia: float  # kg m^2, about the centre of mass


def weights(scene: Scene, body: Body) -> Weights:
    """A body's own; without a mass it has none."""
    placed = arms(scene, body)
    uniform = sum(placed[point] for point in body.corners) / len(body.corners)
    com = uniform if body.com is None else complex(*body.com) - first_point(body)
    return Weights(body.mass or 0.0, com, inertia(body))


def rule(scene: Scene, body: Body) -> str:
    """What a body was taken for: `uniform bar from A to C`, `bar from A to C, 40 mm wide, 8 mm thick, 7850 kg/m^3`."""
    if isinstance(body, DrawnBody):
        shape = f"outline of {len(body.outline)} corners"
        if body.width is not None:
            shape = f"bar from {' to '.join(body.corners)}, {scene.length(body.width)} wide"
        return f"{shape}, {scene.length(body.thickness)} thick, {body.density:g} kg/m^3"
    if body.com is not None:
        return "as given"
    match body.corners:
        case [point]:
            return f"point mass at {point}"
        case [end, other]:
            return f"uniform bar from {end} to {other}"
        case corners:
            return f"uniform triangular plate {', '.join(corners)}"


def distances(body: Body) -> dict[tuple[str, str], float]:
    """The known distances of a body's points, m: of every two, or those that are given."""
    if body.local is not None:
        return {(p, q): abs(complex(*body.local[p]) - complex(*body.local[q])) for p, q in combinations(body.points, 2)}
    known, pairs = body.lengths or {}, combinations(body.points, 2)
    return {pair: known[frozenset(pair)] for pair in pairs if frozenset(pair) in known}


def inertia(body: Body) -> float:
    """The inertia about the com, kg m^2: as given, or of a point, a uniform bar or a triangular plate."""
    if body.inertia is not None:
        return body.inertia
    sides = [length for ends, length in distances(body).items() if {*ends} <= {*body.corners}]
    return (body.mass or 0.0) * sum(side**2 for side in sides) / {1: 1, 2: 12, 3: 36}[len(body.corners)]


def plane(components: tuple[Any, Any]) -> Any:
    """A vector as x + iy; of many machines an array."""
    return components[0] + 1j * components[1]


def first_point(body: Body) -> Any:
    """The body's first point in the body's frame, m."""
    return plane(body.local[body.points[0]]) if body.local is not None else 0j


def arms(scene: Scene, body: Body) -> dict[str, complex]:
    """Where a body's points are from its first one, m, in the body's frame.

    A point given by lengths is where the circles about its two bases meet, on the side that the sketch shows.
    """
    if body.local is not None:
        return {point: complex(*place) - first_point(body) for point, place in body.local.items()}
    drawn, length, (first, second, *others) = scene.drawn, distances(body), body.points
    places = {first: 0j, second: complex(length[first, second])}
    for point in others:
        p, q = body.bases[point]
        way, a, b = places[q] - places[p], length[p, point], length[q, point]
        along = (a**2 - b**2 + abs(way) ** 2) / (2 * abs(way))
        side = np.sign(((drawn[q] - drawn[p]).conjugate() * (drawn[point] - drawn[p])).imag)
        places[point] = places[p] + way / abs(way) * (along + 1j * side * max(a**2 - along**2, 0.0) ** 0.5)
    return places


def largest_length(scene: Scene) -> float:
    """The largest known distance on a body, on the ground in use or in a cylinder, m; else the drive's travel."""
    ends = (end for _, element in scene.elements for end in element.ends)
    joined = {pin.point for pin in scene.pins} | {point for body, point in ends if body == GROUND}
    ground = [complex(*place) for point, place in scene.ground.items() if point in joined]
    known = [length for body in scene.bodies.values() for length in distances(body).values()]
    known += [abs(p - q) for p in ground for q in ground]
    cylinders = (drive.law for drive in scene.drives if drive.slide is not None and drive.on != GROUND)
    known += (abs(end) for law in cylinders for end in law.extent)
    return max(known, default=0.0) or max(drive.span for drive in scene.drives)
