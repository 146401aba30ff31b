"""Pictures of the audit: the toggle press against the crank press, and what its lengths do; the clamp's two designs."""

from collections.abc import Iterator
from math import degrees

import numpy as np
import plotly.graph_objects as go
from numpy import pi
from plotly.subplots import make_subplots

from compare.report.style import COLOURS, DASHES, LAYOUT
from scenes.motion import Samples

from .clamp import designs
from .clamp import equations as formulas
from .clamp.designs import SPEED
from .clamp.variables import DESIGNS, Pose, assembled
from .toggle_press.presses import Press, Side, family, press
from .toggle_press.table_1 import HEIGHT, MOST, speed

STRIDE = 10  # of the presses' samples: a degree of the crank


def figures() -> Iterator[tuple[str, str, go.Figure]]:
    """Yield title, note and figure of every picture."""
    yield (
        "Toggle press against crank press: the slider over a turn",
        f"From where each slider is lowest, as the crank turns; {MOST} strokes a minute. Circles: 6 mm above it.",
        _presses(),
    )
    yield (
        "Toggle press: one length 1 % longer or shorter",
        "Height of the slider above its lowest point. Solid: longer; dashed: shorter; grey: as printed.",
        _family(),
    )
    yield (
        "Clamp: velocity ratio over the stroke",
        "From open to locked. Circles: the printed peaks and startup values, where the computed ones are.",
        _velocity_ratio(),
    )
    yield (
        "Clamp: acceleration of the platen over the stroke",
        f"At an assumed {1e3 * SPEED:g} mm/s of the crosshead. Solid: the corrected formula; dotted: as printed.",
        _acceleration(),
    )


def _presses() -> go.Figure:
    toggle, crank = press("toggle_press"), press("crank_press")
    lines = {f"toggle press, {way}": (toggle, side is toggle.after) for way, side in toggle.closing.items()}
    figure = make_subplots(2, 1, shared_xaxes=True, vertical_spacing=0.06)
    for number, (name, (of, backwards)) in enumerate((lines | {"crank press": (crank, False)}).items()):
        line = {"color": COLOURS[number], "width": 1.8}
        closing, opening = (of.after, of.before) if backwards else (of.before, of.after)
        for row, values in ((1, _heights(closing, opening)), (2, _speeds(closing, opening))):
            figure.add_scatter(
                x=_angles(closing, opening),
                y=values,
                name=name,
                legendgroup=name,
                showlegend=row == 1,
                mode="lines",
                line=line,
                row=row,
                col=1,
            )
        angle, rate = closing.at(HEIGHT)
        marker = {"color": COLOURS[number], "symbol": "circle-open", "size": 9, "line": {"width": 2}}
        for row, value in ((1, 1e3 * HEIGHT), (2, -speed(rate))):
            figure.add_scatter(
                x=[-degrees(angle)],
                y=[value],
                legendgroup=name,
                showlegend=False,
                mode="markers",
                marker=marker,
                name=f"{name}, 6 mm above",
                row=row,
                col=1,
            )
    figure.update_yaxes(title="height [mm]", row=1, col=1)
    figure.update_yaxes(title="speed [mm/s]", row=2, col=1)
    figure.update_xaxes(dtick=60)
    figure.update_xaxes(title="crank angle from the lowest point [deg]", row=2, col=1)
    return figure.update_layout(LAYOUT, height=560)


def _angles(closing: Side, opening: Side) -> Samples:
    angles: Samples = np.degrees(np.concatenate([-closing.angle[::-STRIDE], opening.angle[::STRIDE]]))
    return angles


def _heights(closing: Side, opening: Side) -> Samples:
    heights: Samples = 1e3 * np.concatenate([closing.height[::-STRIDE], opening.height[::STRIDE]])
    return heights


def _speeds(closing: Side, opening: Side) -> Samples:
    rates = np.concatenate([-closing.rate[::-STRIDE], opening.rate[::STRIDE]])
    return np.array([speed(rate) for rate in rates])


def _family() -> go.Figure:
    figure = go.Figure()

    def add(name: str, of: Press, line: dict[str, object]) -> None:
        x, y = _angles(of.before, of.after), _heights(of.before, of.after)
        figure.add_scatter(x=x, y=y, name=name, mode="lines", line={"width": 1.5} | line)

    add("as printed", press("toggle_press"), {"color": "#999999", "width": 3})
    palette = (*COLOURS, "#e69f00", "#56b4e9")
    for number, (name, member) in enumerate(family()):
        add(name, member, {"color": palette[number // 2], "dash": DASHES[1 - number % 2]})
    figure.update_yaxes(title="height [mm]")
    figure.update_xaxes(title="crank angle from the lowest point, counter-clockwise [deg]", dtick=60)
    legend = {"orientation": "v", "x": 1.02, "y": 1, "yanchor": "top"}
    return figure.update_layout(LAYOUT | {"legend": legend}, height=560)


def _stroke(name: str) -> tuple[Pose, Samples]:
    """Return a design over its stroke, and how far the platen has come from where it was open, mm."""
    design = {variable: float(text) for variable, text in DESIGNS[name].items()}
    pose = assembled(design, pi / 180 * design["alpha_max"] * np.linspace(1, 0, 361))
    left = 1e3 * formulas.platen_stroke(pose)
    return pose, left[0] - left


def _velocity_ratio() -> go.Figure:
    figure = go.Figure()
    printed = {"initial": ("1.63", "1.16"), "scheme 4": ("1.80", "1.17")}
    for colour, name in zip(COLOURS, DESIGNS, strict=False):
        pose, way = _stroke(name)
        ratio = formulas.velocity_ratio(pose)
        figure.add_scatter(x=way, y=ratio, name=name, mode="lines", line={"color": colour, "width": 1.8})
        marker = {"color": colour, "symbol": "circle-open", "size": 9, "line": {"width": 2}}
        peak = int(ratio.argmax())
        figure.add_scatter(
            x=way[[peak, 0]],
            y=[float(text) for text in printed[name]],
            name=f"{name}, printed",
            mode="markers",
            marker=marker,
        )
    figure.update_yaxes(title="R_V = v_m / v_o [-]", rangemode="tozero")
    return _over_the_stroke(figure)


def _acceleration() -> go.Figure:
    figure = go.Figure()
    for colour, name in zip(COLOURS, DESIGNS, strict=False):
        pose, way = _stroke(name)
        for printed in (False, True):
            a = 1e3 * designs.platen_acceleration(pose, SPEED, printed=printed)
            line = {"color": colour, "width": 1.8, "dash": "dot" if printed else "solid"}
            figure.add_scatter(x=way, y=a, name=f"{name}, as printed" if printed else name, mode="lines", line=line)
    figure.update_yaxes(title="a_m [mm/s²]")
    return _over_the_stroke(figure)


def _over_the_stroke(figure: go.Figure) -> go.Figure:
    figure.update_xaxes(title="way of the platen from open [mm]")
    return figure.update_layout(LAYOUT, height=480)
