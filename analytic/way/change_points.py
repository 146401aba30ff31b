"""Singular configurations on the drive's way, between samples too: no one motion leads through them.

At a change point two branches meet, and the drive can go on: a parallelogram stretched out, or a crank as long as its
rod. A bar a hair too short does not reach for a hair of the way. Guides that become parallel cross infinitely far away.
Each position beside it is solved on its own branch, and all look fine. So each least distance to such a place among
samples of the way is looked at closer and closer, until it is lost in round-off or stays above it.
"""

import numpy as np

from scenes import Failure, Scene, Status
from scenes.arguments import refuse
from scenes.model.motion import Samples

from ..core.decomposition import Dyad, Linkage, guides_cross
from ..core.groups.group_equations import Group
from ..core.groups.newton_group import ROUGHLY, least_singular_value
from ..core.placing import Kinematics
from ..solve import Solver, check_reach
from .motion_range import in_line, motion_at

SAMPLES = 720  # a cycle, to find where a group is nearest to a singular configuration
POINTS, ROUNDS = 17, 16  # of each look closer: 8 times closer, down to the last place
MEET = 64 * np.finfo(float).eps  # of the largest coordinate: a distance that is lost in round-off


def check_way(solver: Solver) -> None:
    """Look for singular configurations over the drive's range, of the groups that a solver's channels need.

    Raises:
        Failure: `cannot_assemble` at a singular configuration, or where the bodies do not reach.
    """
    if not isinstance(solver, Solver):
        refuse("solver", "what analytic.solver(...) returns", solver)
    scene, linkage = solver.scene, solver.linkage
    way = np.linspace(*scene.drive.extent, SAMPLES + 1)
    k = motion_at(scene, linkage, way)
    check_reach(scene, linkage, k, way)
    for group, distance in _to_lock(linkage, k, way).items():
        before, after = np.append(np.inf, distance[:-1]), np.append(distance[1:], np.inf)
        steepest = np.fmax(np.where(before < np.inf, before, 0), np.where(after < np.inf, after, 0)) - distance
        lowest = (distance <= before) & (distance <= after) & (distance <= steepest)  # so that it may reach zero
        for i in np.flatnonzero(lowest).tolist():
            _look_closer(scene, linkage, group, way[max(i - 1, 0) : i + 2])


def _look_closer(scene: Scene, linkage: Linkage, nearest: Dyad | Group, way: Samples) -> None:
    """Look between two positions, where one group is nearest to a singular configuration, at all of them."""
    size = max(abs(complex(*place)) for place in scene.sketch.points.values())
    singular: Dyad | Group | None = None
    for _ in range(ROUNDS):
        way = np.linspace(way[0], way[-1], POINTS)
        distances = _to_lock(linkage, motion_at(scene, linkage, way), way)
        for group, distance in distances.items():
            lost = ROUGHLY * linkage.tracks[group].equations.size if isinstance(group, Group) else MEET * size
            if singular is None and not (distance > lost).all():
                nearest = singular = group
        i = int(np.where(np.isnan(distances[nearest]), -np.inf, distances[nearest]).argmin())
        where, way = float(way[i]), way[max(i - 1, 0) : i + 2]
    if singular is not None:
        meet = not isinstance(singular, Group) and not guides_cross(singular)
        why = "two ways of assembling the bodies meet" if meet else "the linkage is singular"
        reason = f"{why} at {scene.where(where)}: {in_line(singular)}"
        raise Failure(Status.cannot_assemble, reason, at=(where, singular.P))


def _to_lock(linkage: Linkage, k: Kinematics, way: Samples) -> dict[Dyad | Group, Samples]:
    """What is zero where a group is singular, m, shape (n,), a larger group's being no length; NaN unreached."""
    return {
        group: least_singular_value(*k.jacobian[group.P][::2])
        if isinstance(group, Group)
        else np.broadcast_to(k.to_lock[group.P], way.shape)
        for group in linkage.groups
    }
