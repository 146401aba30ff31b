"""Change points on the drive's way: poses in which two branches meet, so that no one motion leads through them.

There a dyad is singular, but the drive can go on: a parallelogram stretched out, or a crank as long as its rod. Each
position beside it is solved on its own branch, and all look fine, but between two of them the motion jumps.
"""

import numpy as np

from scenes import Failure, Scene, Status
from scenes.drive import Driven
from scenes.motion import Samples

from .decomposition import inner_joint
from .group_equations import Group
from .kinematics import Linkage, kinematics
from .motion_range import in_line
from .solve import Solver

SAMPLES = 720  # a cycle, to find where a dyad is nearest to a singular configuration
POINTS, ROUNDS = 17, 16  # of each look closer: 8 times closer, down to the last place
MEET = 64 * np.finfo(float).eps  # of the largest coordinate: a distance that is lost in round-off


def check_way(solver: Solver) -> None:
    """Look for change points over the drive's range; larger groups are watched while they are followed.

    Args:
        solver: of the scene, and of the channels whose groups are looked at.

    Raises:
        Failure: `cannot_assemble` at a change point.
    """
    scene, linkage = solver.scene, solver.linkage
    if all(isinstance(group, Group) for group in linkage.groups):
        return
    least, most = scene.drive.extent
    way = np.linspace(least, most, SAMPLES + 1)
    distances = _to_lock(scene, linkage, way)
    if any((distance < 0).any() for distance in distances.values()):
        return  # it does not assemble all the way, which is reported where it is solved
    for joint, distance in distances.items():
        before, after = np.append(np.inf, distance[:-1]), np.append(distance[1:], np.inf)
        steepest = np.fmax(np.where(before < np.inf, before, 0), np.where(after < np.inf, after, 0)) - distance
        lowest = (distance <= before) & (distance <= after) & (distance <= steepest)  # so that it may reach zero
        for i in np.flatnonzero(lowest).tolist():
            where = _closest(scene, linkage, joint, float(way[max(i - 1, 0)]), float(way[min(i + 1, SAMPLES)]))
            if where is not None:
                group = next(group for group in linkage.groups if inner_joint(group) == joint)
                reason = f"two ways of assembling the bodies meet at {scene.where(where)}: {in_line(group)}"
                raise Failure(Status.cannot_assemble, reason)


def _closest(scene: Scene, linkage: Linkage, joint: str, least: float, most: float) -> float | None:
    """Return where between two positions a dyad is singular but for round-off, or None."""
    for _ in range(ROUNDS):
        way = np.linspace(least, most, POINTS)
        distance = _to_lock(scene, linkage, way)[joint]
        i = int(np.argmin(np.where(np.isnan(distance), np.inf, distance)))
        least, most = float(way[max(i - 1, 0)]), float(way[min(i + 1, POINTS - 1)])
    size = max(abs(complex(*place)) for place in scene.sketch.points.values())
    return float(way[i]) if distance[i] <= MEET * size else None


def _to_lock(scene: Scene, linkage: Linkage, position: Samples) -> dict[str, Samples]:
    """Return each dyad's distance from a singular configuration, m, shape (n,); NaN where it does not reach."""
    with np.errstate(invalid="ignore", divide="ignore"):
        k = kinematics(scene, linkage, Driven(position, np.array(1.0), np.array(0.0)), rates=False)
    return {joint: np.broadcast_to(distance, position.shape) for joint, distance in k.to_lock.items()}
