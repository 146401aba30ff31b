"""The solution of a larger group's equations: poses by Newton's method, then what is linear in their Jacobian.

Rates follow from the Jacobian J, the forces of the joints from its transpose (virtual work); where its least singular
value is zero the configuration is singular. Nikravesh (1988), as of `group_equations`, chapters 3 and 9.
"""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes.model.motion import Samples

from .group_equations import FramePoses, GroupEquations, Placed, in_plane

CLOSED_TOL = 1e-10  # of the group's size: Newton's last correction, beyond which there are only roundings
SINGULAR_TOL = 1e-7  # of the group's size: the same near a singular pose, where roundings become their root, 1e-8
MAX_MOVE = 0.1  # of the group's size: a rough sketch must not throw the bodies about
ITERATIONS = 200  # from the sketch

Correction: TypeAlias = Callable[[Samples], Samples]  # of coordinates (..., m): what Newton's method takes off them


def length_of(correction: Samples, size: float | Samples) -> Samples:
    """The largest move of corrections of shape (..., m) of a group, or of groups each of its size, shape (...), m."""
    moves = np.abs(correction)
    moves[..., 2::3] *= np.asarray(size)[..., np.newaxis]
    return np.asarray(moves.max(axis=-1))


def assemble(correction: Correction, q: Samples, size: float | Samples) -> Samples:
    """The coordinates near rough guesses q, shape (..., m), where the joints close, if there are any."""
    apart = np.ones(q.shape[:-1], np.bool_)
    for _ in range(ITERATIONS):
        move = correction(q)
        length = length_of(move, size)
        shorter = q - move / np.maximum(1, length / (MAX_MOVE * size))[..., None]
        q = np.where(apart[..., None], shorter, q)
        apart &= length >= SINGULAR_TOL * size
        if not apart.any():
            break
    return q


def refine(correction: Correction, q: Samples, size: float | Samples) -> tuple[Samples, NDArray[np.bool_]]:
    """The coordinates where the joints close, from near guesses q, shape (..., m), and whether they do."""
    # Each position is on its own: it is corrected as long as the corrections at least halve, which ends in their
    # roundings, or until the next one, about the square of the last, is sure to be below them.
    last, apart = np.full(q.shape[:-1], np.inf), np.ones(q.shape[:-1], np.bool_)
    while apart.any():
        move = correction(q)
        length = length_of(move, size)
        apart &= length < last / 2
        q = np.where(apart[..., None], q - move, q)
        last = np.where(apart, length, last)
        apart &= last > CLOSED_TOL * size
    return q, last < SINGULAR_TOL * size


def correction(equations: GroupEquations, placed: FramePoses) -> Correction:
    """Newton's correction of a group's coordinates, by its equations."""

    def move(q: Samples) -> Samples:
        pose = equations.pose(q, placed)
        return solved(own_jacobian(equations, pose), equations.open(pose))

    return move


def rates(equations: GroupEquations, pose: FramePoses, everywhere: Samples, placed: Placed) -> tuple[Samples, Samples]:
    """Return q' and q'', shape (..., m), by the Jacobian of all frames."""
    b = equations.bodies
    J, J_placed = everywhere[..., : 3 * b], everywhere[..., 3 * b :]
    dq = solved(J, -np.einsum("...ij,...j->...i", J_placed, placed.dq))
    turning = equations.quadratic(pose, *in_plane(np.append(dq, placed.dq, axis=-1)))
    return dq, solved(J, -np.einsum("...ij,...j->...i", J_placed, placed.ddq) - turning)


def own_jacobian(equations: GroupEquations, pose: FramePoses) -> Samples:
    """Return dC / dq, shape (..., m, m)."""
    return equations.jacobian(pose)[..., : 3 * equations.bodies]


def least_singular_value(equations: GroupEquations, J: Samples) -> Samples:
    """Return by how much J's entries would have to be off for it to be singular, shape (...), m.

    Moves and differences of angles count as those of the group's longest arm, so that all entries are arms. Near a
    singular pose it falls as the root of the drive's way to there.
    """
    # Rows in m by the group's longest arm, columns in moves of that arm: the singular values are lengths, and do not
    # depend on units.
    lengths = equations.pins + len(equations.S)
    rows = np.repeat([1.0, equations.size, 1.0], [lengths, len(equations.A), len(equations.G)])
    arms = J * rows[:, None] * (equations.size / equations.arms)
    least = np.full(arms.shape[:-2], np.nan)
    reached = ~np.isnan(arms[..., 0, 0])
    least[reached] = np.linalg.svd(arms[reached], compute_uv=False)[:, -1]
    return least


def solved(A: Samples, b: Samples) -> Samples:
    """Return x of A x = b, shape (..., m), NaN where A is singular."""
    return columns(A, b[..., None])[..., 0]


def columns(A: Samples, b: Samples) -> Samples:
    """Return x of A x = b, shape (..., m, k), NaN where A is singular."""
    try:
        x: Samples = np.linalg.solve(A, b).astype(np.float64, copy=False)
    except np.linalg.LinAlgError:  # of one, for all
        singular = np.linalg.slogdet(A)[0] == 0
        x = columns(np.where(singular[..., None, None], np.nan, A), b)
    return x
