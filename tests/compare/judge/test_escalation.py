"""What is tried after a failure, and what is said of it."""

from dataclasses import dataclass, field, replace
from math import nan

import pytest

from compare.engines.runner import Run
from compare.judge.errors import ChannelError
from compare.judge.escalation import escalated, offers
from compare.judge.measure import Measurement
from scenes import Settings, Status

FAST, BALANCED, EXACT = (
    Settings(*of[:1], promise=of[1]) for of in (("fast", 1e-2), ("balanced", 1e-3), ("exact", 1e-6))
)


@dataclass
class Engine:
    """One whose settings end as told; it remembers which were tried."""

    ends: dict[str, Status]
    errors: dict[str, float] = field(default_factory=dict)  # the largest, where they return a motion

    def __post_init__(self) -> None:
        self.tried: list[str] = []

    def __call__(self, settings: Settings) -> Measurement:
        self.tried.append(settings.label)
        status = self.ends.get(settings.label, Status.ok)
        reason = "" if status is Status.ok else f"{settings.label} is not enough"
        off = [self.errors[settings.label]] if settings.label in self.errors else []
        row = ChannelError._make([nan] * len(ChannelError._fields))._replace(group="velocity")
        return Measurement(Run("x", settings, status, reason), None, [], [row._replace(max=error) for error in off])


@pytest.fixture(autouse=True)
def tiers(monkeypatch: pytest.MonkeyPatch) -> None:
    offered = {"fast": FAST, "balanced": BALANCED, "exact": EXACT}
    monkeypatch.setattr("compare.judge.escalation.tiers", lambda _: offered)


def test_all_are_held_to_the_promise_asked_for() -> None:
    assert [(s.label, s.promise) for s in offers("x", "balanced")] == [(s, 1e-3) for s in ("balanced", "exact", "fast")]
    assert [(s.label, s.promise) for s in offers("x", "fast")] == [(s, 1e-2) for s in ("fast", "balanced", "exact")]


def test_what_is_ok_is_not_tried_again() -> None:
    engine = Engine({})
    measured, said = escalated(engine, offers("x", "balanced"))
    assert engine.tried == ["balanced"]
    assert measured.run.status is Status.ok
    assert said == ""


def test_the_next_that_is_ok_is_taken() -> None:
    engine = Engine({"fast": Status.wrong_branch, "balanced": Status.not_converged})
    measured, said = escalated(engine, offers("x", "fast"))
    assert engine.tried == ["fast", "balanced", "exact"]
    assert measured.run.settings == replace(EXACT, promise=1e-2)
    assert said == (
        "x: fast ended wrong_branch, fast is not enough; balanced ended not_converged, balanced is not enough;"
        " so exact was taken"
    )


def test_where_nothing_helps_the_first_stays() -> None:
    engine = Engine(dict.fromkeys(("fast", "balanced", "exact"), Status.diverged))
    measured, said = escalated(engine, offers("x", "balanced"))
    assert measured.run.settings == BALANCED
    assert said.endswith("exact ended diverged, exact is not enough; fast ended diverged, fast is not enough")


@pytest.mark.parametrize(
    ("errors", "finer"),
    [
        ({"balanced": 0.5, "exact": 0.07, "fast": 0.6}, "exact leave 14.0%"),
        ({"balanced": 0.5, "exact": 0.08, "fast": 0.6}, ""),
        ({"balanced": 0.5, "fast": 0.6}, ""),
        ({"exact": 0.07, "fast": 0.6}, ""),
        ({"balanced": 0.5, "exact": float("nan"), "fast": 0.6}, ""),
        ({"balanced": float("nan"), "exact": 0.07, "fast": 0.6}, ""),
        ({"balanced": 0.0, "exact": 0.0, "fast": 0.0}, ""),
    ],
)
def test_settings_that_leave_hardly_any_of_the_error_are_named(errors: dict[str, float], finer: str) -> None:
    engine = Engine(dict.fromkeys(("fast", "balanced", "exact"), Status.inaccurate), errors)
    assert escalated(engine, offers("x", "balanced"))[0].finer == finer


@pytest.mark.parametrize("status", [Status.cannot_assemble, Status.crashed, Status.timed_out])
def test_what_accuracy_cannot_help_is_not_tried_again(status: Status) -> None:
    engine = Engine({"balanced": status})
    escalated(engine, offers("x", "balanced"))
    assert engine.tried == ["balanced"]


def test_where_the_more_accurate_fail_a_cheaper_one_may_hold() -> None:
    engine = Engine({"balanced": Status.inaccurate, "exact": Status.inconsistent})
    measured, said = escalated(engine, offers("x", "balanced"))
    assert measured.run.settings == replace(FAST, promise=1e-3)
    assert said.endswith("so fast was taken")
