"""What a table of speed against error says, on times and errors known beforehand."""

from collections.abc import Sequence
from dataclasses import replace
from math import nan

import numpy as np
import pytest

from compare.measure.speed.speed_table import contests, in_doubt
from compare.measure.speed.work_precision import (
    SpeedRow,
    above_floor,
    as_fast,
    choices,
    front,
    orders,
    step_costs,
)

from .stubs import STEPS, family, table


def names(points: Sequence[SpeedRow], limit: float) -> list[str]:
    return labels(as_fast(points, "reaction_max", limit))


def labels(points: Sequence[SpeedRow]) -> list[str]:
    return [row.setting for row in points]


def test_the_cheapest() -> None:
    points = table(
        ("a", "coarse", 1.0, 1e-1), ("a", "fine", 3.6, 1e-3), ("b", "good", 2.0, 1e-3), ("b", "odd", 0.1, nan)
    )
    found = {limit: names(points, limit) for limit in (1.0, 1e-1, 1e-2, 1e-3, 1e-4)}
    assert found == {1.0: ["coarse"], 1e-1: ["coarse"], 1e-2: ["good"], 1e-3: ["good"], 1e-4: []}


def test_of_level_settings_the_most_accurate_is_named() -> None:
    """Whichever of them a run finds faster, by up to a half; beyond that the faster one, level up to three quarters."""
    for first, second in ((1.0, 1.49), (1.49, 1.0)):
        assert names(table(("a", "rough", first, 1e-3), ("b", "good", second, 1e-6)), 1e-2) == ["good", "rough"]
    assert names(table(("a", "rough", 1.0, 1e-3), ("b", "good", 1.74, 1e-6)), 1e-2) == ["rough", "good"]
    assert names(table(("a", "rough", 1.0, 1e-3), ("b", "good", 1.76, 1e-6)), 1e-2) == ["rough"]


def test_of_level_settings_with_equal_errors_the_fewest_steps_are_named() -> None:
    rows = [("a", "many", 1.0, 1e-3), ("a", "few", 1.2, 1e-3), ("a", "few too", 1.1, 1e-3)]
    assert names(table(*rows, steps_made=[9, 3, 3]), 1e-2) == ["few", "few too", "many"]


def test_who_stands_first() -> None:
    """The reference stands apart, what has a note too; of each engine its fastest setting counts."""
    rows = [("analytic", "core", 0.1, 0.0), ("a", "1", 2.0, 1e-4), ("a", "2", 9.0, 1e-9), ("b", "noted", 0.1, 1e-9)]
    for time, stands in ((1.9, "level"), (1.3, "cheapest"), (3.1, "dearer")):
        points = table(*rows, ("b", "own", time, 1e-3), note=["", "", "", "for show", ""])
        found = {row.engine: row for row in choices(points) if row.level == "1 %" and not row.note}
        assert found["b"].standing == stands
        assert found["a"].standing == {"level": "level", "cheapest": "dearer", "dearer": "cheapest"}[stands]
        assert "analytic" not in {name for name, row in found.items() if row.standing}


def test_what_more_rounds_should_make_sure_of() -> None:
    """Settings near 1.5 times the fastest of a contest, and that one; the others decide nothing."""
    points = table(
        *(("a", "fastest", 1.0, 1e-3), ("a", "near", 1.4, 1e-5), ("a", "nearer", 1.1, 1e-4), ("a", "far", 2.0, 1e-6)),
        *(("b", "alone", 9.0, 1e-9), ("b", "failed", 1.5, 1e-9)),
        status=["ok"] * 5 + ["diverged"],
    )
    compared = contests(points)
    times = [row.solve_min_s for row in points]
    assert in_doubt(compared, times) == [0, 1, 2, 3]
    for ratio, found in ((2.5, [0, 1]), (2.7, [])):  # 1.5 times, of which one run was on a busy machine
        assert in_doubt(compared, [1.0, ratio, 9.0, 30.0, 9.0, 1.5]) == found


def test_front() -> None:
    points = table(
        ("a", "1", 1.0, 1e-1),
        ("a", "2", 2.0, 1e-2),
        ("a", "beaten", 3.0, 5e-2),
        ("b", "3", 4.0, 1e-5),
        ("b", "as fast", 4.2, 1e-6),  # level with `3`, and better
        ("b", "noted", 0.5, 1e-9),
    )
    points[5] = replace(points[5], note="for show")
    assert labels(front(points, "reaction_max")) == ["1", "2", "as fast"]
    assert labels(front(points, "reaction_max", tie=0)) == ["1", "2", "3", "as fast"]


def test_whatever_is_cheapest_for_an_error_is_on_the_front() -> None:
    random = np.random.default_rng(1)
    for _ in range(5):
        rows = [("a", str(n), *values) for n, values in enumerate(np.exp(random.normal(0, [0.3, 5], (30, 2))))]
        points = table(*rows)
        best = front(points, "reaction_max")
        errors = [row.error("reaction_max") for row in best]
        assert errors == sorted(errors, reverse=True)
        for level in np.exp(random.normal(0, 5, 30)):
            assert set(names(points, level)[:1]) <= set(labels(best))


def test_settings_with_a_note_compete_apart() -> None:
    points = table(
        ("a", "own", 2.0, 1e-4), ("a", "newcomer", 1.0, 1e-4), ("b", "own", 8.0, 1e-9), ("b", "failed", 0.1, 1e-9)
    )
    points[1] = replace(points[1], note="the engine's defaults")
    points[3] = replace(points[3], status="diverged")
    found = {(row.level, row.engine, row.note): row for row in choices(points)}
    assert found["0.1 %", "a", ""].ratio == 1
    assert found["0.1 %", "a", "the engine's defaults"].ratio == 0.5
    assert found["0.1 %", "b", ""].ratio == 4
    assert found["1e-6", "a", ""].setting == ""
    assert found["1e-6", "b", ""].setting == "own"
    assert found["1e-6", "b", ""].ratio == 1


def errors_of(local: Sequence[float], steps: Sequence[int] = (100, 200, 400, 800)) -> list[float]:
    """Return errors, from 1e-2 on, that have the given orders from each number of steps to the next."""
    return [1e-2, *(1e-2 * np.cumprod([2.0**-order for order in local]))][: len(steps)]


@pytest.mark.parametrize(
    ("local", "settled", "residual"),
    [
        ((2.1, 1.9), True, 0.0),
        ((2.12, 1.88), True, 0.0),
        ((2.2, 1.8), False, 0.01),
        ((1.0, 2.0, 2.0), True, 0.0),
        ((4.03, 1.70, 6.77), False, 0.1),  # that were once shown as an order of 3.26
    ],
)
def test_an_order_settles_where_the_last_local_orders_agree(
    local: Sequence[float], settled: bool, residual: float
) -> None:
    (row,) = orders(family((100, 200, 400, 800)[: len(local) + 1], errors_of(local)), {})
    assert row.local_orders[-2:] == pytest.approx([*local[-2:]])
    assert row.order == pytest.approx(2, abs=1e-9) if settled else np.isnan(row.order)
    assert row.residual > residual, "it stays"


MANY = (72, 144, 360, 720, 1440, 7200, 14400)
ON_A_LINE = 1e-4 / np.array([1, 4, 16]) * 10 ** np.array([0.01, -0.02, 0.01])  # as many decades off


@pytest.mark.parametrize(
    ("steps", "errors", "floor", "order", "residual", "points"),
    [
        *((STEPS, [3.0 * n**-order for n in STEPS], 0.0, order, 0.0, range(6, 7)) for order in (1.0, 2.0, 3.0, 4.0)),
        ((100, 200, 400), ON_A_LINE, 0.0, 2.0, 0.01 * 2**0.5, range(3, 4)),
        # A floor of the family's own, which shows in its errors, or the reference's.
        (MANY, [n**-2.0 + 1e-8 for n in MANY], 0.0, 2.0, None, range(3, 7)),
        (MANY, [n**-2.0 + 1e-8 for n in MANY], 1e-8, 2.0, None, range(3, 7)),
        (MANY, [n**-2.0 for n in MANY], 1e-7, 2.0, None, range(3, 7)),
        # An error of second order, less one of fourth order that counts at 72 steps: 29 % there, 7 % at 144.
        (STEPS, [n**-2.0 - 1500 * n**-4.0 for n in STEPS], 0.0, 2.0, None, range(5, 6)),
    ],
)
def test_orders_are_fitted_above_the_floor_and_past_too_coarse_settings(
    steps: Sequence[int], errors: Sequence[float], floor: float, order: float, residual: float | None, points: range
) -> None:
    (row,) = orders(family(steps, errors), {"reaction": floor})
    assert row.points in points
    assert row.order == pytest.approx(order, abs=0.02 if residual is None else 1e-12)
    assert row.residual <= 0.02 if residual is None else row.residual == pytest.approx(residual, rel=1e-9, abs=1e-12)


def test_growing_round_off_is_below_the_floor() -> None:
    errors = [n**-4.0 + 3e-13 * n for n in STEPS]  # least at 360, and more than ten times that at 7200
    assert above_floor(np.array(STEPS, float), np.array(errors), 0.0) == 2
    (row,) = orders(family(STEPS, errors), {})
    assert np.isnan(row.order), "of two points there is no residual"


def test_what_a_step_costs() -> None:
    (row,) = step_costs(family(STEPS, [1.0] * len(STEPS)))
    assert row.fixed_s == pytest.approx(1e-3)
    assert row.step_s == pytest.approx(1e-5)
    assert row.residual <= 1e-12
    assert not [*step_costs(family(STEPS[:2], [1.0] * 2))]
