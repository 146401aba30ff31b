"""What a speed table has of the run that it is part of: its main runs, and a share of its processor time.

What the run takes after the table, as the page, is not known yet and does not count: the table's share of the whole run
is below the one that is asked for.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from math import ceil, inf, nan
from typing import NamedTuple, TypeVar

from scenes import Sampling, Settings, Status

from ...engines import runner
from ...engines.runner import Run, Runs
from ...judge.measure import Measurement

SAMPLING = Sampling(samples=72)  # few, so that coarse settings can be asked for them
MAX_SHARE = 1 / 3  # of a run's processor time, for its speed table
ERRORS = 0.75  # of the time for a speed table, for the errors; what they leave is the clock's
LEFT_OUT = "left out, since the table would take more than a third of the run's processor time; --full has it"

T = TypeVar("T")


def steps_per_cycle(settings: Settings, samples: int = SAMPLING.samples) -> int | None:
    """The steps of the coarsest run, rounded up as engines do; None of settings that take none."""
    steps = getattr(settings, "steps", None)
    return None if steps is None else samples * ceil(steps / samples)


# A main run is not done again where the table's samples are among its own, and the engine takes the same steps for
# both: what is between two samples of the table is the same work. Without steps the work is that of the samples, and
# these have to be the same. The time of the solve is that of a run with more samples, up to 1.3 times as long. That is
# less than level settings may differ by, and the time is taken again where a comparison depends on it. The time of
# building is left open, since the first run of a process also prepares what the engine keeps of a scene.


class MainRun(NamedTuple):
    """A main run at the samples of a table."""

    run: Run
    samples: int  # a cycle, that it had, and that its times are of


def at_samples(main: Iterable[Measurement], sampling: Sampling) -> Mapping[tuple[str, Settings], MainRun]:
    """The main runs that went well and have the samples of a table, by engine and settings."""
    known, wanted = dict[tuple[str, Settings], MainRun](), sampling.channels or frozenset()
    for run, asked in ((measured.run, measured.asked) for measured in main):
        if run.settings is None or run.motion is None or not isinstance(asked, Sampling):
            continue
        steps = steps_per_cycle(run.settings, asked.samples)
        alike = asked.samples == sampling.samples or (steps and steps == steps_per_cycle(run.settings))
        among = asked.samples % sampling.samples == 0 and asked.turns == sampling.turns
        if run.status is Status.ok and alike and among and asked.channels in (None, sampling.channels):
            every = asked.samples // sampling.samples
            samples = {c: values[::every] for c, values in run.motion.samples.items() if c in wanted}
            thinned = replace(run, build_s=nan, motion=replace(run.motion, samples=samples))
            known[run.engine, run.settings] = MainRun(thinned, asked.samples)
    return known


def last_run(main: Iterable[Measurement], engine: str) -> tuple[float, int]:
    """How long the main run of an engine took, s, and its steps per cycle; zeros where that is not known."""
    for run in (measured.run for measured in main if measured.run.engine == engine):
        if run.settings is not None and run.seconds >= 0:
            return run.seconds, steps_per_cycle(run.settings) or 0
    return 0.0, 0


class Watch:
    """The processor time that a speed table takes, here and in the engines' processes."""

    def __init__(self, runs: Runs) -> None:
        self._runs, self._began = runs, runner.processor_time() + runs.apart

    def taken(self) -> float:
        """The processor time since the watch began, s."""
        return runner.processor_time() + self._runs.apart - self._began

    def allowed(self, share: float, since: float) -> float:
        """The processor time, s, that is a share of it and of what was spent since then till the watch began."""
        # With b s spent before and a table of t s, the table's share of both is t / (b + t); it is at most `share`
        # where t <= b share / (1 - share).
        return inf if share >= 1 else (self._began - since) * share / (1 - share)


class EngineShare:
    """An engine's part of the time for a speed table."""

    def __init__(self, watch: Watch, allowed: float, seconds: float, steps: int) -> None:
        """`allowed` is the part, s; its main run took so many seconds for so many steps a cycle."""
        self._watch, self._end = watch, watch.taken() + allowed
        self._seconds, self._steps = seconds, steps

    def holds(self, steps: int) -> bool:
        """Whether one more run fits, of so many steps a cycle, if a step takes as long as one of the last run."""
        ahead = self._seconds * (steps / self._steps if steps and self._steps else 1.0)
        return self._watch.taken() + ahead <= self._end

    def take(self, measured: Callable[[str, Settings], T], engine: str, settings: Settings) -> T:
        """What is measured of a setting, whose time is kept in mind."""
        began, steps = self._watch.taken(), steps_per_cycle(settings) or 0
        given = measured(engine, settings)
        self._seconds, self._steps = self._watch.taken() - began, steps
        return given
