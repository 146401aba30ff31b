"""Press forces at their switches, where rounding decides whether they act.

A press force jumps where its slider turns round, and where the last part of the stroke begins. On the switch itself
displacement and velocity say the one or the other by their last digits, and every model has its own: there an engine is
right on either side, as long as all its channels are on the same.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.motion import Samples
from scenes.scene import Force, PressForce

from .motion_vectors import MotionVectors

HAIR = 1e-6  # of the slider's range and peak speed: far above all rounding, far below the way between two samples
TURNING = 1e-3  # of the peak speed, a hair from the end: the way that is left there goes with the square of the speed

Pair: TypeAlias = Sequence[Any] | Samples  # of what is at the two ends of a step
Acts: TypeAlias = NDArray[np.bool_]  # shape (m, n): by sample, whether one force acts; on a switch both may hold
Acting: TypeAlias = Sequence[NDArray[np.bool_]]  # of each force, whether it acts, shape (n,)
Channels: TypeAlias = Mapping[str, Samples]


def press_forces(scene: Scene) -> tuple[PressForce, ...]:
    """Return the loads that depend on the direction of motion."""
    return tuple(load for load in scene.loads if isinstance(load, PressForce))


def stroke_end(state: MotionVectors, load: PressForce) -> float:
    """Return where the closing stroke ends, m: a sample, or a dead point between two, for which a cycle is needed."""
    x, v, a = (load.closing * samples for samples in state.displacement(state.scene.bodies[load.body]))
    time = state.motion["time"]
    turns = np.flatnonzero((v[:-1] > 0) & (v[1:] < 0))
    inside = [_peak(time[k + 1] - time[k], x[k : k + 2], v[k : k + 2], a[k : k + 2]) for k in turns]
    return load.closing * max([float(x.max()), *inside])


def _peak(h: float, x: Samples, v: Samples, a: Samples) -> float:
    """Return the largest value between two samples h apart, of the quintic with their values and derivatives."""
    path = np.polynomial.Polynomial(quintic(h, x, v, a))  # over the time from 0 to 1
    roots = path.deriv().roots()
    real = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > 0) & (roots.real < 1)]
    return float(max(path(real), default=x[0]))


def quintic(h: Any, x: Pair, v: Pair, a: Pair) -> Samples:
    """Return the six coefficients, shape (6, ...), over steps from 0 to 1, h long, from values and derivatives at both.

    Args:
        h: the length of the step.
        x: the values at its two ends, each of shape (...).
        v: the first derivatives.
        a: the second ones.
    """
    (x0, x1), (v0, v1), (a0, a1) = x, (h * v[0], h * v[1]), (h**2 * a[0], h**2 * a[1])
    d, e, f = x1 - x0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
    rest = 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2
    return np.array([x0, v0, a0 / 2, *rest])


def acts(state: MotionVectors, load: PressForce, end: float) -> Acts:
    """Return whether the force acts with displacement and velocity a hair less and a hair more, shape (4, n)."""
    x, v, _ = state.displacement(state.scene.bodies[load.body])
    dx = HAIR * np.ptp(x)
    dv = np.where(np.abs(end - x) <= dx, TURNING, HAIR) * np.abs(v).max()
    return np.array([load.acts(x + i * dx, v + j * dv, end) for i in (-1, 1) for j in (-1, 1)])


def stroke_ends(state: MotionVectors) -> tuple[float, ...]:
    """Return where the closing stroke of every press force ends, m; a slider has one for each way of closing."""
    presses = press_forces(state.scene)
    ends = {(load.body, load.closing): stroke_end(state, load) for load in unlike(presses)}
    return tuple(ends[load.body, load.closing] for load in presses)


def unlike(presses: Iterable[PressForce]) -> Iterable[PressForce]:
    """Return one press force of those whose strokes end at one place."""
    return {(load.body, load.closing): load for load in presses}.values()


# On a switch, n forces could stand in 2^n ways. The forces on one slider go by the same displacement and velocity: they
# stand as a hair to either side has them, or all that may act do, or none. Sliders are tried one after the other, so
# that the cost grows with the number of sliders that are on a switch at once.
def fitted(
    presses: Sequence[PressForce], may: Sequence[Acts], misfit: Callable[[Acting], tuple[Samples, Channels]]
) -> tuple[Channels, Channels]:
    """Return what the forces do where all act that may, and as they stand with the least misfit, sample by sample.

    Args:
        presses: the forces.
        may: whether each may act.
        misfit: of forces that stand somehow, shape (n,), and what they do then, each of shape (n,).
    """
    if not presses:
        _, alone = misfit([])
        return alone, alone
    standing, must = (np.array([of(act, axis=0) for act in may]) for of in (np.any, np.all))
    least, first = misfit([*standing])
    bodies = [load.body for load in presses]
    own = np.array([[name == body for name in bodies] for body in dict.fromkeys(bodies)])
    on = own @ (standing & ~must)  # shape (sliders, n)
    best = first
    for number in range(1, int(on.sum(axis=0).max()) + 1):
        tried = own.T @ (on & (np.cumsum(on, axis=0) == number))
        others = [must, *map(np.array, zip(*may, strict=True))] if len(own) < len(presses) else [must]
        for other in others:
            trial = np.where(tried, other, standing)
            off, then = misfit([*trial])
            better = off < least
            standing, least = np.where(better, trial, standing), np.where(better, off, least)
            best = {channel: np.where(better, then[channel], best[channel]) for channel in best}
    return first, best


def on_switch(may: Sequence[Acts]) -> NDArray[np.intp]:
    """Return the samples where a force may act and may not."""
    return np.flatnonzero(np.any([act.any(axis=0) & ~act.all(axis=0) for act in may], axis=0))


def fixed(scene: Scene, acting: Acting) -> Iterator[tuple[Scene, NDArray[np.intp]]]:
    """Yield scenes whose press forces always or never act, with the samples where they stand so."""
    ways, rows = np.unique(acting, axis=1, return_inverse=True)
    for number, way in enumerate(ways.T):
        standing = iter(way)
        loads = (
            load if not isinstance(load, PressForce) else Force(load.body, load.at, load.force)
            for load in scene.loads
            if not isinstance(load, PressForce) or next(standing)
        )
        yield replace(scene, loads=tuple(loads)), np.flatnonzero(rows == number)
