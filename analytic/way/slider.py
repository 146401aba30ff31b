"""From the drive to a slider and back: dead points, the ends of strokes, and how the drive moves a slider as asked."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from scenes import Failure, InputError, Scene, Status
from scenes.arguments import finite_numbers
from scenes.model.motion import Samples

from ..core.decomposition import Linkage, decompose
from ..core.geometry import guide_of
from ..core.kinematics import followed
from .motion_range import SAMPLES, changes, describe, motion_at, unreached, zeros
from .singular import meetings

STILL_TOL = 1e-12  # of the longest arm: roundings of a slider that stands still

Displaced: TypeAlias = Callable[[Samples], tuple[Samples, Samples, Samples]]  # position of the drive -> s, s', s''


@dataclass(frozen=True)
class InverseStroke:
    """The drive's positions between two neighbouring dead points: one way of reaching positions of the slider.

    The arrays have the shape (n,) of the positions asked for, NaN where the slider does not get there on this stroke.
    """

    start: float  # rad or m, the dead point, or the end of the drive's way, where it begins
    end: float  # the next one
    position: Samples  # of the drive, rad or m
    rate: Samples  # rad/s or m/s
    acceleration: Samples  # rad/s^2 or m/s^2


def inverse(
    scene: Scene, position: ArrayLike, velocity: ArrayLike = 0.0, acceleration: ArrayLike = 0.0
) -> list[InverseStroke]:
    """Find, stroke by stroke over one turn or one way of the drive, how it moves when the slider moves as asked.

    With s(x) the slider's displacement by the drive's position: x' = v / s'(x) and x'' = (a - s''(x) x'^2) / s'(x).

    Args:
        scene: a linkage with an output point that slides, and that assembles all the way.
        position: of the output point along its guide from `through`, m; a number, or shape (n,).
        velocity: v, m/s, likewise.
        acceleration: a, m/s^2, likewise.

    Returns:
        One stroke from each dead point to the next, or to the end of the drive's way, in the order of the positions.

    Raises:
        Failure: the linkage does not decompose, or does not assemble all the way.
        InputError: the output point does not slide on the ground, or does not move.
    """
    linkage = followed(scene, decompose(scene))
    asked = {"position": position, "velocity": velocity, "acceleration": acceleration}
    s, v, a = map(np.atleast_1d, np.broadcast_arrays(*(finite_numbers(name, value) for name, value in asked.items())))
    displaced = displacement(scene, linkage, scene.output)
    least, most = linkage.drive.law.extent
    way = np.linspace(least, most, SAMPLES)
    meetings(scene, linkage).check(scene, linkage, way)
    if (apart := unreached(scene, linkage, way) != "").any():
        raise Failure(Status.cannot_assemble, describe(scene, linkage, float(way[apart][0])))
    if not np.ptp(displaced(way)[0]) > STILL_TOL * linkage.arm:
        raise InputError(f"{scene.output} stands still wherever the drive is: its motion does not give the drive's")
    if linkage.drive.slide is not None or most - least < 2 * pi - 1e-9:
        ends = [least, *dead_points(displaced, least, most), most]
    else:  # round the turn, from beside its start: a dead point there does not fall between its two ends
        dead = dead_points(displaced, least + pi / 1e4, least + pi / 1e4 + 2 * pi)
        ends = [*dead, dead[0] + 2 * pi]
    return [_stroke(displaced, start, end, s, v, a) for start, end in pairwise(ends)]


def _stroke(displaced: Displaced, start: float, end: float, s: Samples, v: Samples, a: Samples) -> InverseStroke:
    first, last = displaced(np.array([start, end]))[0]
    reached = (s >= min(first, last)) & (s <= max(first, last))
    position = zeros(lambda x: displaced(x)[0] - s, np.full(s.shape, start), np.full(s.shape, end))
    _, ds, dds = displaced(position)
    # Chain rule: v = s' x', a = s'' x'^2 + s' x''.
    with np.errstate(divide="ignore", invalid="ignore"):  # at a dead point no rate of the drive moves the slider
        rate = v / ds
        acceleration = (a - dds * rate**2) / ds
    return InverseStroke(start, end, *(np.where(reached, x, np.nan) for x in (position, rate, acceleration)))


def dead_points(displaced: Displaced, least: float, most: float) -> Samples:
    """Find the positions of the drive, from the least to the most, where s' changes its sign."""
    back, forth = changes(lambda position: displaced(position)[1] > 0, least, most)
    return (back + forth) / 2


def displacement(scene: Scene, linkage: Linkage, point: str) -> Displaced:
    """The displacement of a slider's point along its guide from `through`, with its derivatives by the drive."""
    guide_of(scene, point)  # which refuses a point without one

    def displaced(position: Samples) -> tuple[Samples, Samples, Samples]:
        k = motion_at(scene, linkage, position, rates=True)
        s, ds, dds, _ = np.broadcast_arrays(*k.displaced(scene, point), position)
        return s, ds, dds

    return displaced


def stroke_end(scene: Scene, linkage: Linkage, body: str, closing: float) -> float:
    """Find how far a cycle of the drive takes a slider in its closing direction, of this sign, m."""
    displaced = displacement(scene, linkage, scene.bodies[body].points[0])
    return float(
        furthest(lambda way: [each[None] for each in displaced(way[0])], closing, *linkage.drive.law.extent)[0]
    )


def furthest(
    displaced: Callable[[Samples], Sequence[Samples] | Samples], closing: ArrayLike, least: ArrayLike, most: ArrayLike
) -> Samples:
    """Find a slider's displacement at the dead point, or end of the drive's way, that is furthest, shape (m,), m.

    `displaced` gives the displacement, m, and its rate, at positions of m machines, shape (m, n). The sign of it in
    which the slider closes, and the drive's least and largest positions, are one, or each machine's, shape (m, 1).
    """
    closing, least, most = (np.reshape(given, (-1, 1)) for given in (closing, least, most))
    way = least + (most - least) * np.linspace(0, 1, SAMPLES + 1)
    closed = closing * displaced(way)[0]
    closed, way = np.broadcast_arrays(np.where(np.isnan(closed), -np.inf, closed), way)
    # The furthest sample has the dead point between its neighbours, where s' is zero. Both the samples and that zero
    # count: at an end of the way there is none, and the zero that bisection then returns is just another place on the
    # way.
    last = closed.argmax(axis=1)[:, None]
    low, high = (np.take_along_axis(way, np.clip(last + step, 0, SAMPLES), axis=1) for step in (-1, 1))
    dead = zeros(lambda position: closing * displaced(position)[1], low, high)
    ends = np.concatenate([closed.max(axis=1)[:, None], closing * displaced(dead)[0]], axis=1)
    return np.asarray(closing * np.nanmax(ends, axis=1, keepdims=True))[:, 0]
