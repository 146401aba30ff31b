"""The work-precision picture: time against error, setting by setting, and the Pareto front."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go

from scenes import Status
from scenes.motion import Samples

from ...engines.axis import cycle_name
from ...engines.registry import REFERENCE
from ...judge.errors import group_floors
from ...speed.work_precision import contenders, families, front, groups, solved
from ...study import Study
from ..style import BOUND, FLOOR, GREY, cell, colour, draw, error_axes, grid, layout, marker
from .tables import contender

COLUMNS = 3
NOTED = ("x-thin", "asterisk", "cross-thin", "y-up")  # symbols of settings with a note


def work_precision(study: Study) -> go.Figure:
    """Draw every setting's time a cycle against its error, log-log, by channel group; buttons switch to the RMS."""
    found = groups(study.speed)
    figure, rms = _panels(study, found, "max"), _panels(study, found, "rms")
    error_axes(figure, f"ms a {cycle_name(study.scene)}").update_xaxes(dtick=1).update_yaxes(dtick=2)
    figure.update_layout(layout(150 + 390 * -(-len(found) // COLUMNS), titled=True), margin_t=110)
    return figure.update_layout(updatemenus=[_buttons({"largest": figure, "RMS": rms})])


def _panels(study: Study, found: Sequence[str], kind: str) -> go.Figure:
    """Draw the floor, the Pareto fronts, the families' lines and the settings of every group, from back to front."""
    figure = grid(found, min(COLUMNS, len(found)) or 1)
    points = solved(study.speed)
    engines = {m.run.engine: number for number, m in enumerate(study.measurements)}
    notes = list(dict.fromkeys(note for _, note, _ in contenders(points) if note))
    for panel, group in enumerate(found):
        error, where = f"{group}_{kind}", cell(panel, COLUMNS)
        floor, times = group_floors(study.reference).get(group, np.nan), 1e3 * study.speed["solve_min_s"]
        draw(figure, FLOOR, [times.min(), times.max()], [floor] * 2, *where, line=BOUND)
        for name, rows, shade in (
            ("Pareto front", points, "#000000"),
            ("Pareto front without the reference", points[points["engine"] != REFERENCE], "#b8860b"),
        ):
            line = {"color": shade, "width": 7, "shape": "hv"}
            draw(figure, name, *_front(rows, error), *where, line=line, opacity=0.2, hoverinfo="skip")
        for engine, number in engines.items():
            lines = _lines(points[points["engine"] == engine], error)
            draw(figure, "", *lines, *where, line={"color": colour(number), "width": 0.8}, opacity=0.5)
        for engine, note, rows in contenders(points):
            symbol = NOTED[notes.index(note) % len(NOTED)] if note else ""
            mark = marker(engines[engine], symbol, 9)
            draw(figure, contender(engine, note), *_at(rows, error), *where, marker=mark, **_hover(study, rows))
        failed = study.speed[(study.speed["status"] != Status.ok.name) & study.speed[error].notna()]
        if len(failed):
            mark = {"color": GREY, "symbol": "x", "size": 8}
            draw(figure, "failed", *_at(failed, error), *where, marker=mark, **_hover(study, failed))
    return figure


def _buttons(figures: Mapping[str, go.Figure]) -> dict[str, object]:
    """Return the buttons that put the numbers of other figures into the same traces."""
    choices = []
    for kind, figure in figures.items():
        numbers = {axis: [list(trace[axis]) for trace in figure.data] for axis in ("x", "y")}
        choices.append({"label": f"{kind} error", "method": "restyle", "args": [numbers]})
    return {"type": "buttons", "direction": "right", "buttons": choices, "x": 1, "xanchor": "right", "y": 1.01} | {
        "yanchor": "bottom",
        "pad": {"b": 25},
    }


def _at(rows: pd.DataFrame, error: str) -> tuple["pd.Series[float]", "pd.Series[float]"]:
    return 1e3 * rows["solve_min_s"], rows[error]


def _front(points: pd.DataFrame, error: str) -> tuple[Samples, Samples]:
    """Return the front as steps: for every time, ms, the least error that can be had, from the first setting on."""
    best = front(points, error)
    times, errors = 1e3 * best["solve_min_s"].to_numpy(), best[error].to_numpy()
    if len(best):
        times = np.concatenate([times[:1], times, [1e3 * points["solve_min_s"].max()]])
        errors = np.concatenate([[points[error].max()], errors, errors[-1:]])
    return times, errors


def _lines(points: pd.DataFrame, error: str) -> tuple[list[float], list[float]]:
    """Return one engine's families, each as a line, with gaps between them."""
    x: list[float] = []
    y: list[float] = []
    for _, rows in families(points, "steps"):
        x += [*1e3 * rows["solve_min_s"], np.nan]
        y += [*rows[error], np.nan]
    return x, y


def _hover(study: Study, rows: pd.DataFrame) -> dict[str, Any]:
    """Return the style of a group of settings: markers, each with its setting, steps, status and note."""
    columns = (rows[column] for column in ("setting", "steps", "status", "reason", "note"))
    text = ["<br>".join(filter(None, (s, _steps(n), *rest))) for s, n, *rest in zip(*columns, strict=True)]
    template = f"%{{text}}<br>%{{x:.3g}} ms a {cycle_name(study.scene)}<br>error %{{y:.2e}}"
    return {"mode": "markers", "text": text, "hovertemplate": template}


def _steps(steps: float) -> str:
    return f"{steps:.0f} steps a cycle" if steps == steps else ""
