"""That larger groups are on one branch all the way: where boxes meet, both have the same pose.

In a box a pose is off its parabola by a ball at most, and in a larger one there is no other (`box_line`). Two
boxes have the same pose at a place where the ball of the one lies within the larger one of the other.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import tau
from typing import Any

import numpy as np

from scenes.model.motion import Samples

from ..recorded.arithmetics.systems import alone
from ..recorded.arithmetics.taylor_models import ROUNDED, TaylorModel, joined

MIN_BOX = 2.0**-44  # of the whole way: none is divided further
ROOM = 4.0  # times a pose's ball, in that of which two boxes are to have no other: one lies in it beside another


@dataclass(frozen=True)
class Branches:
    """Poses over neighbouring boxes of all the way, each the one of the box before; NaN where that is not known."""

    low: Samples  # (n,), increasing
    high: Samples
    poses: TaylorModel  # the coordinates of all groups, every third an angle, shape (k, n)
    periodic: bool  # whether they are the same a turn, or a cycle, further

    def have(self, poses: TaylorModel, low: Samples, high: Samples) -> Any:
        """Whether other boxes, by their ends, have these poses in their middles, and all are known in them, (m,)."""
        middle = (low + high) / 2
        slip = np.abs(middle)
        # The poses of the first cycle stand for all: other boxes are moved into it. The shift loses last places of a
        # large position, which is allowed for by `slip`.
        if self.periodic:
            turn = self.high[-1] - self.low[0]
            low, middle, high = (x - turn * np.floor((middle - self.low[0]) / turn) for x in (low, middle, high))
        first, nearest = (np.maximum(np.searchsorted(self.low, x, "right") - 1, 0) for x in (low, middle))
        end = np.searchsorted(self.low, high)
        # Prefix sums: no box between two numbers is unknown if the sums are equal.
        unknown = np.append(0, np.cumsum(np.isnan(self.poses.rest).any(axis=0)))
        half, centre = ((self.high[nearest] + sign * self.low[nearest]) / 2 for sign in (-1, 1))
        same = _same(
            self.poses[..., nearest], (middle - centre) / half, poses, 0.0, 1.0, np.maximum(slip, np.abs(middle)) / half
        )
        return same & (unknown[end] == unknown[first])


def branches(
    poses: Callable[[Samples, Samples], TaylorModel],
    boxes: tuple[Samples, Samples],
    most: int,
    *,
    periodic: bool,
) -> Branches:
    """Divide boxes until neighbours have the same pose where they meet, and the first one that of the last.

    Args:
        poses: over boxes by their ends, shape (n,), alone in ROOM times their balls; infinitely far off where none are.
        boxes: the ends of boxes with all the way, in its order, shape (n,) each.
        most: boxes at a time; where more are left, their poses are not known.
        periodic: whether the last box meets the first one.
    """
    (low, high), found = boxes, poses(*boxes)
    # Both boxes are divided where two neighbours do not have the same pose at the edge between them. Division ends at
    # MIN_BOX, next to a singular configuration, where two poses come as near as their bounds.
    while True:
        after = found[..., np.roll(np.arange(len(low)), -1)]
        meets = _same(found, 1.0, after, -1.0, ROOM)
        meets[-1] |= not periodic
        closed, none = np.isfinite(found.rest).all(axis=0), np.isinf(found.rest).any(axis=0)
        unknown = ~none & ~(closed & meets & np.roll(meets, 1))
        divided = unknown & (high - low > MIN_BOX * (high[-1] - low[0]))
        if not divided.any() or 2 * divided.sum() > most:
            return Branches(low, high, TaylorModel(found.c, np.where(unknown | none, np.nan, found.rest)), periodic)
        middle = (low[divided] + high[divided]) / 2
        halves = np.append(low[divided], middle), np.append(middle, high[divided])
        low, high = (np.append(x[~divided], half) for x, half in zip((low, high), halves, strict=True))
        order = np.argsort(low)
        low, high, found = low[order], high[order], joined([found[..., ~divided], poses(*halves)])[..., order]


def _same(x: TaylorModel, s: Any, y: TaylorModel, r: float, room: float, slip: Any = 0.0) -> Any:
    """Whether poses x at s, which may `slip` by its last place, are y at r, which have so much `room`."""
    # Both models are evaluated at their places, s and r, with the scene's numbers left as variables: their coefficients
    # from 3 on are those of the same t_i, and subtract. The ball of one pose has to lie in the ball in which the other
    # one is alone.
    c = np.delete(x.c, (1, 2), axis=0) - np.delete(y.c, (1, 2), axis=0)
    c[0] += s * (x.c[1] + s * x.c[2]) - r * (y.c[1] + r * y.c[2])
    c[0, 2::3] -= tau * np.round(c[0, 2::3] / tau)  # angles, which are the same after whole turns
    apart = np.abs(c).sum(axis=0) + 2 * ROUNDED * (x.most + y.most + slip * x.moving)
    return (apart + x.rest <= alone(y, room)).all(axis=0) | (apart + y.rest <= alone(x, ROOM)).all(axis=0)
