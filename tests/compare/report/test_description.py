"""Figures in words."""

import numpy as np

from compare.report.figures.description import described
from compare.report.figures.figure import draw, stacked
from compare.report.figures.style import layout


def test_extremes_with_their_places_and_curves() -> None:
    figure = stacked(1, 1)
    x = np.array([0.0, 10.0, 20.0])
    draw(figure, "a", x, np.array([1.0, np.nan, -2.0]), 1)
    draw(figure, "b", x, np.array([0.0, 5.0, 0.0]), 1)
    draw(figure, "c", x, np.full(3, np.nan), 1)
    draw(figure, "d", x, np.full(3, np.nan), 2)
    figure.update_yaxes(title="speed [mm/s]", panel=1).update_yaxes(title="error [-]", panel=2)
    figure.update_xaxes(title="crank angle [deg]", panel=2)
    assert described("P5", figure.update_layout(layout(400))) == (
        "P5, over crank angle [deg]. speed [mm/s]: from −2 (a) at 20 to 5 (b) at 10. error [-]: no values."
    )
