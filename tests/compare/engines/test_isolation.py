"""Worker processes: whatever happens in one is an outcome, and the others go on."""

from collections.abc import Iterator

import pytest

from compare.engines.isolation import Ended, Limits, isolated
from compare.engines.stopping import Stopped, kept
from scenes import Status
from tests.worst_cases import do

ENDS = {
    "abort": (Status.crashed, "its process ended by SIGABRT"),
    "segfault": (Status.crashed, "its process ended by SIGSEGV"),
    "exit": (Status.crashed, "its process ended by exit status 3"),
    "hang": (Status.timed_out, "no answer within 10 s"),
    "spin": (Status.timed_out, "no answer within 1 s of processor time"),
    "eat": (Status.crashed, "it needed more than 2 GiB of memory"),
    "raise": (Status.crashed, "ValueError: first line"),
}
LIMITS = Limits(seconds=1.0, memory=2 * 2**30)


def test_nothing_is_lost() -> None:
    items = ["a", *ENDS, "b", "c"]
    results = dict(isolated(do, items, LIMITS, lambda: None))
    assert {item: results[item] for item in ENDS} == {item: Ended(*end) for item, end in ENDS.items()}
    assert {item: results[item] for item in "abc"} == {"a": "A", "b": "B", "c": "C"}


def test_a_stop_ends_what_runs() -> None:
    """The one that hangs would take ten minutes."""

    def poll() -> None:
        if done:
            raise Stopped

    done: list[str] = []

    def collect() -> Iterator[str]:
        for item, _ in kept(isolated(do, ["a", "hang", "hang"], Limits(seconds=600.0, workers=1), poll)):
            done.append(item)
            yield item

    assert list(collect()) == ["a"]


@pytest.mark.parametrize("memory", [2**30, 2**31])
def test_the_memory_limit_is_told(memory: int) -> None:
    ((_, ended),) = isolated(do, ["eat"], Limits(memory=memory), lambda: None)
    assert isinstance(ended, Ended)
    assert f"{memory // 2**30} GiB" in ended.reason
