"""Linear equations over boxes, and the bound by which an approximate solution of equations is off.

Of matrices most of whose entries are zero, as joints have to do with few bodies each.
"""

from collections.abc import Callable, Sequence
from functools import cached_property
from math import isqrt
from typing import Any

import numpy as np

from scenes.model.motion import Samples

from ...core.groups.newton_group import columns, solved
from ..expressions import Expression
from .taylor_models import ROUNDED, UNDERFLOW, UP, TaylorModel

BOUND_TOL = 1e-7  # of a bound
MIN_ROOM = 2.0**-40  # of a pose: it is alone within that, so that roundings are not too far where it stands still
MAX_ENTRIES = 200_000  # of matrices at a time, some hundred bytes each


class Matrix:
    """Which entries of square matrices, row by row, are not zero everywhere."""

    def __init__(self, entries: Sequence[Expression]) -> None:
        self.k = k = isqrt(len(entries))
        zero = [entry.operation == "constant" and entry.of[0] == 0 for entry in entries]
        self.places = np.flatnonzero(~np.reshape(zero, (k, k)) | np.eye(k, dtype=np.bool_))
        self.row, self.column = np.divmod(self.places, k)
        self.first = np.searchsorted(self.row, np.arange(k))  # of each row
        # Of each place what a sum of as many terms is rounded by, shape (places, 1); zeros are added exactly.
        self.of_rows, self.of_columns = (
            ROUNDED * np.bincount(line)[line, np.newaxis] for line in (self.row, self.column)
        )

    def full(self, entries: Samples) -> Samples:
        """Matrices, shape (n, ..., k, k), given what is in those places, shape (..., places, n)."""
        entries = np.moveaxis(entries, -1, 0)
        whole = np.zeros((*entries.shape[:-1], self.k * self.k))
        whole[..., self.places] = entries
        return whole.reshape(*entries.shape[:-1], self.k, self.k)


class Matrices:
    """Matrices over boxes: models of the entries that are not zero."""

    def __init__(self, places: Matrix, entries: TaylorModel) -> None:
        self.places, self.entries = places, entries

    @cached_property
    def inverse(self) -> Samples:
        """Their inverses, about, in the middles of the boxes, shape (n, k, k)."""
        return inverses(self.places.full(self.entries.c[0]))

    @cached_property
    def gains(self) -> Samples:
        """A bound on |1 - R A|, R the inverse, shape (n, k, k)."""
        return gains(self.inverse, self)

    def times(self, x: Samples) -> TaylorModel:
        """The products with vectors of polynomials, of coefficients x, shape (like, k, n)."""
        still = np.zeros((len(self.places.column), 1))
        return _sums(self.entries * TaylorModel(x[:, self.places.column], still), self.places)

    def solution(self, b: TaylorModel) -> TaylorModel:
        """The x of A x = b, shape (k, n); nothing where A may be singular."""

        def left(c: Samples) -> TaylorModel:
            return self.times(c) - b

        start = np.einsum("nij,jn->in", self.inverse, b.c[0])
        c = series(self.inverse, left, start, len(b.c))
        d, holds = contracted(self.inverse, left(c), self.gains)
        return TaylorModel(np.where(holds, c, 0.0), d)


def stacked(models: Sequence[TaylorModel]) -> TaylorModel:
    """Models as one, of shape (k, n)."""
    c, rest = (np.broadcast_arrays(*each) for each in zip(*((model.c, model.rest) for model in models), strict=True))
    return TaylorModel(np.stack(c, axis=1), np.stack(rest))


def _times(matrix: Samples, x: TaylorModel) -> TaylorModel:
    """A matrix of doubles, shape (n, k, k), times models of shape (k, n)."""
    k = matrix.shape[-1]

    def product(matrix: Samples, columns: Samples) -> Samples:
        return np.asarray(np.moveaxis(matrix @ np.moveaxis(columns, -1, 0)[..., np.newaxis], 0, -1)[..., 0, :])

    c = np.stack([product(matrix, part) for part in x.c])
    return TaylorModel(c, product(np.abs(matrix), x.rest + k * ROUNDED * x.most) * UP + UNDERFLOW)


def _sums(x: TaylorModel, matrix: Matrix) -> TaylorModel:
    """The sums of models of entries over each row."""
    rest = np.add.reduceat(x.rest + matrix.of_rows * x.most, matrix.first) * UP
    return TaylorModel(np.add.reduceat(x.c, matrix.first, axis=1), rest)


def alone(x: TaylorModel, room: float) -> Samples:
    """How far from poses, shape (k, n), there is no other, if in so many times their ball there is none."""
    return np.asarray(room * (x.rest + MIN_ROOM * x.most))


def inverses(A: Samples) -> Samples:
    """Inverses, about, of matrices of shape (n, k, k), NaN where there are none."""
    return columns(A, np.eye(A.shape[-1])[np.newaxis])


# E = 1 - R J as a polynomial in doubles, with the sum of the magnitudes of all its coefficients as bound over the box;
# rests and roundings of J go through |R|. Any entry that is not finite makes the bound so, and the contraction fails.
def gains(inverse: Samples, J: Matrices) -> Samples:
    """A bound on |1 - R J|, shape (n, k, k), R about the inverse of J; of so many boxes at a time that they fit."""
    k, n = inverse.shape[-1], len(inverse)
    rounded, bound = UP + k * ROUNDED, np.empty(inverse.shape)
    step = max(MAX_ENTRIES // (k * k), 1)
    for some in (slice(first, first + step) for first in range(0, n, step)):
        entries, R = J.entries[:, some], inverse[some]
        E = R[:, np.newaxis] @ J.places.full(-entries.c)
        E[:, 0] += np.eye(k)
        rest = np.abs(R) @ J.places.full(entries.rest + J.places.of_columns * entries.most) * UP + UNDERFLOW
        bound[some] = (np.abs(E).sum(axis=1) + rest + 2 * ROUNDED) * rounded
    return bound


# Krawczyk's contraction: |x* - x| <= d componentwise for every d with |R F| + |1 - R J| d < d (Moore, Kearfott, Cloud,
# 2009, chapter 8). A candidate is the solution of (1 - G) d = |R F| plus a margin, in doubles. The inequality is then
# tested by itself, with roundings counted upwards, so that nothing depends on how the candidate was found. It fails
# where G has a spectral radius of one or more: boxes too wide, or a singular Jacobian.
def contracted(inverse: Samples, open_by: TaylorModel, gains: Samples) -> tuple[Samples, Any]:
    """What bounds the solution's distance, shape (k, n), and whether there is one: d > |R F| + |1 - R J| d (Krawczyk).

    Of equations F = 0 with the Jacobian J, both near an approximate solution, and R about the inverse of J.
    """
    left, k = _times(inverse, open_by), inverse.shape[-1]
    rounded = UP + k * ROUNDED
    bound = (left.most + left.rest) * rounded
    more = (
        bound * (1 + BOUND_TOL) + BOUND_TOL * bound.max(axis=0) + UNDERFLOW
    )  # so that the bound is one whatever was rounded
    d = solved(np.eye(k) - gains, more.T).T
    holds = ((d > 0) & (d > (bound + np.einsum("nij,jn->in", gains, d)) * rounded)).all(axis=0)
    return np.where(holds, d, np.nan), holds


def series(inverse: Samples, left: Callable[[Samples], TaylorModel], start: Samples, like: int) -> Samples:
    """The coefficients of x where F(x) is zero, shape (like, k, n), order by order from the first, given F of them."""
    c = np.zeros((like, *start.shape))
    c[0] = start
    # With an exact inverse at the middle one correction makes all coefficients of first order right: those of s and of
    # the scene's numbers. The second-order one, of s^2, depends on them and comes after. What the inverse lacks remains
    # in the rest.
    for rows in ([1, *range(3, like)], [2]):
        c[rows] -= np.einsum("nij,ajn->ain", inverse, left(c).c[rows])
    return c
