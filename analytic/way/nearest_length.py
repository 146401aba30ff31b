"""How far a larger group is from a singular configuration: by how much the nearest length would have to be off.

Its lengths are those of its links, bodies that two pins hold, and the offsets of its guides. Where one of them is off
by l, the joints close along a curve of poses and l. From l = 0 it is followed both ways to the first extreme of l,
where the pose is singular: with that length beyond it the group cannot be assembled. With b = dC/dl, the tangent
(q', l'), its change, and the way back onto the curve follow from one matrix; w is the last tangent:

    [ J   b ]     [ 0 ]      [ -C'' - 2 l' b' ]      [ -C ]
    [ w   0 ] x = [ 1 ],     [        0       ],     [  0 ],        the extreme being about -l' / l'' ahead       (2)
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from scenes.model.motion import Samples

from ..core.groups.group_equations import FramePoses, GroupEquations, coordinates, in_plane
from ..core.groups.newton_group import columns, length_of, own_jacobian, solved

MAX_STEP = 0.5  # of the group's size, along a curve
MAX_ASTRAY = 0.05  # of the group's size: so far off the curve a step was too long
MAX_ROUNDS = 60  # of steps along one curve
LAST_STEP_TOL = 1e-5  # of the group's size: the last step to an extreme, which leaves l off by about its third power


def to_lock(equations: GroupEquations, pose: FramePoses) -> Samples:
    """Return by how much, m, the nearest length of a group would have to be off for the group to be singular.

    Of all frames, of shape (..., frames), NaN where the joints do not close, and the length of shape (...) likewise.
    """
    least = np.full(pose.z.shape[:-1], np.nan)
    closed = np.asarray(~np.isnan(pose.z).any(axis=-1))
    some = _rows(pose, closed)
    near = np.where(np.linalg.det(own_jacobian(equations, some)) == 0, 0.0, np.inf)
    for unit in _lengths(equations):
        for sense in (1, -1):
            near = np.minimum(near, _extreme(equations, unit, some, sense, near))
    least[closed] = near
    return least


def _lengths(equations: GroupEquations) -> Iterator[GroupEquations]:
    """Yield what a unit of each length adds to the constraints: of a link in its last pin, of a guide at its point."""
    none = replace(equations, **{name: 0 * getattr(equations, name) for name in "SRAG"})

    def longer(joint: int, frame: int, way: complex) -> GroupEquations:
        R = none.R.copy()
        R[joint, frame] = way
        return replace(none, R=R)

    for link in range(equations.bodies):
        joints = np.flatnonzero(equations.S[:, link])
        if len(joints) == 2 and joints[1] < equations.pins:
            first, last = equations.S[joints, link] * equations.R[joints, link]
            yield longer(joints[1], link, equations.S[joints[1], link] * (last - first) / np.abs(last - first))
    for guide, carrier in enumerate(equations.on):
        yield longer(equations.pins + guide, carrier, 1j * equations.along[guide])


def _extreme(
    equations: GroupEquations, unit: GroupEquations, start: FramePoses, sense: int, nearest: Samples
) -> Samples:
    """Return how far l comes one way to its first extreme, shape (n,), m, or beyond what is the nearest so far."""
    extreme, going, b = np.zeros(len(nearest)), np.arange(len(nearest)), equations.bodies
    placed, longest = FramePoses(start.z[:, b:], start.angle[:, b:]), np.full(len(nearest), MAX_STEP * equations.size)
    x = _with(coordinates(start.z[:, :b], start.angle[:, :b]), 0)
    tangent = sense * _with(solved(own_jacobian(equations, start), -unit.open(start)), 1)
    path = np.stack([x, tangent, 0 * x], axis=1)  # a place on the curve, the tangent there, and its change
    # Predictor and corrector on the curve (q(l), l), all positions at once: back onto the curve, then ahead along its
    # parabola. The step aims at the extreme of l, where l' = 0. The longest step becomes a quarter if the last point
    # was too far off the curve, or if the extreme would lie far behind. A position leaves the loop at its extreme, or
    # where it is beyond the nearest known.
    for _ in range(MAX_ROUNDS):
        back, *ahead = _along(equations, unit, placed, x, path[:, 1])
        astray = length_of(back[:, :-1], equations.size)
        near = astray <= MAX_ASTRAY * equations.size
        path = np.where(near[:, None, None], np.stack([x + back, *ahead], axis=1), path)
        lengths, slope, bend = sense * np.moveaxis(path[..., -1], -1, 0)
        way = np.where(bend < 0, slope / np.where(bend < 0, -bend, 1), np.sign(slope) * np.inf)
        grown = np.minimum(1.5 * longest, MAX_STEP * equations.size)
        longest = np.where(near & (way > -longest), grown, longest / 4)
        step = np.clip(way, -longest, longest)
        x = np.einsum("nk,nkj->nj", np.stack([step**0, step, step**2 / 2], axis=1), path)
        ended = np.maximum(astray, np.abs(way)) <= LAST_STEP_TOL * equations.size
        extreme[going] = np.where(ended, sense * x[:, -1], lengths)
        left = ~ended & (lengths < nearest[going])
        if not left.any():
            break
        going, x, path, longest, placed = going[left], x[left], path[left], longest[left], _rows(placed, left)
    return extreme


def _along(
    equations: GroupEquations, unit: GroupEquations, placed: FramePoses, x: Samples, before: Samples
) -> tuple[Samples, Samples, Samples]:
    """Return the way back onto the curve, its tangent of length one, m, and that one's change, each as x is.

    `x` is q and l, shape (n, m + 1), near the curve, and `before` a tangent nearby.
    """
    pose, longer = equations.pose(x[:, :-1], placed), x[:, -1, None, None]
    varied = replace(equations, R=equations.R + longer * unit.R)
    # The last row of (2): the new tangent has a positive part along the last one, in the metric of lengths (angles
    # times arms). It keeps the direction of travel through the extreme, where J itself is singular.
    across = _with(before[:, :-1] * equations.arms**2, 0)
    bordered = np.append(own_jacobian(varied, pose), unit.open(pose)[..., None], axis=-1)
    matrix, C = np.append(bordered, across[:, None], axis=1), varied.open(pose)
    back, tangent = np.moveaxis(columns(matrix, np.stack([_with(-C, 0), _with(0 * C, 1)], axis=-1)), -1, 0)
    tangent /= np.linalg.norm(tangent[:, :-1] * equations.arms, axis=-1, keepdims=True)
    dq, dl = tangent[:, :-1], tangent[:, -1:]
    everywhere = np.append(dq, np.zeros((len(x), 3 * placed.z.shape[1])), axis=-1)
    bend = varied.quadratic(pose, *in_plane(everywhere))
    bend += 2 * dl * np.einsum("nij,nj->ni", own_jacobian(unit, pose), dq)
    return back, tangent, solved(matrix, _with(-bend, 0))


def _with(rows: Samples, last: float) -> Samples:
    """Return rows with one more column."""
    return np.append(rows, np.full((len(rows), 1), last), axis=-1)


def _rows(pose: FramePoses, rows: NDArray[np.bool_]) -> FramePoses:
    return FramePoses(pose.z[rows], pose.angle[rows])
