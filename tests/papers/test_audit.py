"""`python -m papers.audit`: what it writes is complete, and how bad input ends."""

import json
import re
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from papers import audit as audit_command
from papers import optimise
from papers.audit import audit, write
from papers.claims import Claim, Verdict
from papers.page import overview
from tests.pages import check_figures

Audited = tuple[dict[str, list[Claim]], list[str]]


@pytest.fixture(scope="module")
def audited() -> Audited:
    return audit(lambda _: None)


def test_the_files(audited: Audited, tmp_path: Path) -> None:
    folder = write(*audited, tmp_path)
    assert sorted(path.name for path in folder.iterdir()) == ["audit.html", "audit.json"]
    rows = json.loads((folder / "audit.json").read_text(encoding="utf-8"))
    keys = ["source", "claim", "printed", "computed", "residual", "verdict", "corrected", "corrected_residual", "note"]
    assert all(list(row) == keys for row in rows)
    assert {row["verdict"] for row in rows} == {str(verdict) for verdict in Verdict}
    names = [row["claim"] for row in rows]
    assert len(names) == len(set(names)) == sum(map(len, audited[0].values()))


def test_the_page(audited: Audited, tmp_path: Path) -> None:
    claims, notes = audited
    page = (write(claims, notes, tmp_path) / "audit.html").read_text(encoding="utf-8")
    check_figures(page)
    assert page.partition('class="text audit"')[2].count('<span class="') == sum(map(len, claims.values()))
    assert not re.search(r'<(script|link|img)[^>]*(src|href)="http', page)  # it opens with no network
    assert 'class="misprint">misprint' in page
    assert page.count("The reference is off by ") == len(notes) == 2
    counts = [[rows.count(v) for v in Verdict] for rows in ([c.verdict for c in of] for of in claims.values())]
    assert overview(claims).drop(columns="source").to_numpy().tolist() == counts
    shown = page.partition("</table>")[0]
    assert re.findall(r"<td>(\d+)</td>", shown) == [str(count) for row in counts for count in row]


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
