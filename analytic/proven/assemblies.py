"""All assemblies of a linkage at a position of its drive, and which of them are on one circuit.

A dyad is assembled in two ways. From one to the other without taking it apart a linkage gets where the dyad is in a
singular configuration, at an end of an interval of the drive's range in which it assembles.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from math import inf, remainder, sqrt, tau
from typing import Any

import numpy as np

from scenes import Scene
from scenes.arguments import finite_numbers, scene_of
from scenes.model.enclosures import Assemblies, Assembly
from scenes.model.motion import Samples, kinematic_channels

from ..core.decomposition import Dyad, Linkage, decompose
from ..core.groups.continuation import Track
from ..core.groups.group_equations import FramePoses, Group, equations_of
from ..core.groups.newton_group import own_jacobian
from ..core.kinematics import followed, placed
from ..core.placing import Kinematics
from ..solve import prepared
from ..way.motion_range import End, motion_at, motion_range
from .group_assemblies import poses, together

SAME = 1e-6  # of the longest arm: two poses, or two ends of intervals
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
    drawn, ways = followed(scene, whole), [replace(whole, groups=())]
    for group in whole.groups:
        found = [_assembled(scene, way, group, at) for way in ways]
        ways, complete = [way for some, _ in found for way in some], complete and all(known for _, known in found)
    if not ways and not complete:  # of a group that is too large for it
        ways = [drawn]
    several = len(_branches(whole)) == len(whole.groups) and 2 ** len(whole.groups) <= MOST
    known = _circuits(scene, whole, float(at[0])) if circuits and several else {}
    own, channels, made = _at(scene, drawn, at).z, frozenset(kinematic_channels(scene)[2:]), list[Assembly]()
    for way in ways:
        z = _at(scene, way, at).z
        if not all(np.isfinite(z[point]).all() for point in scene.moving_points):
            complete = False  # a group that can turn by itself there: two of its points are in one place
            continue
        off = [np.ravel(z[point])[0] - complex(*xy) for point, xy in scene.sketch.points.items()]
        meant = all(np.all(np.abs(z[point] - own[point]) <= SAME * way.arm) for point in scene.moving_points)
        motion = prepared(scene, way, channels)(at, np.zeros(1))
        away = float(np.linalg.norm(off)) / sqrt(len(off) or 1)
        made.append(Assembly(motion, meant, away, *known.get(_branches(way), (None, ()))))
    made.sort(key=lambda one: one.off_sketch)
    numbers = [*dict.fromkeys(one.circuit for one in made)]
    named = (one if one.circuit is None else replace(one, circuit=numbers.index(one.circuit)) for one in made)
    return Assemblies(float(at[0]), [*named], complete)


def _at(scene: Scene, way: Linkage, at: Samples) -> Kinematics:
    return motion_at(scene, way, at, rates=False)


def _branches(way: Linkage) -> tuple[Any, ...]:
    """Those of the dyads."""
    return tuple(group.branch for group in way.groups if not isinstance(group, Group))


def _assembled(scene: Scene, before: Linkage, group: Dyad | Group, at: Samples) -> tuple[list[Linkage], bool]:
    """A linkage with a group in each of the ways in which it closes, and whether none is missed."""
    if not isinstance(group, Group):
        both = (replace(before, groups=(*before.groups, replace(group, branch=b))) for b in (1, -1))
        return [way for way in both if not np.any(_at(scene, way, at).reach.get(group.P, np.zeros(1)) < 0)], True
    equations, frames = equations_of(scene, before.bodies, group), placed(scene, before, group, at).pose
    q, complete = poses(equations, FramePoses(frames.z[0], frames.angle[0]), float(at[0]))
    ways = []
    for pose in q[:, np.newaxis]:
        branch = float(np.linalg.slogdet(own_jacobian(equations, equations.pose(pose, frames)))[0][0])
        track = Track(equations, np.inf, np.inf, at, pose, 0 * pose, 0 * pose, branch)
        ways.append(replace(before, groups=(*before.groups, group), tracks={**before.tracks, group: track}))
    return ways, complete


def _circuits(scene: Scene, whole: Linkage, at: float) -> Mapping[tuple[Any, ...], tuple[int, Sequence[End]]]:
    """By branches of dyads, the number of the circuit that a position is on, and where it meets others."""
    turn, parts = tau if scene.driven_slide is None else inf, list[tuple[tuple[Any, ...], tuple[End, End]]]()
    for branches in product((1, -1), repeat=len(whole.groups)):
        groups: Any = (replace(group, branch=b) for group, b in zip(whole.groups, branches, strict=True))  # type: ignore[arg-type]
        intervals = motion_range(scene, replace(whole, groups=tuple(groups))) or [((-inf, ""), (inf, ""))]
        parts += ((branches, ends) for ends in intervals)

    def meet(one: int, other: int) -> bool:
        (a, first), (b, second) = parts[one], parts[other]
        flipped = [group.P for group, p, q in zip(whole.groups, a, b, strict=True) if p != q]
        pairs = product(first, second)
        return any([p] == flipped and p == q and abs(remainder(x - y, turn)) <= SAME for (x, p), (y, q) in pairs)

    count, here = range(len(parts)), dict[tuple[Any, ...], tuple[int, Sequence[End]]]()
    circuit = together(np.array([[one == other or meet(one, other) for other in count] for one in count]))
    for number, (branches, ends) in enumerate(parts):  # none in a gap that is too narrow to be seen
        (start, _), (end, _) = ends
        if not (at - start + SAME) % turn > end - start + 2 * SAME:
            here.setdefault(branches, (int(circuit[number]), [end for end in ends if end[1]]))
    return here
