"""What is tried after a failure, and what is said of it."""

from dataclasses import dataclass, field, replace
from math import nan

import pytest

from compare.engines.runner import Run
from compare.judge.errors import ChannelError
from compare.judge.measure import Measurement, escalated, offers
from scenes import Settings, Status

TIERS = {name: Settings(name, promise=by) for name, by in (("fast", 1e-2), ("balanced", 1e-3), ("exact", 1e-6))}


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
    monkeypatch.setattr("compare.judge.measure.tiers", lambda _: TIERS)


def test_all_are_held_to_the_promise_asked_for() -> None:
    assert [(s.label, s.promise) for s in offers("x", "balanced")] == [(s, 1e-3) for s in ("balanced", "exact", "fast")]
    assert [(s.label, s.promise) for s in offers("x", "fast")] == [(s, 1e-2) for s in ("fast", "balanced", "exact")]


WRONG, SLOW, AWAY = Status.wrong_branch, Status.not_converged, Status.diverged
TAKEN = [  # the accuracy asked for, how settings end, which are tried, which is taken, and how the sentence ends
    ("balanced", {}, ["balanced"], "balanced", ""),
    (
        "fast",
        {"fast": WRONG, "balanced": SLOW},
        ["fast", "balanced", "exact"],
        "exact",
        "x: fast ended wrong_branch, fast is not enough; balanced ended not_converged, balanced is not enough;"
        " so exact was taken",
    ),
    ("balanced", {"balanced": WRONG, "exact": SLOW}, ["balanced", "exact", "fast"], "fast", "so fast was taken"),
    (
        "balanced",
        dict.fromkeys(("fast", "balanced", "exact"), AWAY),
        ["balanced", "exact", "fast"],
        "balanced",
        "balanced ended diverged, balanced is not enough; exact ended diverged, exact is not enough;"
        " fast ended diverged, fast is not enough",
    ),
    *(  # what accuracy cannot help
        ("balanced", {"balanced": status}, ["balanced"], "balanced", "")
        for status in (Status.cannot_assemble, Status.crashed, Status.timed_out)
    ),
]


@pytest.mark.parametrize(("asked", "ends", "tried", "taken", "end"), TAKEN)
def test_what_is_tried_and_taken(asked: str, ends: dict[str, Status], tried: list[str], taken: str, end: str) -> None:
    engine = Engine(ends)
    measured, sentence = escalated(engine, offers("x", asked))
    assert engine.tried == tried
    assert measured.run.settings == replace(TIERS[taken], promise=TIERS[asked].promise)
    assert measured.run.status is ends.get(taken, Status.ok)
    assert sentence.endswith(end)
    assert bool(sentence) == (len(tried) > 1)


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
