"""Curves over the crank angle, and speed against error.

The reference is drawn as lines, the engines as sparse markers on them; below, each engine's error on a log axis.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import floor, log10
from typing import Any

import numpy as np
import pandas as pd
import plotly.graph_objects as go
from plotly.io import templates
from plotly.subplots import make_subplots

from scenes import Motion, Status
from scenes.motion import Samples

from .reference import Reference
from .registry import REFERENCE
from .study import Study

templates.default = "plotly_white"  # once for all: a template in each layout costs a third of the report's time

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")  # Okabe and Ito's, told apart with any colour vision
SYMBOLS = ("circle-open", "diamond-open", "square-open", "cross-open")
DASHES = ("solid", "dash", "dot")
MARKERS = 36  # a turn, shared out between the engines
LAYOUT: dict[str, Any] = {
    "margin": {"l": 70, "r": 20, "t": 40, "b": 55},
    "legend": {"orientation": "h", "yanchor": "bottom", "y": 1.02, "x": 0},
    "hoverlabel": {"namelength": -1},
}
SUBTITLED = {"margin": LAYOUT["margin"] | {"t": 80}, "legend": LAYOUT["legend"] | {"y": 1.07}}


@dataclass(frozen=True)
class Panel:
    """One figure: what is plotted, and the channels whose error, as a vector, is plotted below."""

    title: str
    axis: str
    curves: dict[str, Callable[[Motion], Samples]]
    judged: tuple[str, ...]


def panels(reference: Reference) -> Iterator[Panel]:
    """Yield the output's motion, then every joint's reaction, then the drive's torque."""
    scene = reference.scene
    slide = next((b.slide for b in scene.bodies.values() if b.slide is not None and scene.output in b.points), None)
    for title, unit, q in (("displacement", "m", ""), ("velocity", "m/s", "v"), ("acceleration", "m/s²", "a")):
        x, y = f"{scene.output}.{q}x", f"{scene.output}.{q}y"
        factor, unit = _prefixed(reference.scale[x], unit)
        curves = {"x": _channel(x, factor), "y": _channel(y, factor)}
        if slide is not None:
            tx, ty = slide.along
            curves = {"along the guide": _sum(_channel(x, tx * factor), _channel(y, ty * factor))}
        yield Panel(f"{scene.output}: {title}", f"{title} [{unit}]", curves, (x, y))
    if scene.has_masses:
        yield from _force_panels(reference)


def _force_panels(reference: Reference) -> Iterator[Panel]:
    scene = reference.scene
    for pin in scene.pins:
        x, y = f"{pin.channel}.fx", f"{pin.channel}.fy"
        factor, unit = _prefixed(reference.scale[x], "N")
        curves = {"magnitude": _magnitude(x, y, factor), "x": _channel(x, factor), "y": _channel(y, factor)}
        yield Panel(f"Pin {pin.channel}: force of {pin.first} on {pin.second}", f"force [{unit}]", curves, (x, y))
    for body in scene.bodies.values():
        if body.slide is not None:
            force, moment = f"{body.name}.guide_force", f"{body.name}.guide_moment"
            per_force, newtons = _prefixed(reference.scale[force], "N")
            per_moment, newton_metres = _prefixed(reference.scale[moment], "N m")
            curves = {"force": _channel(force, per_force), "moment": _channel(moment, per_moment)}
            axis = f"force [{newtons}], moment [{newton_metres}]"
            yield Panel(f"Guide: force and moment on {body.name}", axis, curves, (force, moment))
    factor, unit = _prefixed(reference.scale["drive.torque"], "N m")
    curves = {"torque": _channel("drive.torque", factor)}
    yield Panel(f"Drive: torque on {scene.drive.body}", f"torque [{unit}]", curves, ("drive.torque",))


def _prefixed(scale: float, unit: str) -> tuple[float, str]:
    """Return the factor from SI to the unit with the prefix that suits the scale, and that unit."""
    prefixes = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
    power = min(max(3 * floor(log10(scale) / 3), min(prefixes)), max(prefixes))
    return 10.0**-power, prefixes[power] + unit


def _channel(channel: str, factor: float) -> Callable[[Motion], Samples]:
    return lambda motion: factor * motion[channel]


def _sum(a: Callable[[Motion], Samples], b: Callable[[Motion], Samples]) -> Callable[[Motion], Samples]:
    return lambda motion: a(motion) + b(motion)


def _magnitude(x: str, y: str, factor: float) -> Callable[[Motion], Samples]:
    return lambda motion: factor * np.hypot(motion[x], motion[y])


def over_angle(study: Study, panel: Panel) -> go.Figure:
    """Draw one panel: curves above, errors below, on one axis of crank angle."""
    figure = make_subplots(2, 1, shared_xaxes=True, row_heights=[0.6, 0.4], vertical_spacing=0.06)
    degrees = np.degrees(study.sampling.commanded(study.scene))
    for (name, curve), dash in zip(panel.curves.items(), DASHES, strict=False):
        line = {"color": "#555555", "dash": dash, "width": 1.5}
        figure.add_scatter(x=degrees, y=curve(study.motion), name=name, line=line, mode="lines", row=1, col=1)
    stride = max(study.sampling.samples // MARKERS, 1)
    floor = max((study.reference.floor.by_channel.get(channel, 0.0) for channel in panel.judged), default=0.0)
    for number, m in enumerate(study.measurements):
        if m.run.motion is None or m.comparison is None or any(c not in m.run.motion for c in panel.judged):
            continue
        engine, colour = m.run.engine, COLOURS[number % len(COLOURS)]
        rows = slice(number * stride, None, len(study.measurements) * stride)
        marker = {"color": colour, "symbol": SYMBOLS[number % len(SYMBOLS)], "size": 8, "line": {"width": 2}}
        for first, curve in enumerate(panel.curves.values()):
            figure.add_scatter(
                x=degrees[rows],
                y=curve(m.run.motion)[rows],
                name=engine,
                legendgroup=engine,
                showlegend=first == 0,
                mode="markers",
                marker=marker,
                row=1,
                col=1,
            )
        if engine != REFERENCE:
            error = np.sqrt(sum(np.square(m.comparison.actual[channel]) for channel in panel.judged))
            figure.add_scatter(
                x=degrees,
                y=np.maximum(error, floor) if floor else np.where(error > 0, error, np.nan),
                name=f"{engine} error",
                legendgroup=engine,
                showlegend=False,
                mode="lines",
                line={"color": colour, "width": 1.3},
                row=2,
                col=1,
            )
    if floor:
        line = {"color": "#999999", "dash": "dot"}
        ends = degrees[[0, -1]]
        figure.add_scatter(x=ends, y=[floor] * 2, name="reference's floor", line=line, mode="lines", row=2, col=1)
    figure.update_yaxes(title=panel.axis, row=1, col=1)
    figure.update_yaxes(title="relative error [-]", type="log", exponentformat="power", nticks=6, row=2, col=1)
    figure.update_xaxes(title="crank angle [deg]", row=2, col=1)
    forwards = study.scene.drive.speed > 0  # time runs from left to right
    figure.update_xaxes(dtick=60 * study.sampling.turns, autorange=True if forwards else "reversed")
    return figure.update_layout(LAYOUT, height=480)


def speed_against_error(study: Study) -> go.Figure:
    """Draw every ladder point that solved: milliseconds a turn against the largest error, by channel group, log-log."""
    solved = study.speed[study.speed["status"] == Status.ok.name] if len(study.speed) else pd.DataFrame({"engine": []})
    groups = ["position", "velocity", "acceleration", *(["reaction", "torque"] if study.scene.has_masses else [])]
    figure = make_subplots(1, len(groups), shared_yaxes=True, subplot_titles=groups, horizontal_spacing=0.02)
    for column, group in enumerate(groups, start=1):
        for number, m in enumerate(study.measurements):
            points = solved[solved["engine"] == m.run.engine]
            if points.empty:
                continue
            figure.add_scatter(
                x=1e3 * points["solve_min_s"],
                y=points[f"{group}_max"],
                text=points["setting"],
                name=m.run.engine,
                legendgroup=m.run.engine,
                showlegend=column == 1,
                mode="markers",
                marker={"color": COLOURS[number % len(COLOURS)], "symbol": SYMBOLS[number % len(SYMBOLS)], "size": 10}
                | {"line": {"width": 2}},
                hovertemplate="%{text}<br>%{x:.3g} ms a turn<br>error %{y:.2e}",
                row=1,
                col=column,
            )
        figure.update_xaxes(title="ms a turn", type="log", exponentformat="power", dtick=1, row=1, col=column)
    figure.update_yaxes(type="log", exponentformat="power", dtick=2)
    figure.update_yaxes(title="largest relative error [-]", row=1, col=1)
    return figure.update_layout(LAYOUT | SUBTITLED, height=460)
