"""By how much a linkage that cannot be assembled fails to close: the joint that stays open when all others close.

A sentence for the user, so in doubles.
"""

from collections.abc import Iterable

import numpy as np
from flint import arb_mat
from numpy.typing import NDArray

from .constraints import LinkageEquations

HEAVY = 1e3  # weight of what is held closed: it gives way by a millionth of the gap
OPEN = 1e-9  # of the linkage's size: a gap larger than what the least squares leave


def misfit(linkage: LinkageEquations, q: arb_mat, positions: Iterable[float]) -> str:
    """Return which joint stays open at the first position of the drive where one does, and by how much, or nothing.

    Near the pose q, shape (3 bodies, 1), all joints give way alike, then the worst of them alone, the last of equals.
    """
    scene = linkage.scene
    sliders = [body.name for body in scene.bodies.values() if body.slide is not None]
    joints = {f"the guide of {name}": [2 * row] for row, name in enumerate(sliders, start=len(scene.pins))}
    joints |= {pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(scene.pins)}
    for position in positions:
        gaps = _closest(linkage, q, position, [*joints.values()])
        worst = max(reversed(joints), key=lambda joint: float(f"{np.linalg.norm(gaps[joints[joint]]):.2g}"))
        gap = float(np.linalg.norm(_closest(linkage, q, position, [joints[worst]])[joints[worst]]))
        if gap > OPEN * linkage.size:
            where = scene.where(position)
            return f"; with all else closed {worst} stays open by {scene.length(gap)} at {where}"
    return ""


def _closest(linkage: LinkageEquations, q: arb_mat, position: float, give_way: list[list[int]]) -> NDArray[np.float64]:
    """Return f(q) less its goal of least squares near q, where all rows but those that give way are closed."""
    from scipy.optimize import least_squares  # late: only a linkage that fails needs it

    rows, goal, units = linkage.constraints, linkage.drive(position), np.array(linkage.units)
    weights = np.full(len(units), HEAVY)
    weights[np.concatenate(give_way)] = 1.0

    def pose(x: NDArray[np.float64]) -> arb_mat:
        return arb_mat([[value] for value in (x * units).tolist()])

    def gaps(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([float(gap) for gap in (rows.value(pose(x)) - goal).entries()])

    def slope(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(weights[:, np.newaxis] * np.array(rows.jacobian(pose(x)).tolist(), dtype=float) * units)

    start = np.array([float(value) for value in q.entries()]) / units
    return gaps(least_squares(lambda x: weights * gaps(x), start, slope, method="lm").x)
