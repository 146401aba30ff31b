"""Bodies of a scene for the second opinion of `absolute_coordinates`: points, masses, where a sketch has them."""

from collections.abc import Mapping
from itertools import permutations
from math import hypot, sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.scene import GROUND, Body

Floats: TypeAlias = NDArray[np.float64]
Points: TypeAlias = Mapping[str, Floats]

TURNED: Floats = np.array([[0.0, -1.0], [1.0, 0.0]])  # turns a vector by +90 degrees


def local_points(scene: Scene, body: Body) -> dict[str, Floats]:
    """Return a body's points in its own frame, m; by the law of cosines where their distances are given."""
    if body.local is not None:
        return {point: np.array(xy, float) for point, xy in body.local.items()}
    assert body.lengths is not None
    drawn = {**scene.ground, **scene.sketch.points}
    first, second, *others = body.points
    local: dict[str, Floats] = {first: np.zeros(2), second: np.array([body.lengths[frozenset((first, second))], 0.0])}
    for C in others:
        A, B = body.bases[C]
        a, b = body.lengths[frozenset((A, C))], body.lengths[frozenset((B, C))]
        base = local[B] - local[A]
        c = hypot(*base)
        cosine = (a**2 + c**2 - b**2) / (2 * a * c)
        side = np.sign(np.linalg.det([np.subtract(drawn[B], drawn[A]), np.subtract(drawn[C], drawn[A])]))
        local[C] = local[A] + a / c * (cosine * base + side * sqrt(1 - cosine**2) * TURNED @ base)
    return local


def mass_properties(body: Body, local: Points) -> tuple[float, Floats, float]:
    """Return mass, kg, centre of mass in the body's frame, m, and inertia about it, kg m^2."""
    mass = body.mass or 0.0
    if body.com is not None and body.inertia is not None:
        return mass, np.array(body.com), body.inertia
    corners = np.array(list(local.values()))
    com = corners.mean(axis=0)
    share = {1: 0.0, 2: 1 / 6, 3: 1 / 12}[len(corners)]  # of m r^2 at each corner: a bar, a triangular plate
    return mass, com, mass * share * float(((corners - com) ** 2).sum())


def sketched(scene: Scene, local: Mapping[str, Points]) -> Floats:
    """Return x, y, c, s of each body as the sketch shows it, and a last 1."""
    drawn = {**scene.ground, **scene.sketch.points}
    coordinates: list[float] = []
    for name in scene.bodies:
        angle = _sketched_angle(scene, local, name)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        origins = [drawn[point] - turn @ xy for point, xy in local[name].items() if point in drawn] or [np.zeros(2)]
        coordinates += [*np.mean(origins, axis=0), np.cos(angle), np.sin(angle)]
    return np.array([*coordinates, 1.0])


def _sketched_angle(scene: Scene, local: Mapping[str, Points], name: str) -> float:
    """Return the angle that shows between the two points furthest apart of a body, or of one parallel to it."""
    group, drawn = scene.aligned[name], {**scene.ground, **scene.sketch.points}
    if GROUND in group:
        return 0.0
    if scene.drive.slide is None and scene.drive.body in group:
        on = scene.drive.on
        return scene.sketch.drive + (0.0 if on == GROUND else _sketched_angle(scene, local, on))
    for points in (local[other] for other in (name, *sorted(group))):
        if len(shown := [point for point in points if point in drawn]) > 1:
            p, q = max(permutations(shown, 2), key=lambda ends: hypot(*(points[ends[1]] - points[ends[0]])))
            return _turned(np.subtract(drawn[q], drawn[p]), points[q] - points[p])
    for slider in sorted(group & {*scene.slides}):
        slide = scene.slides[slider]
        shown = [next((point for point in local[of] if point in drawn), "") for of in (slide.on, slider)]
        if all(shown):
            seen = np.subtract(drawn[shown[1]], drawn[shown[0]])
            own = local[slider][shown[1]] - local[slider][scene.bodies[slider].points[0]] - local[slide.on][shown[0]]
            apart, along, s = np.array(slide.through) + own, np.array(slide.along), scene.sketch.drive
            if slider != scene.drive.body:  # the longer of |apart + along s| = |seen|, or where that comes nearest
                half = float(along @ apart)
                s = max(sqrt(max(half**2 - apart @ apart + seen @ seen, 0.0)) - half, 1e-3 * hypot(*seen))
            return _turned(seen, apart + along * s)
    raise AssertionError(f"nothing shows the angle of {name}")


def _turned(seen: Floats, own: Floats) -> float:
    return float(np.arctan2(seen[1], seen[0]) - np.arctan2(own[1], own[0]))
