"""By how much a linkage that cannot be assembled fails to close: the joint that stays open when all others close."""

from collections.abc import Iterable

import numpy as np

from .equations import Equations
from .system import Array, ExudynSystem

HEAVY = 1e3  # weight of what does not give way: the drive, and the angles of guides
OPEN = 1e-9  # of the linkage's size: a gap larger than roundings


def misfit(system: ExudynSystem, equations: Equations, q: Array, positions: Iterable[float]) -> str:
    """Return which joint stays open, near a pose q, at the first position of the drive where one does, or nothing."""
    scene = system.scene
    joints = {f"the guide of {name}": system.columns(slide)[:1] for name, slide in system.slides.items()}
    joints |= {name: system.columns(pin) for name, pin in system.pins.items()}
    for position in positions:
        joint, gap = _open(equations, system.size, q, position, joints)
        if gap > OPEN * system.size:
            return f"; with all else closed {joint} stays open by {scene.length(gap)} at {scene.where(position)}"
    return ""


def _open(
    equations: Equations, size: float, q: Array, position: float, joints: dict[str, list[int]]
) -> tuple[str, float]:
    """Return the joint that stays open, and its gap, m: none where all close, or where not one alone stays open.

    By least squares all joints give way; then the worst of them alone, the last of equals.
    """
    from scipy.optimize import least_squares, minimize  # late: only a linkage that fails needs it

    is_gap = np.isin(np.arange(len(q)), np.concatenate([*joints.values()]))
    scale, weights = np.where(is_gap, 1 / size, 1.0), np.where(is_gap, 1.0, HEAVY * max(1.0, 1 / size))
    units = np.tile([size, size, 1.0], len(q) // 3)

    def gaps(x: Array) -> Array:
        return np.asarray(scale * equations.residual(x * units, position))

    def slope(x: Array) -> Array:
        return np.asarray(scale[:, np.newaxis] * equations.jacobian(x * units) * units)

    x = least_squares(
        lambda x: weights * gaps(x), q / units, lambda x: weights[:, np.newaxis] * slope(x), method="lm"
    ).x
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
