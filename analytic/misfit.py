"""By how much a group that cannot be assembled fails to close: the joint that stays open when all others close."""

import numpy as np

from scenes import Scene
from scenes.motion import Samples

from .decomposition import Dyad, guides_cross
from .group_equations import Group, GroupEquations, Pose
from .newton_group import own_jacobian

HEAVY = 1e3  # weight of what does not give way: the angles of guides
OPEN = 1e-9  # of the group's size: a gap larger than roundings


def of_dyad(scene: Scene, dyad: Dyad, to_lock: float) -> str:
    """Return how far apart the legs end, by the distance beyond the singular pose, m; nothing of crossing guides."""
    one, two = (leg.body for leg in dyad.legs)
    return "" if guides_cross(dyad) else f": {one} and {two} end {scene.length(abs(to_lock))} apart"


def of_group(scene: Scene, group: Group, equations: GroupEquations, q: Samples, placed: Pose) -> str:
    """Return which joint of a larger group stays open, near coordinates q, shape (1, m), or nothing."""
    pins = len(group.pins)
    joints = {f"the guide of {slide.slider}": [2 * pins + row] for row, slide in enumerate(group.slides)}
    joints |= {pin.point: [row, pins + row] for row, pin in enumerate(group.pins)}
    joint, gap = _open(equations, q[0], placed, joints)
    return f": with all else closed {joint} stays open by {scene.length(gap)}" if gap > OPEN * equations.size else ""


def _open(equations: GroupEquations, q: Samples, placed: Pose, joints: dict[str, list[int]]) -> tuple[str, float]:
    """Return the joint that stays open, and its gap, m: none where all close, or where not one alone stays open.

    By least squares all joints give way; then the worst of them alone, the last of equals.
    """
    from scipy.optimize import least_squares, minimize  # late: only a linkage that fails needs it

    size, is_gap = equations.size, np.isin(np.arange(len(q)), np.concatenate([*joints.values()]))
    scale, weights = np.where(is_gap, 1 / size, 1.0), np.where(is_gap, 1.0, HEAVY * max(1.0, 1 / size))
    units = np.tile([size, size, 1.0], equations.bodies)

    def pose(x: Samples) -> Pose:
        return equations.pose((x * units)[np.newaxis], placed)

    def gaps(x: Samples) -> Samples:
        return np.asarray(scale * equations.open(pose(x))[0])

    def slope(x: Samples) -> Samples:
        return np.asarray(scale[:, np.newaxis] * own_jacobian(equations, pose(x))[0] * units)

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
