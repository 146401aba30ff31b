"""Singular configurations on the drive's way, between samples too: no one motion leads through them.

At a change point two branches meet, and the drive can go on: a parallelogram stretched out, or a crank as long as its
rod. A bar a hair too short does not reach for a hair of the way. Guides that become parallel cross infinitely far away.
Each position beside it is solved on its own branch, and all look fine. So each least distance to such a place among
samples of the way is looked at closer and closer, until it is lost in round-off or stays above it.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, pi, tau

import numpy as np

from scenes import Failure, Scene, Status
from scenes.arguments import refuse
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed

from ..core.decomposition import Dyad, Linkage, guides_cross
from ..core.groups.group_equations import Group
from ..core.groups.newton_group import ROUGHLY, least_singular_value
from ..core.placing import Kinematics
from ..solve import Solver, check_reach
from .motion_range import ROUNDED, extent_of, in_line, motion_at, motion_range

SAMPLES = 720  # a cycle, to find where a group is nearest to a singular configuration
POINTS, ROUNDS = 17, 16  # of each look closer: 8 times closer, down to the last place
MEET = 64 * np.finfo(float).eps  # of the largest coordinate: a distance that is lost in round-off


def check_way(solver: Solver) -> None:
    """Look for singular configurations over the drive's range, of the groups that a solver's channels need.

    Raises:
        Failure: `cannot_assemble` at the first place, as the drive goes, that is singular or where the bodies do not
            reach.
    """
    if not isinstance(solver, Solver):
        refuse("solver", "what analytic.solver(...) returns", solver)
    scene, linkage = solver.scene, solver.linkage
    way = np.linspace(*scene.drive.extent, SAMPLES + 1)
    k, after = motion_at(scene, linkage, way), _steps_to(scene, way)
    short = _short(scene, linkage, k, way)
    end = min((int(after[rows].min()) for rows in short.values() if rows.any()), default=SAMPLES + 1)
    found, last = [], end
    candidates = [(int(after[i]), i, group) for group, i in _lowest(linkage, k, way, short)]
    for step, i, group in sorted(candidates, key=lambda one: one[0]):
        if step > last:
            break
        if place := _look_closer(scene, linkage, group, way[max(i - 1, 0) : i + 2]):
            found.append(place)
            last = min(last, step + 1)  # one that is found from a later row may be reached before
    if found:
        steps = _steps_to(scene, np.array([where for where, _ in found]))
        order = [(step, abs(where - scene.drive.start)) for step, (where, _) in zip(steps, found, strict=True)]
        where, (singular, *_) = found[order.index(min(order))]
        raise _singular(scene, linkage, where, singular)
    if end <= SAMPLES:
        first = np.argsort(after, kind="stable")
        reach = {P: np.where(rows[first], -1.0, 0.0) for P, rows in short.items()}
        check_reach(scene, linkage, replace(k, reach=reach), way[first])


def free_range(scene: Scene, linkage: Linkage) -> tuple[float, float] | None:
    """The positions of the drive round the sketch, between singular configurations: a run there keeps its assembly.

    None where there are none to one side, so that the drive is free to go on.
    """
    start, turns = scene.sketch.drive, scene.driven_slide is None
    ends = [end for both in motion_range(scene, linkage) for end, _ in both]
    ends += [where for where, _ in change_points(scene, linkage)]
    ends = [end + off for end in ends for off in ((0, tau, -tau) if turns else (0,))]
    below, above = max((e for e in ends if e < start), default=-inf), min((e for e in ends if e > start), default=inf)
    return (below, above) if below > -inf and above < inf else None


def change_points(scene: Scene, linkage: Linkage) -> list[tuple[float, str]]:
    """The places on a turn, or on a driven slider's way, where a linkage is singular and goes on, with the joint.

    None where a group is singular all the way.
    """
    start = scene.sketch.drive
    low, high = (start - pi, start + pi) if scene.driven_slide is None else scene.drive.extent
    way = np.linspace(low, high, SAMPLES + 1)
    k = motion_at(scene, linkage, way)
    lost, found = MEET * extent_of(scene), dict[tuple[float, str], None]()
    for group, i in _lowest(linkage, k, way, _short(scene, linkage, k, way)):
        beside = way[max(i - 1, 0) : i + 2]
        if (_to_lock(linkage, motion_at(scene, linkage, beside), beside)[group][[0, -1]] > lost).all() and (
            place := _look_closer(scene, linkage, group, beside)
        ):
            found |= dict.fromkeys((place[0], singular.P) for singular in place[1])
    return [*found]


def _steps_to(scene: Scene, way: Samples) -> Samples:
    """After how many of `SAMPLES` steps of a cycle the drive has reached each position of its way, shape (n,)."""
    position = scene.drive.at(np.linspace(0, scene.drive.cycle, SAMPLES + 1)).position
    up, down = np.maximum.accumulate(position), -np.minimum.accumulate(position)
    steps = np.where(way >= position[0], np.searchsorted(up, way), np.searchsorted(down, -way))
    return np.minimum(steps, SAMPLES)


def _short(scene: Scene, linkage: Linkage, k: Kinematics, way: Samples) -> dict[str, Samples]:
    """By inner joint, whether a group does not reach by more than roundings, shape (n,)."""
    lost, short = ROUNDED * extent_of(scene), {}
    for group in linkage.groups:
        beyond = np.abs(np.broadcast_to(k.to_lock.get(group.P, inf), way.shape)) > lost
        short[group.P] = (np.broadcast_to(k.reach.get(group.P, 0.0), way.shape) < 0) & beyond
    return short


def _lowest(
    linkage: Linkage, k: Kinematics, way: Samples, short: dict[str, Samples]
) -> Iterator[tuple[Dyad | Group, int]]:
    """Yield the groups, and the rows where each is nearest to a singular configuration while it reaches beside it."""
    for group, distance in _to_lock(linkage, k, way).items():
        before, after = np.append(np.inf, distance[:-1]), np.append(distance[1:], np.inf)
        steepest = np.fmax(np.where(before < np.inf, before, 0), np.where(after < np.inf, after, 0)) - distance
        lowest = (distance <= before) & (distance <= after) & (distance <= steepest)  # so that it may reach zero
        apart = np.concatenate([[False], short[group.P], [False]])
        lowest &= ~(apart[:-2] | apart[1:-1] | apart[2:])
        yield from ((group, i) for i in np.flatnonzero(lowest).tolist())


def _look_closer(
    scene: Scene, linkage: Linkage, nearest: Dyad | Group, way: Samples
) -> tuple[float, list[Dyad | Group]] | None:
    """Where groups are singular between two positions, where one is nearest to that, and which; None if it is not."""
    size = extent_of(scene)
    lost = {
        g: ROUGHLY * linkage.tracks[g].equations.size if isinstance(g, Group) else MEET * size for g in linkage.groups
    }
    for _ in range(ROUNDS):
        way = np.linspace(way[0], way[-1], POINTS)
        distances = _to_lock(linkage, motion_at(scene, linkage, way), way)
        i = int(np.where(np.isnan(distances[nearest]), -np.inf, distances[nearest]).argmin())
        where, way = float(way[i]), way[max(i - 1, 0) : i + 2]
    if (distances[nearest] > lost[nearest]).all():
        return None
    return where, [group for group, distance in distances.items() if not (distance > lost[group]).all()]


def _singular(scene: Scene, linkage: Linkage, where: float, singular: Dyad | Group) -> Failure:
    """Two assemblies that meet, or a linkage that is singular, and where a run can be."""
    meet = not isinstance(singular, Group) and not guides_cross(singular)
    why = "two ways of assembling the bodies meet" if meet else "the linkage is singular"
    reason = f"{why} at {scene.where(where)}: {in_line(singular)}"
    if free := free_range(scene, linkage):
        limits = "drive.start and drive.end" if isinstance(scene.drive, ConstantSpeed) else "the drive's law"
        reason += f"; {limits} can limit a run to within {scene.between(free)}"
    return Failure(Status.cannot_assemble, reason, at=(where, singular.P))


def _to_lock(linkage: Linkage, k: Kinematics, way: Samples) -> dict[Dyad | Group, Samples]:
    """What is zero where a group is singular, m, shape (n,), a larger group's being no length; NaN unreached."""
    return {
        group: least_singular_value(*k.jacobian[group.P][::2])
        if isinstance(group, Group)
        else np.broadcast_to(k.to_lock[group.P], way.shape)
        for group in linkage.groups
    }
