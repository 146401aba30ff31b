"""Singular configurations, between samples too: no one motion leads through them.

At a change point two branches meet, and the drive can go on: a parallelogram stretched out, or a crank as long as its
rod. A bar a hair too short does not reach for a hair of the way. Guides that become parallel cross infinitely far away.
Each position beside it is solved on its own branch, and all look fine. So each least distance to such a place among
samples of the way is looked at closer and closer, until it is lost in round-off or stays above it.
"""

from collections.abc import Iterator, Sequence
from math import inf, pi, tau
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from scenes import Failure, Scene, Status
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed

from ..core.decomposition import Dyad, Linkage, guides_cross
from ..core.groups.group_equations import Group
from ..core.groups.newton_group import SINGULAR_TOL, least_singular_value
from ..core.placing import Kinematics
from .motion_range import IN_LINE_TOL, extent_of, in_line, motion_at, motion_range

SAMPLES = 720  # a cycle, to find where a group is nearest to a singular configuration
POINTS, ROUNDS = 17, 16  # of each look closer: 8 times closer, down to the last place
MEETING_TOL = 64 * np.finfo(float).eps  # of the largest coordinate: a distance that is lost in round-off
PLACE_TOL = 1e-12  # of a turn, or of the way: how closely a place is known


def free_range(scene: Scene, linkage: Linkage) -> tuple[float, float] | None:
    """The positions of the drive round the sketch, between singular configurations: a run there keeps its assembly.

    None where there are none to one side, so that the drive is free to go on.
    """
    start, turns = scene.sketch.drive, linkage.drive.slide is None
    ends = [end for both in motion_range(scene, linkage) for end, _ in both]
    ends += [where for where, _ in change_points(scene, linkage)]
    ends = [end + shift for end in ends for shift in ((0, tau, -tau) if turns else (0,))]
    below, above = max((e for e in ends if e < start), default=-inf), min((e for e in ends if e > start), default=inf)
    return (below, above) if below > -inf and above < inf else None


def change_points(scene: Scene, linkage: Linkage) -> list[tuple[float, str]]:
    """The places on a turn, or on a driven slider's way, where a linkage is singular and goes on, with the joint.

    None where a group is singular all the way.
    """
    start = scene.sketch.drive
    low, high = (start - pi, start + pi) if linkage.drive.slide is None else linkage.drive.law.extent
    way = np.linspace(low, high, SAMPLES + 1)
    k = motion_at(scene, linkage, way)
    lost, found = MEETING_TOL * extent_of(scene), dict[tuple[float, str], None]()
    for group, i in lowest(linkage.groups, k, way, short_of(scene, linkage, k, way)):
        neighbours = way[max(i - 1, 0) : i + 2]
        if (to_lock([group], motion_at(scene, linkage, neighbours), neighbours)[group][[0, -1]] > lost).all() and (
            place := look_closer(scene, linkage, linkage.groups, group, neighbours)
        ):
            found |= dict.fromkeys((place[0], singular.P) for singular in place[1])
    return [*found]


def short_of(scene: Scene, linkage: Linkage, k: Kinematics, way: Samples) -> dict[str, Samples]:
    """By inner joint, whether a group does not reach by more than roundings, shape (n,)."""
    lost, short = IN_LINE_TOL * extent_of(scene), {}
    for group in linkage.groups:
        beyond = np.abs(np.broadcast_to(k.to_lock.get(group.P, inf), way.shape)) > lost
        short[group.P] = (np.broadcast_to(k.reach.get(group.P, 0.0), way.shape) < 0) & beyond
    return short


def lowest(
    groups: Sequence[Dyad | Group], k: Kinematics, way: Samples, short: dict[str, Samples]
) -> Iterator[tuple[Dyad | Group, int]]:
    """Yield the groups, and the rows where each is nearest to a singular configuration while it reaches beside it."""
    for group, distance in to_lock(groups, k, way).items():
        before, after = np.append(np.inf, distance[:-1]), np.append(distance[1:], np.inf)
        # A local least of the distance can reach zero between two samples only if it is no more than the distance falls
        # by within one step. That holds of a distance that falls about linearly, as to a crossing of two branches.
        steepest = np.fmax(np.where(before < np.inf, before, 0), np.where(after < np.inf, after, 0)) - distance
        lowest = (distance <= before) & (distance <= after) & (distance <= steepest)  # so that it may reach zero
        apart = np.concatenate([[False], short[group.P], [False]])
        lowest &= ~(apart[:-2] | apart[1:-1] | apart[2:])
        yield from ((group, i) for i in np.flatnonzero(lowest).tolist())


# Nested sampling rather than a minimiser: the distance has a corner where it is zero, not a parabola, and several
# groups may be singular at one place. Each round keeps the two intervals about the least of POINTS samples.
def look_closer(
    scene: Scene, linkage: Linkage, groups: Sequence[Dyad | Group], nearest: Dyad | Group, way: Samples
) -> tuple[float, list[Dyad | Group]] | None:
    """Where groups are singular between two positions, where one is nearest to that, and which; None if it is not."""
    size = extent_of(scene)
    lost = {
        g: SINGULAR_TOL * linkage.tracks[g].equations.size if isinstance(g, Group) else MEETING_TOL * size
        for g in groups
    }
    for _ in range(ROUNDS):
        way = np.linspace(way[0], way[-1], POINTS)
        distances = to_lock(groups, motion_at(scene, linkage, way), way)
        i = int(np.where(np.isnan(distances[nearest]), -np.inf, distances[nearest]).argmin())
        where, way = float(way[i]), way[max(i - 1, 0) : i + 2]
    if (distances[nearest] > lost[nearest]).all():
        return None
    return where, [group for group, distance in distances.items() if not (distance > lost[group]).all()]


def singular_at(scene: Scene, linkage: Linkage, where: float, singular: Dyad | Group) -> Failure:
    """Two assemblies that meet, or a linkage that is singular, and where a run can be."""
    meet = not isinstance(singular, Group) and not guides_cross(singular)
    why = "two ways of assembling the bodies meet" if meet else "the linkage is singular"
    reason = f"{why} at {scene.where(where)}: {in_line(singular)}"
    if free := free_range(scene, linkage):
        limits = "drive.start and drive.end" if isinstance(linkage.drive.law, ConstantSpeed) else "the drive's law"
        reason += f"; {limits} can limit a run to within {scene.between(free)}"
    return Failure(Status.cannot_assemble, reason, at=(where, singular.P))


def to_lock(groups: Sequence[Dyad | Group], k: Kinematics, way: Samples) -> dict[Dyad | Group, Samples]:
    """What is zero where a group is singular, m, shape (n,), a larger group's being no length; NaN unreached."""
    return {
        group: least_singular_value(*k.jacobian[group.P][::2])
        if isinstance(group, Group)
        else np.broadcast_to(k.to_lock[group.P], way.shape)
        for group in groups
    }


class Meetings(NamedTuple):
    """Where two assemblies of a dyad meet, nearest to the sketch on either side of it."""

    first: float  # rad or m: within a turn of a crank about the sketch, or the way of a driven slider
    last: float
    nearest: Sequence[tuple[float, Dyad | Group]]  # its position, rad or m, and the dyad

    def check(self, scene: Scene, linkage: Linkage, asked: Samples) -> None:
        """Look for such a place between positions asked for and the sketch.

        The sketch picks the assembly; beyond such a place it leaves open which is meant. Larger groups are followed
        from the sketch, and end there by themselves. Raises Failure, `cannot_assemble`.
        """
        turns = linkage.drive.slide is None
        if turns and not self.nearest:
            return
        least, most, sketch, nearest = float(asked.min()), float(asked.max()), scene.sketch.drive, self.nearest
        # The turn in which the sketch is as near as it can be to the middle of what is asked for.
        whole = 2 * pi * round(((least + most) / 2 - sketch) / (2 * pi)) if turns else 0.0  # as near as turns bring it
        if not turns and not self.first <= least <= most <= self.last:
            nearest = _nearest(scene, linkage, min(least, sketch), max(most, sketch))
        margin = PLACE_TOL * (self.last - self.first)
        for position, dyad in nearest:
            place = position + whole
            if min(least, sketch + whole) - margin <= place <= max(most, sketch + whole) + margin:
                raise singular_at(scene, linkage, place, dyad)


_FOUND: WeakKeyDictionary[Scene, dict[int, Meetings]] = WeakKeyDictionary()  # by the number of groups


def meetings(scene: Scene, linkage: Linkage) -> Meetings:
    """Where two assemblies of a dyad meet; of one scene they are looked for once."""
    by_groups, count = _FOUND.setdefault(scene, {}), len(linkage.groups)
    if count not in by_groups:
        first, last = way_of(scene, linkage)
        by_groups[count] = Meetings(first, last, _nearest(scene, linkage, first, last))
    return by_groups[count]


def way_of(scene: Scene, linkage: Linkage) -> tuple[float, float]:
    """From where to where, rad or m, assemblies may meet: a turn to either side of the sketch, or a slider's way."""
    sketch, (least, most) = scene.sketch.drive, linkage.drive.law.extent
    if linkage.drive.slide is None:
        return sketch - 2 * pi, sketch + 2 * pi
    return min(least, sketch), max(most, sketch)


def _nearest(scene: Scene, linkage: Linkage, first: float, last: float) -> list[tuple[float, Dyad | Group]]:
    """The place nearest to the sketch on either side of it; of a crank that has none on a turn ahead there is none."""
    sketch, found = scene.sketch.drive, list[tuple[float, Dyad | Group]]()
    dyads = [group for group in linkage.groups if not isinstance(group, Group)]
    for end in (last, first) if dyads else ():
        step = (end - sketch) / SAMPLES
        if step and (found or linkage.drive.slide is not None or end == last):
            way = np.linspace(sketch - step, end + step, SAMPLES + 3)
            k = motion_at(scene, linkage, way)
            candidates = lowest(dyads, k, way, short_of(scene, linkage, k, way))
            for group, i in sorted(candidates, key=lambda candidate: candidate[1]):
                place = look_closer(scene, linkage, dyads, group, way[max(i - 1, 0) : i + 2])
                if place and (place[0] - sketch) * step >= -PLACE_TOL * abs(step):
                    found.append((place[0], place[1][0]))
                    break
    return found
