"""By how much a linkage that cannot be assembled fails to close: the joint that stays open when all others close.

A sentence for the user, so in doubles.
"""

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np
from flint import arb_mat
from numpy.typing import NDArray

from .constraints import LinkageEquations

Array: TypeAlias = NDArray[np.float64]

HEAVY = 1e3  # weight of what does not give way: the drive, and the angles of guides
OPEN = 1e-9  # of the linkage's size: a gap larger than roundings


def misfit(linkage: LinkageEquations, q: arb_mat, positions: Iterable[float]) -> str:
    """Return which joint stays open, near a pose q, at the first position of the drive where one does, or nothing."""
    scene = linkage.scene
    sliders = [body.name for body in scene.bodies.values() if body.slide is not None]
    joints = {f"the guide of {name}": [2 * row] for row, name in enumerate(sliders, start=len(scene.pins))}
    joints |= {pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(scene.pins)}
    for position in positions:
        joint, gap = _open(linkage, q, position, joints)
        if gap > OPEN * linkage.size:
            return f"; with all else closed {joint} stays open by {scene.length(gap)} at {scene.where(position)}"
    return ""


def _open(linkage: LinkageEquations, q: arb_mat, position: float, joints: dict[str, list[int]]) -> tuple[str, float]:
    """Return the joint that stays open, and its gap, m: none where all close, or where not one alone stays open.

    By least squares all joints give way; then the worst of them alone, the last of equals.
    """
    from scipy.optimize import least_squares, minimize  # late: only a linkage that fails needs it

    size, is_gap = linkage.size, np.isin(np.arange(q.nrows()), np.concatenate([*joints.values()]))
    scale, weights = np.where(is_gap, 1 / size, 1.0), np.where(is_gap, 1.0, HEAVY * max(1.0, 1 / size))
    rows_of, goal, units = linkage.constraints, linkage.drive(position), np.array(linkage.units)

    def pose(x: Array) -> arb_mat:
        return arb_mat([[value] for value in (x * units).tolist()])

    def gaps(x: Array) -> Array:
        return np.asarray(scale * [float(gap) for gap in (rows_of.value(pose(x)) - goal).entries()])

    def slope(x: Array) -> Array:
        return np.asarray(scale[:, np.newaxis] * np.array(rows_of.jacobian(pose(x)).tolist(), dtype=float) * units)

    start = np.array([float(value) for value in q.entries()]) / units
    x = least_squares(lambda x: weights * gaps(x), start, lambda x: weights[:, np.newaxis] * slope(x), method="lm").x
    worst = max(reversed(joints), key=lambda joint: float(f"{np.linalg.norm(gaps(x)[joints[joint]]):.2g}"))
    rows = joints[worst]
    others = np.delete(np.arange(len(x)), rows)
    closest = minimize(
        lambda x: gaps(x)[rows] @ gaps(x)[rows],
        x,
        jac=lambda x: 2 * gaps(x)[rows] @ slope(x)[rows],
        constraints={"type": "eq", "fun": lambda x: gaps(x)[others], "jac": lambda x: slope(x)[others]},
        method="SLSQP",
        options={"ftol": 1e-14},
    )
    left = gaps(closest.x)
    return worst, float(np.linalg.norm(left[rows])) * size if np.abs(left[others]).max() <= OPEN else 0.0
