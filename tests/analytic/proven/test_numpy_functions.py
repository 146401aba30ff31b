"""NumPy's functions, by which Taylor models have their values, against exact arithmetic: to some last places."""

from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from analytic.recorded.arithmetics.taylor_models import FUNCTION
from scenes.model.motion import Samples
from tests.comparisons import SLOW

LAST_PLACES = 4  # units, of a value: half of what FUNCTION allows for


def units_off(values: Samples, true: Callable[..., Any], *arguments: Samples) -> float:
    """By how many units in the last place values are off at most, of 2^-52 of the true value."""
    worst = 0.0
    with ctx.workprec(120):
        for value, *x in zip(values.tolist(), *(own.tolist() for own in arguments), strict=True):
            exact = true(*map(arb, x))
            worst = max(worst, float(abs((arb(value) - exact) / exact).upper())) if exact != 0 else worst
    return worst * 2.0**52


def arguments(seed: int, count: int) -> Samples:
    """Angles of a few turns, tiny ones, long ones, and about multiples of a right angle."""
    chance = np.random.default_rng(seed)
    kinds = [chance.uniform(-10, 10, count), chance.uniform(-1, 1, count) * 10.0 ** chance.uniform(-12, 6, count)]
    kinds.append(chance.integers(-9, 10, count) * pi / 2 * (1 + 2.0**-50 * chance.integers(-99, 99, count)))
    return np.concatenate([kind[: count // 3] for kind in kinds])


def assert_close_to_the_last_place(seed: int, count: int) -> None:
    x = arguments(seed, count)
    y = np.random.default_rng(seed + 1).permutation(x)
    assert FUNCTION >= 2 * LAST_PLACES * 2.0**-52
    for values, true, of in (
        (np.sin(x), lambda x: x.sin(), [x]),
        (np.cos(x), lambda x: x.cos(), [x]),
        (np.tanh(x), lambda x: x.tanh(), [x]),
        (np.arctan(x), lambda x: x.atan(), [x]),
        (np.sqrt(np.abs(x)), lambda x: abs(x).sqrt(), [x]),
        (np.arctan2(y, x), lambda y, x: arb.atan2(y, x), [y, x]),
    ):
        assert units_off(values, true, *of) <= LAST_PLACES


@SLOW
def test_functions_of_numpy_are_off_by_less_than_their_bound() -> None:
    assert_close_to_the_last_place(0, 60_000)


@pytest.mark.study
def test_functions_of_numpy_at_millions_of_arguments() -> None:
    assert_close_to_the_last_place(2, 10_000_000)
