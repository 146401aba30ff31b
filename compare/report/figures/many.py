"""Pictures of many linkages: a family's curves and numbers; how numbers are distributed over machines, and why."""

from collections.abc import Iterator
from math import ceil, pi, sqrt

import numpy as np

from ...judge.peaks.numbers import STROKE
from ...measure.many.family import Cycle, Family, Member
from ...measure.many.study import MonteCarlo
from ...mechanics.axis import axis, prefixed
from ..numbers import capital
from ..tables.family import EFFORTS, label, names
from ..tables.family import shown_units as family_units
from ..tables.monte_carlo import moving, shown_units
from .figure import Figure, draw, grid
from .style import DARK_GREY, DASHES, LEGEND_BESIDE, categories, colour, drive_axes, graded, layout

MAX_LINES = 25
STRIDE = 10  # samples of the cycle to a point of a line
CURVES = {"displacement": "m", "x": "m", "y": "m", "velocity": "m/s", "acceleration": "m/s^2"}  # SI units by name
OF_THE_DRIVE = {"torque": "N*m", "force": "N"}
COLUMNS, MAX_BINS = 3, 60  # bins at most
SPAN = 4.5  # standard deviations on either side of the drawing's number
SHOWN = (STROKE, "largest force", *EFFORTS)  # kinds of numbers that a family is run for
SHADES = 5  # colours before they are taken again, paler


def curves(family: Family) -> Figure:
    """Draw the output's displacement, velocity and acceleration, and the drive's effort, over the drive's position."""
    shown, named = list(drawn(family)), family_units(family)
    units = {name: unit for name, unit in (CURVES | OF_THE_DRIVE).items() if name in shown[0][1].curves}
    along = axis(family.scene)
    figure = grid([f"{'Drive' if name in OF_THE_DRIVE else family.scene.output}: {name}" for name in units], 2)
    for number, (name, si) in enumerate(units.items(), start=1):
        factor, unit = named[si]
        for member, cycle in shown:
            x = (along.factor * cycle.position)[::STRIDE].astype(np.float32)
            y = (factor * cycle.curves[name])[::STRIDE].astype(np.float32)
            draw(figure, label(family, member), x, y, number, line=_line(family, member))
        figure.update_yaxes(title=f"{name} [{unit}]", panel=number)
    drive_axes(figure, family.scene)
    arranged = layout(60 + 380 * ceil(len(units) / 2)) | {"legend": LEGEND_BESIDE}
    return figure.update_layout(arranged, hovermode="closest", dragmode="zoom")


def drawn(family: Family) -> Iterator[tuple[Member, Cycle]]:
    """Yield the members to draw: all that run, or `MAX_LINES` of them, evenly chosen."""
    able = [(member, member.cycle) for member in family.members if member.cycle is not None]
    for number in np.unique(np.linspace(0, len(able) - 1, MAX_LINES).round().astype(int)) if able else ():
        yield able[number]


def _line(family: Family, member: Member) -> dict[str, object]:
    """A line's colour, by the first of the varied numbers, and its dashes, by the second."""
    first, *others = zip(*(list(m.changes.values()) for m in family.members), strict=True)
    value, *rest = member.changes.values()
    share = (value - min(first)) / ((max(first) - min(first)) or 1.0)
    dash = DASHES[sorted(set(others[0])).index(rest[0]) % len(DASHES)] if rest else DASHES[0]
    return {"color": graded(0.25 + 0.6 * share), "dash": dash, "width": 1.5}  # its ends are seen on one ground alone


def over_number(family: Family) -> Figure:
    """Draw a panel a number over the first that varies, a line for each value of the others; a gap where none runs."""
    known = [(tuple(m.changes.values()), m.numbers) for m in family.members]
    kinds = [kind for kind in SHOWN if any(kind in numbers for _, numbers in known)]
    first, *others = names(family.variations)
    named = family_units(family)
    figure = grid([capital(kind) for kind in kinds], 2)
    for panel, kind in enumerate(kinds, start=1):
        found = [numbers[kind] for _, numbers in known if kind in numbers]
        factor, unit = named[found[0].unit]
        for number, rest in enumerate(dict.fromkeys(values[1:] for values, _ in known)):
            members = [(values[0], numbers) for values, numbers in known if values[1:] == rest]
            y = [factor * numbers[kind].value if kind in numbers else np.nan for _, numbers in members]
            x, line = np.array([value for value, _ in members]), {"color": colour(number)}
            alike = ", ".join(f"{name} = {value:.6g}" for name, value in zip(others, rest, strict=True)) or "members"
            draw(figure, alike, x, np.array(y), panel, mode="lines+markers", line=line)
        figure.update_yaxes(title=f"[{unit}]", panel=panel)
    figure.update_xaxes(title=first)
    return figure.update_layout(layout(60 + 300 * -(-len(kinds) // 2), titled=True))


def histograms(study: MonteCarlo) -> Figure:
    """Draw the density of each number over the machines, and that of the linear model beside it."""
    named, shown = shown_units(study), moving(study)
    figure = grid([capital(s.name) for s in shown], COLUMNS)
    by_name = dict(zip((s.name for s in study.spreads), study.values.T, strict=True))
    for number, s in enumerate(shown, start=1):
        values = by_name[s.name][~np.isnan(by_name[s.name])]
        factor, unit = named.get(s.unit) or prefixed(abs(s.nominal), s.unit)
        # As many bins as the square root of the machines, a usual rule: each then holds about as many machines as there
        # are bins.
        density, edges = np.histogram(factor * values, min(MAX_BINS, max(10, int(values.size**0.5))), density=True)
        steps = np.repeat(edges, 2), np.concatenate([[0.0], np.repeat(density, 2), [0.0]])
        draw(figure, "machines", *steps, number, line={"color": colour(0)}, fill="tozeroy")
        if s.linear > 0:
            deviations = np.linspace(-SPAN, SPAN, 121)
            normal = np.exp(-(deviations**2) / 2) / (sqrt(2 * pi) * s.linear * factor)
            numbers = factor * (s.nominal + deviations * s.linear)
            draw(figure, "linear model, if normal", numbers, normal, number, line={"color": colour(1), "dash": "dash"})
        high, line = [0.0, float(density.max())], {"color": DARK_GREY, "dash": "dot"}
        draw(figure, "as drawn", [factor * s.nominal] * 2, high, number, line=line)
        figure.update_xaxes(title=f"[{unit}]", nticks=4, panel=number)
        figure.update_yaxes(showticklabels=False, panel=number)
    return figure.update_layout(layout(60 + 260 * ceil(len(shown) / COLUMNS), titled=True))


def variance_shares(study: MonteCarlo) -> Figure:
    """Draw a bar for each number, of the shares that the variations have in its variance."""
    shown, varied = moving(study)[::-1], study.scene.variations
    figure = grid([""], 1)
    left = np.zeros(len(shown))
    for number, (name, path) in enumerate(zip(names(varied), (v.path for v in varied), strict=True)):
        share = np.array([100 * s.shares[path] for s in shown])
        bar = {"type": "bar", "orientation": "h", "name": name, "x": share, "y": np.arange(len(shown))}
        shade = {"color": colour(number), "opacity": 1.0 if number < SHADES else 0.5}
        figure.add(bar | {"base": left.copy(), "marker": shade, "legendgroup": name, "showlegend": True}, 1)
        left += share
    figure.update_xaxes(title="share of the variance [%]", range=[0, 100])
    figure.update_yaxes(categories([capital(s.name) for s in shown]), automargin=True)
    return figure.update_layout(layout(140 + 26 * len(shown)), barmode="overlay")
