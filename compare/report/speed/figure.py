"""The work-precision picture: time against error, setting by setting, and the Pareto front."""

from collections.abc import Iterator
from itertools import chain
from typing import Any, TypeAlias

import numpy as np
import pandas as pd
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from scenes import Status

from ...engines.axis import cycle_name
from ...engines.registry import REFERENCE
from ...judge.errors import group_floors
from ...speed.work_precision import contender, contenders, families, front, groups, solved
from ...study import Study
from ..curves import COLOURS, LAYOUT, SYMBOLS

COLUMNS = 3
NOTED = ("x-thin", "asterisk", "cross-thin", "y-up")  # symbols of settings with a note
ERRORS = {"max": "largest", "rms": "RMS"}
GREY = "#999999"

Trace: TypeAlias = dict[str, Any]


def work_precision(study: Study) -> go.Figure:
    """Draw every setting's time a cycle against its error, log-log, by channel group; buttons switch to the RMS."""
    found = groups(study.speed)
    rows = max(-(-len(found) // COLUMNS), 1)
    figure = make_subplots(
        rows, min(COLUMNS, len(found)) or 1, subplot_titles=found, horizontal_spacing=0.06, vertical_spacing=0.3 / rows
    )
    drawn = {kind: [list(_traces(study, group, kind)) for group in found] for kind in ERRORS}
    for number, traces in enumerate(drawn["max"]):
        row, column = divmod(number, COLUMNS)
        for trace in traces:
            legend = number == 0 and "name" in trace
            figure.add_trace(trace | {"type": "scatter", "showlegend": legend}, row=row + 1, col=column + 1)
    figure.update_xaxes(title=f"ms a {cycle_name(study.scene)}", type="log", exponentformat="power", dtick=1)
    figure.update_yaxes(type="log", exponentformat="power", dtick=2)
    figure.update_yaxes(title="relative error [-]", col=1)
    return figure.update_layout(
        LAYOUT,
        margin=LAYOUT["margin"] | {"t": 110},
        legend=LAYOUT["legend"] | {"y": 1 + 45 / (390 * rows)},
        updatemenus=[_buttons({kind: list(chain.from_iterable(traces)) for kind, traces in drawn.items()})],
        height=150 + 390 * rows,
    )


def _buttons(drawn: dict[str, list[Trace]]) -> dict[str, object]:
    """Return the buttons that put other numbers into the same traces."""
    choices = []
    for kind, traces in drawn.items():
        numbers = {axis: [list(trace[axis]) for trace in traces] for axis in ("x", "y")}
        choices.append({"label": f"{ERRORS[kind]} error", "method": "restyle", "args": [numbers]})
    return {"type": "buttons", "direction": "right", "buttons": choices, "x": 1, "xanchor": "right", "y": 1.01} | {
        "yanchor": "bottom",
        "pad": {"b": 25},
    }


def _traces(study: Study, group: str, kind: str) -> Iterator[Trace]:
    """Yield the floor, the Pareto fronts, the families' lines and the settings of one group, from back to front."""
    error = f"{group}_{kind}"
    points = solved(study.speed)
    engines = {m.run.engine: number for number, m in enumerate(study.measurements)}
    yield _floor(study, group)
    yield _front(points, error, "Pareto front", "#000000")
    yield _front(points[points["engine"] != REFERENCE], error, "Pareto front without the reference", "#b8860b")
    for engine, number in engines.items():
        yield _lines(points[points["engine"] == engine], error, COLOURS[number % len(COLOURS)])
    notes = list(dict.fromkeys(points["note"][points["note"] != ""]))
    for engine, note, rows in contenders(points):
        number = engines[engine]
        symbol = NOTED[notes.index(note) % len(NOTED)] if note else SYMBOLS[number % len(SYMBOLS)]
        colour = COLOURS[number % len(COLOURS)]
        marker = {"color": colour, "symbol": symbol, "size": 9, "line": {"width": 2, "color": colour}}
        yield _settings(study, rows, error, contender(engine, note), marker)
    failed = study.speed[(study.speed["status"] != Status.ok.name) & study.speed[error].notna()]
    if len(failed):
        yield _settings(study, failed, error, "failed", {"color": GREY, "symbol": "x", "size": 8})


def _floor(study: Study, group: str) -> Trace:
    floor, times = group_floors(study.reference).get(group, np.nan), 1e3 * study.speed["solve_min_s"]
    line = {"color": GREY, "dash": "dot"}
    return {
        "x": [times.min(), times.max()],
        "y": [floor] * 2,
        "name": "reference's floor",
        "line": line,
        "mode": "lines",
    }


def _front(points: pd.DataFrame, error: str, name: str, colour: str) -> Trace:
    """Return the front as steps: for every time, the least error that can be had, from the first setting on."""
    best = front(points, error)
    times, errors = 1e3 * best["solve_min_s"].to_numpy(), best[error].to_numpy()
    if len(best):
        times = np.concatenate([times[:1], times, [1e3 * points["solve_min_s"].max()]])
        errors = np.concatenate([[points[error].max()], errors, errors[-1:]])
    line = {"color": colour, "width": 7, "shape": "hv"}
    return {"x": times, "y": errors, "name": name, "mode": "lines", "line": line} | {
        "opacity": 0.2,
        "hoverinfo": "skip",
    }


def _lines(points: pd.DataFrame, error: str, colour: str) -> Trace:
    """Return one engine's families, each as a line, with gaps between them."""
    x: list[float] = []
    y: list[float] = []
    for _, rows in families(points, "steps"):
        x += [*1e3 * rows["solve_min_s"], np.nan]
        y += [*rows[error], np.nan]
    return {"x": x, "y": y, "mode": "lines", "line": {"color": colour, "width": 0.8}} | {
        "opacity": 0.5,
        "hoverinfo": "skip",
    }


def _settings(study: Study, rows: pd.DataFrame, error: str, name: str, marker: dict[str, object]) -> Trace:
    columns = (rows[column] for column in ("setting", "steps", "status", "reason", "note"))
    said = ["<br>".join(filter(None, (s, _steps(n), *rest))) for s, n, *rest in zip(*columns, strict=True)]
    hover = f"%{{text}}<br>%{{x:.3g}} ms a {cycle_name(study.scene)}<br>error %{{y:.2e}}"
    trace = {"x": 1e3 * rows["solve_min_s"], "y": rows[error], "text": said, "name": name, "legendgroup": name}
    return trace | {"mode": "markers", "marker": marker, "hovertemplate": hover}


def _steps(steps: float) -> str:
    return f"{steps:.0f} steps a cycle" if steps == steps else ""
