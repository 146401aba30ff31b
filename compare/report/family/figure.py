"""A family's curves over one cycle, one line a member, coloured by the first number that is varied."""

from collections.abc import Iterator
from math import ceil

import numpy as np
import plotly.graph_objects as go
from plotly.colors import sample_colorscale
from plotly.subplots import make_subplots

from scenes import Scene
from scenes.scene import ConstantSpeed

from ...engines.axis import axis, prefixed, turns_fully
from ...family.cycle import Cycle
from ...family.family import Family, Member
from ..curves import LAYOUT
from .tables import label

MOST_LINES = 25
STRIDE = 10  # samples of the cycle to a point of a line
DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
CURVES = {
    "displacement": "m",
    "x": "m",
    "y": "m",
    "velocity": "m/s",
    "acceleration": "m/s²",
    "torque": "N m",
    "force": "N",
}  # name -> SI unit


def curves(family: Family) -> go.Figure:
    """Draw the output's displacement, velocity and acceleration, and the drive's effort, over the drive's position."""
    drawn = list(_drawn(family))
    names = [name for name in CURVES if name in drawn[0][1].curves]
    over = axis(family.scene)
    rows = ceil(len(names) / 2)
    titles = [_title(family.scene, name) for name in names]
    figure = make_subplots(rows, 2, subplot_titles=titles, horizontal_spacing=0.07, vertical_spacing=0.28 / rows)
    for number, name in enumerate(names):
        where = {"row": number // 2 + 1, "col": number % 2 + 1}
        factor, unit = prefixed(max(np.ptp(cycle.curves[name]) for _, cycle in drawn) or 1.0, CURVES[name])
        for member, cycle in drawn:
            figure.add_scatter(
                x=(over.factor * cycle.position)[::STRIDE].astype(np.float32),
                y=(factor * cycle.curves[name])[::STRIDE].astype(np.float32),
                name=label(family, member),
                legendgroup=label(family, member),
                showlegend=number == 0,
                mode="lines",
                line=_line(family, member),
                **where,
            )
        figure.update_yaxes(title=f"{name} [{unit}]", **where)
    figure.update_xaxes(title=over.title, dtick=60 if turns_fully(family.scene) else None)
    if isinstance(family.scene.drive, ConstantSpeed) and family.scene.drive.speed < 0:
        figure.update_xaxes(autorange="reversed")  # time runs from left to right
    legend = {"orientation": "v", "x": 1.02, "y": 1, "yanchor": "top"}
    return figure.update_layout(LAYOUT | {"legend": legend}, height=60 + 380 * rows)


def _drawn(family: Family) -> Iterator[tuple[Member, Cycle]]:
    """Yield the members to draw: all that run, or `MOST_LINES` of them, evenly chosen."""
    able = [(member, member.cycle) for member in family.members if member.cycle is not None]
    for number in np.unique(np.linspace(0, len(able) - 1, MOST_LINES).round().astype(int)):
        yield able[number]


def _line(family: Family, member: Member) -> dict[str, object]:
    """Return a line's colour, by the first of the varied numbers, and its dashes, by the second."""
    first, *others = zip(*(list(m.changes.values()) for m in family.members), strict=True)
    value, *rest = member.changes.values()
    share = (value - min(first)) / ((max(first) - min(first)) or 1.0)
    dash = DASHES[sorted(set(others[0])).index(rest[0]) % len(DASHES)] if rest else DASHES[0]
    return {"color": sample_colorscale("Viridis", 0.9 * share)[0], "dash": dash, "width": 1.5}  # its end is too pale


def _title(scene: Scene, curve: str) -> str:
    return f"Drive: {curve}" if curve in ("torque", "force") else f"{scene.output}: {curve}"
