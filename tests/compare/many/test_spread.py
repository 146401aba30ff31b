"""The statistics of a number, from values whose statistics are known."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from compare.judge.peaks.curves import CycleCurve
from compare.judge.peaks.numbers import CycleNumber
from compare.measure.many.study import Spread, spread
from compare.report.tables.monte_carlo import verdicts
from scenes.model.motion import Samples

CURVE = CycleCurve("velocity", "P", "m/s", {"P.vx": 1}, 1.0)
X, Y = np.meshgrid(np.linspace(-1, 1, 201), np.linspace(-1, 1, 201))  # uniform: of variance 1/3 each, but for the grid


def of(values: Samples, linear: Samples, gradient: dict[str, float]) -> Spread:
    number = CycleNumber("peak speed", CURVE, np.array([5.0]), "m/s", np.array([5.0]))
    return spread(number, values.ravel(), linear.ravel(), gradient)


def test_a_number_that_is_linear() -> None:
    values = 5 + 2 * X + Y
    values[3, 7] = np.nan  # one that does not run
    number = of(values, 5 + 2 * X + Y, {"x": 2 / 3**0.5, "y": 1 / 3**0.5})
    assert number.mean == pytest.approx(5, abs=1e-4)
    assert number.deviation == pytest.approx(number.linear, rel=0.01)
    assert number.linear == pytest.approx((5 / 3) ** 0.5, rel=1e-12)
    assert number.shares == {"x": pytest.approx(0.8), "y": pytest.approx(0.2)}
    assert number.unexplained == 0
    assert (number.least, number.largest) == (0, values.size - 1)
    assert number.quantiles["0.5"] == pytest.approx(5, abs=0.02)
    assert number.quantiles["0.95"] == pytest.approx(5 + 3 - 2 * 0.2**0.5, abs=0.03)  # a corner of 1/20 of the square


def test_a_number_that_is_not() -> None:
    number = of(5 + X**2, np.full(X.shape, 5.0), {"x": 0.0, "y": 0.0})
    assert number.linear == 0
    assert number.shares == {"x": 0, "y": 0}
    assert number.deviation == pytest.approx((1 / 5 - 1 / 9) ** 0.5, rel=0.02)
    assert number.unexplained == pytest.approx((1 / 5) / (1 / 5 - 1 / 9), rel=0.02)  # the mean is off as well
    slightly = of(5 + X + 0.05 * X**2, 5 + X, {"x": 3**-0.5})
    assert slightly.unexplained == pytest.approx(0.05**2 / 5 * 3, rel=0.02)
    hardly = of(5 + X + 0.02 * X**2, 5 + X, {"x": 3**-0.5})
    assert hardly.unexplained == pytest.approx(0.02**2 / 5 * 3, rel=0.02)


def test_where_nothing_runs_or_nothing_differs() -> None:
    nothing = of(np.full((2, 2), np.nan), np.zeros((2, 2)), {"x": 1.0})
    assert np.isnan([nothing.mean, nothing.deviation, *nothing.quantiles.values()]).all()
    alike = of(np.full((2, 2), 5.0), np.full((2, 2), 5.0), {"x": 0.0})
    assert alike.deviation == 0
    rounding = of(5 + 1e-13 * X, np.full(X.shape, 5.0), {"x": 1e-13})
    assert rounding.deviation == 0


def test_the_linear_model_is_doubted_where_its_standard_deviation_misleads() -> None:
    """Of X + a X^2, X uniform within 1, the variance is 1/3 + a^2 (1/5 - 1/9), and 1/3 by the linear model."""
    said = []
    for a in (0.3, 1.0):
        study = SimpleNamespace(
            spreads=[of(5 + X + a * X**2, 5 + X, {"x": float(X.std())})],
            count=10_000,
            scene=SimpleNamespace(limits={}),
            judged=SimpleNamespace(measurements=[]),
        )
        (sentence,) = verdicts(study)  # type: ignore[arg-type]
        (number,) = re.findall(r"([\d.]+) %", sentence)
        off = 1 - (1 + 3 * a**2 * (1 / 5 - 1 / 9)) ** -0.5
        assert float(number) == pytest.approx(100 * off, rel=0.03), "of the grid"
        said.append(sentence)
    assert said[0].startswith("Adding the tolerances up linearly gives each standard deviation to within 1.1")
    assert said[1].startswith("Tolerances do not add up linearly for peak speed (off by ")
