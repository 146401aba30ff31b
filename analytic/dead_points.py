"""Where a slider stands still while the drive moves on, and how far it gets."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from scenes import InputError, Scene
from scenes.drive import Driven
from scenes.motion import Samples
from scenes.scene import PressForce

from .dyads import Vectors, dot
from .geometry import as_complex
from .kinematics import Linkage, kinematics
from .numbers import Number, of_machines, samples

SAMPLES = 3600  # over the drive's way: two dead points closer together than this grid are not seen
BISECTIONS = 60  # from the whole way down to the last place
TOGETHER = 8  # machines, whose samples stay in cache

Displaced: TypeAlias = Callable[[Samples], tuple[Samples, Samples, Samples]]  # position of the drive -> s, s', s''


def displacement(scene: Scene, linkage: Linkage, point: str) -> Displaced:
    """Return the displacement of a slider's point along its guide from `through`, with its derivatives by the drive.

    Raises:
        InputError: the point is on no body that slides on the ground.
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
        InputError: the point is on no body that slides on the ground.
    """
    guided = scene.guided(point)
    if guided is None:
        raise InputError(f"{point} is on no body that slides on the ground")
    _, slide = guided
    return samples(as_complex(slide.along)), as_complex(slide.through)


def dead_points(displaced: Displaced, least: float, most: float) -> Samples:
    """Return the positions of the drive, from the least to the most, where s' changes its sign."""
    way = np.linspace(least, most, SAMPLES + 1)
    forward = displaced(way)[1] > 0
    before = np.flatnonzero(forward[1:] != forward[:-1])
    return bisected(lambda position: displaced(position)[1], way[before], way[before + 1])


def stroke_end(scene: Scene, linkage: Linkage, number: int, machines: int = 1) -> Number:
    """Return how far a cycle of the drive takes a press force's slider in its closing direction, m.

    Args:
        scene: the mechanism.
        linkage: its groups.
        number: of the load.
        machines: how many the numbers of the scene are of; a number for each is returned, shape (machines, 1).
    """
    if machines == 1:
        return float(_stroke_end(scene, linkage, number)[0])
    parts = (slice(first, first + TOGETHER) for first in range(0, machines, TOGETHER))
    some = map(of_machines((scene, linkage)), parts)
    return np.concatenate([_stroke_end(part, those, number) for part, those in some])[:, None]


def _stroke_end(scene: Scene, linkage: Linkage, number: int) -> Samples:
    """Return the displacement at the dead point, or end of the drive's way, that is furthest, shape (m,)."""
    load = scene.loads[number]
    assert isinstance(load, PressForce)
    displaced = displacement(scene, linkage, scene.bodies[load.body].points[0])
    least, most = (np.reshape(end, (-1, 1)) for end in scene.drive.extent)
    way = least + (most - least) * np.linspace(0, 1, SAMPLES + 1)
    closed = load.closing * displaced(way)[0]
    closed, way = np.broadcast_arrays(np.where(np.isnan(closed), -np.inf, closed), way)
    furthest = closed.argmax(axis=1)[:, None]
    beside = (np.clip(furthest + step, 0, SAMPLES) for step in (-1, 1))
    low, high = (np.take_along_axis(way, at, axis=1) for at in beside)
    dead = bisected(lambda position: load.closing * displaced(position)[1], low, high)
    found = np.concatenate([closed.max(axis=1)[:, None], load.closing * displaced(dead)[0]], axis=1)
    return np.asarray(load.closing * np.nanmax(found, axis=1, keepdims=True))[:, 0]


def bisected(f: Callable[[Samples], Samples], low: Samples, high: Samples) -> Samples:
    """Return the zeros of f, one in each bracket, shape (n,)."""
    rising = f(high) > f(low)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        beyond = (f(middle) > 0) == rising
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return (low + high) / 2
