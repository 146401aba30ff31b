"""Figures in words, for those who do not see them: of every panel its extremes and where they are."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..numbers import short
from .figure import Attributes, Figure
from .style import FLOOR, ROUND_OFF


def described(title: str, figure: Figure) -> str:
    """What curves over a common axis show: the least and the largest value by panel."""
    panels: dict[str, list[Attributes]] = {}
    for trace in figure.traces:
        if trace["name"] and trace["name"] not in (FLOOR, ROUND_OFF) and len(trace["x"]):
            panels.setdefault(trace["yaxis"], []).append(trace)
    axes = {name: part["title"]["text"] for name, part in figure.layout.items() if "axis" in name and "title" in part}
    over = [title for name, title in axes.items() if name.startswith("x")]
    notes = [note["text"] for note in figure.layout.get("annotations", ())]
    names = notes or [axes[f"yaxis{panel.removeprefix('y')}"] for panel in panels]
    sentences = [f"{title}, over {over[-1]}"] if over else [title]
    for name, traces in zip(names, panels.values(), strict=False):
        lines = [trace for trace in traces if trace["mode"] == "lines"]  # markers lie on them
        sentences.append(f"{name}: {_extremes(lines or traces)}")
    return ". ".join(sentences) + "."


def _extremes(traces: Sequence[Attributes]) -> str:
    """The least and the largest value of some curves, each with its place and the name of its curve."""
    traces = [trace for trace in traces if np.isfinite(np.asarray(trace["y"], float)).any()]
    if not traces:
        return "no values"
    values = [np.asarray(trace["y"], float) for trace in traces]

    def at(pick: Any, most: Any, none: float) -> str:
        rows = [pick(np.where(np.isnan(y), none, y)) for y in values]
        number = int(most([y[row] for y, row in zip(values, rows, strict=True)]))
        trace, row = traces[number], rows[number]
        return f"{short(float(values[number][row]))} ({trace['name']}) at {short(float(trace['x'][row]))}"

    return f"from {at(np.argmin, np.nanargmin, np.inf)} to {at(np.argmax, np.nanargmax, -np.inf)}"
