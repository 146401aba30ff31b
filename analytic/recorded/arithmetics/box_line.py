"""Recorded expressions over boxes of the drive's range, as Taylor models."""

from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from types import MappingProxyType

import numpy as np

from scenes.model.motion import Samples

from ..expressions import Closing, Expression, needed
from .box_equations import alone, contracted, inverses, series, solution, stacked
from .in_numpy import NewtonsMethod
from .taylor_models import EXACT, ROUNDED, RULES, TaylorModel, point


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
            case "less" | "less_equal" if not one.sampled:  # of the file's numbers: as they are, to the last place
                return point(getattr(np, one.operation)(*(x.c[0] for x in of)), self.like)
        return RULES[one.operation](*of)
