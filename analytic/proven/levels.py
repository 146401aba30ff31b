"""What is kept of boxes: of each row the boxes that may hold its extremes, and where a condition may not hold.

Extremes are largest values: each row is there twice, its values with the opposite sign first. Of a box no more is kept
than the rows whose largest value in it is not below what they attain elsewhere, so that memory goes with the boxes that
matter and not with all boxes times all rows.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from scenes.model.motion import Samples

from ..recorded.arithmetics.taylor_models import ROUNDED, TaylorModel, parabola_most
from .boxes import BLOCK, Boxes, Numbers

MAX_MODELS = 1_000_000  # rows times boxes in memory, some hundred bytes each
MAX_AT_ONCE = 200_000  # of these, of which it is asked at once where they are largest


class Level(NamedTuple):
    """Boxes that were evaluated together, shape (n,), and what rows have in those that may hold an extreme, (k,)."""

    low: Samples  # (n,)
    high: Samples
    own: Numbers  # of which box it is: some are several times of one
    doubtful: Any  # where a condition may not hold
    fails: Any  # where one does not
    condition: Numbers  # the first that may not hold, by number
    box: Numbers  # (k,)
    row: Numbers
    c: Samples  # (3, k), the coefficients of the row's parabola
    beside: Samples  # the most of all else
    most: Samples  # of the row's values, infinite where nothing is known
    attained: Samples  # what one of them is at least

    @classmethod
    def of(cls, boxes: Boxes, low: Samples, high: Samples, attained: Samples) -> tuple["Level", Samples]:
        """Boxes by their ends, and what is attained, shape (2 rows,), given what was without them."""
        parts, rows = list[Level](), len(boxes.names)
        size = max(MAX_MODELS // (BLOCK * max(rows, 1)), 1) * BLOCK
        for first in range(0, len(low), size):
            some = slice(first, first + size)
            models, box = boxes(low[some], high[some])
            assumed = np.bincount(box)[box] > 1
            step = max(MAX_AT_ONCE // max(rows, 1), 1)
            for here in (slice(begin, begin + step) for begin in range(0, len(box), step)):
                ends = low[some][box[here]], high[some][box[here]], box[here] + first
                part, attained = cls._of(models[:, here], *ends, assumed[here], attained)
                parts.append(part)
        return joined(parts), attained

    @classmethod
    def _of(
        cls, models: TaylorModel, low: Samples, high: Samples, index: Numbers, assumed: Any, attained: Samples
    ) -> tuple["Level", Samples]:
        rows = len(attained) // 2
        c, rest = models.c[:, :rows], models.rest[:rows]
        c = np.concatenate([-c, c], axis=1)
        further = np.abs(c[3:]).sum(axis=0)
        top, rest = parabola_most(c) + further, np.concatenate([rest, rest])
        error = rest + np.tile(8 * ROUNDED * models.most[:rows], (2, 1))
        unknown = np.isnan(rest)
        # A value counts as attained only in boxes that surely assemble: not where a condition fails, and not in copies
        # of a box that assume how a press force or a joint's friction stands, of which one alone is true.
        least, largest = (bound[rows:] for bound in models.range)
        doubtful, fails = ~(least > 0).all(axis=0), (largest < 0).any(axis=0)
        condition = (~(least > 0)).argmax(axis=0) if len(least) else np.zeros(len(index), np.intp)
        most, known = np.where(unknown, np.inf, top + error), np.where(unknown | fails | assumed, -np.inf, top - error)
        attained = np.maximum(attained, known.max(axis=1))
        row, box = np.nonzero((most >= attained[:, np.newaxis]) & ~doubtful)  # with one that stays so nothing is known
        of_rows = c[:3, row, box], (rest + further)[row, box], most[row, box], known[row, box]
        return cls(low, high, index, doubtful, fails, condition, box, row, *of_rows), attained

    def wanted(self, enough: Samples) -> Any:
        """Boxes where a row may have values above what is enough, shape (2 rows,), or a condition may not hold."""
        wanted = self.doubtful.copy()
        wanted[self.box[self.most > enough[self.row]]] = True
        return wanted

    def kept(self, boxes: Any, attained: Samples) -> "Level":
        """Those of some boxes, and of their rows those that may still hold an extreme."""
        some = boxes[self.box] & (self.most >= attained[self.row])
        number = np.cumsum(boxes) - 1
        of_boxes = {name: getattr(self, name)[boxes] for name in OF_BOXES}
        of_rows = {name: getattr(self, name)[..., some] for name in OF_ROWS}
        return self._replace(**of_boxes, box=number[self.box[some]], **of_rows)

    def places(self, attained: Samples, most: Samples) -> tuple[Samples, Samples, Any]:
        """The parts of boxes where rows may attain values, shape (2 rows,): from where and to where.

        With them whether the row is known to be there as near to that as it can be more than that elsewhere.
        """
        c0, c1, c2 = self.c
        # Where c0 + c1 s + c2 s^2 plus its bound may reach what is attained: between the roots of a parabola that opens
        # downwards, else anywhere in the box. Roots are found in doubles, so that the part is widened by 1e-6 of the
        # box; it stays inside the box.
        excess = c0 + self.beside - attained[self.row]
        low, high = self.low[self.box], self.high[self.box]
        middle, half = (low + high) / 2, (high - low) / 2
        error = 1e-6 * half + 8 * ROUNDED * np.maximum(np.abs(low), np.abs(high))
        with np.errstate(invalid="ignore", divide="ignore"):  # between the roots of a parabola that has a top
            root = np.sqrt(np.maximum(c1 * c1 - 4 * c2 * excess, 0))
            first, last = (
                middle + half * np.where((c2 < 0) & np.isfinite(excess), np.clip((c1 + s * root) / (-2 * c2), -1, 1), s)
                for s in (-1, 1)
            )
        holds = self.attained >= (2 * attained - most)[self.row]
        return np.maximum(first - error, low), np.minimum(last + error, high), holds


OF_BOXES = ("low", "high", "own", "doubtful", "fails", "condition")  # the fields of a level of shape (n,)
OF_ROWS = ("row", "c", "beside", "most", "attained")  # of shape (..., k), besides the box


def joined(levels: Iterable[Level]) -> Level:
    """The boxes of several, with their rows in order."""
    every = [*levels]
    counts = np.cumsum([0, *(len(level.low) for level in every)])
    numbered = [level._replace(box=level.box + first) for level, first in zip(every, counts, strict=False)]
    order = np.argsort(np.concatenate([level.row for level in every]), kind="stable")
    whole = Level(*(np.concatenate(parts, axis=-1) for parts in zip(*numbered, strict=True)))
    return whole._replace(**{name: getattr(whole, name)[..., order] for name in ("box", *OF_ROWS)})
