"""What a table of speed against error says, on times and errors known beforehand."""

from math import nan

import numpy as np
import pandas as pd
import pytest

from compare.speed.work_precision import above_floor, cheapest, choices, front, orders, step_costs

from .stubs import STEPS, family, table


def test_cheapest() -> None:
    points = table(
        ("a", "coarse", 1.0, 1e-1), ("a", "fine", 3.0, 1e-3), ("b", "fine", 2.0, 1e-3), ("b", "odd", 0.1, nan)
    )
    found = {level: cheapest(points, "reaction_max", level) for level in (1.0, 1e-1, 1e-2, 1e-3, 1e-4)}
    named = {level: None if row is None else (row["engine"], row["setting"]) for level, row in found.items()}
    fine, coarse = ("b", "fine"), ("a", "coarse")
    assert named == {1.0: coarse, 1e-1: coarse, 1e-2: fine, 1e-3: fine, 1e-4: None}


def test_of_settings_as_fast_the_most_accurate_is_cheapest() -> None:
    for first, second in ((1.0, 1.09), (1.09, 1.0)):  # as two runs might find them
        points = table(("a", "rough", first, 1e-3), ("b", "good", second, 1e-6))
        best = cheapest(points, "reaction_max", 1e-2)
        assert best is not None
        assert best["setting"] == "good"
    best = cheapest(table(("a", "rough", 1.0, 1e-3), ("b", "good", 1.2, 1e-6)), "reaction_max", 1e-2)
    assert best is not None
    assert best["setting"] == "rough"


def test_front() -> None:
    points = table(
        ("a", "1", 1.0, 1e-1),
        ("a", "2", 2.0, 1e-2),
        ("a", "beaten", 3.0, 5e-2),
        ("b", "3", 4.0, 1e-5),
        ("b", "as fast", 4.2, 1e-6),  # as fast as `3`, and better
        ("b", "noted", 0.5, 1e-9),
    )
    points.loc[5, "note"] = "for show"
    assert front(points, "reaction_max")["setting"].tolist() == ["1", "2", "as fast"]


def test_whatever_is_cheapest_for_an_error_is_on_the_front() -> None:
    random = np.random.default_rng(1)
    for _ in range(20):
        rows = [("a", str(n), *values) for n, values in enumerate(np.exp(random.normal(0, [0.3, 5], (30, 2))))]
        points = table(*rows)
        best = front(points, "reaction_max")
        assert best["reaction_max"].is_monotonic_decreasing
        for level in np.exp(random.normal(0, 5, 30)):
            row = cheapest(points, "reaction_max", level)
            assert row is None or row["setting"] in set(best["setting"])


def test_settings_with_a_note_compete_apart() -> None:
    points = table(
        ("a", "own", 2.0, 1e-4), ("a", "newcomer", 1.0, 1e-4), ("b", "own", 8.0, 1e-9), ("b", "failed", 0.1, 1e-9)
    )
    points.loc[1, "note"] = "the engine's defaults"
    points.loc[3, "status"] = "diverged"
    found = {(row["level"], row["engine"], row["note"]): row for row in choices(points).to_dict("records")}
    assert found["0.1 %", "a", ""]["ratio"] == 1
    assert found["0.1 %", "a", "the engine's defaults"]["ratio"] == 0.5
    assert found["0.1 %", "b", ""]["ratio"] == 4
    assert found["1e-6", "a", ""]["setting"] == ""
    assert found["1e-6", "b", ""]["setting"] == "own"
    assert found["1e-6", "b", ""]["ratio"] == 1


def order_of(points: pd.DataFrame, floor: float = 0.0) -> tuple[float, float, int]:
    (row,) = orders(points, {"reaction": floor}).to_dict("records")
    return row["order"], row["residual"], row["points"]


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_orders(order: int) -> None:
    found, residual, points = order_of(family(STEPS, [3.0 * n**-order for n in STEPS]))
    assert found == pytest.approx(order, abs=1e-12)
    assert residual <= 1e-12
    assert points == len(STEPS)


def test_the_residual_of_an_order() -> None:
    """Errors 0.04 decades above a line, twice that below it, and as much above it again."""
    errors = np.array([1e-4, 1e-4 / 4, 1e-4 / 16]) * 10 ** np.array([0.04, -0.08, 0.04])
    found, residual, points = order_of(family((100, 200, 400), errors))
    assert found == pytest.approx(2, abs=1e-12)
    assert residual == pytest.approx(0.04 * np.sqrt(2), rel=1e-9)
    assert points == 3


def test_too_coarse_settings_are_left_out() -> None:
    """An error of second order, less one of fourth order that counts at 72 steps: 29 % there, 7 % at 144."""
    found, residual, points = order_of(family(STEPS, [n**-2.0 - 1500 * n**-4.0 for n in STEPS]))
    assert points == len(STEPS) - 1
    assert found == pytest.approx(2, abs=0.02)
    assert residual <= 0.02


@pytest.mark.parametrize(("floor", "of_reference"), [(1e-8, 0.0), (1e-8, 1e-8), (0.0, 1e-7)])
def test_orders_are_fitted_above_the_floor(floor: float, of_reference: float) -> None:
    """A floor of the family's own, which shows in its errors, or the reference's."""
    steps = (72, 144, 360, 720, 1440, 7200, 14400)
    found, _, points = order_of(family(steps, [n**-2.0 + floor for n in steps]), of_reference)
    assert points < len(steps)
    assert found == pytest.approx(2, abs=0.02)


def test_growing_round_off_is_below_the_floor() -> None:
    errors = [n**-4.0 + 3e-13 * n for n in STEPS]  # least at 360, and more than ten times that at 7200
    assert above_floor(np.array(STEPS, float), np.array(errors), 0.0) == 2
    assert np.isnan(order_of(family(STEPS, errors))[0]), "of two points there is no residual"


def test_what_a_step_costs() -> None:
    (row,) = step_costs(family(STEPS, [1.0] * len(STEPS))).to_dict("records")
    assert row["fixed_s"] == pytest.approx(1e-3)
    assert row["step_s"] == pytest.approx(1e-5)
    assert row["residual"] <= 1e-12
    assert step_costs(family(STEPS[:2], [1.0] * 2)).empty
