"""Figures as plain data: what plotly itself would make of them."""

import numpy as np
import plotly.graph_objects as go
import pytest
from plotly.subplots import make_subplots

from compare.report.figures.figure import Figure, draw, grid, side_by_side, stacked, thinned
from compare.report.figures.offline import offline
from compare.report.figures.style import layout
from compare.report.pages.report import described

TITLES = ("a", "b", "c")


@pytest.mark.parametrize(
    ("figure", "same"),
    [
        (stacked(), make_subplots(1, 1)),
        (stacked(0.6, 0.4), make_subplots(2, 1, row_heights=[0.6, 0.4], vertical_spacing=0.06, shared_xaxes=True)),
        (
            side_by_side(TITLES),
            make_subplots(1, 3, subplot_titles=TITLES, horizontal_spacing=0.03, shared_yaxes=True),
        ),
        (grid(TITLES, 2), make_subplots(2, 2, subplot_titles=TITLES, horizontal_spacing=0.09, vertical_spacing=0.15)),
    ],
    ids=["one", "stacked", "side by side", "grid"],
)
def test_panels_are_where_plotly_places_them(figure: Figure, same: go.Figure) -> None:
    expected = same.to_plotly_json()["layout"]
    notes = expected.pop("annotations", []), figure.layout.pop("annotations", [])
    expected.pop("template")
    assert figure.layout.keys() == expected.keys()
    for axis, placed in figure.layout.items():
        assert placed["domain"] == pytest.approx(expected[axis].pop("domain"), abs=1e-12)  # round-off
        assert {name: value for name, value in placed.items() if name != "domain"} == expected[axis]
    for theirs, ours in zip(*notes, strict=True):
        assert [ours.pop(name) for name in "xy"] == pytest.approx([theirs.pop(name) for name in "xy"], abs=1e-12)
        assert ours == theirs


def test_floats_are_packed_and_what_is_not_finite_is_null() -> None:
    figure = stacked()
    draw(figure, "list", [0.0, 1.0], [np.nan, 2.0], text=["a", np.float64(np.inf)])
    draw(figure, "arrays", np.array([0.0, 1.0]), np.array([[1, 2], [3, 4]], np.int16), text=np.array(["b", None]))
    one, other = figure.shown()["data"]
    assert (one["x"], one["y"], one["text"]) == ([0, 1], [None, 2], ["a", None])
    assert (other["x"], other["text"]) == ({"dtype": "f8", "bdata": "AAAAAAAAAAAAAAAAAADwPw=="}, ["b", None])
    assert other["y"] == [[1, 2], [3, 4]]


def test_a_wrong_attribute_is_found() -> None:
    with pytest.raises(ValueError, match="colour"):
        offline(stacked().update_xaxes(colour="red"))


def test_a_figure_in_words_has_its_extremes_with_their_places_and_curves() -> None:
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


def test_curves_of_a_stack_have_the_same_places() -> None:
    """Each with its own extremes in them, though each is drawn with fewer points."""
    x, figure = np.linspace(0, 1, 30_000), stacked()
    for row in (123, 20_001):
        draw(figure, str(row), x, np.where(np.arange(30_000) == row, 5.0, 1.0), stackgroup="losses")
    one, other = thinned(figure.traces)
    assert np.array_equal(one["x"], other["x"])
    assert len(one["x"]) <= 2000
    assert max(one["y"]) == max(other["y"]) == 5.0
