"""How far a linkage goes that cannot run, posed on the way there: for a picture of where it stops."""

from dataclasses import replace
from math import remainder

import numpy as np

from scenes import Failure, Scene
from scenes.channels import Role
from scenes.model.enclosures import MotionRange

from ..core.decomposition import decompose
from ..core.kinematics import followed
from ..solve import prepared
from .motion_range import motion_at, motion_range, unreached
from .singular import free_range

BESIDE = np.array([1e-9, 1e-6, 1e-4])  # of the way, before the end: the last of the poses that a singular one leaves
POSES = 361
SAME_PLACE_TOL = 1e-6  # rad or m: two places of the drive; where bars are in line roundings grow to their root


def stopped(scene: Scene, at: tuple[float, str] | None = None) -> MotionRange | None:
    """Return how far a linkage goes and the poses on the way, back from where it stops.

    Args:
        scene: the mechanism.
        at: a position of the drive, rad or m, where it cannot go on, and a joint that does not close there; None where
            no position is to blame.

    Returns:
        None where it has no pose at all.
    """
    try:
        linkage = followed(scene, decompose(scene))
        intervals = motion_range(scene, linkage)
    except Failure:
        return None
    start, turn = linkage.drive.law.start, linkage.drive.turn
    position, joint = at or (start, "")
    ways = [(first, last) for (first, _), (last, _) in intervals]
    free = free_range(scene, linkage) if at and not intervals else None
    # The end that is nearest to where the run fails: of an interval in which the linkage assembles; else that place
    # itself; else the singular configuration there, with the free range up to it. Poses are then laid from that end
    # towards the other one, densest next to it.
    if intervals:
        ends = [*intervals, *(interval[::-1] for interval in intervals)]
        (end, joint), (begin, _) = min(ends, key=lambda way: abs(remainder(way[0][0] - position, turn)))
    elif position != start:
        end, begin, ways = position, start, [(min(start, position), max(start, position))]
    elif free and (near := [x for x in free if abs(remainder(x - position, turn)) <= SAME_PLACE_TOL]):
        (end,), ways = near[:1], [free]
        begin = free[free[0] == end]
    else:
        end, begin = start, max(linkage.drive.law.extent, key=lambda other: abs(other - start))
    way = end + (begin - end) * np.union1d(BESIDE, np.linspace(0, 1, POSES))
    posed = motion_at(scene, linkage, way).z
    way = way[np.all([np.broadcast_to(np.isfinite(posed[point]), way.shape) for point in scene.moving_points], axis=0)]
    if not len(way):
        return None
    places = frozenset(c for c in scene.channels.names(Role.kinematic) if scene.channels[c].order == 0)
    solver = replace(prepared(scene, linkage, places), as_sketched=False)  # the range ends where assemblies meet
    motion = solver(way, np.zeros(len(way)))
    beyond = end + np.sign(end - begin) * BESIDE[1:2] * abs(end - begin)
    meets = bool(joint) and unreached(scene, linkage, beyond)[0] == ""
    return MotionRange(motion, joint, ways, meets)
