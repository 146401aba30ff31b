"""`python -m papers.audit`: which residuals lead to which verdict, what it writes, and how bad input ends."""

import json
import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from papers import audit as audit_command
from papers import optimise
from papers.audit import audit, overview, write
from papers.claims import UNDECIDED, Claim, Verdict, comparison, judge, limit, number
from papers.written import Equation
from tests.comparisons import SLOW
from tests.pages import check_figures

Audited = tuple[dict[str, list[Claim]], list[str]]


@pytest.fixture(scope="module")
def audited() -> Audited:
    return audit(lambda _: None)


@SLOW
def test_the_files(audited: Audited, tmp_path: Path) -> None:
    folder = write(*audited, tmp_path)
    assert sorted(path.name for path in folder.iterdir()) == ["audit.html", "audit.json"]
    rows = json.loads((folder / "audit.json").read_text(encoding="utf-8"))
    keys = ["source", "claim", "printed", "computed", "residual", "verdict", "corrected", "corrected_residual", "note"]
    assert all(list(row) == keys for row in rows)
    assert {row["verdict"] for row in rows} == {str(verdict) for verdict in Verdict}
    names = [row["claim"] for row in rows]
    assert len(names) == len(set(names)) == sum(map(len, audited[0].values()))


@SLOW
def test_the_page(audited: Audited, tmp_path: Path) -> None:
    claims, notes = audited
    page = (write(claims, notes, tmp_path) / "audit.html").read_text(encoding="utf-8")
    check_figures(page)
    assert page.partition('class="text audit"')[2].count('<span class="') == sum(map(len, claims.values()))
    assert not re.search(r'<(script|link|img)[^>]*(src|href)="http', page)  # it opens with no network
    assert 'class="misprint">misprint' in page
    assert page.count("The reference is off by ") == len(notes) == 2
    counts = [[rows.count(v) for v in Verdict] for rows in ([c.verdict for c in of] for of in claims.values())]
    assert [[*row.values()][1:] for row in overview(claims)] == counts
    shown = page.partition("</table>")[0]
    assert re.findall(r"<td>(\d+)</td>", shown) == [str(count) for row in counts for count in row]


@SLOW
def test_how_many_claims_came_out_how(audited: Audited) -> None:
    by_reference = {
        source: Counter(claim.verdict for claim in rows if not claim.claim.endswith(("exudyn", "pymunk")))
        for source, rows in audited[0].items()
    }
    assert {source: tuple(count[verdict] for verdict in Verdict) for source, count in by_reference.items()} == {
        "toggle press": (37, 19, 3, 7, 6, 6),
        "double-toggle clamp": (33, 3, 2, 1, 2, 22),
    }


@pytest.mark.parametrize("main", [audit_command.main, optimise.main])
@pytest.mark.parametrize("arguments", [["--ou", "x", "y"], ["--out"], ["--out", __file__], ["extra"]])
def test_bad_input_is_named_in_one_line(
    main: Callable[[list[str]], int], arguments: Sequence[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(list(arguments)) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert len(printed.err.splitlines()) == 1


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
    equation = Equation("length", "eq", "p = 0", "c = 0", branch=("b", "p", "b"))
    symbols = {name: np.full(3, value) for name, value in zip("pbc", (printed, branch, corrected), strict=True)}
    assert judge(equation, symbols, {"length": (1.0, "m")}).verdict is verdict


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
    assert comparison("", "", UNDECIDED, "").verdict is Verdict.UNDERDETERMINED
    assert comparison("", "", [False], "").verdict is Verdict.NOT_REPRODUCIBLE
