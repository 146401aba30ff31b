"""By how much a linkage that cannot be assembled fails to close: the joint that stays open when all others close."""

from collections.abc import Iterable

import numpy as np

from scenes.motion import Samples

from .constraints import LinkageConstraints, Poses

HEAVY = 1e3  # weight of what is held closed: it gives way by a millionth of the gap
OPEN = 1e-9  # of the linkage's size: a gap larger than what the least squares leave


def misfit(linkage: LinkageConstraints, q: Poses, positions: Iterable[float]) -> str:
    """Return which joint stays open at the first position of the drive where one does, and by how much, or nothing.

    Near the pose q, shape (1, bodies, 3), all joints give way alike, then the worst of them alone, the last of
    equals.
    """
    scene = linkage.scene
    joints = {f"the guide of {name}": [2 * row] for row, name in enumerate(linkage.slides, start=len(scene.pins))}
    joints |= {pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(scene.pins)}
    for position in positions:
        gaps = _closest(linkage, q, position, [*joints.values()])
        worst = max(reversed(joints), key=lambda joint: float(f"{np.linalg.norm(gaps[joints[joint]]):.2g}"))
        gap = float(np.linalg.norm(_closest(linkage, q, position, [joints[worst]])[joints[worst]]))
        if gap > OPEN * linkage.size:
            where = scene.where(position)
            return f"; with all else closed {worst} stays open by {scene.length(gap)} at {where}"
    return ""


def _closest(linkage: LinkageConstraints, q: Poses, position: float, give_way: list[list[int]]) -> Samples:
    """Return C of least squares near q, shape (3 bodies,), where all rows but those that give way are closed."""
    from scipy.optimize import least_squares  # late: only a linkage that fails needs it

    units = np.tile([linkage.size, linkage.size, 1.0], q.shape[1])
    weights = np.full(q.size, HEAVY)
    weights[np.concatenate(give_way)] = 1.0

    def pose(x: Samples) -> Poses:
        return np.reshape(x * units, q.shape)

    def gaps(x: Samples) -> Samples:
        return np.asarray(linkage.gaps(pose(x), np.array([position]))[0])

    def slope(x: Samples) -> Samples:
        return np.asarray(weights[:, np.newaxis] * linkage.jacobian(pose(x))[0] * units)

    return gaps(least_squares(lambda x: weights * gaps(x), q.ravel() / units, slope, method="lm").x)
