"""Runs take turns under the clock of what runs them; those whose times decide a comparison, until they are known.

It counts processor time, of all threads together. On an idle machine that is the time on the wall, which stands beside
it; on a busy one other programs make a run wait, and the time on the wall is as much theirs as the run's.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, chain, groupby
from math import inf
from typing import TypeAlias

from ...engines.processes.stopping import Progress, kept
from ...engines.runner import Run

LEAST_ROUNDS = 3  # for a minimum, a median and a spread
PATIENCE = 0.3  # s of processor time for the least rounds, the same for every setting: a slow one is timed less often
# The three fastest solves within this of each other: chance alone would hardly repeat a lucky one. Two runs may be
# three times as far apart and name the same setting, or call both level.
AGREE = 0.05


@dataclass(frozen=True)
class Budget:
    """How much may be spent on speed: `LEAST_ROUNDS`, fewer of slow settings, up to `rounds` while `seconds` last."""

    rounds: int
    seconds: float  # of processor time, of the runs in the rounds beyond the least
    full: bool = False
    point_s: float = 1.0  # of processor time, one run of one setting; what takes longer is not repeated


Again: TypeAlias = Callable[[Sequence[int]], Sequence[Run]]  # runs settings, by their places, one after the other
NO_CLOCK = Budget(rounds=0, seconds=0.0)  # for a speed table whose times are those of the error runs


def spent(runs: Iterable[Run]) -> float:
    """The processor time of runs, s."""
    return sum(run.build_s + run.solve_s for run in runs)


def known(runs: Iterable[Run]) -> bool:
    """Whether the fastest solve was reached again and again."""
    fastest = sorted(run.solve_s for run in runs)[:LEAST_ROUNDS]
    return len(fastest) == LEAST_ROUNDS and fastest[-1] <= (1 + AGREE) * fastest[0]


def take_turns(
    first: Sequence[Run],
    again: Again,
    budget: Budget,
    progress: Progress,
    in_doubt: Callable[[Sequence[float]], Collection[int]],
) -> list[list[Run]]:
    """The runs of every setting in the rounds; none of a slow one that decides nothing.

    One round goes over all settings, so that a slow spell of the machine falls on all of them; each takes part in the
    least number of rounds as far as its share of the patience lasts. After these only those take part that are in
    doubt, given the fastest solve of every setting, s, and whose fastest time is not known yet. A stop leaves the times
    that are known. `first` has the runs that warmed every setting up; those of one engine are neighbours.
    """
    times, engines = [list[Run]() for _ in first], [run.engine for run in first]

    def seconds(n: int) -> float:
        runs = times[n] or [first[n]]
        return spent(runs) / len(runs)

    def fastest(n: int) -> float:
        return min((run.solve_s for run in times[n]), default=first[n].solve_s)

    def batches() -> Iterator[Sequence[int]]:
        every, end = range(len(times)), inf  # of the processor time of all runs, after which none begins
        share, able = max(PATIENCE, budget.seconds) / (len(times) or 1), [*every]
        for done in range(max(LEAST_ROUNDS, budget.rounds)):
            if done == LEAST_ROUNDS:
                end = spent(chain.from_iterable(times)) + budget.seconds
            if done < LEAST_ROUNDS:
                numbers = able = [n for n in able if (done + 1) * seconds(n) <= share]
            else:
                numbers = [n for n in in_doubt([*map(fastest, every)]) if not known(times[n])]
            for _, settings in groupby(numbers, engines.__getitem__):
                batch, left = [*settings], end - spent(chain.from_iterable(times))
                before = accumulate([0.0, *map(fastest, batch)])
                if chosen := [n for n, taken in zip(batch, before, strict=False) if taken < left]:
                    progress(f"timing {len(numbers)} settings, round {done + 1}")
                    yield chosen

    runs = (zip(batch, again(batch), strict=True) for batch in batches())
    for number, run in kept(chain.from_iterable(runs)):
        times[number].append(run)
    return times
