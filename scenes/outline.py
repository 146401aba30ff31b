"""Bodies as drawn: what a plane outline, or a bar of some width, of one thickness and one density weighs.

By Green's theorem the integrals over an area are sums along its outline. With each corner x, y from the first one, the
next one x', y', and c = x y' - x' y, the area is the sum of c / 2, its first moments are those of (x + x') c / 6 and
(y + y') c / 6, its polar moment that of (x^2 + x x' + x'^2 + y^2 + y y' + y'^2) c / 12; all change their sign with the
sense of the outline. Numbers are floats, arrays of many machines, shape (m, 1), or recorded expressions.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

Corner: TypeAlias = tuple[Any, Any]  # m
Weight: TypeAlias = tuple[Any, Corner, Any]  # mass, kg; centre of mass, m; inertia about it, kg m^2


def of_plate(outline: Sequence[Corner], density: Any) -> Weight:
    """The weight of what an outline encloses, of a density in kg/m^2; nothing where that is no area."""
    x0, y0 = outline[0]
    area, moment_x, moment_y, polar = 0.0, 0.0, 0.0, 0.0  # twice, six, six and twelve times what they are
    for (x, y), (u, v) in pairwise((x - x0, y - y0) for x, y in outline[1:]):  # of sides at the first corner c is zero
        c = x * v - u * y
        area = area + c
        moment_x, moment_y = moment_x + (x + u) * c, moment_y + (y + v) * c
        polar = polar + (x * x + x * u + u * u + y * y + y * v + v * v) * c
    if not np.ndim(area) and area == 0:
        return 0.0, outline[0], 0.0
    with np.errstate(all="ignore"):  # of machines without an area
        mass, x, y = density * abs(area) / 2, moment_x / (3 * area), moment_y / (3 * area)
        return mass, (x0 + x, y0 + y), mass * (polar / (6 * area) - (x * x + y * y))


def of_bar(first: Corner, second: Corner, width: Any, density: Any) -> Weight:
    """The weight of a rectangle that ends at two points, of a density in kg/m^2."""
    (x, y), (u, v) = first, second
    length = abs((u - x) + 1j * (v - y))
    mass = density * width * length
    return mass, ((x + u) / 2, (y + v) / 2), mass * (length * length + width * width) / 12


def places(outline: Sequence[Corner]) -> Any:
    """Where the corners are as complex numbers, m, shape (corners,), or (corners, m, 1) of many machines."""
    return np.stack(np.broadcast_arrays(*(x + 1j * y for x, y in outline)))


def meetings(start: Any) -> Iterator[tuple[int, int, Any]]:
    """Yield two sides, each by its first corner, that meet and are no neighbours; of many machines, in which."""
    end = np.roll(start, -1, axis=0)
    for side in range(len(start) - 2):
        others = np.arange(side + 2, len(start) - (side == 0))
        a, b, c, d = start[side], end[side], start[others], end[others]
        # Two segments meet unless one lies strictly on one side of the line of the other, or their bounding boxes are
        # apart. The boxes decide for segments on one line, where all turns are zero. A touch counts as a meeting; no
        # division is needed, and parallel sides are no special case.
        apart = (_turn(a, b, c) * _turn(a, b, d) > 0) | (_turn(c, d, a) * _turn(c, d, b) > 0)
        for p, q, r, s in ((a.real, b.real, c.real, d.real), (a.imag, b.imag, c.imag, d.imag)):
            apart |= (np.maximum(p, q) < np.minimum(r, s)) | (np.maximum(r, s) < np.minimum(p, q))
        yield from ((side, other, ~free) for other, free in zip(others.tolist(), apart, strict=True) if not free.all())


def _turn(a: Any, b: Any, c: Any) -> Any:
    """On which side of the line from a to b a point c is: positive on its left."""
    return ((b - a).conjugate() * (c - a)).imag
