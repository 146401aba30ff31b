"""The clock: how runs take turns under it, and when their times count as known."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

import pytest

from compare.engines.runner import Run
from compare.measure.speed.timing import Budget, Times, take_turns
from scenes import Status

from .stubs import quiet


@dataclass
class Job:
    """A setting that takes the given times to solve, then the last one again and again."""

    engine: str
    solves: Sequence[float]
    build: float = 0.0
    done: int = 0

    def run(self) -> Run:
        solve = self.solves[min(self.done, len(self.solves) - 1)]
        self.done += 1
        return Run(self.engine, None, Status.ok, build_s=self.build, solve_s=solve, wall_s=2 * solve)


def turns(
    jobs: Sequence[Job],
    budget: Budget,
    in_doubt: Callable[[Sequence[float]], Sequence[int]],
    first: float = 0.0,
) -> tuple[list[Times], str]:
    """Return the times, and the engines in the order in which they ran; a bar ends each batch.

    The runs that warmed everything up took `first` s.
    """
    ran: list[str] = []
    runs = [Run(job.engine, None, Status.ok, build_s=0.0, solve_s=first, read_s=0.0) for job in jobs]

    def again(numbers: Sequence[int]) -> list[Run]:
        ran.extend((*(jobs[number].engine for number in numbers), "|"))
        return [jobs[number].run() for number in numbers]

    times = take_turns(runs, again, budget, quiet, in_doubt)
    return times, "".join(ran)


def all_of(times: Sequence[float]) -> Sequence[int]:
    return range(len(times))


def test_settings_take_turns_in_batches_of_one_engine() -> None:
    _, ran = turns([Job(engine, [1.0]) for engine in "aabc"], Budget(10, inf), all_of)
    assert ran == "aa|b|c|" * 3


def test_build_and_solve_are_timed_apart() -> None:
    (times,), _ = turns([Job("a", [2.0], build=1.0)], Budget(10, inf), all_of)
    assert [(run.build_s, run.solve_s, run.wall_s) for run in times] == [(1.0, 2.0, 4.0)] * 3
    assert times.spent == 9


def test_rounds_go_on_until_the_fastest_time_is_known() -> None:
    """`a` is known after 3 rounds and drops out; of `b` the three fastest agree after 6."""
    jobs = [Job("a", [1.0]), Job("b", [3.0, 1.0, 2.0, 1.01, 5.0, 1.019, 1.0])]
    times, ran = turns(jobs, Budget(100, inf), all_of)
    assert [len(of) for of in times] == [3, 6]
    assert ran == "a|b|" * 3 + "b|" * 3


def test_a_lucky_time_has_to_come_again() -> None:
    (times,), _ = turns([Job("a", [1.0, 0.5, 1.0])], Budget(8, inf), all_of)
    assert len(times) == 8


@pytest.mark.parametrize(("budget", "runs"), [(Budget(0, 0.0), 3), (Budget(99, 0.35), 5), (Budget(5, inf), 5)])
def test_what_a_budget_ends(budget: Budget, runs: int) -> None:
    """Solves of 0.05, 0.1, 0.15 ... seconds are never known; three of them are taken in any case."""
    (times,), _ = turns([Job("a", [n / 20 for n in range(1, 99)])], budget, all_of)
    assert len(times) == runs


def test_slow_settings_have_fewer_rounds_than_the_least() -> None:
    """Of two settings each has half of the time: three rounds of 0.3 s, of 2 s as many as it lasts for, or one."""
    for budget, rounds in ((Budget(20, 2.0), 1), (Budget(20, 9.0), 2), (Budget(20, 12.0), 3)):
        times, _ = turns([Job("a", [0.3]), Job("b", [2.0])], budget, lambda _: ())
        assert [len(of) for of in times] == [3, rounds]


def test_a_setting_whose_first_run_took_its_share_is_timed_where_it_decides() -> None:
    """Its first run took 0.6 s, of a share of 0.5 s; then it is timed until it is known, in rounds 4 to 6."""
    seen = []

    def never(times: Sequence[float]) -> Sequence[int]:
        seen.append([*times])
        return []

    (times,), _ = turns([Job("a", [0.4])], Budget(20, 0.1), never, first=0.6)
    assert (times, seen[0]) == ([], [0.6])
    (times,), _ = turns([Job("a", [0.4])], Budget(20, 9.0), all_of, first=10.0)
    assert [run.solve_s for run in times] == [0.4] * 3


def test_a_batch_ends_with_the_budget() -> None:
    """Two of three settings, of 0.01 s each, begin within 0.015 s."""
    jobs = [Job("a", [0.02, 0.015, 0.01]) for _ in range(3)]
    times, ran = turns(jobs, Budget(99, 0.015), all_of)
    assert [len(of) for of in times] == [4, 4, 3]
    assert ran == "aaa|aaa|aaa|aa|"


def test_only_what_is_in_doubt_is_timed_longer() -> None:
    """`a` and `c` are never known; `b` decides until its fastest solve is 4 s, `c` never."""
    seen = []
    jobs = [Job("a", [1.0]), Job("b", [7.0, 6.0, 5.0, 4.0]), Job("c", [3.0, 2.0, 1.0])]

    def in_doubt(times: Sequence[float]) -> Sequence[int]:
        seen.append(list(times))
        return [1] if times[1] > 4 else []

    times, ran = turns(jobs, Budget(10, inf), in_doubt)
    assert ran == "a|b|c|" * 3 + "b|"
    assert [len(of) for of in times] == [3, 4, 3]
    assert seen[:2] == [[1.0, 5.0, 1.0], [1.0, 4.0, 1.0]]
