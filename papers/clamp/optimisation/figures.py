"""The study's pictures: the coordination curve, the lengths, and what the better designs do over the stroke."""

from collections.abc import Mapping, Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from compare.report.style import COLOURS, DASHES, LAYOUT

from ..formulas import DEGREE, Array, acceleration, velocity_ratio
from .measures import measure
from .study import ASSUMPTIONS, LENGTHS, LITERALLY, MAIN, Point
from .tables import LARGEST_IN_PRINT, PRINTED, PUBLISHED, of

MARKS = ("circle", "diamond", "star", "star-square")


def coordination(points: Sequence[Point], ahead: Mapping[str, Array]) -> go.Figure:
    """Draw M_P and L_sum over R_S, with the published designs and those ahead of them."""
    figure = make_subplots(2, 1, shared_xaxes=True, row_heights=[0.6, 0.4], vertical_spacing=0.05)
    names = [name for name in ASSUMPTIONS if name != LITERALLY]  # which is far below the others
    for name, dash, colour in zip(names, DASHES, (COLOURS[0], "#777777", "#aaaaaa"), strict=False):
        line = {"dash": dash, "color": colour, "width": 2 if name == MAIN else 1.2}
        mode = "lines+markers" if name == MAIN else "lines"
        _add(figure, f"largest M_P, {name}", of(points, name), {"mode": mode, "line": line})
    step = {"mode": "lines+markers", "line": {"color": COLOURS[2], "width": 1.5}, "marker": {"symbol": "square-open"}}
    _add(figure, "least L_sum within 0.5 % of M_P and R_S", of(points, LENGTHS), step)
    for number, (name, X) in enumerate(
        ({f"{name}, computed": X for name, X in PUBLISHED.items()} | dict(ahead)).items()
    ):
        marker = {"symbol": MARKS[number % len(MARKS)], "size": 11, "color": COLOURS[3 if name in ahead else 1]}
        _mark(figure, name, {of_design: measure(of_design, X) for of_design in ("R_S", "M_P", "L_sum")}, marker)
    for number, (name, printed) in enumerate(PRINTED.items()):
        marker = {"symbol": MARKS[number] + "-open", "size": 11, "color": COLOURS[1], "line": {"width": 2}}
        _mark(figure, f"{name}, printed", printed, marker)
    figure.add_hline(y=LARGEST_IN_PRINT, line={"dash": "dot", "color": "#999999"}, row=1, col=1)
    figure.add_annotation(
        text="largest M_P in print", x=1.1, y=LARGEST_IN_PRINT, yshift=9, showarrow=False, row=1, col=1
    )
    figure.update_yaxes(title="M_P at α = 2.5° [-]", row=1, col=1)
    figure.update_yaxes(title="L_sum [mm]", row=2, col=1)
    figure.update_xaxes(title="R_S [-]", row=2, col=1)
    return figure.update_layout(LAYOUT | {"margin": LAYOUT["margin"] | {"t": 110}}, height=760)


def _add(figure: go.Figure, name: str, points: Sequence[Point], style: Mapping[str, object]) -> None:
    at = [measure("R_S", point.optimum.X) for point in points]
    for row, of_design in ((1, "M_P"), (2, "L_sum")):
        value = [measure(of_design, point.optimum.X) for point in points]
        shown = {"name": name, "legendgroup": name, "showlegend": row == 1}
        figure.add_scatter(x=at, y=value, row=row, col=1, **shown, **style)


def _mark(figure: go.Figure, name: str, values: Mapping[str, float], marker: Mapping[str, object]) -> None:
    for row, of_design in ((1, "M_P"), (2, "L_sum")):
        shown = {"name": name, "legendgroup": name, "showlegend": row == 1, "mode": "markers", "marker": marker}
        figure.add_scatter(x=[values["R_S"]], y=[values[of_design]], row=row, col=1, **shown)


def over_stroke(designs: Mapping[str, Array]) -> go.Figure:
    """Draw R_V and a_m over the stroke, from open to locked."""
    figure = make_subplots(2, 1, shared_xaxes=True, vertical_spacing=0.05)
    for number, (name, X) in enumerate(designs.items()):
        alpha = np.linspace(X[6], 0.0, 301)
        style = {"name": name, "legendgroup": name, "mode": "lines"}
        line = {"color": COLOURS[number % len(COLOURS)], "width": 1.7}
        for row, values in ((1, velocity_ratio(X, alpha)), (2, 1e3 * acceleration(X, alpha))):
            figure.add_scatter(x=alpha / DEGREE, y=values, line=line, showlegend=row == 1, row=row, col=1, **style)
    figure.update_yaxes(title="R_V [-]", row=1, col=1)
    figure.update_yaxes(title="a_m / v_o² [1/m]", row=2, col=1)
    figure.update_xaxes(title="α [deg]", autorange="reversed", row=2, col=1)
    return figure.update_layout(LAYOUT, height=560)
