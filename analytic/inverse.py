"""From the slider back to the drive: where it is when the slider is there, and how it must move to move it so."""

from dataclasses import dataclass
from itertools import pairwise
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from scenes import Failure, InputError, Scene, Status
from scenes.arguments import finite_numbers
from scenes.motion import Samples

from .dead_points import SAMPLES, Displaced, bisected, dead_points, displacement
from .decomposition import decompose
from .kinematics import followed
from .motion_range import describe

STILL = 1e-12  # of the longest arm: roundings of a slider that stands still


@dataclass(frozen=True)
class Stroke:
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
) -> list[Stroke]:
    """Return, stroke by stroke over one turn or one way of the drive, how it moves when the slider moves as asked.

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
    way = np.linspace(*scene.drive.extent, SAMPLES)
    along = displaced(way)[0]
    if np.isnan(along).any():
        raise Failure(Status.cannot_assemble, describe(scene, linkage, float(way[np.isnan(along)][0])))
    if not np.ptp(along) > STILL * linkage.arm:
        raise InputError(f"{scene.output} stands still wherever the drive is: its motion does not give the drive's")
    return [_stroke(displaced, start, end, s, v, a) for start, end in pairwise(_ends(scene, displaced))]


def _ends(scene: Scene, displaced: Displaced) -> Samples:
    """Return where strokes begin and end: from dead point to dead point round the turn, or along the drive's way."""
    least, most = scene.drive.extent
    if scene.driven_slide is not None or most - least < 2 * pi - 1e-9:
        return np.array([least, *dead_points(displaced, least, most), most])
    first = least + pi / 1e4  # so that a dead point just at the start does not fall between both ends of the turn
    dead = dead_points(displaced, first, first + 2 * pi)
    return np.append(dead, dead[0] + 2 * pi)


def _stroke(displaced: Displaced, start: float, end: float, s: Samples, v: Samples, a: Samples) -> Stroke:
    first, last = displaced(np.array([start, end]))[0]
    reached = (s >= min(first, last)) & (s <= max(first, last))
    position = bisected(lambda x: displaced(x)[0] - s, np.full(s.shape, start), np.full(s.shape, end))
    _, ds, dds = displaced(position)
    with np.errstate(divide="ignore", invalid="ignore"):  # at a dead point no rate of the drive moves the slider
        rate = v / ds
        acceleration = (a - dds * rate**2) / ds
    return Stroke(start, end, *(np.where(reached, x, np.nan) for x in (position, rate, acceleration)))
