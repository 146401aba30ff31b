"""Which points span the uniform body that one is taken for where no centre of mass and inertia are given.

One point is a point mass, two are the ends of a bar, three the corners of a triangular plate; points on one line,
however many, are on a bar between the outermost two. Which of these a body is follows here from its numbers as drawn;
centre and inertia each model works out by itself.

The inertia of a plate does not tend to that of a bar as the plate gets flatter: with a third corner in the middle it is
half of it. So there is a limit between the two, a height of 1e-3 of the longest side. General tolerances of places (ISO
2768-1, medium: 0.3 mm on 120 to 400 mm) leave the pins of a straight lever below it, so that machines drawn from a
lever's tolerances are bars as well; nobody cuts a plate so flat, and doubles leave far less of a height.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from math import inf
from typing import Any, TypeAlias

import numpy as np

from .limits import POINTS

Places: TypeAlias = Mapping[str, tuple[Any, Any]]  # m; numbers, or arrays of one shape
Lengths: TypeAlias = Mapping[frozenset[str], Any]  # m, of pairs of points; likewise

LINE = 1e-3  # of the longest side: at most so high is a triangle whose corners are on one line
CLOSED = 1e-12  # of two lengths: what their sum is off a third one by rounding, where the points are on one line


def corners(points: Sequence[str], local: Places | None, lengths: Lengths | None) -> tuple[str, ...]:
    """The points that span a uniform body: all, or of three and more on one line the outermost two.

    By lengths, without places, no more than three points are on one line here.
    """
    if len(points) < 3 or (local is None and len(points) > 3):
        return tuple(points)
    end = max(points, key=partial(_length, local, lengths, points[0]))
    other = max(points, key=partial(_length, local, lengths, end))
    ends = tuple(point for point in points if point in (end, other))
    return ends if all(height <= LINE for height in heights(ends, points, local, lengths)) else tuple(points)


def heights(
    corners: Sequence[str], points: Sequence[str], local: Places | None, lengths: Lengths | None
) -> Iterator[Any]:
    """Yield how high the triangles of two corners and another point are over their longest side, as a share of it."""
    p, q, *_ = corners
    for r in points:
        if r not in (p, q):
            sides = np.broadcast_arrays(*(_length(local, lengths, *ends) for ends in ((p, q), (q, r), (r, p))))
            with np.errstate(all="ignore"):  # of numbers that no file may have
                a, b, c = sides / np.maximum.reduce(sides)
                heron = (a + b + c) * (a + b - c) * (a - b + c) * (b + c - a)
                yield np.sqrt(np.maximum(heron, 0)) / 2


def on_one_line(points: Sequence[str], lengths: Lengths) -> dict[str, tuple[float, float]]:
    """Where points are, m, whose lengths close on one line alone: on x, which goes from the first to the second.

    Each point after the second has lengths to two before it. Nothing where there are not three points, all on the line.
    """
    if not 2 < len(points) <= POINTS:
        return {}
    first, second, *others = points
    places = {first: 0.0, second: lengths.get(frozenset((first, second)), inf)}
    for point in others:
        bases = [(x, lengths[pair]) for p, x in places.items() if (pair := frozenset((p, point))) in lengths]
        if len(bases) != 2:
            return {}
        (x, a), (y, b) = bases
        off, place = min((abs(abs(place - y) - b), place) for place in (x - a, x + a))
        if not off <= CLOSED * (a + b):
            return {}
        places[point] = place
    return {point: (place, 0.0) for point, place in places.items()}


def _length(local: Places | None, lengths: Lengths | None, p: str, q: str) -> Any:
    """The distance of two points, m; infinite where it is not known."""
    if local is None:
        return 0.0 if p == q else (lengths or {}).get(frozenset((p, q)), inf)
    (x, y), (u, v) = local[p], local[q]
    return np.hypot(x - u, y - v)
