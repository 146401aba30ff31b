"""The audit's rules: which residuals lead to which verdict; and bad arguments."""

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from papers.audit import main
from papers.claims import Equation, Verdict, bound, comparison, judge, limit, number
from papers.sources import CLAMP, TOGGLE_PRESS, claims_of


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

    equation = Equation("eq", "length", "", form(printed), "c", form(corrected), {"b": form(branch)})
    assert judge("", equation, np.ones(3), {"length": (1.0, "m")}).verdict is verdict


def test_the_rule_of_numbers() -> None:
    def verdict(printed: str, computed: float, **more: Any) -> Verdict:
        return number("", "", printed, computed, **more).verdict

    assert verdict("1.63", 1.6349) is Verdict.HOLDS
    assert verdict("1.63", 1.6351) is Verdict.NOT_REPRODUCIBLE
    assert verdict("1.63", 1.6351, among_printed=True) is Verdict.INCONSISTENT
    assert verdict("1.63", 1.6351, allowed=[(1.634, 1.64)]) is Verdict.UNDERDETERMINED
    assert verdict("1.63", 1.7, allowed=[(1.69, 1.71)]) is Verdict.NOT_REPRODUCIBLE
    assert verdict("1.63", 1630.0, corrected=("another unit", 1.63)) is Verdict.MISPRINT
    assert verdict("1.63", float("nan")) is Verdict.NOT_REPRODUCIBLE


def test_the_rules_of_limits_and_words() -> None:
    def verdict(excess: float | None, low: float, high: float) -> Verdict:
        return limit("", "", "", excess, (low, high), scale=1, computed="").verdict

    assert verdict(-1.0, -2.0, 1.0) is Verdict.HOLDS
    assert verdict(1.0, -2.0, 2.0) is Verdict.UNDERDETERMINED
    assert verdict(1.0, 0.5, 2.0) is Verdict.INCONSISTENT
    assert verdict(None, -2.0, -1.0) is Verdict.HOLDS
    assert verdict(None, -2.0, 1.0) is Verdict.UNDERDETERMINED
    assert verdict(None, 1.0, 2.0) is Verdict.INCONSISTENT
    assert comparison("", "", "", [True, True], "").verdict is Verdict.HOLDS
    assert comparison("", "", "", [True, False], "").verdict is Verdict.UNDERDETERMINED
    assert comparison("", "", "", [False], "").verdict is Verdict.NOT_REPRODUCIBLE
    assert bound("", "", "", "", 2.0, ("", 0.5)).verdict is Verdict.MISPRINT
    assert bound("", "", "", "", 2.0, ("", 1.5)).verdict is Verdict.NOT_REPRODUCIBLE


@pytest.mark.parametrize(
    ("source", "counts"),
    [(TOGGLE_PRESS, (37, 19, 3, 7, 7, 5)), (CLAMP, (32, 3, 2, 1, 2, 20))],
)
def test_how_many_claims_came_out_how(source: str, counts: tuple[int, ...]) -> None:
    claims = claims_of(source)
    found = Counter(claim.verdict for claim in claims)
    assert tuple(found[verdict] for verdict in Verdict) == counts
    assert {claim.source for claim in claims} == {source}


@pytest.mark.parametrize("arguments", [["--ou", "x", "y"], ["--out"], ["--out", __file__]])
def test_bad_input_is_told_in_one_line(arguments: Sequence[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(list(arguments)) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1
