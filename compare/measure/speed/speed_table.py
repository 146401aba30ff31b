"""Every setting of every engine: errors and times, taken in separate runs."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain, product
from math import ceil, inf, nan
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes import Sampling, Settings, Status

from ...engines.processes.stopping import Progress, kept
from ...engines.registry import REFERENCE, settings_of, tiers
from ...engines.runner import HERE, Run, Runs
from ...judge.measure import Measurement, measure
from ...mechanics.reference import Reference
from ...mechanics.round_off import explain
from .timing import NO_CLOCK, Budget, take_turns
from .work_precision import LEVELS, TIE, SpeedRow, contenders, groups, solved

SAMPLING = Sampling(samples=72)  # few, so that coarse settings can be asked for them
DOUBT = 1.75  # ratio of the limit of a tie to a time, below which a busy machine might have moved it across


def speed_table(
    reference: Reference,
    engines: Iterable[str],
    budget: Budget,
    progress: Progress,
    channels: frozenset[str] | None = None,
    runs: Runs = HERE,
) -> list[SpeedRow]:
    """One row per setting: status, times, errors by group, counters. Failed settings stay in the table.

    The error run comes first and warms everything up. Then all settings take turns under the clock, those longest that
    decide which is the cheapest for some error; those that failed, and slow ones that decide nothing or take longer
    than the budget has for one, keep the times of their error run. A stop leaves what is done.
    """
    sampling = replace(SAMPLING, channels=channels)
    at = partial(measure, reference, sampling=sampling, explained=explain(reference, sampling), runs=runs)
    points = list(kept(chain.from_iterable(_error_runs(at, engine, budget, progress) for engine in engines)))
    able = [place for place, (run, _) in enumerate(points) if run.status is Status.ok and run.seconds <= budget.point_s]
    able = [] if budget == NO_CLOCK else able
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
            table[able[number]] = replace(table[able[number]], **_seconds(times), timed_runs=len(times))
    return table


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
        near = (np.abs(np.log(ratio / (1 + TIE))) < np.log(DOUBT)) & (ratio > 1)
        if near.any():
            doubtful |= {int(place) for place in places[near | (ratio == 1)]}
    return sorted(doubtful)


def steps_per_cycle(settings: Settings) -> int | None:
    """The steps of the coarsest run, rounded up as engines do; None of settings that take none."""
    steps = getattr(settings, "steps", None)
    return None if steps is None else SAMPLING.samples * ceil(steps / SAMPLING.samples)


def _error_runs(
    measured: Callable[..., Measurement], engine: str, budget: Budget, progress: Progress
) -> Iterator[tuple[Run, SpeedRow]]:
    """Every setting's error run and row; once one has taken too long, the finer ones of its family are not run."""
    too_slow: dict[str, int] = {}  # steps per cycle, by family
    offered = tiers(engine)
    for settings, role in settings_of(engine, full=budget.full).items():
        tier = " ".join(name for name, own in offered.items() if own == settings)
        steps, least = steps_per_cycle(settings) or 0, too_slow.get(settings.family, inf)
        if steps > least:
            reason = f"{least} steps per cycle took longer than {budget.point_s:g} s already"
            run = Run(engine, settings, Status.timed_out, reason)
            yield run, _row(Measurement(run, None, []), settings, role, tier)
            continue
        progress(f"measuring the error of {engine}, {settings.label}")
        measurement = measured(engine, settings=settings)
        if settings.family and measurement.run.seconds > budget.point_s:
            too_slow[settings.family] = steps
        yield measurement.run, _row(measurement, settings, role, tier)


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
        errors={f"{group}_{figure}": of[group] for group in worst["max"] for figure, of in worst.items()},
        steps_made=run.counters.get("steps", nan),
        counters=run.counters,
    )


def _seconds(runs: Sequence[Run]) -> dict[str, Any]:
    build, solve, wall = zip(*((run.build_s, run.solve_s, run.wall_s) for run in runs), strict=True)
    known = {"build_s": min(build), "solve_min_s": min(solve), "solve_median_s": median(solve)}
    return known | {"solve_spread_s": max(solve) - min(solve), "solve_wall_s": min(wall)}
