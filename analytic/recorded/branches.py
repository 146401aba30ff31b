"""The branches of larger groups of many machines, each beside that of the scene.

At the positions of the scene's poses (`groups.continuation.Track`) Newton's method leads from those to each machine's.
They are on one branch with what the machine's sketch shows where they are so at the sketch, and where from one pose to
the next the way from the scene's to the machine's changes by little of the move. A machine of which that cannot be said
is followed alone, by the core.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from scenes import Scene
from scenes.drive import Driven, Samples

from ..core.decomposition import decompose
from ..core.groups.continuation import Track, comes_back
from ..core.groups.group_equations import Group, sketched_coordinates, within_a_turn
from ..core.groups.newton_group import SINGULAR_TOL, assemble, length_of
from ..core.kinematics import followed
from .arithmetics.in_numpy import NewtonsMethod, StraightLine
from .expressions import Expression
from .program import Program, inputs_at
from .traced import traced

COARSE = 4  # steps of the core's own branch, from pose to pose
MAX_CHANGE = 0.05  # of a move, of the way to a machine's pose meanwhile; half of what is allowed later


def branches(scene: Scene, program: Program, numbers: Mapping[str, Samples], count: int) -> list[dict[Group, Track]]:
    """The branches of all larger groups of each machine, whose numbers are SI, shape (count, 1); NaN where unknown."""
    each: list[dict[Group, Track]] = [{} for _ in range(count)]
    if program.closed:
        whole = decompose(scene)
        followed_linkage = followed(scene, replace(whole, groups=whole.groups[: len(program.linkage.groups)]))
        for group, track in followed_linkage.tracks.items():
            coarse = _thinned(track, scene.sketch.drive)
            for tracks, q in zip(each, _poses(scene, program, numbers, group, coarse, each), strict=True):
                tracks[group] = replace(coarse, q=q)
    return each


def _thinned(track: Track, sketch: float) -> Track:
    """A branch with fewer poses, between which its parabolas still hold; that of the sketch is one of them."""
    kept = replace(track, step=COARSE * track.step)
    dropped = 1
    # Every other pose is dropped where the parabola of the next one still reaches back over it, again and again, up to
    # COARSE steps.
    while dropped:
        before, after = kept.rows(slice(None, -2, 2)), kept.rows(slice(2, None, 2))
        middle = kept.position[1:-1:2]
        drop = (after.position - before.position <= kept.step) & (after.off_parabola(before) <= 1) & (middle != sketch)
        rows = np.ones(len(kept.position), np.bool_)
        rows[1:-1:2] = ~drop
        kept, dropped = kept.rows(rows), int(drop.sum())
    return kept


def _poses(
    scene: Scene,
    program: Program,
    numbers: Mapping[str, Samples],
    group: Group,
    track: Track,
    before: list[dict[Group, Track]],
) -> Samples:
    """The coordinates of each machine at the poses of a branch, shape (machines, N, k), NaN where they are unknown.

    Newton's method finds them from the poses of the linkage as drawn. A machine's branch is the one of its own sketch:
    at the sketch's position it has to have the sketched pose. From there it is known as far as it moves from pose to
    pose about as the drawn linkage does; over a whole turn it has to come back.
    """
    make, closed, k, start = program.make, program.closed[group], track.q.shape[1], scene.sketch.drive
    closing, begin, (allowed, branch, size_of) = closed.of[0], closed.of[1 : k + 1], closed.of[k + 1 : k + 4]
    (row,) = track.nearest(np.array([start]))
    if track.position[row] != start:  # of a crank that is driven elsewhere than it is drawn
        return np.full((len(before), *track.q.shape), np.nan)

    def values(expressions: list[Expression], position: Samples, sought: Mapping[str, Samples]) -> Samples:
        given = inputs_at(Driven(position, np.ones(()), np.zeros(())), before)
        return StraightLine(expressions)({**numbers, **given, branch.of[0]: track.branch, **sought})

    drawn = [
        traced(make, coordinate).x for coordinate in sketched_coordinates(program.scene, group, program.linkage.bodies)
    ]
    rows = values([*drawn, size_of, *closing.outer], np.array([start]), {})
    # For all machines at once: the sketched pose by damped Newton from the sketch, then every pose of the drawn linkage
    # as the guess for the machine's.
    size = rows[k]
    sketched = assemble(NewtonsMethod(closing).correction(rows[k + 1 :]), np.moveaxis(rows[:k], 0, -1), size)

    guesses = dict(zip([entry.of[0] for entry in begin], track.q.T, strict=True))
    anywhere = {allowed.of[0]: np.full(len(track.q), np.inf)}
    q = np.moveaxis(values([make.component(closed, i) for i in range(k)], track.position, guesses | anywhere), 0, -1)
    change = q[:, [row]] - sketched
    change[..., 2::3] = within_a_turn(change[..., 2::3])
    changed = length_of(np.diff(q - track.q, axis=1), size)
    # A machine's branch is accepted outwards from the sketch, pose by pose, as long as its distance to the drawn branch
    # changes little.
    near = changed <= MAX_CHANGE * length_of(np.diff(track.q, axis=0), track.equations.size) + SINGULAR_TOL * size
    known = np.repeat(length_of(change, size) <= SINGULAR_TOL * size, len(track.q), axis=1)
    known[:, row + 1 :] &= np.logical_and.accumulate(near[:, row:], axis=1)
    known[:, :row] &= np.logical_and.accumulate(near[:, :row][:, ::-1], axis=1)[:, ::-1]
    if track.position[-1] - track.position[0] > track.turn - track.step and comes_back(track.q):
        known &= (comes_back(q) & known.all(axis=1))[:, np.newaxis]
    return np.where(known[..., np.newaxis], q, np.nan)
