"""Processes of their own: whatever happens in one is an outcome, and the others go on."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from compare.engines.isolation import Ended, Limits, isolated
from compare.engines.stopping import Stopped, kept
from scenes import Status
from tests.deaths import DEATHS, MEMORY, TWELVE, alive, children, within

LIMITS = Limits(seconds=0.5, memory=MEMORY)


def do(what: str) -> str:
    if what in DEATHS:
        DEATHS[what][0]()
    return what.upper()


def test_nothing_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compare.engines.isolation.WAIT", 1e3)  # on a busy machine too the processor time ends hangs
    items = ["a", *TWELVE, "b", "c"]
    results = dict(isolated(do, items, LIMITS, lambda: None))
    for death, (_, status, reason) in TWELVE.items():
        ended = results[death]
        assert isinstance(ended, Ended)
        assert ended.status is status
        assert reason in ended.reason
        assert ended.at_limit == (death in ("hang in Python", "hang in C", "memory"))
    assert {item: results[item] for item in "abc"} == {"a": "A", "b": "B", "c": "C"}
    assert children() == []


@pytest.mark.parametrize(
    ("death", "wait", "reason"),
    [
        ("hang in Python", 1e3, "no answer within 0.2 s of processor time"),
        ("hang in C", 1e3, "no answer within 0.2 s of processor time"),
        ("asleep", 1.0, "no answer within 0.2 s"),
        ("asleep in C", 1.0, "no answer within 0.2 s"),
    ],
)
def test_the_time_limits(death: str, wait: float, reason: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compare.engines.isolation.WAIT", wait)
    ((_, ended),) = isolated(do, [death], Limits(seconds=0.2), lambda: None)
    assert ended == Ended(Status.timed_out, reason, at_limit=True)


def test_a_stop_ends_what_runs() -> None:
    """The one that hangs would take half an hour."""

    def poll() -> None:
        if done:
            raise Stopped

    done: list[str] = []

    def collect() -> Iterator[str]:
        for item, _ in kept(isolated(do, ["a", "asleep in C", "b"], Limits(seconds=600.0, workers=1), poll)):
            done.append(item)
            yield item

    assert list(collect()) == ["a"]
    assert children() == []


@pytest.mark.parametrize("memory", [2**30, 2**31])
def test_the_memory_limit_is_named(memory: int) -> None:
    ((_, ended),) = isolated(do, ["memory"], Limits(memory=memory), lambda: None)
    assert isinstance(ended, Ended)
    assert f"{memory // 2**30} GiB" in ended.reason


def test_processes_that_are_begun_anew_answer_die_and_end_with_their_parent() -> None:
    """As they are off Linux, where no processor time of another process is known."""
    command = [sys.executable, "-m", "tests.spawned"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, cwd=Path(__file__).parents[3], text=True) as process:
        assert process.stdout is not None
        *found, begun = (process.stdout.readline().strip() for _ in range(5))
        process.kill()
    assert found == [
        "a: A",
        "SystemExit: SystemExit: bye",
        "asleep: no answer within 0.3 s",
        "abort: its process ended by SIGABRT",
    ]
    assert within(5.0, lambda: not alive(int(begun)))
