"""All assemblies of a linkage at a position of its drive, and which of them are on one circuit.

A dyad is assembled in two ways. From one to the other without taking it apart a linkage gets where the dyad is in a
singular configuration, at an end of an interval of the drive's range in which it assembles.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from math import ceil, inf, remainder, sqrt, tau
from typing import Any, TypeAlias

import numpy as np

from scenes import Scene
from scenes.arguments import finite_numbers, scene_of
from scenes.model.enclosures import Assemblies, Assembly
from scenes.model.motion import Samples, kinematic_channels

from ..core.decomposition import Linkage, decompose
from ..core.groups.continuation import Track
from ..core.groups.group_equations import FramePoses, Group, equations_of
from ..core.groups.newton_group import own_jacobian
from ..core.kinematics import followed, placed
from ..core.placing import Kinematics
from ..solve import prepared
from ..way.motion_range import Interval, motion_at, motion_range
from .group_assemblies import poses

SAME = 1e-6  # of the longest arm: two poses, or two ends of intervals
End: TypeAlias = tuple[float, str]  # a position of the drive, rad or m, and the joint of the group singular there

MOST = 64  # branches of dyads of which circuits are looked for, each by its whole range


def assemblies(scene: Scene, position: float | None = None, *, circuits: bool = True) -> Assemblies:
    """Find all ways to put the bodies together while the drive stays where it is.

    Args:
        scene: the mechanism.
        position: of the drive, rad or m; where the sketch shows it if None.
        circuits: whether to look for which are on one circuit, over the whole range of each.

    Raises:
        Failure: the linkage does not decompose, or a larger group does not close near the sketch.
    """
    at = finite_numbers("position", scene_of(scene).sketch.drive if position is None else position).reshape(1)
    whole, complete = decompose(scene), True
    ways = [replace(whole, groups=())]
    for group in whole.groups:
        if isinstance(group, Group):
            found = [_closed(scene, way, group, at) for way in ways]
            ways, complete = [way for some, _ in found for way in some], complete and all(known for _, known in found)
        else:
            both = [replace(way, groups=(*way.groups, replace(group, branch=b))) for way in ways for b in (1, -1)]
            ways = [way for way in both if not np.any(_at(scene, way, at).reach.get(group.P, np.zeros(1)) < 0)]
    drawn = followed(scene, whole)
    own = _at(scene, drawn, at).z
    if not ways and not complete:  # of a group that is too large for it
        ways = [drawn]
    several = not any(isinstance(group, Group) for group in whole.groups) and 2 ** len(whole.groups) <= MOST
    known: Sequence[tuple[int | None, Sequence[End]]] = [(None, ())] * len(ways)
    if circuits and several:
        known = _circuits(scene, whole, ways, float(at[0]))
    channels = frozenset(kinematic_channels(scene)[2:])
    made = []
    for way, (circuit, meets) in zip(ways, known, strict=True):
        z = _at(scene, way, at).z
        if not all(np.isfinite(z[point]).all() for point in scene.moving_points):
            complete = False  # a group that can turn by itself there: two of its points are in one place
            continue
        off = [np.ravel(z[point])[0] - complex(*xy) for point, xy in scene.sketch.points.items()]
        meant = all(np.all(np.abs(z[point] - own[point]) <= SAME * way.arm) for point in scene.moving_points)
        motion = prepared(scene, way, channels, way.tracks)(at, np.zeros(1))
        away = float(np.linalg.norm(off)) / sqrt(len(off) or 1)
        made.append(Assembly(motion, meant, away, circuit, meets))
    made.sort(key=lambda one: one.off_sketch)
    numbers = [*dict.fromkeys(one.circuit for one in made)]
    named = (one if one.circuit is None else replace(one, circuit=numbers.index(one.circuit)) for one in made)
    return Assemblies(float(at[0]), [*named], complete)


def _at(scene: Scene, way: Linkage, at: Samples) -> Kinematics:
    return motion_at(scene, way, at, rates=False)


def _closed(scene: Scene, before: Linkage, group: Group, at: Samples) -> tuple[list[Linkage], bool]:
    """A linkage with each of the poses in which a larger group closes, and whether none is missed."""
    equations, frames = equations_of(scene, before.bodies, group), placed(scene, before, group, at).pose
    q, complete = poses(equations, FramePoses(frames.z[0], frames.angle[0]), float(at[0]))
    ways = []
    for pose in q[:, np.newaxis]:
        branch = float(np.linalg.slogdet(own_jacobian(equations, equations.pose(pose, frames)))[0][0])
        track = Track(equations, np.inf, np.inf, at, pose, 0 * pose, 0 * pose, branch)
        ways.append(replace(before, groups=(*before.groups, group), tracks={**before.tracks, group: track}))
    return ways, complete


def _circuits(scene: Scene, whole: Linkage, ways: Sequence[Linkage], at: float) -> list[tuple[int | None, list[End]]]:
    """By assembly of dyads, the number of its circuit, and where it meets others."""
    from scipy.sparse.csgraph import connected_components  # late: slow to import, and few runs need it

    groups, turns = whole.groups, scene.driven_slide is None
    parts: list[tuple[tuple[Any, ...], Interval]] = []
    for branches in product((1, -1), repeat=len(groups)):
        branched: Any = (replace(group, branch=b) for group, b in zip(groups, branches, strict=True))  # type: ignore[arg-type]
        intervals = motion_range(scene, replace(whole, groups=tuple(branched)))
        parts += [(branches, interval) for interval in intervals or [Interval(-np.inf, np.inf, "", "")]]

    def off(one: float, other: float) -> float:
        return abs(remainder(one - other, tau) if turns else one - other)

    def meet(one: int, other: int) -> bool:
        (a, first), (b, second) = parts[one], parts[other]
        flipped = [group.P for group, p, q in zip(groups, a, b, strict=True) if p != q]
        pairs = product(_ends(first), _ends(second))
        return any([p] == flipped and p == q and off(x, y) <= SAME for (x, p), (y, q) in pairs)

    count = range(len(parts))
    joined = np.array([[meet(one, other) for other in count] for one in count])
    _, circuit = connected_components(joined, directed=False)
    found: list[tuple[int | None, list[End]]] = []
    for way in ways:
        branches = tuple(group.branch for group in way.groups if not isinstance(group, Group))
        here = (n for n in count if parts[n][0] == branches and _holds(parts[n][1], at, tau if turns else inf))
        own = next(here, None)  # none in a gap that is too narrow to be seen
        found.append((None, []) if own is None else (int(circuit[own]), _ends(parts[own][1])))
    return found


def _ends(interval: Interval) -> list[End]:
    """The ends of an interval in singular configurations, each with its joint."""
    ends = (interval.start, interval.start_joint), (interval.end, interval.end_joint)
    return [(position, joint) for position, joint in ends if joint]


def _holds(interval: Interval, position: float, turn: float) -> bool:
    """Whether an interval has a position, or one that is whole turns further."""
    if turn < inf and interval.start > -inf:
        position += turn * ceil((interval.start - SAME - position) / turn)
    return interval.start - SAME <= position <= interval.end + SAME
