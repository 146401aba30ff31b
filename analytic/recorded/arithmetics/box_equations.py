"""Equations over boxes: around an approximate solution, a parabola of each unknown, a ball that holds exactly one."""

from collections.abc import Callable, Sequence
from math import isqrt
from typing import Any

import numpy as np

from scenes.model.motion import Samples

from ...core.groups.newton_group import columns, solved
from .taylor_models import ROUNDED, TINY, UP, TaylorModel

SLACK = 1e-7  # of a bound
ROUGH = 2.0**-40  # of a pose: it is alone within that at least, so that roundings are not too far where it stands still


def stacked(models: Sequence[TaylorModel]) -> TaylorModel:
    """Models as one, of shape (k, n)."""
    c, rest = (np.broadcast_arrays(*each) for each in zip(*((one.c, one.rest) for one in models), strict=True))
    return TaylorModel(np.stack(c, axis=1), np.stack(rest))


def _times(matrix: Samples, x: TaylorModel) -> TaylorModel:
    """A matrix of doubles, shape (n, k, k), times models of shape (k, ..., n)."""
    n, k, _ = matrix.shape

    def product(matrix: Samples, columns: Samples) -> Samples:
        rows = np.matmul(matrix[:, np.newaxis], np.moveaxis(columns.reshape(-1, k, x.rest.size // (n * k), n), -1, 0))
        return np.asarray(np.moveaxis(rows, 0, -1).reshape(columns.shape))

    return TaylorModel(product(matrix, x.c), product(np.abs(matrix), x.rest + k * ROUNDED * x.most) * UP + TINY)


def _sum(x: TaylorModel) -> TaylorModel:
    """The sum of models over their second axis."""
    return TaylorModel(x.c.sum(axis=2), (x.rest + x.c.shape[2] * ROUNDED * x.most).sum(axis=1) * UP)


def alone(x: TaylorModel, room: float) -> Samples:
    """How far from poses, shape (k, n), there is no other, if in so many times their ball there is none."""
    return np.asarray(room * (x.rest + ROUGH * x.most))


def inverses(A: Samples) -> Samples:
    """Inverses, about, of matrices of shape (n, k, k), NaN where there are none."""
    return columns(A, np.eye(A.shape[-1])[np.newaxis])


def contracted(inverse: Samples, open_by: TaylorModel, J: TaylorModel) -> tuple[Samples, Any]:
    """What bounds the solution's distance, shape (k, n), and whether there is one: d > |R F| + |1 - R J| d (Krawczyk).

    Of equations F = 0 with the Jacobian J, both near an approximate solution, and R about the inverse of J.
    """
    left, E = _times(inverse, open_by), _times(inverse, -J)
    k = inverse.shape[-1]
    E.c[0] += np.eye(k)[..., np.newaxis]
    rounded = UP + k * ROUNDED
    off, gains = (left.most + left.rest) * rounded, (E.most + E.rest + 2 * ROUNDED) * rounded
    more = off * (1 + SLACK) + SLACK * off.max(axis=0) + TINY  # so that the bound is one whatever was rounded
    d = solved(np.eye(k) - np.moveaxis(gains, -1, 0), more.T).T
    holds = ((d > 0) & (d > (off + np.einsum("ijn,jn->in", gains, d)) * rounded)).all(axis=0)
    return np.where(holds, d, np.nan), holds


def series(inverse: Samples, left: Callable[[Samples], TaylorModel], start: Samples, like: int) -> Samples:
    """The coefficients of x where F(x) is zero, shape (like, k, n), order by order from the first, given F of them."""
    c = np.zeros((like, *start.shape))
    c[0] = start
    for rows in ([1, *range(3, like)], [2]):
        c[rows] -= np.einsum("nij,ajn->ain", inverse, left(c).c[rows])
    return c


def solution(entries: Sequence[TaylorModel]) -> TaylorModel:
    """The x of A x = b, shape (k, n), given the entries of A, row by row, and of b; nothing where A may be singular."""
    k, every = isqrt(len(entries)), stacked(entries)
    like, n = len(every.c), every.c.shape[-1]
    A = TaylorModel(every.c[:, : k * k].reshape(like, k, k, n), every.rest[: k * k].reshape(k, k, n))
    b = TaylorModel(every.c[:, k * k :], every.rest[k * k :])
    inverse = inverses(np.moveaxis(A.c[0], -1, 0))

    def left(c: Samples) -> TaylorModel:
        return _sum(A * TaylorModel(c[:, np.newaxis], np.zeros((1, k, n)))) - b

    c = series(inverse, left, np.einsum("nij,jn->in", inverse, b.c[0]), like)
    d, holds = contracted(inverse, left(c), A)
    return TaylorModel(np.where(holds, c, 0.0), d)
