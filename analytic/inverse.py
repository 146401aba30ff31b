"""From the slider back to the crank: which crank angles put it there, and how the crank must turn to move it so."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from math import pi
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.motion import Samples

from .decomposition import Decomposition, decompose
from .solve import solve_decomposed

SAMPLES = 3600  # a turn: two dead points closer together than this grid are not seen
BISECTIONS = 60  # from a whole turn down to the last place


Displaced: TypeAlias = Callable[[Samples], tuple[Samples, Samples, Samples]]  # crank angle -> s, s', s''


@dataclass(frozen=True)
class Stroke:
    """The crank angles between two neighbouring dead points: one way of reaching positions of the slider.

    The arrays have the shape (n,) of the positions asked for, NaN where the slider does not get there on this stroke.
    """

    start: float  # rad, the dead point where it begins
    end: float  # rad, the next one
    crank_angle: Samples  # rad
    omega: Samples  # rad/s
    alpha: Samples  # rad/s^2


def inverse(
    scene: Scene, position: ArrayLike, velocity: ArrayLike = 0.0, acceleration: ArrayLike = 0.0
) -> list[Stroke]:
    """Return, stroke by stroke over one turn, how the crank moves when the slider moves as asked.

    With s(theta) the slider's displacement, omega = v / s' and alpha = (a - s'' omega^2) / s'.

    Args:
        scene: a linkage that turns fully, with an output point that slides.
        position: of the output point along its guide from `through`, m; a number, or shape (n,).
        velocity: v, m/s, likewise.
        acceleration: a, m/s^2, likewise.

    Raises:
        Failure: the linkage does not decompose, or does not turn fully.
        ValueError: the output point does not slide.
    """
    s, v, a = (np.atleast_1d(np.asarray(x, float)) for x in np.broadcast_arrays(position, velocity, acceleration))
    displaced = partial(displacement, scene, decompose(scene))
    dead = _dead_points(displaced, scene.drive.start)
    return [_stroke(displaced, start, end, s, v, a) for start, end in pairwise(dead)]


def displacement(scene: Scene, linkage: Decomposition, crank_angle: Samples) -> tuple[Samples, Samples, Samples]:
    """Return s, s' and s'' of the output point along its guide, m and m a radian (squared), shape (n,).

    Raises:
        ValueError: the output point does not slide.
    """
    slide = next((body.slide for body in scene.bodies.values() if body.slide and scene.output in body.points), None)
    if slide is None:
        raise ValueError(f"{scene.output} is on no body that slides")
    motion, p, w = solve_decomposed(scene, linkage, crank_angle), scene.output, scene.drive.speed
    (tx, ty), (x, y) = slide.along, slide.through
    s = tx * (motion[f"{p}.x"] - x) + ty * (motion[f"{p}.y"] - y)
    ds = (tx * motion[f"{p}.vx"] + ty * motion[f"{p}.vy"]) / w
    dds = (tx * motion[f"{p}.ax"] + ty * motion[f"{p}.ay"]) / w**2
    return s, ds, dds


def _dead_points(displaced: Displaced, first: float) -> Samples:
    """Return the crank angles of one turn where the slider stands still, and the first again a turn later."""
    grid = np.arange(SAMPLES + 1) + 0.5  # a dead point just at the start must not fall between both ends of the turn
    turn = first + grid * 2 * pi / SAMPLES
    forward = displaced(turn)[1] > 0
    before = np.flatnonzero(forward[1:] != forward[:-1])
    dead = _bisect(lambda angle: displaced(angle)[1], turn[before], turn[before + 1])
    return np.append(dead, dead[0] + 2 * pi)


def _stroke(displaced: Displaced, start: float, end: float, s: Samples, v: Samples, a: Samples) -> Stroke:
    first, last = displaced(np.array([start, end]))[0]
    reached = (s >= min(first, last)) & (s <= max(first, last))
    angle = _bisect(lambda x: displaced(x)[0] - s, np.full(s.shape, start), np.full(s.shape, end))
    _, ds, dds = displaced(angle)
    with np.errstate(divide="ignore", invalid="ignore"):  # at a dead point no crank speed moves the slider
        omega = v / ds
        alpha = (a - dds * omega**2) / ds
    return Stroke(start, end, *(np.where(reached, x, np.nan) for x in (angle, omega, alpha)))


def _bisect(f: Callable[[Samples], Samples], low: Samples, high: Samples) -> Samples:
    """Return the zeros of f, one in each bracket, shape (n,)."""
    rising = f(high) > f(low)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        beyond = (f(middle) > 0) == rising
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return (low + high) / 2
