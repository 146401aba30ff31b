"""The scene's channels, rounded to double precision here and nowhere before."""

from collections.abc import Iterable, Sequence
from math import ceil, tau

import numpy as np
from flint import arb, arb_mat

from scenes.motion import Samples, force_channels

from .constraints import LinkageEquations
from .rows import angles
from .solution import State


def channels(linkage: LinkageEquations, states: Sequence[State]) -> dict[str, Samples]:
    """Return all channels but the time, shape (n,), at the precision that the caller has set."""
    scene, points = linkage.scene, linkage.points
    found = {scene.drive_channel: _table(linkage.position.value(state.q) for state in states)[:, 0]}
    moved = [(points.jacobian(state.q), state) for state in states]
    levels = {
        "": _table(points.value(state.q) for state in states),
        "v": _table(J * state.velocity for J, state in moved),
        "a": _table(J * state.acceleration - points.centripetal(state.q, state.velocity) for J, state in moved),
    }
    for k, point in enumerate(scene.moving_points):
        for level, values in levels.items():
            found |= {f"{point}.{level}x": values[:, 2 * k], f"{point}.{level}y": values[:, 2 * k + 1]}
    turns = {
        "angle": _rounded(map(_within_a_turn, angles(state.q)) for state in states),
        "omega": _rounded(angles(state.velocity) for state in states),
        "alpha": _rounded(angles(state.acceleration) for state in states),
    }
    for body in scene.turning:
        found |= {f"{body}.{rate}": values[:, linkage.index[body]] for rate, values in turns.items()}
    if scene.has_masses:
        found |= zip(force_channels(scene), _table(state.multipliers for state in states).T, strict=True)
    return found


def _within_a_turn(angle: arb) -> arb:
    """Return an angle less the whole turns that leave it in (-π, π]."""
    return angle - 2 * arb.pi() * ceil(float(angle) / tau - 0.5)


def _table(columns: Iterable[arb_mat]) -> Samples:
    return _rounded(column.entries() for column in columns)


def _rounded(rows: Iterable[Iterable[arb]]) -> Samples:
    return np.array([[float(ball) for ball in row] for row in rows])
