"""The study's pictures: the coordination curve, the lengths, and what the better designs do over the stroke."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from compare.report.figures.figure import Figure, draw, stacked
from compare.report.figures.style import BOUND, DASHES, colour, layout, marker

from ..formulas import DEGREE, PUBLISHED, Design, acceleration, at, velocity_ratio
from ..measures import measure
from ..printed import LARGEST_FORCE_RATIO, TABLE_1
from .study import ASSUMPTIONS, LENGTHS, LITERALLY, MAIN, Point
from .tables import of

AXES = ("R_S", "M_P", "L_sum")
MARKS = ("circle", "diamond", "star", "star-square")


def coordination(points: Sequence[Point], ahead: Mapping[str, Design]) -> Figure:
    """Draw M_P and L_sum over R_S, with the published designs and those ahead of them."""
    figure = stacked(0.6, 0.4)
    names = [name for name in ASSUMPTIONS if name != LITERALLY]  # which is far below the others
    for name, dash, shade in zip(names, DASHES, (colour(0), "#777777", "#aaaaaa"), strict=False):
        line = {"dash": dash, "color": shade, "width": 2 if name == MAIN else 1.2}
        mode = "lines+markers" if name == MAIN else "lines"
        _draw(figure, f"largest M_P, {name}", _of(points, name), mode=mode, line=line)
    step = {"mode": "lines+markers", "line": {"color": colour(2), "width": 1.5}, "marker": {"symbol": "square-open"}}
    _draw(figure, "least L_sum within 0.5 % of M_P and R_S", _of(points, LENGTHS), **step)
    computed = {f"{name}, computed": d for name, d in PUBLISHED.items()}
    for mark, (name, d) in zip(MARKS, (computed | dict(ahead)).items(), strict=False):
        values = {axis: [measure(axis, d)] for axis in AXES}
        _draw(figure, name, values, mode="markers", marker=marker(3 if name in ahead else 1, mark, 11))
    for mark, name in zip(MARKS, PUBLISHED, strict=False):
        values = {axis: [float(TABLE_1[axis][name])] for axis in AXES}
        _draw(figure, f"{name}, printed", values, mode="markers", marker=marker(1, f"{mark}-open", 11))
    figure.update_yaxes(title="M_P at α = 2.5° [-]", panel=1)
    figure.update_yaxes(title="L_sum [mm]", panel=2)
    figure.update_xaxes(title="R_S [-]", panel=2)
    printed = {"yref": "y", "y0": float(LARGEST_FORCE_RATIO), "y1": float(LARGEST_FORCE_RATIO)}
    across = {"type": "line", "line": BOUND, "xref": "x domain", "x0": 0, "x1": 1}
    place = {"xref": "x domain", "x": 0.5, "xanchor": "center", "y": printed["y0"], "yanchor": "bottom"}
    figure.note("largest M_P in print", yref="y", **place)
    return figure.update_layout(layout(760), margin={"t": 110}, shapes=[across | printed])


def _of(points: Sequence[Point], name: str) -> Mapping[str, Sequence[float]]:
    """The measures that are drawn of one set of points."""
    return {axis: [measure(axis, point.optimum.design) for point in of(points, name)] for axis in AXES}


def _draw(figure: Figure, name: str, values: Mapping[str, Sequence[float]], **style: Any) -> None:
    for row, axis in ((1, "M_P"), (2, "L_sum")):
        draw(figure, name, values["R_S"], values[axis], row, **style)


def over_stroke(designs: Mapping[str, Design]) -> Figure:
    """Draw R_V and a_m over the stroke, from open to locked."""
    figure = stacked(1, 1)
    for number, (name, d) in enumerate(designs.items()):
        pose = at(d, np.linspace(d.alpha_max, 0.0, 301))
        for row, values in ((1, velocity_ratio(pose)), (2, 1e3 * acceleration(pose))):
            draw(figure, name, pose.alpha / DEGREE, values, row, line={"color": colour(number), "width": 1.7})
    figure.update_yaxes(title="R_V [-]", panel=1)
    figure.update_yaxes(title="a_m / v_o² [1/m]", panel=2)
    figure.update_xaxes(title="α [deg]", autorange="reversed", panel=2)
    return figure.update_layout(layout(560))
