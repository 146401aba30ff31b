"""Pictures of tolerances: how the numbers are distributed, and which variation has which share in that."""

from math import ceil, pi, sqrt

import numpy as np

from ...measure.many.study import MonteCarlo
from ...mechanics.axis import prefixed
from ..numbers import capital
from ..tables.family import names
from ..tables.monte_carlo import moving, shown_units
from .figure import Figure, draw, grid
from .style import DARK_GREY, LEGEND_BESIDE, colour, layout

COLUMNS, BINS = 3, 60  # bins at most
SPAN = 4.5  # standard deviations on either side of the drawing's number
SHADES = 5  # colours before they are taken again, paler


def histograms(study: MonteCarlo) -> Figure:
    """Draw the density of each number over the machines, and that of the linear model beside it."""
    named, shown = shown_units(study), moving(study)
    figure = grid([capital(s.name) for s in shown], COLUMNS)
    numbers = [s.name for s in study.spreads]
    for number, s in enumerate(shown, start=1):
        values = study.values[:, numbers.index(s.name)]
        values = values[~np.isnan(values)]
        factor, unit = named.get(s.unit) or prefixed(abs(s.nominal), s.unit)
        density, edges = np.histogram(factor * values, min(BINS, max(10, int(values.size**0.5))), density=True)
        steps = np.repeat(edges, 2), np.concatenate([[0.0], np.repeat(density, 2), [0.0]])
        draw(figure, "machines", *steps, number, line={"color": colour(0)}, fill="tozeroy")
        if s.linear > 0:
            off = np.linspace(-SPAN, SPAN, 121)
            normal = np.exp(-(off**2) / 2) / (sqrt(2 * pi) * s.linear * factor)
            at = factor * (s.nominal + off * s.linear)
            draw(figure, "linear model, if normal", at, normal, number, line={"color": colour(1), "dash": "dash"})
        high = [0.0, float(density.max())]
        drawn = {"color": DARK_GREY, "dash": "dot"}
        draw(figure, "as drawn", [factor * s.nominal] * 2, high, number, line=drawn)
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
        bar = {"type": "bar", "orientation": "h", "name": name, "x": share, "y": [capital(s.name) for s in shown]}
        shade = {"color": colour(number), "opacity": 1.0 if number < SHADES else 0.5}
        figure.add(bar | {"base": left.copy(), "marker": shade, "legendgroup": name, "showlegend": True}, 1)
        left += share
    figure.update_xaxes(title="share of the variance [%]", range=[0, 100])
    figure.update_yaxes(automargin=True)
    arranged = layout(140 + 26 * len(shown)) | {"legend": LEGEND_BESIDE, "barmode": "overlay"}
    return figure.update_layout(arranged)
