"""Press forces at their switches, where rounding decides whether they act.

A press force jumps where its slider turns round, and where the last part of the stroke begins. On the switch itself
displacement and velocity say the one or the other by their last digits, and every model has its own: there an engine is
right on either side, as long as all its channels are on the same.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.model.motion import Samples
from scenes.scene import Force, PressForce

from .motion_vectors import Acts

Acting: TypeAlias = Sequence[NDArray[np.bool_]]  # of each force, whether it acts, shape (n,)
Channels: TypeAlias = Mapping[str, Samples]


# On a switch, n forces could stand in 2^n ways. The forces on one slider go by the same displacement and velocity: they
# stand as a hair to either side has them, or all that may act do, or none. Sliders are tried one after the other, so
# that the cost grows with the number of sliders that are on a switch at once.
def fitted(
    presses: Sequence[PressForce], may: Sequence[Acts], misfit: Callable[[Acting], tuple[Samples, Channels]]
) -> tuple[Channels, Channels]:
    """What the forces do where all act that may, and as they stand with the least misfit, sample by sample.

    `misfit` is that of forces that stand somehow, shape (n,), with what they do then, each of shape (n,).
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
    """The samples where a force may act and may not."""
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
