"""What is tried after a failure, and what is said of it."""

from dataclasses import dataclass

import pandas as pd
import pytest

from compare.engines.runner import Run
from compare.judge.escalation import escalated
from compare.judge.measure import Measurement
from scenes import Settings, Status

FAST, BALANCED, EXACT = Settings("fast"), Settings("balanced"), Settings("exact")


@dataclass
class Engine:
    """One whose settings end as told; it remembers which were tried."""

    ends: dict[str, Status]

    def __post_init__(self) -> None:
        self.tried: list[str] = []

    def __call__(self, settings: Settings) -> Measurement:
        self.tried.append(settings.label)
        status = self.ends.get(settings.label, Status.ok)
        reason = "" if status is Status.ok else f"{settings.label} is not enough"
        return Measurement(Run("x", settings, status, reason), None, [], pd.DataFrame())


@pytest.fixture(autouse=True)
def tiers(monkeypatch: pytest.MonkeyPatch) -> None:
    offered = {"fast": FAST, "balanced": BALANCED, "exact": EXACT}
    monkeypatch.setattr("compare.judge.escalation.tiers", lambda _: offered)


def test_what_is_ok_is_not_tried_again() -> None:
    engine = Engine({})
    measured, said = escalated(engine, "x", BALANCED)
    assert engine.tried == ["balanced"]
    assert measured.run.status is Status.ok
    assert said == ""


def test_the_next_that_is_ok_is_taken() -> None:
    engine = Engine({"fast": Status.wrong_branch, "balanced": Status.not_converged})
    measured, said = escalated(engine, "x", FAST)
    assert engine.tried == ["fast", "balanced", "exact"]
    assert measured.run.settings == EXACT
    assert said == (
        "x: fast ended wrong_branch, fast is not enough; balanced ended not_converged, balanced is not enough;"
        " so exact was taken"
    )


def test_where_nothing_helps_the_first_stays() -> None:
    engine = Engine(dict.fromkeys(("balanced", "exact"), Status.diverged))
    measured, said = escalated(engine, "x", BALANCED)
    assert measured.run.settings == BALANCED
    assert said.endswith("exact ended diverged, exact is not enough")


@pytest.mark.parametrize("status", [Status.unsupported, Status.cannot_assemble, Status.crashed, Status.timed_out])
def test_what_accuracy_cannot_help_is_not_tried_again(status: Status) -> None:
    engine = Engine({"balanced": status})
    escalated(engine, "x", BALANCED)
    assert engine.tried == ["balanced"]


def test_settings_without_a_name_are_followed_by_the_most_accurate() -> None:
    engine = Engine({"other": Status.diverged})
    escalated(engine, "x", Settings("other"))
    assert engine.tried == ["other", "exact"]
