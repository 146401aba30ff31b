"""Recorded expressions over boxes of the drive's range, as Taylor models.

Of equations a parabola of each unknown, around an approximate solution, and a ball that holds exactly one.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from math import isqrt
from types import MappingProxyType
from typing import Any

import numpy as np

from scenes.model.motion import Samples

from ...core.groups.newton_group import columns, solved
from ..expressions import Closing, Expression, needed
from .in_numpy import NewtonsMethod
from .taylor_models import EXACT, ROUNDED, RULES, TINY, UP, TaylorModel, point

SLACK = 1e-7  # of a bound
ROUGH = 2.0**-40  # of a pose: it is alone within that at least, so that roundings are not too far where it stands still


class BoxLine:
    """The values of expressions over boxes, for many calls; what is the same in all boxes is worked out only once."""

    def __init__(
        self,
        expressions: Sequence[Expression],
        like: int,
        numbers: Mapping[str, TaylorModel],
        known: AbstractSet[int] = frozenset(),
        room: float = 1.0,
    ) -> None:
        """Prepare it; the poses of larger groups are to be `alone` in so many times what they may be off by."""
        self.rows, self.like = expressions, like
        order = [one for one in needed(expressions, known) if one.order not in known]
        self.closed = {one.order: Closed(one.of[0], like, room) for one in order if one.operation == "closed"}
        self.order = [one for one in order if one.sampled]
        self.still = self._values([one for one in order if not one.sampled], numbers, {})

    def __call__(
        self, given: Mapping[str, TaylorModel], known: Mapping[int, TaylorModel] = MappingProxyType({})
    ) -> list[TaylorModel]:
        """The values of the expressions, given the inputs that differ from box to box, and what is known by order."""
        values = self._values(self.order, given, {**self.still, **known})
        return [values[one.order] for one in self.rows]

    @np.errstate(all="ignore")
    def _values(
        self, order: Iterable[Expression], given: Mapping[str, TaylorModel], values: dict[int, TaylorModel]
    ) -> dict[int, TaylorModel]:
        for one in order:
            values[one.order] = self._value(given, one, [values[of.order] for of in one.operands])
        return values

    def _value(self, given: Mapping[str, TaylorModel], one: Expression, of: Sequence[TaylorModel]) -> TaylorModel:
        match one.operation:
            case "constant":
                rounded = 0.0 if (one.of[0] * EXACT).is_integer() else ROUNDED * abs(one.of[0])
                return point(one.of[0], self.like, rounded)
            case "input":
                return given[one.of[0]]
            case "closed":
                return self.closed[one.order](*of)
            case "system":
                return solution(of)
            case "component":
                return of[0][int(one.of[1].of[0])]
            case "less" | "less_equal" if not one.sampled and _told_apart(*of):
                # Of the file's numbers: as they are, to the last place, unless what they may be off by decides.
                return point(getattr(np, one.operation)(*(x.c[0] for x in of)), self.like)
        return RULES[one.operation](*of)


def _told_apart(x: TaylorModel, y: TaylorModel) -> Any:
    """Whether numbers that are the same in all boxes are in one order, whatever they may be off by."""
    return not (np.abs(x.c[1:]) + np.abs(y.c[1:])).any() or ((y - x).sizes[0] > (y - x).moving).all()


class Closed:
    """A larger group's coordinates over boxes, around the poses that Newton's method finds in their middles."""

    def __init__(self, closing: Closing, like: int, room: float) -> None:
        self.room = room
        self.newton, self.k, self.like = NewtonsMethod(closing), len(closing.coordinates), like
        self.names = [one.of[0] for one in closing.coordinates]
        self.outer = closing.outer
        self.line = BoxLine([*closing.C, *closing.J], like, {}, {one.order for one in closing.outer})

    def __call__(self, *given: TaylorModel) -> TaylorModel:
        """The coordinates, given what `Recorder.closed` has: nothing where none, or several, may be in a box."""
        k, like = self.k, self.like
        known = dict(zip((one.order for one in self.outer), given[k + 3 :], strict=True))
        n = max(len(one.rest) for one in given)
        at = ([one.c[0] + s * one.c[1] + s * s * one.c[2] for s in (0, -1, 1)] for one in given)  # middles and ends
        several = (np.broadcast_to(one, (3, n)).reshape(1, 3 * n) for one in at)
        start, *ends = np.moveaxis(self.newton((1, 3 * n), *several).reshape(k, 3, n), 1, 0)

        def equations(c: Samples, off: Samples) -> tuple[TaylorModel, TaylorModel]:
            q = TaylorModel(c, off)
            rows = stacked(self.line({name: q[i] for i, name in enumerate(self.names)}, known))
            J = rows.c[:, k:].reshape(like, k, k, n), rows.rest[k:].reshape(k, k, n)
            return TaylorModel(rows.c[:, :k], rows.rest[:k]), TaylorModel(*J)

        exactly = np.zeros((k, n))
        still = np.concatenate([start[np.newaxis], np.zeros((like - 1, k, n))])
        inverse = inverses(np.moveaxis(equations(still, exactly)[1].c[0], -1, 0))
        c = series(inverse, lambda c: equations(c, exactly)[0], start, like)
        c = np.where(np.isfinite(c).all(axis=(0, 1)), c, 0.0)
        open_by, J = equations(c, exactly)
        tried = 2 * alone(TaylorModel(c, np.nan_to_num(contracted(inverse, open_by, J)[0])), self.room)
        d, holds = contracted(inverse, open_by, equations(c, tried)[1])
        holds &= (alone(TaylorModel(c, d), self.room) <= tried).all(axis=0)  # so that J was that of the whole ball
        nowhere = np.isnan([start, *ends]).any(axis=1).all(axis=0)  # neither in the middle nor at an end
        unknown = np.where(nowhere, np.inf, np.nan)
        return TaylorModel(np.where(holds, c, 0.0), np.where(holds, d, unknown))


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
