"""A family's curves over one cycle, one line per member, coloured by the first number that is varied."""

from collections.abc import Iterator
from math import ceil

import numpy as np
from plotly.colors import sample_colorscale

from ...measure.many.family import Cycle, Family, Member
from ...mechanics.axis import axis, prefixed
from ..tables.family import label
from .figure import Figure, draw, grid
from .style import DASHES, LEGEND_BESIDE, drive_axes, layout

MOST_LINES = 25
STRIDE = 10  # samples of the cycle to a point of a line
CURVES = {"displacement": "m", "x": "m", "y": "m", "velocity": "m/s", "acceleration": "m/s^2"}  # SI units by name
EFFORTS = {"torque": "N*m", "force": "N"}  # of the drive


def curves(family: Family) -> Figure:
    """Draw the output's displacement, velocity and acceleration, and the drive's effort, over the drive's position."""
    shown = list(drawn(family))
    units = {name: unit for name, unit in (CURVES | EFFORTS).items() if name in shown[0][1].curves}
    over = axis(family.scene)
    figure = grid([f"{'Drive' if name in EFFORTS else family.scene.output}: {name}" for name in units], 2)
    for number, (name, si) in enumerate(units.items(), start=1):
        factor, unit = prefixed(max(np.ptp(cycle.curves[name]) for _, cycle in shown), si)
        for member, cycle in shown:
            x = (over.factor * cycle.position)[::STRIDE].astype(np.float32)
            y = (factor * cycle.curves[name])[::STRIDE].astype(np.float32)
            draw(figure, label(family, member), x, y, number, line=_line(family, member))
        figure.update_yaxes(title=f"{name} [{unit}]", panel=number)
    drive_axes(figure, family.scene)
    arranged = layout(60 + 380 * ceil(len(units) / 2)) | {"legend": LEGEND_BESIDE}
    return figure.update_layout(arranged, hovermode="closest")


def drawn(family: Family) -> Iterator[tuple[Member, Cycle]]:
    """Yield the members to draw: all that run, or `MOST_LINES` of them, evenly chosen."""
    able = [(member, member.cycle) for member in family.members if member.cycle is not None]
    for number in np.unique(np.linspace(0, len(able) - 1, MOST_LINES).round().astype(int)) if able else ():
        yield able[number]


def _line(family: Family, member: Member) -> dict[str, object]:
    """A line's colour, by the first of the varied numbers, and its dashes, by the second."""
    first, *others = zip(*(list(m.changes.values()) for m in family.members), strict=True)
    value, *rest = member.changes.values()
    share = (value - min(first)) / ((max(first) - min(first)) or 1.0)
    dash = DASHES[sorted(set(others[0])).index(rest[0]) % len(DASHES)] if rest else DASHES[0]
    return {"color": sample_colorscale("Viridis", 0.9 * share)[0], "dash": dash, "width": 1.5}  # its end is too pale
