"""That no singular configuration, through which no one motion leads, lies on the drive's way, between samples too."""

from dataclasses import replace

import numpy as np

from scenes import Scene
from scenes.arguments import refuse
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples

from ..solve import Solver, check_reach
from .motion_range import motion_at
from .singular import SAMPLES, look_closer, lowest, short_of, singular_at


def check_way(solver: Solver) -> None:
    """Look for singular configurations over the drive's range, of the groups that a solver's channels need.

    Raises:
        Failure: `cannot_assemble` at the first place, as the drive goes, that is singular or where the bodies do not
            reach.
    """
    if not isinstance(solver, Solver):
        refuse("solver", "what analytic.solver(...) returns", solver)
    scene, linkage = solver.scene, solver.linkage
    way = np.linspace(*linkage.drive.law.extent, SAMPLES + 1)
    k, after = motion_at(scene, linkage, way), _steps_to(scene, way)
    short = short_of(scene, linkage, k, way)
    end = min((int(after[rows].min()) for rows in short.values() if rows.any()), default=SAMPLES + 1)
    found, last = [], end
    candidates = [(int(after[i]), i, group) for group, i in lowest(linkage.groups, k, way, short)]
    # Candidates in the order in which the drive comes to them. The search may end at the first singular place, but a
    # place found from a later row may lie half a step before, so that one step more is looked at.
    for step, i, group in sorted(candidates, key=lambda candidate: candidate[0]):
        if step > last:
            break
        if place := look_closer(scene, linkage, linkage.groups, group, way[max(i - 1, 0) : i + 2]):
            found.append(place)
            last = min(last, step + 1)  # one that is found from a later row may be reached before
    if found:
        steps = _steps_to(scene, np.array([where for where, _ in found]))
        order = [(step, abs(where - linkage.drive.law.start)) for step, (where, _) in zip(steps, found, strict=True)]
        where, (singular, *_) = found[order.index(min(order))]
        raise singular_at(scene, linkage, where, singular)
    if end <= SAMPLES:
        first = np.argsort(after, kind="stable")
        reach = {P: np.where(rows[first], -1.0, 0.0) for P, rows in short.items()}
        check_reach(scene, linkage, replace(k, reach=reach), way[first])
    solver.check_hull(way)


def _steps_to(scene: Scene, way: Samples) -> Samples:
    """After how many of `SAMPLES` steps of a cycle the drive has reached each position of its way, shape (n,)."""
    position = inputs_of(scene, np.linspace(0, scene.cycle, SAMPLES + 1)).driven().position
    up, down = np.maximum.accumulate(position), -np.minimum.accumulate(position)
    steps = np.where(way >= position[0], np.searchsorted(up, way), np.searchsorted(down, -way))
    return np.minimum(steps, SAMPLES)
