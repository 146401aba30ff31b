"""How far points travel: the largest distance between two of their positions, and what errors are divided by."""

from collections.abc import Mapping, Sequence

import numpy as np

from scenes import Motion, Scene
from scenes.scene import GROUND, Body

from .motion_vectors import Vectors

LEAST = 1e-2  # of the largest travel: what a point's own is taken for at least


def travels(scene: Scene, motion: Motion) -> dict[str, float]:
    """Return the largest distance between two positions of each moving point, m, no less than `LEAST` of the largest.

    Left out are points whose positions the motion has not.
    """
    known = [point for point in scene.moving_points if {f"{point}.x", f"{point}.y"} <= motion.samples.keys()]
    own = {point: largest_distance(motion[f"{point}.x"] + 1j * motion[f"{point}.y"]) for point in known}
    least = LEAST * max(own.values(), default=0.0)
    return {point: max(travel, least) for point, travel in own.items()}


def guide_travel(scene: Scene, travel: Mapping[str, float], body: Body) -> float:
    """Return the largest travel of the points of a body that slides and of the one that it slides on, m."""
    assert body.slide is not None
    points = {*body.points, *(() if body.slide.on == GROUND else scene.bodies[body.slide.on].points)}
    return max(travel[point] for point in points & travel.keys())


def largest_distance(places: Vectors) -> float:
    """Return the largest distance between two of some positions, given as x + iy, shape (n,)."""
    return abs(chord(places))


def chord(places: Vectors) -> complex:
    """Return the longest vector from one to another of some positions, x + iy, shape (n,); exact, by n log n.

    It is one between corners of their convex hull that two parallel lines touch (rotating calipers, Shamos 1978): the
    corner opposite to an edge has that edge's direction, turned by half a turn, between those of its own two edges.
    """
    ordered = np.sort(places)  # by x, then by y
    hull = np.array(_below(ordered.tolist())[:-1] + _below(ordered[::-1].tolist())[:-1])
    if len(hull) < 3:
        return complex(ordered[-1] - ordered[0])
    ends = np.roll(hull, -1)
    edges = np.unwrap(np.angle(ends - hull))  # rising, round once
    opposite = hull[np.searchsorted([*edges, *(edges + 2 * np.pi)], edges + np.pi) % len(hull)]
    pairs = np.concatenate([hull - opposite, ends - opposite, ordered[-1:] - ordered[:1]])  # these if but for round-off
    return complex(pairs[np.abs(pairs).argmax()])


def _below(places: Sequence[complex]) -> list[complex]:
    """Return the corners of the hull from the first to the last of sorted positions, to the right of that way.

    By Andrew's monotone chain (1979): where the way would not turn left is no corner.
    """
    corners: list[complex] = []
    for place in places:
        while len(corners) > 1 and ((corners[-1] - corners[-2]).conjugate() * (place - corners[-1])).imag <= 0:
            corners.pop()
        corners.append(place)
    return corners
