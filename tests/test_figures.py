"""What the report draws: the right channels, in the units that the axes say, with the errors below."""

import numpy as np
import pytest

from compare.figures import Panel, _prefixed, over_angle, panels, speed_against_error
from compare.speed import Budget
from compare.study import Study, study
from scenes import Sampling, load


@pytest.fixture(scope="module")
def result() -> Study:
    return study(load("toggle_press"), ["analytic", "pymunk"], Sampling(72), Budget(1, 0.0), lambda _: None)


def panel_of(result: Study, title: str) -> Panel:
    return next(panel for panel in panels(result.reference) if panel.title.startswith(title))


def test_every_joint_has_a_panel(result: Study) -> None:
    titles = [panel.title for panel in panels(result.reference)]
    for wanted in (
        "P5: displacement",
        "P5: velocity",
        "P5: acceleration",
        "Pin O",
        "Pin P1",
        "Pin P2",
        "Pin P3",
        "Pin P4",
    ):
        assert any(title.startswith(wanted) for title in titles), wanted
    assert any("slider" in title for title in titles)
    assert any("torque" in title for title in titles)


def test_curves_are_in_the_units_of_their_axes(result: Study) -> None:
    motion = result.motion
    pin = panel_of(result, "Pin P3")
    assert "kN" in pin.axis
    assert np.allclose(pin.curves["magnitude"](motion), 1e-3 * np.hypot(motion["P3.fx"], motion["P3.fy"]))
    assert np.allclose(pin.curves["x"](motion), 1e-3 * motion["P3.fx"])
    assert np.allclose(pin.curves["y"](motion), 1e-3 * motion["P3.fy"])
    displacement = panel_of(result, "P5: displacement")
    assert "mm" in displacement.axis
    assert np.allclose(displacement.curves["along the guide"](motion), 1e3 * motion["P5.y"])


def test_the_error_below_is_the_engines(result: Study) -> None:
    figure = over_angle(result, panel_of(result, "Pin P3"))
    drawn = next(trace for trace in figure.data if trace.name == "pymunk error")
    comparison = result.measurements[1].comparison
    assert comparison is not None
    expected = np.hypot(comparison.actual["P3.fx"], comparison.actual["P3.fy"])
    assert np.allclose(drawn.y, expected)
    assert not any(trace.name == "analytic error" for trace in figure.data), "the reference has no error to itself"
    assert figure.layout.yaxis2.type == "log"
    assert figure.layout.xaxis2.title.text == "crank angle [deg]"


def test_speed_shows_every_solved_point(result: Study) -> None:
    figure = speed_against_error(result)
    drawn = [trace for trace in figure.data if trace.name == "pymunk"]
    assert len(drawn) == 5  # position, velocity, acceleration, reaction, torque
    assert {len(trace.x) for trace in drawn} == {int((result.speed["engine"] == "pymunk").sum())}


@pytest.mark.parametrize(
    ("scale", "factor", "unit"),
    [(0.18, 1e3, "mN"), (1.0, 1.0, "N"), (340e3, 1e-3, "kN"), (1e-12, 1e9, "nN"), (2e6, 1e-6, "MN")],
)
def test_prefixes(scale: float, factor: float, unit: str) -> None:
    found, named = _prefixed(scale, "N")
    assert found == pytest.approx(factor)
    assert named == unit
