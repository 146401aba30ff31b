"""Every setting of every engine: errors and times, taken in separate runs."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from math import ceil, inf, nan
from statistics import median
from typing import NamedTuple

from scenes import Sampling, Settings, Status

from ...engines import registry
from ...engines.processes.stopping import kept
from ...engines.runner import HERE, Run, Runs
from ...engines.settings import settings_of, tiers
from ...judge.measure import Measurement, measure
from ...mechanics.reference import Reference
from ...mechanics.round_off import explain
from .row import SpeedRow
from .timing import NO_CLOCK, Budget, Times, take_turns
from .work_precision import contests, in_doubt

SAMPLING = Sampling(samples=72)  # few, so that coarse settings can be asked for them


class MeasuredSetting(NamedTuple):
    """One setting of one engine, after its error run."""

    role: str
    settings: Settings
    measurement: Measurement
    tier: str  # its names among the engine's settings

    @property
    def run(self) -> Run:
        """The error run."""
        return self.measurement.run


def speed_table(
    reference: Reference,
    engines: Iterable[str],
    budget: Budget,
    progress: Callable[[str], None],
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
    error_runs = (_error_runs(at, engine, budget, progress) for engine in engines)
    points = list(kept(chain.from_iterable(error_runs)))
    able = (point for point in points if point.run.status is Status.ok and point.run.seconds <= budget.point_s)
    timed = [] if budget == NO_CLOCK else list(able)
    failed: set[int] = set()

    def again(numbers: Sequence[int]) -> list[Run]:
        """Run settings of one engine once more; those that fail now keep the times of their error run."""
        settings = [timed[number].settings for number in numbers]
        taken = runs.timed(timed[numbers[0]].run.engine, reference.scene, sampling, settings)
        failed.update(n for n, run in zip(numbers, taken, strict=True) if run.status is not Status.ok)
        return [timed[n].run if n in failed else run for n, run in zip(numbers, taken, strict=True)]

    compared = contests([_row(point, None) for point in timed])
    turns = take_turns([point.run for point in timed], again, budget, progress, partial(in_doubt, compared))
    times = {id(timed[number]): turn for number, turn in enumerate(turns) if number not in failed}
    return [_row(point, times.get(id(point))) for point in points]


def steps_per_cycle(settings: Settings) -> int | None:
    """The steps of the coarsest run, rounded up as engines do; None of settings that take none."""
    steps = getattr(settings, "steps", None)
    return None if steps is None else SAMPLING.samples * ceil(steps / SAMPLING.samples)


def _error_runs(
    measured: Callable[..., Measurement], engine: str, budget: Budget, progress: Callable[[str], None]
) -> Iterator[MeasuredSetting]:
    """Every setting's error run; once one has taken too long, the finer ones of its family are not run."""
    too_slow: dict[str, int] = {}  # steps per cycle, by family
    offered = tiers(engine)
    for settings, role in settings_of(engine, full=budget.full).items():
        tier = " ".join(name for name, own in offered.items() if own == settings)
        steps, least = steps_per_cycle(settings) or 0, too_slow.get(settings.family, inf)
        if steps > least:
            reason = f"{least} steps per cycle took longer than {budget.point_s:g} s already"
            run = Run(engine, settings, Status.timed_out, reason, registry.ENTRIES[engine].version)
            yield MeasuredSetting(role, settings, Measurement(run, None, []), tier)
            continue
        progress(f"measuring the error of {engine}, {settings.label}")
        point = MeasuredSetting(role, settings, measured(engine, settings=settings), tier)
        if settings.family and point.run.seconds > budget.point_s:
            too_slow[settings.family] = steps
        yield point


def _row(point: MeasuredSetting, times: Times | None) -> SpeedRow:
    run, settings = point.run, point.settings
    clean = times if times and times.solve else Times([run.build_s], [run.solve_s], [run.wall_s])
    worst = {figure: point.measurement.worst(figure) for figure in ("max", "rms")}
    return SpeedRow(
        engine=run.engine,
        setting=settings.label,
        role=point.role,
        tier=point.tier,
        family=settings.family,
        expected_order=settings.order,
        note=settings.note,
        steps=steps_per_cycle(settings) or nan,
        samples_a_turn=SAMPLING.samples,
        status=run.status.name,
        reason=run.reason,
        build_s=min(clean.build),
        solve_min_s=min(clean.solve),
        solve_median_s=median(clean.solve),
        solve_spread_s=max(clean.solve) - min(clean.solve),
        solve_wall_s=min(clean.wall),
        read_s=run.read_s,
        timed_runs=len(times.solve) if times else 0,
        errors={f"{group}_{figure}": of[group] for group in worst["max"] for figure, of in worst.items()},
        steps_made=run.counters.get("steps", nan),
        counters=run.counters,
    )
