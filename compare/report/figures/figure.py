"""A figure as plain data, in plotly's names: `plots.js` draws it in a page, plotly itself in a notebook.

Fewer points of a curve are drawn without losing an extreme: of each stretch the first, last, least and largest (M4).
After Jugel et al. (2014), doi:10.14778/2732951.2732953.
"""

from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from functools import partialmethod
from itertools import accumulate, product
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import DTypeLike, NDArray

from scenes.model.motion import Samples

from ..plain import plain

Attributes: TypeAlias = Mapping[str, Any]  # as plotly names them

MAX_POINTS = 2000  # of a curve
MAX_POINTS_OF_PAGE = 80_000  # of all curves; a point is 6 to 11 bytes of the page
POINTS_OF_STRETCH = 8  # ends, least, largest and gap of both coordinates; mostly four, where one of them only grows
HEADING = {"font": {"size": 16}, "xanchor": "center", "yanchor": "bottom", "xref": "paper", "yref": "paper"}


class Figure:
    """Panels with traces in them, counted from 1, row by row; see `stacked`, `side_by_side` and `grid`."""

    def __init__(self, heights: Sequence[float], columns: int, titles: Sequence[str], gaps: Sequence[float]) -> None:
        """Begin with empty panels: relative heights of rows, titles of the first panels, gaps of columns and rows."""
        self.traces: list[dict[str, Any]] = []
        self.layout: dict[str, Any] = {}
        wide, high = _shares([1.0] * columns, gaps[0]), _shares(heights[::-1], gaps[1])[::-1]  # from below
        self._panels = range(1, len(heights) * columns + 1)
        self.left = self._panels[::columns]  # those of the first column
        for number, (down, across) in zip(self._panels, product(high, wide), strict=True):
            self.layout[f"xaxis{_name(number)}"] = {"anchor": f"y{_name(number)}", "domain": across}
            self.layout[f"yaxis{_name(number)}"] = {"anchor": f"x{_name(number)}", "domain": down}
            if number <= len(titles):
                self.note(titles[number - 1], x=sum(across) / 2, y=down[1], **HEADING)

    def add(self, trace: Attributes, panel: int) -> None:
        """Add a trace to a panel."""
        self.traces.append({"type": "scatter", "xaxis": f"x{_name(panel)}", "yaxis": f"y{_name(panel)}"} | dict(trace))

    def note(self, text: str, **place: Any) -> None:
        """Write a text without an arrow."""
        self.layout.setdefault("annotations", []).append({"text": text, "showarrow": False} | place)

    def _update(
        self, letter: str, *more: Attributes, panel: int | Iterable[int] | None = None, **attributes: Any
    ) -> Self:
        """Set attributes of an axis of a panel, of some panels, or of all of them."""
        for number in self._panels if panel is None else [panel] if isinstance(panel, int) else panel:
            _merge(self.layout[f"{letter}axis{_name(number)}"], *more, attributes)
        return self

    update_xaxes, update_yaxes = partialmethod(_update, "x"), partialmethod(_update, "y")

    def update_layout(self, *more: Attributes, **attributes: Any) -> Self:
        """Set attributes of the layout."""
        _merge(self.layout, *more, attributes)
        return self

    def shown(self, most: int = MAX_POINTS) -> Any:
        """What the script of a page draws, in JSON's types, with at most so many points a curve."""
        traces = [
            {name: _packed(values) for name, values in each.items()} for each in thinned(self.traces, most, np.float32)
        ]
        return plain({"data": traces, "layout": self.layout})


def stacked(*heights: float) -> Figure:
    """Empty panels one above the other over one axis, by their relative heights; a single one by default."""
    figure, last = Figure(heights or [1.0], 1, (), (0.0, 0.06)), len(heights) or 1
    figure.update_xaxes(matches=f"x{last}", showticklabels=False, panel=range(1, last))
    return figure


def side_by_side(titles: Sequence[str]) -> Figure:
    """An empty panel a title, all in one row with one vertical axis."""
    figure = Figure([1.0], len(titles), titles, (0.03, 0.0))
    figure.update_yaxes(matches="y", showticklabels=False, panel=range(2, len(titles) + 1))
    return figure


def grid(titles: Sequence[str], columns: int) -> Figure:
    """An empty panel a title, row by row, each with axes of its own."""
    rows = max(-(-len(titles) // columns), 1)
    return Figure([1.0] * rows, columns, titles, (0.18 / columns, 0.3 / rows))


def draw(
    figure: Figure, name: str, x: Any, y: Any, panel: int = 1, *, group: str = "", mode: str = "lines", **style: Any
) -> None:
    """Add a curve or markers to one panel of a figure.

    A trace without a name is background, with no entry in the legend and no hover. Traces of a group, which is the name
    where it is empty, share the entry of the first named one. Mode and style are attributes of plotly's scatter trace.
    """
    group = group or name
    listed = bool(name) and not any(t.get("showlegend") and t["legendgroup"] == group for t in figure.traces)
    hover = {} if name else {"hoverinfo": "skip"}
    trace = {"x": x, "y": y, "name": name, "mode": mode, "legendgroup": group, "showlegend": listed}
    figure.add(trace | hover | style, panel)


def _name(number: int) -> str:
    return str(number) if number > 1 else ""


def _shares(parts: Sequence[float], gap: float) -> list[tuple[float, float]]:
    """Where each part of a line of length 1 begins and ends, with gaps between them."""
    scale = (1 - gap * (len(parts) - 1)) / sum(parts)
    ends = [scale * end + gap * number for number, end in enumerate(accumulate(parts))]
    return [(end - scale * part, end) for part, end in zip(parts, ends, strict=True)]


def _merge(target: dict[str, Any], *more: Attributes) -> None:
    """Set attributes, of parts attribute by attribute; of a title its text alone may be given."""
    for name, value in (item for attributes in more for item in attributes.items()):
        if isinstance(value, Mapping):
            _merge(target.setdefault(name, {}), value)
        else:
            target[name] = {"text": value} if name == "title" else value


def extremes(x: Samples, y: Samples, most: int = MAX_POINTS) -> NDArray[np.intp]:
    """The rows of a curve to draw, in order: all, or `most` at most with every stretch's extremes and a gap (NaN)."""
    n, stretches = len(x), max(most // POINTS_OF_STRETCH, 1)
    if n <= most:
        return np.arange(n)
    # Shape (stretches, rows in each); the last stretch is filled up with the last row. M4 keeps of each the first and
    # last row and the rows of the least and the largest value: at one stretch a pixel column, the line drawn is the
    # same to the pixel as that through all rows. Extremes along x matter too, for curves that turn back. Without a gap
    # `argmax` gives the first row, which is kept anyway.
    rows = np.minimum(np.arange(stretches * -(-n // stretches)), n - 1).reshape(stretches, -1)
    kept = [rows[:, 0], rows[:, -1]]
    for values in (np.asarray(x, float)[rows], np.asarray(y, float)[rows]):
        gap = np.isnan(values)
        least, largest = np.where(gap, np.inf, values).argmin(axis=1), np.where(gap, -np.inf, values).argmax(axis=1)
        kept += [
            np.take_along_axis(rows, column[:, np.newaxis], 1)[:, 0] for column in (least, largest, gap.argmax(axis=1))
        ]
    return np.array(sorted({*np.concatenate(kept).tolist()}))


def affordable(figures: Iterable[Iterable[Attributes]]) -> int:
    """How many points a curve may have, so that all curves of some figures fit on a page."""
    lengths = [len(trace["x"]) for traces in figures for trace in traces if _is_curve(trace)]
    most = MAX_POINTS
    while sum(min(length, most) for length in lengths) > MAX_POINTS_OF_PAGE:
        most = most * 3 // 4
    return most


def thinned(
    traces: Iterable[Attributes], most: int = MAX_POINTS, precision: DTypeLike = np.float64
) -> list[Attributes]:
    """Traces with at most so many points a curve, and those in some precision; curves of a stack have the same rows."""
    shown = [*traces]
    stack = [np.asarray(trace["y"]) for trace in shown if "stackgroup" in trace]
    for number, trace in enumerate(shown):
        if _is_curve(trace):
            x, y = np.asarray(trace["x"]), np.asarray(trace["y"])
            together = stack if "stackgroup" in trace else [y]
            each = [extremes(x, other, most // len(together)).tolist() for other in together]
            rows = np.array(sorted({row for rows in each for row in rows}))
            kept = (values[rows].astype(precision if values.dtype == np.float64 else values.dtype) for values in (x, y))
            shown[number] = {**trace, **dict(zip("xy", kept, strict=True))}
    return shown


def _is_curve(trace: Attributes) -> bool:
    """Whether a trace is a curve or a cloud of unnamed points."""
    return trace["type"] == "scatter" and "text" not in trace and len(trace["x"]) > 0


def _packed(value: Any) -> Any:
    """A value of a trace as a script takes it, an array of floats by its bytes."""
    if not (isinstance(value, np.ndarray) and value.dtype.kind == "f"):
        return value
    return {"dtype": value.dtype.str[1:], "bdata": b64encode(value.tobytes()).decode()}
