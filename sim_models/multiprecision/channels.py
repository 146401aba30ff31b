"""The scene's channels, rounded to double precision here and nowhere before."""

from collections.abc import Iterable, Sequence
from math import ceil, tau

import numpy as np
from flint import arb, arb_mat

from scenes.motion import Samples, force_channels

from .constraints import LinkageEquations
from .rows import angles
from .solution import Solution


def channels(linkage: LinkageEquations, solutions: Sequence[Solution]) -> dict[str, Samples]:
    """Return all channels but the time, shape (n,), at the precision that the caller has set."""
    scene, points = linkage.scene, linkage.points
    found = {scene.drive_channel: _table(linkage.position.value(solution.q) for solution in solutions)[:, 0]}
    moved = [(points.jacobian(solution.q), solution) for solution in solutions]
    levels = {
        "": _table(points.value(solution.q) for solution in solutions),
        "v": _table(J * solution.velocity for J, solution in moved),
        "a": _table(
            J * solution.acceleration - points.centripetal(solution.q, solution.velocity) for J, solution in moved
        ),
    }
    for k, point in enumerate(scene.moving_points):
        for level, values in levels.items():
            found |= {f"{point}.{level}x": values[:, 2 * k], f"{point}.{level}y": values[:, 2 * k + 1]}
    turns = {
        "angle": _rounded(map(_within_a_turn, angles(solution.q)) for solution in solutions),
        "omega": _rounded(angles(solution.velocity) for solution in solutions),
        "alpha": _rounded(angles(solution.acceleration) for solution in solutions),
    }
    for body in scene.turning:
        found |= {f"{body}.{rate}": values[:, linkage.index[body]] for rate, values in turns.items()}
    if scene.has_masses:
        found |= zip(force_channels(scene), _table(solution.multipliers for solution in solutions).T, strict=True)
    return found


def _within_a_turn(angle: arb) -> arb:
    """Return an angle less the whole turns that leave it in (-π, π]."""
    return angle - 2 * arb.pi() * ceil(float(angle) / tau - 0.5)


def _table(columns: Iterable[arb_mat]) -> Samples:
    return _rounded(column.entries() for column in columns)


def _rounded(rows: Iterable[Iterable[arb]]) -> Samples:
    return np.array([[float(ball) for ball in row] for row in rows])
