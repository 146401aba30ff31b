"""Every setting of every engine: errors and times, taken in separate runs.

Runs take turns under the clock of what runs them; those whose times decide a comparison, until they are known. It
counts processor time, of all threads together. On an idle machine that is the time on the wall, which stands beside it;
on a busy one other programs make a run wait, and the time on the wall is as much theirs as the run's.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate, chain, groupby, product
from math import inf, nan
from statistics import median
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Settings, Status

from ...engines.processes.stopping import Progress, kept
from ...engines.registry import REFERENCE, settings_of, tiers
from ...engines.runner import HERE, Run, Runs
from ...judge.checks import Check
from ...judge.measure import Measurement, Standard, assess
from ...judge.verdict import MAX_GAP, MAX_SUM
from ...mechanics.reference import Reference
from .share import ERRORS, LEFT_OUT, SAMPLING, EngineShare, Watch, at_samples, last_run, steps_per_cycle
from .work_precision import LEVELS, TIE_TOL, SpeedRow, contenders, groups, solved

MAX_DOUBTED_RATIO = 1.75  # of the limit of a tie to a time, below which a busy machine might have moved it across
MIN_ROUNDS = 1  # beside its neighbours; what is compared takes more, and of alike solves in full there are several
# The three fastest solves within this of each other: chance alone would hardly repeat a lucky one. Two runs may be
# three times as far apart and name the same setting, or call both level.
ALIKE_SOLVES, AGREE = 3, 0.05


@dataclass(frozen=True)
class Budget:
    """How much may be spent on speed: `MIN_ROUNDS`, fewer of slow settings, up to `rounds` while `seconds` last."""

    rounds: int
    seconds: float  # of processor time, of the runs in the rounds beyond the least
    full: bool = False
    point_s: float = 1.0  # of processor time, one run of one setting; what takes longer is not repeated
    most_s: float = inf  # of processor time, all rounds together
    share: float = 1.0  # of the processor time since `since`, the table; below one, what does not fit is left out
    since: float = 0.0  # s of this process's processor time: what came before is none of the table's
    # s of processor time for the least rounds, the same for every setting: a slow one is timed less often
    patience: float = 0.3


Again: TypeAlias = Callable[[Sequence[int]], Sequence[Run]]  # runs settings, by their places, one after the other
# Of a report. With twice as much as many choices of settings differ from run to run, and the clock takes twice as long.
QUICK = Budget(rounds=20, seconds=0.05, patience=0.15)
NO_CLOCK = Budget(rounds=0, seconds=0.0)  # for a speed table whose times are those of the error runs


def speed_table(
    reference: Reference,
    engines: Iterable[str],
    budget: Budget,
    progress: Progress,
    channels: frozenset[str] | None = None,
    runs: Runs = HERE,
    main: Sequence[Measurement] = (),
) -> list[SpeedRow]:
    """One row per setting: status, times, errors by group, counters. Failed settings stay in the table.

    The error run comes first and warms everything up. Then all settings take turns under the clock, those longest that
    decide which is the cheapest for some error; those that failed, and slow ones that decide nothing or take longer
    than the budget has for one, keep the times of their error run. A run of `main` that has the samples of the table is
    the error run of its settings. Each engine has an equal part of what is left of the budget's share; a setting that
    would take more stays as a row, `LEFT_OUT`. A stop leaves what is done.
    """
    # by name: the core has others of its own, which no engine is held against
    sampling = replace(SAMPLING, channels=channels or frozenset(reference.scene.channels.names()))
    names, watch, standard = list(engines), Watch(runs), Standard.of(reference, sampling)
    allowed, known = watch.allowed(budget.share, budget.since), at_samples(main, sampling)

    def at(engine: str, settings: Settings) -> Measurement:
        main_run = known.get((engine, settings))
        run = main_run.run if main_run else runs.run(engine, reference.scene, sampling, settings)
        checked = main_run and run.settings and run.settings.promise <= settings.promise  # at its samples and more
        run = replace(run, settings=settings)
        held = assess(standard, run, _none)
        found = checked or run.status is not Status.ok or confirmed(standard, held)
        return held if found else assess(standard, run)

    def error_runs() -> Iterator[tuple[Run, SpeedRow]]:
        for number, engine in enumerate(names):
            # What is left of the time is divided by the engines that are left, so that what a quick engine does not use
            # is the later ones'. Engines come in the order asked for, and no later one can take from an earlier one.
            part = EngineShare(
                watch, (ERRORS * allowed - watch.taken()) / (len(names) - number), *last_run(main, engine)
            )
            free = {settings: main_run.samples for (name, settings), main_run in known.items() if name == engine}
            yield from _error_runs(at, engine, budget, progress, part, free)

    points = list(kept(error_runs()))
    able = [
        place for place, (run, _) in enumerate(points) if run.status is Status.ok and not run.seconds > budget.point_s
    ]
    able = [] if budget == NO_CLOCK else able
    budget = replace(budget, most_s=max(0.0, min(budget.most_s, allowed - watch.taken())))
    first, failed = [points[place][0] for place in able], set[int]()

    def again(numbers: Sequence[int]) -> list[Run]:
        """Run settings of one engine once more; those that fail now keep the times of their error run."""
        settings = [run.settings for run in map(first.__getitem__, numbers) if run.settings is not None]
        taken = runs.timed(first[numbers[0]].engine, reference.scene, sampling, settings)
        failed.update(n for n, run in zip(numbers, taken, strict=True) if run.status is not Status.ok)
        return [first[n] if n in failed else run for n, run in zip(numbers, taken, strict=True)]

    table = [row for _, row in points]
    compared = contests([table[place] for place in able])
    for number, times in enumerate(take_turns(first, again, budget, progress, partial(in_doubt, compared))):
        if times and number not in failed:
            table[able[number]] = replace(
                table[able[number]], **_seconds(times), timed_runs=len(times), samples_a_turn=SAMPLING.samples
            )
    return table


def _none(_: Motion) -> list[Check]:
    """What the checks find in a run that needs none: a main run, which was judged by them, or one that is confirmed."""
    return []


# The checks of a run's own output take twice as long as all else that is done with it. They were made for runs without
# a reference. Where one that is certified has every channel within a tenth of what the checks allow, poses that close,
# forces that balance and one branch follow: over the joints of a body errors add up to `MAX_SUM` times the largest.
def confirmed(standard: Standard, held: Measurement) -> bool:
    """Whether the reference alone shows that a run is ok, which was held against it without checks."""
    run, floor = held.run, standard.reference.floor
    if run.status is not Status.ok or run.settings is None or not held.errors or floor.doubt or not floor.by_channel:
        return False
    promise = run.settings.promise
    most = {"drive": run.settings.drive_promise, "position": min(promise, MAX_GAP)}
    return all(MAX_SUM * error <= most.get(group, promise) for group, error in held.worst().items())


def _error_runs(
    measured: Callable[[str, Settings], Measurement],
    engine: str,
    budget: Budget,
    progress: Progress,
    part: EngineShare,
    free: Mapping[Settings, int],
) -> Iterator[tuple[Run, SpeedRow]]:
    """Every setting's error run and row; once one has taken too long, the finer ones of its family are not run.

    `free` has the samples a cycle of the main runs that are error runs too, by their settings.
    """
    too_slow: dict[str, int] = {}  # steps per cycle, by family
    offered = tiers(engine)
    for settings, role in settings_of(engine, full=budget.full).items():
        tier = " ".join(name for name, offer in offered.items() if offer == settings)
        steps, least = steps_per_cycle(settings) or 0, too_slow.get(settings.family, inf)
        reason = f"{least} steps per cycle took longer than {budget.point_s:g} s already" if steps > least else ""
        if reason := reason or LEFT_OUT * (settings not in free and not part.holds(steps)):
            run = Run(engine, settings, Status.timed_out, reason)
            yield run, _row(Measurement(run, None, []), settings, role, tier)
            continue
        progress(f"measuring the error of {engine}, {settings.label}")
        measurement = measured(engine, settings) if settings in free else part.take(measured, engine, settings)
        if settings.family and measurement.run.seconds > budget.point_s:
            too_slow[settings.family] = steps
        row = _row(measurement, settings, role, tier)
        yield measurement.run, replace(row, samples_a_turn=free.get(settings, SAMPLING.samples))


def _row(measurement: Measurement, settings: Settings, role: str, tier: str) -> SpeedRow:
    run, worst = measurement.run, {figure: measurement.worst(figure) for figure in ("max", "rms")}
    return SpeedRow(
        engine=run.engine,
        setting=settings.label,
        role=role,
        tier=tier,
        family=settings.family,
        expected_order=settings.order,
        note=settings.note,
        steps=steps_per_cycle(settings) or nan,
        samples_a_turn=SAMPLING.samples,
        status=run.status.name,
        reason=run.reason,
        **_seconds([run]),
        read_s=run.read_s,
        timed_runs=0,
        errors={f"{group}_{figure}": sizes[group] for group in worst["max"] for figure, sizes in worst.items()},
        steps_made=run.counters.get("steps", nan),
        counters=run.counters,
    )


def _seconds(runs: Sequence[Run]) -> dict[str, Any]:
    build, solve, wall = zip(*((run.build_s, run.solve_s, run.wall_s) for run in runs), strict=True)
    least = {"build_s": min(build), "solve_min_s": min(solve), "solve_median_s": median(solve)}
    return least | {"solve_spread_s": max(solve) - min(solve), "solve_wall_s": min(wall)}


# --- the clock -------------------------------------------------------------------------------------------------------


def spent(runs: Iterable[Run]) -> float:
    """The processor time of runs, s."""
    return sum(run.build_s + run.solve_s for run in runs)


def known(runs: Iterable[Run]) -> bool:
    """Whether the fastest solve was reached again and again."""
    # The least of several times estimates the time without disturbance, since other programs only add to it. How close
    # the next ones come to it shows how far that estimate may still fall.
    fastest = sorted(run.solve_s for run in runs)[:ALIKE_SOLVES]
    return len(fastest) == ALIKE_SOLVES and fastest[-1] <= (1 + AGREE) * fastest[0]


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

    def runs_of(n: int) -> list[Run]:
        return times[n] or [first[n]]

    def fastest(n: int) -> float:
        return min(run.solve_s for run in runs_of(n))

    def batches() -> Iterator[Sequence[int]]:
        every, end = range(len(times)), inf  # of the processor time of all runs, after which none begins
        share, able = max(budget.patience, budget.seconds) / (len(times) or 1), [*every]
        rounds = ALIKE_SOLVES if budget.full else MIN_ROUNDS
        for done in range(max(rounds, budget.rounds)):
            if done == rounds:
                end = spent(chain.from_iterable(times)) + budget.seconds
            if done < rounds:
                numbers = able = [n for n in able if (done + 1) * spent(runs_of(n)) / len(runs_of(n)) <= share]
            else:
                numbers = [n for n in in_doubt([*map(fastest, every)]) if not known(times[n])]
            for _, settings in groupby(numbers, engines.__getitem__):
                batch, done_s = [*settings], spent(chain.from_iterable(times))
                # The processor time that would be spent before each run of the batch, if each took as long as its
                # fastest so far: a run begins only where the budget has not ended before it and would not be overrun by
                # it.
                taken = [*accumulate([done_s, *map(fastest, batch)])]  # before each, and after the last
                in_turn = zip(batch, taken, taken[1:], strict=False)
                if chosen := [n for n, before, after in in_turn if before < end and after <= budget.most_s]:
                    progress(f"timing {len(numbers)} settings, round {done + 1}")
                    yield chosen

    runs = (zip(batch, again(batch), strict=True) for batch in batches())
    for number, run in kept(chain.from_iterable(runs)):
        times[number].append(run)
    return times


def contests(speed: Sequence[SpeedRow]) -> list[NDArray[np.intp]]:
    """The sets of settings, by their places in the table, of which the fastest is asked for.

    One for every group, level and contender, and one for all engines besides the reference.
    """
    places = {id(row): place for place, row in enumerate(speed)}
    sets = [rows for *_, rows in contenders(solved(speed))]
    sets.append([row for row in solved(speed) if not row.note and row.engine != REFERENCE])
    rivals = (
        tuple(places[id(row)] for row in rows if row.error(f"{group}_max") <= limit)
        for group, limit, rows in product(groups(speed), LEVELS.values(), sets)
    )
    return [np.array(rows) for rows in dict.fromkeys(rivals) if len(rows) > 1]


def in_doubt(contests: Sequence[NDArray[np.intp]], times: Sequence[float]) -> list[int]:
    """The settings whose times, s, more rounds should make sure of, by their places.

    Those are near the limit up to which settings of a contest are level, and the fastest of that contest.
    """
    doubtful: set[int] = set()
    for places in contests:
        ratio = np.array(times)[places] / min(times[place] for place in places)
        # Which setting is named depends on the ratio of its time to the fastest. Far from the limit of a tie no
        # plausible error of a time moves the ratio across it; only settings near the limit, on a logarithmic scale, are
        # timed again, and the fastest itself, by which all others are divided.
        near = (np.abs(np.log(ratio / (1 + TIE_TOL))) < np.log(MAX_DOUBTED_RATIO)) & (ratio > 1)
        if near.any():
            doubtful |= {int(place) for place in places[near | (ratio == 1)]}
    return sorted(doubtful)
