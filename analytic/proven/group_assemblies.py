"""All poses of a larger group while what it hangs on stays where it is: none is missed, and each is known to be one.

The joints are linear in where the bodies' first points are. These go by the null space of the joints' incidence matrix,
which leaves the closed loops, of attitudes u_c = exp(i phi_c) and displacements s_k along guides; phi_0 = 0 is what
stays where it is, so that its column has all that is constant:

    F = sum_c (W_c + sum_k s_k V_kc) u_c = 0.                                                                   (1)

Boxes of (phi, s) are divided until F is zero nowhere in them, or one zero is alone around them (Krawczyk's operator, as
in Moore, Kearfott, Cloud, Introduction to Interval Analysis, 2009, chapter 8).
"""

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.model.motion import Samples

from ..core.groups.group_equations import Complex, FramePoses, GroupEquations, coordinates
from ..recorded.arithmetics.box_equations import inverses

PARTS = 4  # of the range of each unknown, to begin with
LEAST = 2.0**-24  # of that range: where two poses meet no box decides
TOO_MANY = 50_000  # boxes of a level: groups of four angles take up to a thousand
SAME = 1e-6  # of a range: two boxes with one zero
SLACK = 1e-11  # of the loops' terms: roundings
STEPS = 5  # of Newton's method from the middle of a box


@dataclass(frozen=True)
class Loops:
    """The closed loops (1)."""

    W: Complex  # (L, C + 1), m
    V: Complex  # (L, K, C + 1)

    def at(self, y: Samples) -> tuple[Samples, Samples, Samples]:
        """F, (n, 2 L), and its Jacobian, (n, 2 L, C + K), by the angles and displacements y; and the arms' lengths."""
        C = self.W.shape[1] - 1
        u, s = np.exp(1j * np.pad(y[:, :C], ((0, 0), (1, 0)))), y[:, C:]
        arms = self.W + np.einsum("lkc,nk->nlc", self.V, s)
        F = np.einsum("nlc,nc->nl", arms, u)
        J = np.concatenate([1j * arms[..., 1:] * u[:, np.newaxis, 1:], np.einsum("lkc,nc->nlk", self.V, u)], axis=2)
        return np.hstack([F.real, F.imag]), np.hstack([J.real, J.imag]), np.abs(arms[..., 1:])

    def bend(self, arms: Samples, rho: Samples) -> Samples:
        """By how much the Jacobian differs at most within rho, (n, C + K), of where the arms are, (n, 2 L, C + K)."""
        C, V = self.W.shape[1] - 1, np.abs(self.V[..., 1:])
        slid = np.einsum("lkc,nk->nlc", V, rho[:, C:])
        turned = (arms + slid) * rho[:, np.newaxis, :C] + slid
        bend = np.concatenate([turned, np.einsum("lkc,nc->nlk", V, rho[:, :C])], axis=2)
        return np.hstack([bend, bend])


def poses(equations: GroupEquations, placed: FramePoses, drive: float) -> tuple[Samples, bool]:
    """All coordinates of a group, shape (poses, m), and whether it is proven that none is missed.

    `placed` are the frames that it hangs on, shape (frames,), and `drive` is the position of its drive, if it has one.
    """
    b, p, on, joints, arms = equations.bodies, equations.pins, equations.on, equations.S, equations.R
    shown = _attitudes(equations, placed)
    null = np.linalg.svd(joints[:, :b])[0][:, b:].conj().T  # of full rank: else a body would hang on nothing
    free = [k for k in range(len(on)) if k not in equations.driven]
    guides = -equations.along[:, np.newaxis] * shown[on]  # (s, C + 1)
    W = null @ arms @ shown
    W[:, 0] += null @ (joints[:, b:] @ placed.z)
    W += drive * null[:, p + equations.driven] @ guides[equations.driven]
    loops = Loops(W, null[:, [p + k for k in free]][..., np.newaxis] * guides[free])
    reach = np.abs(arms).sum() + np.abs(joints[:, b:] @ placed.z).sum() + abs(drive)
    angles = shown.shape[1] - 1
    y, complete = _zeros(loops, np.array([np.pi] * angles + [reach] * len(free)))
    u = np.exp(1j * np.pad(y[:, :angles], ((0, 0), (1, 0)))) @ shown.T
    s = np.full((len(y), len(on)), drive)
    s[:, free] = y[:, angles:]
    rest = u @ arms.T + joints[:, b:] @ placed.z
    rest[:, p:] -= s * equations.along * u[:, on]
    z = -np.linalg.lstsq(joints[:, :b], rest.T, rcond=None)[0].T
    return coordinates(z, np.angle(u[:, :b])), complete


def _attitudes(equations: GroupEquations, placed: FramePoses) -> Complex:
    """Each frame's attitude by the unknown angles, shape (frames, C + 1).

    Frames that joints keep parallel, or the drive at an angle, turn together, what is placed not at all.
    """
    b, frames, ties = equations.bodies, equations.S.shape[1], equations.A
    tied = np.abs(ties)
    tied[len(equations.on) :, -1] = 0  # not with the frame that stands for the drive
    joined = tied.T @ tied + np.eye(frames) > 0
    angles = np.linalg.lstsq(ties[:, :b], -ties[:, b:] @ placed.angle, rcond=None)[0]
    joined[b:, b:] = True
    placed_first = np.roll(np.arange(frames), frames - b)
    first = together(joined[np.ix_(placed_first, placed_first)])
    column = np.unique(first, return_inverse=True)[1][np.argsort(placed_first)]
    return np.asarray(np.eye(column.max() + 1)[column] * np.exp(1j * np.append(angles, placed.angle))[:, np.newaxis])


def together(joined: Any) -> NDArray[np.intp]:
    """The first of those that each is joined to, if by way of others, given which are joined; shape (n, n) to (n,)."""
    for _ in range(len(joined).bit_length()):
        joined = joined @ joined
    return np.asarray(joined.argmax(axis=-1))


def _zeros(loops: Loops, half: Samples) -> tuple[Samples, bool]:
    """The zeros of the loops within +-half, shape (zeros, U), and whether all boxes are decided."""
    middles = (2 * np.arange(PARTS) + 1) / PARTS - 1
    if PARTS ** len(half) > TOO_MANY:
        return np.zeros((0, len(half))), False
    y, rho = np.array([*product(middles, repeat=len(half))]) * half, half / PARTS
    slack = SLACK * (np.abs(loops.W).sum() + np.abs(loops.V).sum() * half.max())
    zeros, level = np.zeros((0, len(half))), 0
    while len(y) and len(y) < TOO_MANY and rho.max() > LEAST * half.max():
        y = y[_may(loops, y, rho, slack)]
        at, alone = _alone(loops, y, rho)
        here = alone & (np.abs(at - y) <= rho * (1 + SAME)).all(axis=1)
        zeros = np.concatenate([zeros, at[here]])
        y, axis = y[~alone], level % len(half)
        rho = np.where(np.arange(len(half)) == axis, rho / 2, rho)
        step = np.zeros(len(half))
        step[axis] = rho[axis]
        y, level = np.concatenate([y - step, y + step]), level + 1
    kept: list[Samples] = []
    for zero in zeros:
        apart = [np.abs(np.where(half == np.pi, np.angle(np.exp(1j * (zero - k))), zero - k)) for k in kept]
        if not any((off <= SAME * half).all() for off in apart):
            kept.append(zero)
    return np.array(kept).reshape(-1, len(half)), not len(y)


def _may(loops: Loops, y: Samples, rho: Samples, slack: float) -> Any:
    """Whether boxes may hold a zero, by F and its slope in their middles and by what that changes."""
    F, J, arms = loops.at(y)
    bend = loops.bend(arms, np.broadcast_to(rho, y.shape)) @ rho / 2 + slack
    may = (np.abs(F) <= np.abs(J) @ rho + bend).all(axis=1)
    inverse = inverses(J)
    off, more = np.abs(np.einsum("nij,nj->ni", inverse, F)), np.einsum("nij,nj->ni", np.abs(inverse), bend)
    return may & ~(off > rho + more).any(axis=1)


def _alone(loops: Loops, y: Samples, rho: Samples) -> tuple[Samples, Any]:
    """The zeros that Newton's method leads to from the middles of boxes, and whether each is alone around its box."""
    at = y
    for _ in range(STEPS):
        F, J, arms = loops.at(at)
        at = at - np.einsum("nij,nj->ni", inverses(J), F)
    F, J, arms = loops.at(at)
    inverse, around = inverses(J), np.abs(at - y) + rho
    off = np.abs(np.einsum("nij,nj->ni", inverse, F))
    moved = np.einsum("nij,njk,nk->ni", np.abs(inverse), loops.bend(arms, around), around)
    return at, (off + moved < around * (1 - SAME)).all(axis=1)
