"""Where a slider stands still while the drive moves on, and how far it gets."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from scenes import Scene
from scenes.drive import Driven
from scenes.motion import Samples
from scenes.scene import PressForce

from .dyads import Vectors, dot
from .geometry import as_complex
from .kinematics import Linkage, kinematics

SAMPLES = 3600  # over the drive's way: two dead points closer together than this grid are not seen
BISECTIONS = 60  # from the whole way down to the last place

Displaced: TypeAlias = Callable[[Samples], tuple[Samples, Samples, Samples]]  # position of the drive -> s, s', s''


def displacement(scene: Scene, linkage: Linkage, point: str) -> Displaced:
    """Return the displacement of a slider's point along its guide from `through`, with its derivatives by the drive.

    Raises:
        ValueError: the point is on no body that slides on the ground.
    """
    t, through = guide_of(scene, point)

    def displaced(position: Samples) -> tuple[Samples, Samples, Samples]:
        unit = Driven(position, np.array(1.0), np.array(0.0))
        with np.errstate(invalid="ignore", divide="ignore"):  # there is none where it does not assemble
            k = kinematics(scene, linkage, unit)
        shape = np.zeros(np.shape(position))
        return tuple(dot(t, x) + shape for x in (k.z[point] - through, k.v[point], k.a[point]))  # type: ignore[return-value]

    return displaced


def guide_of(scene: Scene, point: str) -> tuple[Vectors, complex]:
    """Return the direction, and a point, of the guide on the ground along which a point runs.

    Raises:
        ValueError: the point is on no body that slides on the ground.
    """
    guided = scene.guided(point)
    if guided is None:
        raise ValueError(f"{point} is on no body that slides on the ground")
    _, slide = guided
    return np.asarray(as_complex(slide.along)), as_complex(slide.through)


def dead_points(displaced: Displaced, least: float, most: float) -> Samples:
    """Return the positions of the drive, from the least to the most, where s' changes its sign."""
    way = np.linspace(least, most, SAMPLES + 1)
    forward = displaced(way)[1] > 0
    before = np.flatnonzero(forward[1:] != forward[:-1])
    return bisected(lambda position: displaced(position)[1], way[before], way[before + 1])


def stroke_end(scene: Scene, linkage: Linkage, load: PressForce) -> float:
    """Return how far a cycle of the drive takes the slider in its closing direction: the displacement there, m."""
    displaced = displacement(scene, linkage, scene.bodies[load.body].points[0])
    least, most = scene.drive.extent
    closed = load.closing * displaced(np.array([least, *dead_points(displaced, least, most), most]))[0]
    return load.closing * float(np.max(closed, initial=-np.inf, where=~np.isnan(closed)))


def bisected(f: Callable[[Samples], Samples], low: Samples, high: Samples) -> Samples:
    """Return the zeros of f, one in each bracket, shape (n,)."""
    rising = f(high) > f(low)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        beyond = (f(middle) > 0) == rising
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return (low + high) / 2
