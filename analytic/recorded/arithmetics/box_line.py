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

from ..expressions import Closing, Expression, needed
from .in_numpy import NewtonsMethod, StraightLine
from .systems import Matrices, Matrix, alone, contracted, gains, series, stacked
from .taylor_models import EXACT, ROUNDED, RULES, TaylorModel, point


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
        order = [expression for expression in needed(expressions, known) if expression.order not in known]
        closed = (expression for expression in order if expression.operation == "closed")
        self.closed = {
            expression.order: (Chained if expression.of[0].start else Closed)(expression.of[0], like, room)
            for expression in closed
        }
        systems = (expression for expression in order if expression.operation == "system")
        self.systems = {
            expression.order: Matrix(expression.of[: isqrt(len(expression.of)) ** 2]) for expression in systems
        }
        self.order = [expression for expression in order if expression.sampled]
        last = {operand.order: expression.order for expression in self.order for operand in expression.operands}
        self.ended: dict[int, list[int]] = {}  # by order, what no later one is of
        for order_of in {expression.order for expression in self.order} - {
            expression.order for expression in expressions
        }:
            self.ended.setdefault(last[order_of], []).append(order_of)
        self.still = self._values([expression for expression in order if not expression.sampled], numbers, {})

    def __call__(
        self, given: Mapping[str, TaylorModel], known: Mapping[int, TaylorModel] = MappingProxyType({})
    ) -> list[TaylorModel]:
        """The values of the expressions, given the inputs that differ from box to box, and what is known by order."""
        values = self._values(self.order, given, {**self.still, **known}, self.ended)
        return [values[expression.order] for expression in self.rows]

    @np.errstate(all="ignore")
    def _values(
        self,
        order: Iterable[Expression],
        given: Mapping[str, TaylorModel],
        values: dict[int, TaylorModel],
        ended: Mapping[int, Iterable[int]] = MappingProxyType({}),
    ) -> dict[int, TaylorModel]:
        factored: dict[Any, Matrices] = {}  # rates and accelerations are of one matrix
        for expression in order:
            values[expression.order] = self._value(
                given, expression, [values[operand.order] for operand in expression.operands], factored
            )
            for done in ended.get(expression.order, ()):
                del values[done]
        return values

    def _value(
        self,
        given: Mapping[str, TaylorModel],
        expression: Expression,
        operands: Sequence[TaylorModel],
        factored: dict[Any, Matrices],
    ) -> TaylorModel:
        match expression.operation:
            case "constant":
                rounded = 0.0 if (expression.of[0] * EXACT).is_integer() else ROUNDED * abs(expression.of[0])
                return point(expression.of[0], self.like, rounded)
            case "input":
                return given[expression.of[0]]
            case "closed":
                return self.closed[expression.order](*operands)
            case "system":
                matrix, k = self.systems[expression.order], self.systems[expression.order].k
                entries = expression.of[: k * k]
                # A group's rates and accelerations are solved with one Jacobian: its inverse and the bound on 1 - R A
                # are found once.
                if (key := tuple(entry.order for entry in entries)) not in factored:
                    factored[key] = Matrices(matrix, stacked([operands[place] for place in matrix.places.tolist()]))
                return factored[key].solution(stacked(operands[k * k :]))
            case "component":
                return operands[0][int(expression.of[1].of[0])]
            case "less" | "less_equal" if not expression.sampled and _told_apart(*operands):
                # A choice by numbers of the file alone is made with their values, not left open for their last places,
                # unless the amounts that they may be off by decide it.
                return point(getattr(np, expression.operation)(*(x.c[0] for x in operands)), self.like)
        return RULES[expression.operation](*operands)


def _told_apart(x: TaylorModel, y: TaylorModel) -> Any:
    """Whether numbers that are the same in all boxes are in one order, whatever they may be off by."""
    return not (np.abs(x.c[1:]) + np.abs(y.c[1:])).any() or ((y - x).sizes[0] > (y - x).moving).all()


class Closed:
    """A larger group's coordinates over boxes, around the poses that Newton's method finds in their middles."""

    def __init__(self, closing: Closing, like: int, room: float) -> None:
        self.room = room
        self.k, self.like, self.start = len(closing.coordinates), like, self._start(closing)
        self.names = [coordinate.of[0] for coordinate in closing.coordinates]
        self.outer, self.J = [expression.order for expression in closing.outer], Matrix(closing.J)
        self.unknowns = np.append(np.arange(self.k), self.J.row)  # the unknown that each equation, and entry, goes with
        self.unit = np.append(np.zeros(self.k, np.bool_), self.J.row == self.J.column)
        entries = [closing.J[place] for place in self.J.places.tolist()]
        self.line = BoxLine([*closing.C, *entries], like, {}, {*self.outer})

    def _start(self, closing: Closing) -> Callable[..., Samples]:
        """What finds coordinates in the middles of boxes, and at both ends, shape (k, 3, n)."""
        return NewtonsMethod(closing)

    def __call__(self, *given: TaylorModel) -> TaylorModel:
        """The coordinates, given what `Recorder.closed` has: nothing where none, or several, may be in a box."""
        k, like = self.k, self.like
        known = dict(zip(self.outer, given[-len(self.outer) :], strict=True))
        n = max(len(model.rest) for model in given)
        places = (
            [model.c[0] + s * model.c[1] + s * s * model.c[2] for s in (0, -1, 1)] for model in given
        )  # middles and ends
        several = (np.broadcast_to(values, (3, n)).reshape(1, 3 * n) for values in places)
        # Approximate poses by the same method as at samples, in the middle and at both ends; those at the ends only
        # tell a box without any pose from one whose pose is not found.
        start, *ends = np.moveaxis(self.start((1, 3 * n), *several).reshape(k, 3, n), 1, 0)

        def equations(c: Samples, rest: Samples) -> tuple[TaylorModel, Matrices]:
            q = TaylorModel(c, rest)
            rows = stacked(self.line({name: q[i] for i, name in enumerate(self.names)}, known))
            # Where one has no start it and what hangs on it are left out: their equations are x = 0.
            c, rest = (np.where(lost[self.unknowns], 0.0, part) for part in (rows.c, rows.rest))
            c[0] += self.unit[:, np.newaxis] & lost[self.unknowns]
            return TaylorModel(c[:, :k], rest[:k]), Matrices(self.J, TaylorModel(c[:, k:], rest[k:]))

        # Existence and uniqueness of the pose over a whole box, by Krawczyk's operator around a parabola:
        # 1. the inverse R of the Jacobian in the middle of each box, in doubles;
        # 2. the coefficients of q along the box, order by order, by corrections with that R (`series`);
        # 3. a ball twice as large as what the residual of the parabola suggests, and the Jacobian over that whole ball;
        # 4. the contraction with that Jacobian: it has to map the ball into itself, so that exactly one pose is in it.
        # Where 4 fails the box is too wide or next to a singular configuration, and the caller divides it.
        exactly, lost = np.zeros((k, n)), np.isnan(start)
        still = np.concatenate([np.nan_to_num(start)[np.newaxis], np.zeros((like - 1, k, n))])
        inverse = equations(still, exactly)[1].inverse
        c = series(inverse, lambda c: equations(c, exactly)[0], still[0], like)
        c = np.where(np.isfinite(c).all(axis=(0, 1)), c, 0.0)
        open_by, J = equations(c, exactly)
        tried = 2 * alone(TaylorModel(c, np.nan_to_num(contracted(inverse, open_by, gains(inverse, J))[0])), self.room)
        d, holds = contracted(inverse, open_by, gains(inverse, equations(c, tried)[1]))
        holds &= (alone(TaylorModel(c, d), self.room) <= tried).all(axis=0)  # so that J was that of the whole ball
        nowhere = np.isnan([start, *ends]).any(axis=1).all(axis=0)  # neither in the middle nor at an end
        unknown = np.where(nowhere, np.inf, np.nan)
        holds = holds & ~lost
        return TaylorModel(np.where(holds, c, 0.0), np.where(holds, d, unknown))


class Chained(Closed):
    """The pins of dyads in a row over boxes, around where closed forms have them."""

    def _start(self, closing: Closing) -> Callable[..., Samples]:
        line, names = StraightLine(closing.start), [entry.of[0] for entry in closing.begun]
        return lambda _, *given: line(dict(zip(names, (np.ravel(x) for x in given), strict=False)))[:, 0]
