"""The clock: prepared runs take turns under it; those whose times decide a comparison, until they are known.

It counts processor time, of all threads together. On an idle machine that is the time on the wall, which stands beside
it; on a busy one other programs make a run wait, and the time on the wall is as much theirs as the run's.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from time import perf_counter, process_time

from scenes import Simulation

from ..engines.stopping import kept

LEAST_ROUNDS = 3  # for a minimum, a median and a spread
AGREE = 0.02  # the three fastest solves within this of each other: chance alone would hardly repeat a lucky one


@dataclass(frozen=True)
class Budget:
    """How much may be spent on speed: `LEAST_ROUNDS` in any case, up to `rounds` while `seconds` last."""

    rounds: int
    seconds: float  # of processor time, for the rounds beyond the least, with all that is not under the clock
    full: bool = False
    point_s: float = 1.0  # of processor time, one run of one setting; what takes longer is not repeated


NO_CLOCK = Budget(rounds=0, seconds=0.0)  # for a speed table whose times are those of the error runs


@dataclass
class Times:
    """Times of one setting, s, one entry per round."""

    build: list[float] = field(default_factory=list)
    solve: list[float] = field(default_factory=list)
    read: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)  # of the solve, by a clock on the wall

    @property
    def known(self) -> bool:
        """Whether the fastest solve was reached again and again."""
        fastest = sorted(self.solve)[:LEAST_ROUNDS]
        return len(fastest) == LEAST_ROUNDS and fastest[-1] <= (1 + AGREE) * fastest[0]


def take_turns(
    builds: Sequence[Callable[[], Simulation]],
    budget: Budget,
    progress: Callable[[str], None],
    in_doubt: Callable[[Sequence[float]], Collection[int]],
    clock: Callable[[], float] = process_time,
    wall: Callable[[], float] = perf_counter,
) -> list[Times]:
    """Return the times of every setting, given what builds it.

    One round goes over all settings, so that a slow spell of the machine falls on all of them. After the least number
    of rounds only those take part that are in doubt, given the fastest solve of every setting, s, and whose fastest
    time is not known yet. A stop leaves the times that are known.
    """
    times = [Times() for _ in builds]

    def due() -> Iterator[tuple[Callable[[], Simulation], Times]]:
        for done, number in product(range(LEAST_ROUNDS), range(len(builds))):
            progress(f"timing {len(builds)} settings, round {done + 1}")
            yield builds[number], times[number]
        started = clock()
        for done in range(LEAST_ROUNDS, budget.rounds):
            doubtful = [n for n in in_doubt([min(record.solve) for record in times]) if not times[n].known]
            for number in doubtful:
                if clock() - started < budget.seconds:
                    progress(f"timing {len(doubtful)} settings, round {done + 1}")
                    yield builds[number], times[number]

    for build, record in kept(due()):
        _time(build, record, clock, wall)
    return times


def _time(build: Callable[[], Simulation], times: Times, clock: Callable[[], float], wall: Callable[[], float]) -> None:
    started = clock()
    simulation = build()
    on_wall, built = wall(), clock()
    simulation.solve()
    solved, done_on_wall = clock(), wall()
    simulation.read()
    times.read.append(clock() - solved)
    times.build.append(built - started)
    times.solve.append(solved - built)
    times.wall.append(done_on_wall - on_wall)
