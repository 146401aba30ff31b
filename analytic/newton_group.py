"""The solution of a larger group's equations: poses by Newton's method, then what is linear in their Jacobian.

Rates follow from the Jacobian J, the forces of the joints from its transpose (virtual work), the distance from a
singular configuration from its least singular value. Nikravesh (1988), as of `group_equations`, chapters 3 and 9.
"""

import numpy as np
from numpy.typing import NDArray

from scenes.motion import Samples

from .group_equations import Complex, GroupEquations, Placed, Pose, coordinates, in_plane

CLOSED = 1e-10  # of the group's size: Newton's last correction, beyond which there are only roundings
ROUGHLY = 1e-7  # of the group's size: the same near a singular pose, where roundings grow to their square root, 1e-8
LONGEST = 0.1  # of the group's size: a rough sketch must not throw the bodies about
ITERATIONS = 200  # from the sketch


def assemble(equations: GroupEquations, q: Samples, placed: Pose) -> Samples:
    """Return the coordinates near a rough guess q, shape (1, m), where the joints close, if there are any."""
    for _ in range(ITERATIONS):
        correction = _correction(equations, q, placed)
        length = equations.length(correction)
        q = q - correction / np.maximum(1, length / (LONGEST * equations.size))[:, None]
        if not length >= ROUGHLY * equations.size:
            break
    return q


def refine(equations: GroupEquations, q: Samples, placed: Pose) -> tuple[Samples, NDArray[np.bool_]]:
    """Return the coordinates where the joints close, from a near guess q, shape (n, m), and whether they were found.

    Each position is on its own: it is corrected as long as the corrections at least halve, which ends in their
    roundings, or until the next one, about the square of the last, is sure to be below them.
    """
    last = np.full(len(q), np.inf)
    while True:
        correction = _correction(equations, q, placed)
        length = equations.length(correction)
        halved = (length < last / 2) & (last > CLOSED * equations.size)
        if not halved.any():
            return q, last < ROUGHLY * equations.size
        q = np.where(halved[:, None], q - correction, q)
        last = np.where(halved, length, last)


def rates(equations: GroupEquations, pose: Pose, placed: Placed) -> tuple[Samples, Samples]:
    """Return q' and q'', shape (n, m)."""
    b = equations.bodies
    everywhere = equations.jacobian(pose)
    J, J_placed = everywhere[:, :, : 3 * b], everywhere[:, :, 3 * b :]
    dq = solved(J, -np.einsum("nij,nj->ni", J_placed, coordinates(placed.v, placed.omega)))
    v, omega = (np.concatenate(pair, axis=1) for pair in zip(in_plane(dq), (placed.v, placed.omega), strict=True))
    driving = np.einsum("nij,nj->ni", J_placed, coordinates(placed.a, placed.alpha))
    return dq, solved(J, -driving - equations.quadratic(pose, v, omega))


def own_jacobian(equations: GroupEquations, pose: Pose) -> Samples:
    """Return dC / dq, shape (n, m, m)."""
    return equations.jacobian(pose)[:, :, : 3 * equations.bodies]


def joint_forces(
    equations: GroupEquations, J: Samples, force: Complex, moment: Samples
) -> tuple[Complex, Samples, Samples]:
    """Return what each pin does on the body pinned, N, shape (n, p), each guide on the slider, N and N m, shape (n, s).

    By J^T forces + Q = 0 (virtual work); `force` and `moment` about the first point, shape (n, b), are what the bodies
    carry without these joints, inertia included.
    """
    multipliers = solved(J.transpose(0, 2, 1), -coordinates(force, moment))
    p, s = len(equations.S), len(equations.T)
    x, y, guide_force, guide_moment = np.split(multipliers, [p, 2 * p, 2 * p + s], axis=1)
    return x + 1j * y, guide_force, guide_moment


def to_lock(equations: GroupEquations, J: Samples) -> Samples:
    """Return how much arms would have to be off for J to be singular, shape (n,), m: its least singular value.

    So it is by Eckart and Young's theorem when all its entries are arms: moves and differences of angles count as those
    of the group's longest arm.
    """
    p, s = len(equations.S), len(equations.T)
    rows = np.repeat([1.0, equations.size], [2 * p + s, s])
    arms = J * rows[:, None] * np.tile([equations.size, equations.size, 1], equations.bodies)
    least: Samples = np.linalg.svd(arms, compute_uv=False)[:, -1]
    return least


def solved(A: Samples, b: Samples) -> Samples:
    """Return x of A x = b, shape (n, m), NaN where A is singular."""
    x = np.empty_like(b)
    try:
        x[:] = np.linalg.solve(A, b[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:  # of one, for all
        singular = np.linalg.slogdet(A)[0] == 0
        x[:] = solved(np.where(singular[:, None, None], np.nan, A), b)
    return x


def _correction(equations: GroupEquations, q: Samples, placed: Pose) -> Samples:
    pose = equations.pose(q, placed)
    return solved(own_jacobian(equations, pose), equations.open(pose))
