"""Fewer points of a curve, without losing an extreme: of each stretch the first, last, least and largest (M4).

After Jugel et al. (2014), doi:10.14778/2732951.2732953.
"""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import plotly.graph_objects as go
from numpy.typing import NDArray

from scenes.motion import Samples

CURVE = 2000  # points at most
PAGE = 80_000  # of all curves; a point is 6 to 11 bytes of the page
OF_A_STRETCH = 8  # ends, least, largest and gap of both coordinates; mostly four, where one of them only grows


def extremes(x: Samples, y: Samples, most: int = CURVE) -> NDArray[np.intp]:
    """Return the rows of a curve to draw, in order: all, or `most` at most with every stretch's extremes and a gap.

    Args:
        x: shape (n,); NaN is a gap.
        y: shape (n,).
        most: points.
    """
    n, stretches = len(x), max(most // OF_A_STRETCH, 1)
    if n <= most:
        return np.arange(n)
    rows = np.minimum(np.arange(stretches * -(-n // stretches)), n - 1).reshape(stretches, -1)
    kept = [rows[:, 0], rows[:, -1]]
    for values in (np.asarray(x, float)[rows], np.asarray(y, float)[rows]):
        gap = np.isnan(values)
        least, largest = np.where(gap, np.inf, values).argmin(axis=1), np.where(gap, -np.inf, values).argmax(axis=1)
        kept += [np.take_along_axis(rows, at[:, np.newaxis], 1)[:, 0] for at in (least, largest, gap.argmax(axis=1))]
    return np.unique(kept)


def affordable(figures: Iterable[go.Figure]) -> int:
    """Return how many points a curve may have, so that all curves of some figures fit on a page."""
    lengths = [len(trace.x) for figure in figures for trace in _curves(figure)]
    most = CURVE
    while sum(min(length, most) for length in lengths) > PAGE:
        most = most * 3 // 4
    return most


def thinned(figure: go.Figure, most: int) -> go.Figure:
    """Return the figure with at most so many points a curve, in single precision."""
    for trace in _curves(figure):
        x, y = (np.asarray(values) for values in (trace.x, trace.y))
        rows = extremes(x, y, most)
        trace.update({"x": _single(x[rows]), "y": _single(y[rows])})
    return figure


def _curves(figure: go.Figure) -> Iterator[Any]:
    """Yield the traces that are curves or clouds of unnamed points."""
    yield from (trace for trace in figure.data if trace.type == "scatter" and trace.text is None and len(trace.x))


def _single(values: NDArray[Any]) -> NDArray[Any]:
    return values.astype(np.float32) if values.dtype == np.float64 else values
