"""A figure while it is drawn: plain data that plotly checks once, at the end; one by one takes three times as long."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from functools import cache
from typing import Any, Self, TypeAlias

import plotly.graph_objects as go
from plotly.io import templates
from plotly.subplots import make_subplots

templates.default = "plotly_white"  # once for all: a template in each layout costs a third of the report's time

Attributes: TypeAlias = Mapping[str, Any]  # as plotly names them


class Draft:
    """Panels in rows and columns, counted from 1, with traces in them."""

    def __init__(self, rows: int, columns: int, titles: Sequence[str] = (), **arrangement: Any) -> None:
        """Begin with empty panels, titled row by row; the arrangement is that of plotly's `make_subplots`."""
        layout, self._numbers = _panels(rows, columns, tuple(titles), tuple(arrangement.items()))
        self._layout = deepcopy(layout)
        self.traces: list[dict[str, Any]] = []

    def add(self, trace: Attributes, row: int, column: int) -> None:
        """Add a trace to a panel."""
        number = self._numbers[row, column]
        self.traces.append({"type": "scatter", "xaxis": f"x{number}", "yaxis": f"y{number}"} | dict(trace))

    def lists(self, group: str) -> bool:
        """Return whether the legend has an entry of a group."""
        return any(trace["showlegend"] and trace["legendgroup"] == group for trace in self.traces)

    def note(self, text: str, **place: Any) -> None:
        """Write a text without an arrow."""
        self._layout.setdefault("annotations", []).append({"text": text, "showarrow": False} | place)

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
                    _merge(self._layout[f"{letter}axis{number}"], attributes)
        return self

    def update_layout(self, *more: Attributes, **own: Any) -> Self:
        """Set attributes of the layout."""
        for attributes in (*more, own):
            _merge(self._layout, attributes)
        return self

    def finished(self, layout: Attributes) -> go.Figure:
        """Return the figure with a layout, checked by plotly."""
        return go.Figure({"data": self.traces, "layout": self.update_layout(layout)._layout})


@cache
def _panels(
    rows: int, columns: int, titles: tuple[str, ...], arrangement: tuple[tuple[str, Any], ...]
) -> tuple[dict[str, Any], dict[tuple[int, int], str]]:
    """Return the layout of empty panels, and the number of the axes of each."""
    figure = make_subplots(rows, columns, subplot_titles=titles or None, **dict(arrangement))
    places = [(row, column) for row in range(1, rows + 1) for column in range(1, columns + 1)]
    numbers = {place: figure.get_subplot(*place).xaxis.plotly_name.removeprefix("xaxis") for place in places}
    return figure.layout.to_plotly_json(), numbers


def _merge(into: dict[str, Any], attributes: Attributes) -> None:
    """Set attributes, of parts attribute by attribute."""
    for name, value in attributes.items():
        if isinstance(value, Mapping) and isinstance(into.get(name), dict):
            _merge(into[name], value)
        else:
            into[name] = dict(value) if isinstance(value, Mapping) else value
