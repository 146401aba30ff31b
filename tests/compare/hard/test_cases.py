"""Hard cases: how an attempt is judged, and that nothing that was done is lost."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import scenes
from compare.engines import registry
from compare.engines.processes.inside import Ended, Limits
from compare.engines.processes.stopping import Stopped
from compare.measure.hard import case as hard
from compare.measure.hard.case import Case, examine
from compare.report.pages.html import render
from compare.report.pages.report import in_full
from compare.report.tables import hard as hard_tables
from scenes import Failure, Motion, Sampling, Settings, Status
from scenes.hard import ladder as read
from tests import scene_files
from tests.comparisons import Plug, Stub, changed

LADDER = (scene_files.FOLDER / "ladders" / "rod.toml").read_text(encoding="utf-8")


@pytest.fixture
def ladder(tmp_path: Path) -> str:
    file = tmp_path / "rod.toml"
    file.write_text(LADDER, encoding="utf-8")
    return str(file)


def examined_on(ladder: str, rung: str, engine: str) -> list[dict[str, Any]]:
    return examine({ladder: read(ladder)}, Case(ladder, rung, engine))


@pytest.fixture
def judge(ladder: str, plug: Plug, monkeypatch: pytest.MonkeyPatch) -> Callable[..., dict[str, Any]]:
    """Return a function that has an engine, which promises 1e-3, end as told on a rung, and returns the row."""
    for tier in ("FAST", "DEFAULT", "EXACT"):
        monkeypatch.setattr(Stub, tier, Settings("stub", promise=1e-3))

    def judge(outcome: Motion | Failure, rung: str = "as_is") -> dict[str, Any]:
        plug(outcome)
        (row,) = examined_on(ladder, rung, "stub")
        return row

    return judge


@pytest.fixture(scope="module")
def right() -> Motion:
    scene, sampling = scenes.load("toggle_press"), Sampling(hard.SAMPLES)
    return registry.reference(scene)(sampling.inputs(scene))


def told(row: dict[str, Any]) -> tuple[str, str, str]:
    return row["status"], row["outcome"], row["found_by"]


def test_what_is_right_is_right(judge: Callable[..., dict[str, Any]], right: Motion) -> None:
    row = judge(right)
    assert told(row) == ("ok", "right", "")
    assert row["reaction_max"] <= 1e-12
    assert 10 < row["condition"] < 100
    assert 0 < row["to_lock_m"] < 1


def test_wrong_answers_and_refusals_are_told_apart(judge: Callable[..., dict[str, Any]], right: Motion) -> None:
    """A wrong answer is found by itself, however little it is off its promise; another assembly by the reference."""

    def off(channel: str, by: float) -> Motion:
        return changed(right, channel, by * float(np.abs(right[channel]).max()))

    for channel, by in (("P3.fx", 2e-3), ("P5.ay", 0.02), ("P5.ay", 10.0), ("P4.x", 0.5), ("P4.x", 2e-3)):
        status, *found = told(judge(off(channel, by)))
        assert (status != "ok", *found) == (True, "refused", "checks"), (channel, by)
    upward = scene_files.load("toggle_press", {"sketch.P5": [0, -400]})
    other = registry.reference(upward)(right.inputs(upward))
    assert told(judge(other)) == ("wrong_branch", "silent", "reference")
    for rings, outcome in ((off("P3.fx", 0.1), "refused"), (None, "refused"), (right, "false alarm")):
        row = judge(Failure(Status.not_converged, "it rings", rings))
        assert told(row) == ("not_converged", outcome, "engine")
    denied = judge(Failure(Status.cannot_assemble, "they do not fit"))
    assert told(denied) == ("cannot_assemble", "false alarm", "engine")
    assert told(judge(right, "locking")) == ("diverged", "refused", "checks"), "where nothing moves"
    assert told(judge(Failure(Status.diverged, "no"), "locking")) == ("diverged", "refused", "engine")


def test_the_reference_is_held_to_arbitrary_precision(ladder: str) -> None:
    for rung, *expected in (("as_is", "ok", "right"), ("locking", "cannot_assemble", "refused")):
        (row,) = examined_on(ladder, rung, "analytic")
        assert [row["status"], row["outcome"]] == expected


def test_a_reference_that_is_off_is_silent(ladder: str, monkeypatch: pytest.MonkeyPatch) -> None:
    real = registry.reference

    def wrong(scene: scenes.Scene, _: frozenset[str] | None = None) -> registry.Solve:
        return lambda inputs: changed(real(scene)(inputs), "P3.fx", 1e-3, row=5)

    monkeypatch.setattr(registry, "reference", wrong)
    monkeypatch.setattr(registry, "check_way", lambda _: None)
    exact = "compare.mechanics.round_off._sensitivity"
    monkeypatch.setattr(exact, lambda _, true: dict.fromkeys(true.samples, 0 * true["time"]))
    (row,) = examined_on(ladder, "as_is", "analytic")
    assert row["outcome"] == "silent"
    assert "P3.fx" in row["reason"]


def test_an_expectation_that_does_not_hold_is_told(ladder: str) -> None:
    file = Path(ladder)
    file.write_text(LADDER.replace('locking = "cannot_assemble"', 'shorter = "cannot_assemble"'), encoding="utf-8")
    assert examined_on(ladder, "shorter", "analytic")[0]["outcome"] == "silent"
    assert examined_on(ladder, "locking", "analytic")[0]["outcome"] == "false alarm"


@pytest.fixture
def examined(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Run cases at once in this process; return where the names of those that were will be."""
    done: list[str] = []

    def at_once(
        _: object, items: Sequence[Case], __: Limits, poll: Callable[[], None]
    ) -> Iterator[tuple[Case, list[dict[str, Any]] | Ended]]:
        for case in items:
            poll()
            done.append(f"{case.rung} {case.engine}")
            row = hard.case_row(case, "ok", "", "", hard.Outcome.right)
            yield case, Ended(Status.timed_out, "too slow") if case.rung == "locking" else [row]

    monkeypatch.setattr(hard, "isolated", at_once)
    return done


def test_a_stopped_run_goes_on_where_it_was(ladder: str, tmp_path: Path, examined: list[str]) -> None:
    def progress(doing: str) -> None:
        if "2 of 6" in doing:
            raise Stopped

    first = hard.hard_cases([ladder], ["analytic", "exudyn"], tmp_path, progress, print)
    assert examined == ["shorter analytic", "shorter exudyn"]
    assert list(first["rung"]) == ["shorter", "shorter"]
    examined.clear()
    second = hard.hard_cases([ladder], ["analytic", "exudyn"], tmp_path, lambda _: None, print)
    assert examined == ["as_is analytic", "as_is exudyn", "locking analytic", "locking exudyn"]
    assert list(second["rung"]) == ["shorter", "shorter", "as_is", "as_is", "locking", "locking"]
    assert list(second["outcome"][4:]) == ["not certified", "refused"]
    assert list(second["status"][4:]) == ["timed_out"] * 2
    examined.clear()
    assert hard.hard_cases([ladder], ["analytic", "exudyn"], tmp_path, lambda _: None, print).equals(second)
    assert examined == []
    hard.forget(tmp_path)
    hard.hard_cases([ladder], ["analytic"], tmp_path, lambda _: None, print)
    assert len(examined) == 3


def test_counts_and_verdict(ladder: str, tmp_path: Path, examined: list[str]) -> None:
    cases = hard.hard_cases([ladder], ["analytic", "exudyn"], tmp_path, lambda _: None, print)
    assert examined
    by_engine = {row["engine"]: row for row in hard_tables.counts(cases)}
    assert by_engine["analytic"]["not certified"] == 1
    assert by_engine["exudyn"]["by isolation"] == 1
    assert by_engine["exudyn"]["right"] == 2
    said = hard_tables.verdict(cases.assign(outcome=["silent", *cases["outcome"][1:]]))
    assert said == (
        "6 runs of 3 linkages, in 1 series from easy to impossible:"
        " 1 wrong results passed for right ones, 0 right results were refused."
    )
    ((shown, table),) = hard_tables.ladders(cases)
    assert shown.file.title == "Rod"
    assert [row["length of the rod, mm"] for row in table] == ["shorter", "as_is", "locking"]
    assert [row["exudyn"] for row in table] == ["ok", "ok", "timed_out (isolation)"]


def test_digits_are_counted_where_the_ladder_asks(ladder: str, monkeypatch: pytest.MonkeyPatch) -> None:
    file = Path(ladder)
    file.write_text(LADDER.replace("[steps]", "digits = true\n[steps]"), encoding="utf-8")
    monkeypatch.setattr("compare.measure.hard.digits.AROUND", np.array([1e-3]))  # few positions do here
    (row,) = examined_on(ladder, "as_is", "analytic")
    assert row["outcome"] == "right"
    assert 0 <= row["acceleration_lost"] <= row["acceleration_allowed"] <= 4
    (digits,) = hard_tables.digits(pd.DataFrame([row]))
    assert list(digits)[3:] == ["position", "velocity", "acceleration", "reaction", "torque"]
    monkeypatch.setattr(hard, "digits_lost", lambda _: {"velocity": {"lost": 5.0, "allowed": 2.0}})
    (row,) = examined_on(ladder, "as_is", "analytic")
    assert (row["outcome"], row["reason"]) == ("silent", "velocity loses 5.0 digits")


def study_of(cases: pd.DataFrame) -> Any:
    return SimpleNamespace(hard=cases, maps=pd.DataFrame())


def test_the_section_of_the_report(ladder: str, judge: Callable[..., dict[str, Any]], right: Motion) -> None:
    rows = [judge(right), judge(Failure(Status.wrong_branch, "it flips")), *examined_on(ladder, "as_is", "analytic")]
    html = render("hard.html", **in_full(study_of(pd.DataFrame(rows))))
    assert "3 runs of 1 linkages" in html
    assert "0 wrong results passed for right ones, 0 right results were refused." in html
    assert "All solve it." in html
    assert "then wrong_branch" in html
    assert not render("hard.html", **in_full(study_of(pd.DataFrame()))).strip()
