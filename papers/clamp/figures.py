"""Pictures of the clamp's two designs over their strokes, as printed and as computed."""

from collections.abc import Iterator

import numpy as np
import plotly.graph_objects as go

from compare.report.style import colour, draw, layout, marker, stacked

from .formulas import PUBLISHED, Array, Design, Pose, acceleration, at, platen_stroke, velocity_ratio
from .printed import TABLE_1
from .tables import SPEED


def figures() -> Iterator[tuple[str, str, go.Figure]]:
    """Yield title, note and figure of every picture."""
    yield (
        "Clamp: velocity ratio over the stroke",
        "From open to locked. Circles: the printed peaks and startup values, where the computed ones are.",
        _velocity_ratio(),
    )
    yield (
        "Clamp: acceleration of the platen over the stroke",
        f"At an assumed {SPEED:g} mm/s of the crosshead. Solid: the corrected formula; dotted: as printed.",
        _acceleration(),
    )


def _stroke(d: Design) -> tuple[Pose, Array]:
    """Return a design over its stroke, and how far the platen has come from where it was open, mm."""
    pose = at(d, d.alpha_max * np.linspace(1, 0, 361))
    left = platen_stroke(pose)
    return pose, left[0] - left


def _velocity_ratio() -> go.Figure:
    figure = stacked()
    for number, (name, d) in enumerate(PUBLISHED.items()):
        pose, way = _stroke(d)
        ratio = velocity_ratio(pose)
        draw(figure, name, way, ratio, line={"color": colour(number), "width": 1.8})
        printed = [float(TABLE_1[what][name]) for what in ("R_V max", "R_V startup")]
        there, circle = way[[int(ratio.argmax()), 0]], marker(number, "circle-open", 9)
        draw(figure, f"{name}, printed", there, printed, mode="markers", marker=circle)
    figure.update_yaxes(title="R_V = v_m / v_o [-]", rangemode="tozero")
    return _over_the_stroke(figure)


def _acceleration() -> go.Figure:
    figure = stacked()
    for number, (name, d) in enumerate(PUBLISHED.items()):
        pose, way = _stroke(d)
        for label, printed, dash in ((name, False, "solid"), (f"{name}, as printed", True, "dot")):
            line = {"color": colour(number), "width": 1.8, "dash": dash}
            draw(figure, label, way, acceleration(pose, SPEED, printed=printed), line=line)
    figure.update_yaxes(title="a_m [mm/s²]")
    return _over_the_stroke(figure)


def _over_the_stroke(figure: go.Figure) -> go.Figure:
    figure.update_xaxes(title="way of the platen from open [mm]")
    return figure.update_layout(layout(480))
