"""The clock: how runs take turns under it, and when their times count as known."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf

import pytest

from compare.speed.timing import Budget, Times, take_turns
from scenes import Motion

from .stubs import Clock, quiet


@dataclass
class Job:
    """A simulation, and what builds it, that takes the given times to solve, then the last one again and again."""

    clock: Clock
    name: str
    solves: Sequence[float]
    build: float = 0.0
    reading: float = 0.0
    done: int = 0
    counters: Mapping[str, int] = field(default_factory=dict)
    residuals: Mapping[str, float] = field(default_factory=dict)

    def __call__(self) -> "Job":
        self.clock.now += self.build
        return self

    def solve(self) -> None:
        self.clock.turns += self.name
        self.clock.now += self.solves[min(self.done, len(self.solves) - 1)]
        self.done += 1

    def read(self) -> Motion:
        self.clock.now += self.reading
        return Motion({})


def turns(jobs: Sequence[Job], budget: Budget, in_doubt: Callable[[Sequence[float]], Sequence[int]]) -> list[Times]:
    return take_turns(jobs, budget, quiet, in_doubt, jobs[0].clock, jobs[0].clock)


def all_of(times: Sequence[float]) -> Sequence[int]:
    return range(len(times))


def test_settings_take_turns() -> None:
    clock = Clock()
    turns([Job(clock, name, [1.0]) for name in "abc"], Budget(10, inf), all_of)
    assert clock.turns == "abcabcabc"


def test_build_solve_and_read_are_timed_apart() -> None:
    clock = Clock()
    (times,) = turns([Job(clock, "a", [2.0], build=1.0, reading=4.0)], Budget(10, inf), all_of)
    assert (times.build, times.solve, times.read) == ([1.0] * 3, [2.0] * 3, [4.0] * 3)


def test_rounds_go_on_until_the_fastest_time_is_known() -> None:
    """`a` is known after 3 rounds and drops out; of `b` the three fastest agree after 6."""
    clock = Clock()
    jobs = [Job(clock, "a", [1.0]), Job(clock, "b", [3.0, 1.0, 2.0, 1.01, 5.0, 1.019, 1.0])]
    times = turns(jobs, Budget(100, inf), all_of)
    assert [len(of.solve) for of in times] == [3, 6]
    assert clock.turns == "abababbbb"


def test_a_lucky_time_has_to_come_again() -> None:
    clock = Clock()
    (times,) = turns([Job(clock, "a", [1.0, 0.5, 1.0])], Budget(8, inf), all_of)
    assert len(times.solve) == 8


@pytest.mark.parametrize(("budget", "runs"), [(Budget(0, 0.0), 3), (Budget(99, 7.0), 5), (Budget(5, inf), 5)])
def test_what_a_budget_ends(budget: Budget, runs: int) -> None:
    """Solves of 1, 2, 3 ... seconds are never known; three of them are taken in any case."""
    clock = Clock()
    (times,) = turns([Job(clock, "a", [float(n) for n in range(1, 99)])], budget, all_of)
    assert len(times.solve) == runs


def test_only_what_is_in_doubt_is_timed_longer() -> None:
    """`a` and `c` are never known; `b` decides until its fastest solve is 4 s, `c` never."""
    clock, seen = Clock(), []
    jobs = [Job(clock, "a", [1.0]), Job(clock, "b", [7.0, 6.0, 5.0, 4.0]), Job(clock, "c", [3.0, 2.0, 1.0])]

    def in_doubt(times: Sequence[float]) -> Sequence[int]:
        seen.append(list(times))
        return [1] if times[1] > 4 else []

    times = turns(jobs, Budget(10, inf), in_doubt)
    assert clock.turns == "abcabcabcb"
    assert [len(of.solve) for of in times] == [3, 4, 3]
    assert seen[:2] == [[1.0, 5.0, 1.0], [1.0, 4.0, 1.0]]
