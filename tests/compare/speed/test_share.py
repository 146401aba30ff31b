"""What a speed table takes of the run that it is part of: the main runs, and a share of the processor time."""

from dataclasses import replace
from html import unescape
from math import inf

import numpy as np
import pytest

from compare.judge.measure import measure
from compare.measure.speed.share import LEFT_OUT, MAX_SHARE
from compare.measure.speed.speed_table import NO_CLOCK, Budget, speed_table
from compare.mechanics.reference import Reference
from compare.report.pages.report import page
from compare.report.tables import speed as speed_tables
from compare.study import study
from scenes import Sampling
from tests.comparisons import sampled

from .stubs import StubEngine, StubRun, quiet, rows_of, second_order, study_of


def told_what_runs(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the settings that are solved from now on, as they are."""
    solved_now, solve = list[str](), StubRun.solve

    def told(run: StubRun) -> None:
        solved_now.append(run.settings.label)
        solve(run)

    monkeypatch.setattr(StubRun, "solve", told)
    return solved_now


def test_a_table_takes_its_share_and_names_what_did_not_fit(
    reference: Reference, stub: StubEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The rest took 3 s, so that a third is 1.5 s: for the errors 1.125 s, of which 0.072 and 0.144 s are two settings.

    3600 steps take 3.6 s, by what a step took before, and are not begun; 216 steps, which come after, still fit.
    """
    settings = (*map(second_order, (72, 144, 3600)), second_order(216, note="noted"))
    monkeypatch.setattr(StubEngine, "WORK_PRECISION", settings)
    ran = told_what_runs(monkeypatch)
    stub.clock.now = 5.0
    budget = Budget(rounds=99, seconds=inf, share=MAX_SHARE, since=2.0)
    speed = speed_table(reference, ["stub"], budget, quiet)
    assert stub.clock.now - 5.0 <= 1.5
    rows = {row.setting: row for row in speed}
    assert list(rows) == [each.label for each in settings]
    assert (rows["3600 steps"].status, rows["3600 steps"].reason) == ("timed_out", LEFT_OUT)
    assert rows["3600 steps"].timed_runs == 0
    assert "3600 steps" not in ran
    assert rows["216 steps, noted"].status == "ok"
    assert rows["72 steps"].timed_runs >= 2
    said = speed_tables.left_out(study_of(reference, speed))
    assert said.startswith("Speed against error is of all but 1 of 4 settings")
    assert said.endswith("; --full has it (stub: 3600 steps).")
    whole = study(reference.scene, ["analytic"], Sampling(72), NO_CLOCK, quiet)
    shown = replace(whole, speed=[replace(row, engine="analytic") for row in speed])
    assert speed_tables.left_out(shown) in unescape(page(shown))
    everything = speed_table(reference, ["stub"], replace(budget, share=1.0, seconds=0.0, rounds=0), quiet)
    assert {row.status for row in everything} == {"ok"}
    assert speed_tables.left_out(study_of(reference, everything)) == ""


@sampled(2)
@pytest.mark.usefixtures("stub")
@pytest.mark.parametrize(("samples", "times"), [(72, 0), (360, 0), (180, 1), (90, 1)])
def test_a_main_run_with_the_same_steps_and_samples_is_not_run_twice(
    reference: Reference, monkeypatch: pytest.MonkeyPatch, samples: int, times: int
) -> None:
    """Its 360 steps are as many with 72, 180 and 360 samples; 72 are every 5th of 360, and among 180 and 90 are not."""
    monkeypatch.setattr(StubEngine, "WORK_PRECISION", (second_order(72), second_order(360)))
    monkeypatch.setattr(StubEngine, "DEFAULT", second_order(360))
    alone = rows_of(speed_table(reference, ["stub"], NO_CLOCK, quiet))["360 steps"]
    main = measure(reference, "stub", Sampling(samples), StubEngine.DEFAULT)
    ran = told_what_runs(monkeypatch)
    speed = speed_table(reference, ["stub"], NO_CLOCK, quiet, main=[main])
    assert (ran.count("360 steps"), ran.count("72 steps")) == (times, 1)
    row = rows_of(speed)["360 steps"]
    assert row["status"] == "ok"
    assert row["reaction_max"] == alone["reaction_max"]
    assert row["steps_made"] == alone["steps_made"]
    assert np.isnan(row["build_s"]) == (times == 0)
    assert row["samples_a_turn"] == (samples if times == 0 else 72)  # that its time is of
