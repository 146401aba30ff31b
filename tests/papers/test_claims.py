"""The rules of the claims: which residuals lead to which verdict."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from papers.claims import OPEN, Equation, Verdict, comparison, judge, limit, number


@pytest.mark.parametrize(
    ("printed", "branch", "corrected", "verdict"),
    [
        (0.0, 1.0, 1.0, Verdict.HOLDS),
        (2e-12, 0.0, 0.0, Verdict.WRONG_BRANCH),
        (1.0, 1.0, 0.0, Verdict.MISPRINT),
        (1.0, 1.0, 2e-12, Verdict.NOT_REPRODUCIBLE),
        (np.nan, 1.0, 0.0, Verdict.MISPRINT),
        (1.0, np.nan, np.nan, Verdict.NOT_REPRODUCIBLE),
    ],
)
def test_the_rule_of_equations(printed: float, branch: float, corrected: float, verdict: Verdict) -> None:
    def form(value: float) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        return lambda v: v * value

    equation = Equation("length", "eq", "", form(printed), "c", form(corrected), {"b": form(branch)})
    assert judge(equation, np.ones(3), {"length": (1.0, "m")}).verdict is verdict


def test_the_rule_of_numbers() -> None:
    def verdict(printed: str, computed: float, **more: Any) -> Verdict:
        return number("", printed, computed, **more).verdict

    assert verdict("1.63", 1.6349) is Verdict.HOLDS
    assert verdict("1.63", 1.6351) is Verdict.NOT_REPRODUCIBLE
    assert verdict("-1.63", -1.6349) is Verdict.HOLDS
    assert verdict("-1.63", 1.6349) is Verdict.NOT_REPRODUCIBLE
    assert verdict("1.63", 1.6351, among_printed=True) is Verdict.INCONSISTENT
    assert verdict("1.63", 1.6351, allowed=[(1.634, 1.64)]) is Verdict.UNDERDETERMINED
    assert verdict("1.63", 1.7, allowed=[(1.69, 1.71)]) is Verdict.NOT_REPRODUCIBLE
    assert verdict("1.63", 1630.0, corrected=("another unit", 1.63)) is Verdict.MISPRINT
    assert verdict("1.63", float("nan")) is Verdict.NOT_REPRODUCIBLE


def test_the_rules_of_limits_and_words() -> None:
    def verdict(excess: float | None, low: float, high: float, **more: Any) -> Verdict:
        return limit("", "", excess, (low, high), scale=1, computed="", **more).verdict

    assert verdict(-1.0, -2.0, 1.0) is Verdict.HOLDS
    assert verdict(1.0, -2.0, 2.0) is Verdict.UNDERDETERMINED
    assert verdict(1.0, 0.5, 2.0) is Verdict.INCONSISTENT
    assert verdict(None, -2.0, -1.0) is Verdict.HOLDS
    assert verdict(None, -2.0, 1.0) is Verdict.UNDERDETERMINED
    assert verdict(None, 1.0, 2.0) is Verdict.INCONSISTENT
    assert verdict(1.0, 1.0, 1.0, corrected=("another unit", -0.5)) is Verdict.MISPRINT
    assert verdict(1.0, 1.0, 1.0, corrected=("another unit", 0.5)) is Verdict.INCONSISTENT
    assert comparison("", "", [True, True], "").verdict is Verdict.HOLDS
    assert comparison("", "", OPEN, "").verdict is Verdict.UNDERDETERMINED
    assert comparison("", "", [False], "").verdict is Verdict.NOT_REPRODUCIBLE
