"""A figure as plain data, in plotly's names: its script draws it in the page, its library takes long to import here."""

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from importlib.resources import files
from itertools import accumulate, product
from math import isfinite
from typing import TYPE_CHECKING, Any, Self, TypeAlias

import numpy as np

from .extremes import CURVE, thinned

if TYPE_CHECKING:
    from plotly.graph_objects import Figure as Checked

Attributes: TypeAlias = Mapping[str, Any]  # as plotly names them

TEMPLATE = "plotly_white"
TYPES = {"f4", "f8", "i1", "i2", "i4", "u1", "u2", "u4"}  # of arrays that plotly's script takes as bytes
# Every button by name, so that none comes in with another version of plotly; nothing in a figure leads to another host.
BUTTONS = [["toImage"], ["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "autoScale2d", "resetScale2d"]]
CONFIG = {"modeBarButtons": BUTTONS, "displaylogo": False, "showSendToCloud": False, "plotlyServerURL": ""}
HEADING = {"font": {"size": 16}, "xanchor": "center", "yanchor": "bottom", "xref": "paper", "yref": "paper"}


class Figure:
    """Panels in rows and columns, counted from 1, with traces in them."""

    def __init__(
        self,
        heights: Sequence[float],
        columns: int = 1,
        titles: Sequence[str] = (),
        gaps: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Begin with empty panels.

        Args:
            heights: of the rows, one to another.
            columns: how many, all of one width.
            titles: of the panels, row by row.
            gaps: between columns and between rows, of the whole.
        """
        self.traces: list[dict[str, Any]] = []
        self.layout: dict[str, Any] = {}
        places = product(range(1, len(heights) + 1), range(1, columns + 1))
        self._numbers = {place: str(number) if number > 1 else "" for number, place in enumerate(places, start=1)}
        wide, high = _shares([1.0] * columns, gaps[0]), _shares(heights[::-1], gaps[1])[::-1]  # from below
        for (row, column), number in self._numbers.items():
            self.layout[f"xaxis{number}"] = {"anchor": f"y{number}", "domain": wide[column - 1]}
            self.layout[f"yaxis{number}"] = {"anchor": f"x{number}", "domain": high[row - 1]}
        for title, (row, column) in zip(titles, self._numbers, strict=False):
            self.note(title, x=sum(wide[column - 1]) / 2, y=high[row - 1][1], **HEADING)

    def add(self, trace: Attributes, row: int, column: int) -> None:
        """Add a trace to a panel."""
        number = self._numbers[row, column]
        self.traces.append({"type": "scatter", "xaxis": f"x{number}", "yaxis": f"y{number}"} | dict(trace))

    def lists(self, group: str) -> bool:
        """Return whether the legend has an entry of a group."""
        return any(trace["showlegend"] and trace["legendgroup"] == group for trace in self.traces)

    def note(self, text: str, **place: Any) -> None:
        """Write a text without an arrow."""
        self.layout.setdefault("annotations", []).append({"text": text, "showarrow": False} | place)

    def update_xaxes(self, *more: Attributes, row: int | None = None, col: int | None = None, **own: Any) -> Self:
        """Set attributes of the horizontal axes: of all panels, or of those in a row or column."""
        return self._update("x", (*more, own), row, col)

    def update_yaxes(self, *more: Attributes, row: int | None = None, col: int | None = None, **own: Any) -> Self:
        """Set attributes of the vertical axes: of all panels, or of those in a row or column."""
        return self._update("y", (*more, own), row, col)

    def _update(self, letter: str, more: Sequence[Attributes], row: int | None, col: int | None) -> Self:
        for place, number in self._numbers.items():
            if row in (None, place[0]) and col in (None, place[1]):
                for attributes in more:
                    _merge(self.layout[f"{letter}axis{number}"], attributes)
        return self

    def update_layout(self, *more: Attributes, **own: Any) -> Self:
        """Set attributes of the layout."""
        for attributes in (*more, own):
            _merge(self.layout, attributes)
        return self

    def json(self, most: int = CURVE) -> str:
        """Return what plotly's script draws in the look of `template`, with at most so many points a curve."""
        return json.dumps(_plain({"data": thinned(self.traces, most), "layout": self.layout}))

    def checked(self) -> "Checked":
        """Return plotly's own figure, with the buttons of the pages.

        Raises:
            ValueError: an attribute is none of plotly's, or has a value that it does not take.
        """
        from .offline import Offline

        return Offline({"data": self.traces, "layout": self.layout | {"template": TEMPLATE}})


def _shares(parts: Sequence[float], gap: float) -> list[tuple[float, float]]:
    """Return where each part of a line of length 1 begins and ends, with gaps between them."""
    scale = (1 - gap * (len(parts) - 1)) / sum(parts)
    ends = [scale * end + gap * number for number, end in enumerate(accumulate(parts))]
    return [(end - scale * part, end) for part, end in zip(parts, ends, strict=True)]


def _merge(into: dict[str, Any], attributes: Attributes) -> None:
    """Set attributes, of parts attribute by attribute; of a title its text alone may be given."""
    for name, value in attributes.items():
        if isinstance(value, Mapping):
            _merge(into.setdefault(name, {}), value)
        elif name == "title":
            into[name] = {"text": value}
        else:
            into[name] = value


def template() -> str:
    """Return the look of figures by plotly, as JSON, without the library."""
    return (files("plotly") / f"package_data/templates/{TEMPLATE}.json").read_text(encoding="utf-8")


def _plain(value: Any) -> Any:
    """Return a value as JSON has it: arrays as plotly's script takes them, null for what is not finite."""
    if isinstance(value, Mapping):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, np.ndarray) or hasattr(value, "to_numpy"):  # or a column of a data frame
        array = np.ascontiguousarray(value)
        if array.dtype.str[1:] not in TYPES:
            return _plain(array.tolist())
        packed = {"dtype": array.dtype.str[1:], "bdata": b64encode(array.data).decode()}
        return packed | ({"shape": ", ".join(map(str, array.shape))} if array.ndim > 1 else {})
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value
