"""The look of every figure: colours, symbols, lines, log axes, margins."""

from collections.abc import Collection
from typing import Any

import numpy as np

from scenes import Scene
from scenes.scene import ConstantSpeed

from ...mechanics.axis import axis, turns_fully
from .figure import Figure

# Of Okabe and Ito, for any colour vision; their yellow and black, unseen on one of the grounds, are purple and brown.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#9467bd", "#8c564b")
SCALE = ("#440154", "#3b528b", "#21918c", "#5ec962", "#fde725")  # Viridis
GREY, DARK_GREY = "#999999", "#555555"  # of bounds and failures; of the reference's curves
SYMBOLS = ("circle-open", "diamond-open", "square-open", "cross-open")
DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
BOUND = {"color": GREY, "dash": "dot"}  # line of the reference's floor, of round-off, of a limit
FLOOR, ROUND_OFF = "reference's floor", "explained by round-off"  # names of such lines
BEFORE = "before"  # the name of an earlier run
LOG = {"type": "log", "exponentformat": "power"}
MARGIN = {"l": 70, "r": 20, "t": 40, "b": 55}  # px
LEGEND = {"orientation": "h", "yanchor": "bottom", "y": 1.02, "x": 0}  # above the panels
LEGEND_BESIDE = {"orientation": "v", "yanchor": "top", "y": 1, "x": 1.02}
LAYOUT: dict[str, Any] = {"margin": MARGIN, "legend": LEGEND, "hoverlabel": {"namelength": -1}}


def colour(number: int) -> str:
    """The colour of a series, such as an engine, by its number from 0."""
    return COLOURS[number % len(COLOURS)]


def graded(share: float) -> str:
    """The colour at a share, from 0 to 1, of a scale."""
    channels = np.array([[int(stop[k : k + 2], 16) for k in (1, 3, 5)] for stop in SCALE]).T
    mixed = (np.interp(share, np.linspace(0, 1, len(SCALE)), channel) for channel in channels)
    return "#" + "".join(f"{round(value):02x}" for value in mixed)


def categories(labels: Collection[object]) -> dict[str, Any]:
    """The attributes of an axis with a place for each label, from 0."""
    return {"tickvals": [*range(len(labels))], "ticktext": [*map(str, labels)], "range": [-0.5, len(labels) - 0.5]}


def marker(number: int, symbol: str = "", size: int = 8) -> dict[str, Any]:
    """The marker of a series by its number from 0; `symbol` replaces the series' own, `size` is in px."""
    edge = {"width": 2, "color": colour(number)}
    return {"color": colour(number), "symbol": symbol or SYMBOLS[number % len(SYMBOLS)], "size": size, "line": edge}


def error_axes(figure: Figure, across: str, error: str = "relative error [-]") -> Figure:
    """Make all axes of a figure logarithmic: `across` titles the horizontal ones, `error` the first vertical one."""
    figure.update_xaxes(LOG, title=across, nticks=6)
    figure.update_yaxes(LOG, nticks=8).update_yaxes(title=error, panel=figure.left)
    return figure


def drive_axes(figure: Figure, scene: Scene, turns: int = 1, titled: int | None = None) -> None:
    """Let time run from left to right over the drive's position; only the panel `titled` gets the title, or all."""
    backwards = any(isinstance(drive.law, ConstantSpeed) and drive.law.speed < 0 for drive in scene.drives)
    ticks = {"dtick": 60 * turns} if turns_fully(scene) else {}  # degrees
    figure.update_xaxes(title=axis(scene).title, panel=titled)
    figure.update_layout(dragmode=False, hovermode=False)  # the page's cursor follows the pointer instead
    figure.update_xaxes(**ticks, autorange="reversed" if backwards else True)


def layout(height: int, *, titled: bool = False) -> dict[str, Any]:
    """The layout of a figure of `height` px; where its panels are titled, with a place for their titles."""
    return LAYOUT | {"height": height, "margin": MARGIN | {"t": 80 if titled else MARGIN["t"]}}
