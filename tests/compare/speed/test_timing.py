"""The clock: how runs take turns under it, and when their times count as known."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

import pytest

from compare.engines.runner import Run
from compare.measure.speed.speed_table import Budget, spent, take_turns
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
    jobs: Sequence[Job], budget: Budget, in_doubt: Callable[[Sequence[float]], Sequence[int]], first: float = 0.0
) -> tuple[list[list[Run]], str]:
    """The times, and the engines in the order in which they ran, a bar after each batch; warming up took `first` s."""
    ran: list[str] = []
    runs = [Run(job.engine, None, Status.ok, build_s=0.0, solve_s=first, read_s=0.0) for job in jobs]

    def again(numbers: Sequence[int]) -> list[Run]:
        ran.extend((*(jobs[number].engine for number in numbers), "|"))
        return [jobs[number].run() for number in numbers]

    return take_turns(runs, again, budget, quiet, in_doubt), "".join(ran)


def all_of(times: Sequence[float]) -> Sequence[int]:
    return range(len(times))


def none_of(_: Sequence[float]) -> Sequence[int]:
    return ()


def only_b(_: Sequence[float]) -> Sequence[int]:
    return (1,)


NEVER_KNOWN = [n / 20 for n in range(1, 99)]  # s; three of them are taken in any case
ALIKE, UNLIKE = ("a", [1.0]), ("b", [3.0, 1.0, 2.0, 1.01, 5.0, 1.019, 1.0])  # known after 3 rounds, and after 6
SLOW, BATCH = [("a", [0.3]), ("b", [2.0])], [("a", [0.02, 0.015, 0.01])] * 3
Jobs = Sequence[tuple[str, Sequence[float]]]


@pytest.mark.parametrize(
    ("jobs", "budget", "in_doubt", "rounds", "order"),
    [
        ([(engine, [1.0]) for engine in "aabc"], Budget(10, inf), all_of, [3] * 4, "aa|b|c|" * 3),
        ([ALIKE, UNLIKE], Budget(100, inf), all_of, [3, 6], "a|b|" * 3 + "b|" * 3),
        ([("a", [1.0, 0.5, 1.0])], Budget(8, inf), all_of, [8], "a|" * 8),  # a lucky time has to come again
        ([("a", NEVER_KNOWN)], Budget(0, 0.0, full=True), all_of, [3], "a|" * 3),
        ([("a", NEVER_KNOWN)], Budget(99, 0.35, full=True), all_of, [5], "a|" * 5),
        ([("a", NEVER_KNOWN)], Budget(5, inf), all_of, [5], "a|" * 5),
        # Of two settings each has half of the time: three rounds of 0.3 s, of 2 s as many as it lasts for, or one.
        (SLOW, Budget(20, 2.0, full=True), none_of, [3, 1], "a|b|a|a|"),
        (SLOW, Budget(20, 9.0, full=True), none_of, [3, 2], "a|b|a|b|a|"),
        (SLOW, Budget(20, 12.0, full=True), none_of, [3, 3], "a|b|" * 3),
        # Two of three settings, of 0.01 s each, begin within 0.015 s: a batch ends with the budget.
        (BATCH, Budget(99, 0.015, full=True), all_of, [4, 4, 3], "aaa|aaa|aaa|aa|"),
        # One round is enough for what decides nothing; what decides goes on until it is known.
        ([ALIKE, UNLIKE], Budget(20, inf), none_of, [1, 1], "a|b|"),
        ([ALIKE, UNLIKE], Budget(20, inf), only_b, [1, 6], "a|b|" + "b|" * 5),
        # No run begins that would end after the time for all of them.
        ([("a", [1.0]), ("b", [1.0])], Budget(20, inf, most_s=3.5), all_of, [2, 1], "a|b|a|"),
    ],
)
def test_rounds_go_on_until_the_fastest_time_is_known_or_the_budget_ends(
    jobs: Jobs, budget: Budget, in_doubt: Callable[[Sequence[float]], Sequence[int]], rounds: list[int], order: str
) -> None:
    times, ran = turns([Job(*job) for job in jobs], budget, in_doubt)
    assert ([len(of) for of in times], ran) == (rounds, order)


def test_build_and_solve_are_timed_apart() -> None:
    (times,), _ = turns([Job("a", [2.0], build=1.0)], Budget(10, inf), all_of)
    assert [(run.build_s, run.solve_s, run.wall_s) for run in times] == [(1.0, 2.0, 4.0)] * 3
    assert spent(times) == 9


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


def test_only_what_is_in_doubt_is_timed_longer() -> None:
    """`a` and `c` are never known; `b` decides until its fastest solve is 4 s, `c` never."""
    seen = []
    jobs = [Job("a", [1.0]), Job("b", [7.0, 6.0, 5.0, 4.0]), Job("c", [3.0, 2.0, 1.0])]

    def in_doubt(times: Sequence[float]) -> Sequence[int]:
        seen.append(list(times))
        return [1] if times[1] > 4 else []

    times, ran = turns(jobs, Budget(10, inf, full=True), in_doubt)
    assert ([len(of) for of in times], ran) == ([3, 4, 3], "a|b|c|" * 3 + "b|")
    assert seen[:2] == [[1.0, 5.0, 1.0], [1.0, 4.0, 1.0]]
