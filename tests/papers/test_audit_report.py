"""The report's section on the source of a shipped scene: who has it, what it says, and that it stays cheap."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from compare.audit.claims import Verdict
from compare.audit.sources import CLAMP, SCENES, TOGGLE_PRESS, claims_of, source_of
from compare.report.page import page
from compare.speed.timing import Budget
from compare.study import Study, study
from scenes import LIBRARY, Sampling, load, shipped

HEADING = "The source paper, audited"


@pytest.fixture(scope="module")
def result() -> Study:
    return study(load("crank_press"), ["analytic"], Sampling(36), Budget(1, 0.0), lambda _: None)


def test_which_scenes_are_audited() -> None:
    audited = {name: source_of(load(name)) for name in shipped()}
    assert {name: source for name, source in audited.items() if source is not None} == {
        "toggle_press": TOGGLE_PRESS,
        "crank_press": TOGGLE_PRESS,
        "double_toggle_clamp": CLAMP,
        "double_toggle_clamp_scheme4": CLAMP,
    }


def test_whose_scene_is_not_the_sources(tmp_path: Path) -> None:
    """A file of one's own may be called as it likes; changed lengths are another linkage's."""
    own = tmp_path / "toggle_press.toml"
    own.write_text((LIBRARY / "toggle_press.toml").read_text(encoding="utf-8"), encoding="utf-8")
    scene = load("toggle_press")
    assert load(own).name == scene.name
    for other in (load(own), load("toggle_press", {"bodies.rod.lengths.P4-P5": 301})):
        assert source_of(other) is None


@pytest.mark.parametrize(
    ("source", "counts"),
    [(TOGGLE_PRESS, (37, 19, 3, 7, 7, 5)), (CLAMP, (32, 3, 2, 1, 2, 20))],
)
def test_how_many_claims_came_out_how(source: str, counts: tuple[int, ...]) -> None:
    claims = claims_of(source)
    found = Counter(claim.verdict for claim in claims)
    assert tuple(found[verdict] for verdict in Verdict) == counts
    assert {claim.source for claim in claims} == {source}


def test_the_section_of_a_report(result: Study) -> None:
    html = page(result)
    assert html.count(HEADING) == 1
    section = html.partition(HEADING)[2].partition("<h2>")[0]
    claims = claims_of(TOGGLE_PRESS)
    counts = Counter(claim.verdict for claim in claims)
    shown = section.partition("</table>")[0]
    assert re.findall(r"<td>(\d+)</td>", shown) == [str(counts[verdict]) for verdict in Verdict]
    assert section.count("<tr><td>") == len(claims)
    assert section.count("<details>") == 1
    assert 'class="misprint">misprint' in section


def test_no_section_for_a_scene_of_ones_own(result: Study) -> None:
    html = page(replace(result, scene=replace(result.scene, file="crank_press.toml")))
    assert HEADING not in html
    assert 'class="audit"' not in html


def test_the_section_runs_no_engine_and_no_oracle(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are what would make every report of an audited scene slower by a second."""

    def refused(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr("compare.engines.runner.run", refused)
    monkeypatch.setattr("compare.audit.clamp.run", refused)
    monkeypatch.setattr("compare.engines.reference.establish", refused)
    for source in SCENES:
        assert claims_of(source)
