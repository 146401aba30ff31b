"""The budget of processor time: it lasts as long as it should, and what ends with it names what it was doing."""

from itertools import count
from math import inf

import pytest

from scenes import Failure, ProcessorBudget, Status
from scenes.model import engine as clock


def test_a_budget_lasts_for_its_seconds_and_names_the_task_and_its_progress(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = count(100.0, 1.0)  # s; the clock of a process does not begin at zero
    monkeypatch.setattr(clock, "process_time", lambda: next(ticks))
    monkeypatch.setattr(clock, "perf_counter", lambda: inf)  # the time on the wall is long over
    budget = ProcessorBudget(4.5, "the run-up")
    for done in range(4):
        budget.check(f"{done} of 10 steps are done")
    with pytest.raises(Failure) as failure:
        budget.check("4 of 10 steps are done")
    assert failure.value.status is Status.timed_out
    assert failure.value.reason == "4.5 s of processor time were not enough for the run-up: 4 of 10 steps are done"


def test_processor_time_is_asked_for_only_when_the_time_on_the_wall_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter((7.0,))  # of the process, at the start alone
    monkeypatch.setattr(clock, "process_time", lambda: next(times))
    budget = ProcessorBudget(60.0, "the run-up")
    for _ in range(3):
        budget.check("")
