"""The look of every figure: colours, symbols, lines, entries of the legend, log axes, arrangements of panels."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenes import Scene
from scenes.scene import ConstantSpeed

from ..engines.axis import axis, turns_fully
from .extremes import CURVE, extremes
from .figure import Figure

# Of Okabe and Ito, for any colour vision; their yellow and black, unseen on one of the grounds, are purple and brown.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#9467bd", "#8c564b")
GREY, DARK_GREY = "#999999", "#555555"  # of bounds and failures; of the reference's curves
SYMBOLS = ("circle-open", "diamond-open", "square-open", "cross-open")
DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
BOUND = {"color": GREY, "dash": "dot"}  # line of the reference's floor, of round-off, of a limit
FLOOR, ROUND_OFF = "reference's floor", "explained by round-off"  # names of such lines
LOG = {"type": "log", "exponentformat": "power"}
MARGIN = {"l": 70, "r": 20, "t": 40, "b": 55}  # px
LEGEND = {"orientation": "h", "yanchor": "bottom", "y": 1.02, "x": 0}  # above the panels
LEGEND_BESIDE = {"orientation": "v", "yanchor": "top", "y": 1, "x": 1.02}
LAYOUT: dict[str, Any] = {"margin": MARGIN, "legend": LEGEND, "hoverlabel": {"namelength": -1}}


def colour(number: int) -> str:
    """Return the colour of a series, such as an engine, by its number from 0."""
    return COLOURS[number % len(COLOURS)]


def marker(number: int, symbol: str = "", size: int = 8) -> dict[str, Any]:
    """Return the marker of a series by its number from 0; `symbol` replaces the series' own, `size` is in px."""
    edge = {"width": 2, "color": colour(number)}
    return {"color": colour(number), "symbol": symbol or SYMBOLS[number % len(SYMBOLS)], "size": size, "line": edge}


def draw(
    figure: Figure,
    name: str,
    x: Any,
    y: Any,
    row: int = 1,
    column: int = 1,
    *,
    group: str = "",
    mode: str = "lines",
    **style: Any,
) -> None:
    """Add a trace to one panel of a figure.

    Args:
        figure: of `stacked`, `side_by_side` or `grid`.
        name: of the trace; one without a name is background, with no entry in the legend and no hover.
        x: values, shape (n,); of a long curve its extremes are drawn.
        y: values, shape (n,).
        row: of the panel, from 1.
        column: of the panel, from 1.
        group: of traces that share an entry of the legend, that of the first named one; the name if empty.
        mode: lines, markers or both, as plotly names them.
        style: further attributes of plotly's scatter trace.
    """
    group = group or name
    listed = bool(name) and not figure.lists(group)
    style = ({} if name else {"hoverinfo": "skip"}) | style
    if len(x) > CURVE and "text" not in style:
        rows = extremes(x, y)
        x, y = np.asarray(x)[rows], np.asarray(y)[rows]
    trace = {"x": x, "y": y, "name": name, "mode": mode, "legendgroup": group, "showlegend": listed}
    figure.add(trace | style, row, column)


def stacked(*heights: float) -> Figure:
    """Return empty panels one above the other over one axis, by their relative heights; a single one by default."""
    figure, last = Figure(heights or [1.0], gaps=(0.0, 0.06)), len(heights) or 1
    for row in range(1, last):
        figure.update_xaxes(matches=f"x{last}", showticklabels=False, row=row)
    return figure


def side_by_side(titles: Sequence[str]) -> Figure:
    """Return an empty panel per title, all in one row with one vertical axis."""
    figure = Figure([1.0], len(titles), titles, gaps=(0.03, 0.0))
    for column in range(2, len(titles) + 1):
        figure.update_yaxes(matches="y", showticklabels=False, col=column)
    return figure


def grid(titles: Sequence[str], columns: int) -> Figure:
    """Return an empty panel per title, row by row, each with axes of its own; see `cell`."""
    rows = max(-(-len(titles) // columns), 1)
    return Figure([1.0] * rows, columns, titles, gaps=(0.18 / columns, 0.3 / rows))


def cell(number: int, columns: int) -> tuple[int, int]:
    """Return row and column, from 1, of a panel of a grid by its number from 0."""
    row, column = divmod(number, columns)
    return row + 1, column + 1


def error_axes(figure: Figure, across: str, error: str = "relative error [-]") -> Figure:
    """Make all axes of a figure logarithmic: `across` titles the horizontal ones, `error` the first vertical one."""
    figure.update_xaxes(LOG, title=across, nticks=6)
    return figure.update_yaxes(LOG, nticks=8).update_yaxes(title=error, col=1)


def drive_axes(figure: Figure, scene: Scene, turns: int = 1, row: int | None = None) -> Figure:
    """Let time run from left to right over the drive's position; of stacked panels, only `row` gets the title."""
    backwards = isinstance(scene.drive, ConstantSpeed) and scene.drive.speed < 0
    ticks = {"dtick": 60 * turns} if turns_fully(scene) else {}  # degrees
    figure.update_xaxes(title=axis(scene).title, row=row)
    figure.update_layout(dragmode=False, hovermode=False)  # the page's cursor follows the pointer instead
    return figure.update_xaxes(**ticks, autorange="reversed" if backwards else True)


def layout(height: int, *, titled: bool = False) -> dict[str, Any]:
    """Return the layout of a figure of `height` px; where its panels are titled, with the legend above their titles."""
    if not titled:
        return LAYOUT | {"height": height}
    plotted = height - 80 - MARGIN["b"]
    return LAYOUT | {"height": height, "margin": MARGIN | {"t": 80}, "legend": LEGEND | {"y": 1 + 38 / plotted}}
