"""Fewer points of a curve, without losing an extreme: of each stretch the first, last, least and largest (M4).

After Jugel et al. (2014), doi:10.14778/2732951.2732953.
"""

from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes.model.motion import Samples

Trace: TypeAlias = Mapping[str, Any]  # as plotly names its parts

CURVE = 2000  # points at most
PAGE = 80_000  # of all curves; a point is 6 to 11 bytes of the page
OF_A_STRETCH = 8  # ends, least, largest and gap of both coordinates; mostly four, where one of them only grows


def extremes(x: Samples, y: Samples, most: int = CURVE) -> NDArray[np.intp]:
    """The rows of a curve to draw, in order: all, or `most` at most with every stretch's extremes and a gap (NaN)."""
    n, stretches = len(x), max(most // OF_A_STRETCH, 1)
    if n <= most:
        return np.arange(n)
    rows = np.minimum(np.arange(stretches * -(-n // stretches)), n - 1).reshape(stretches, -1)
    kept = [rows[:, 0], rows[:, -1]]
    for values in (np.asarray(x, float)[rows], np.asarray(y, float)[rows]):
        gap = np.isnan(values)
        least, largest = np.where(gap, np.inf, values).argmin(axis=1), np.where(gap, -np.inf, values).argmax(axis=1)
        kept += [np.take_along_axis(rows, at[:, np.newaxis], 1)[:, 0] for at in (least, largest, gap.argmax(axis=1))]
    return np.array(sorted({*np.concatenate(kept).tolist()}))


def affordable(figures: Iterable[Iterable[Trace]]) -> int:
    """How many points a curve may have, so that all curves of some figures fit on a page."""
    lengths = [len(trace["x"]) for traces in figures for trace in traces if _is_curve(trace)]
    most = CURVE
    while sum(min(length, most) for length in lengths) > PAGE:
        most = most * 3 // 4
    return most


def thinned(traces: Iterable[Trace], most: int = CURVE, precision: type[np.floating[Any]] = np.float64) -> list[Trace]:
    """Traces with at most so many points a curve, and those in some precision."""
    shown = [*traces]
    for number, trace in enumerate(shown):
        if _is_curve(trace):
            x, y = np.asarray(trace["x"]), np.asarray(trace["y"])
            rows = extremes(x, y, most)
            kept = (of[rows].astype(precision if of.dtype == np.float64 else of.dtype) for of in (x, y))
            shown[number] = {**trace, **dict(zip("xy", kept, strict=True))}
    return shown


def _is_curve(trace: Trace) -> bool:
    """Whether a trace is a curve or a cloud of unnamed points."""
    return trace["type"] == "scatter" and "text" not in trace and len(trace["x"]) > 0
