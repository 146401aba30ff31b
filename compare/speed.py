"""Speed against error: every setting of every engine's ladder, errors and times taken in separate runs."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from time import perf_counter

import numpy as np
import pandas as pd

from scenes import Sampling, Scene, Status

from . import registry
from .measure import Measurement, measure
from .reference import Reference
from .runner import Run

LEAST_ROUNDS = 3  # for a minimum, a median and a spread
LADDER_SAMPLING = Sampling(samples=72)  # few, so that coarse settings can be asked for them


@dataclass(frozen=True)
class Budget:
    """How much may be spent: `LEAST_ROUNDS` over all points at least, up to `rounds` while `seconds` last."""

    rounds: int
    seconds: float
    long_ladders: bool = False


def speed_table(
    reference: Reference, engines: Iterable[str], budget: Budget, progress: Callable[[str], None]
) -> pd.DataFrame:
    """Return one row a setting: status, seconds a turn, errors by group, counters. Failed points stay in the table.

    The error run comes first and warms everything up. Then all points take turns under the clock, round after round, so
    that a slow spell of the machine falls on all of them; the minimum is the headline.
    """
    measurements = []
    for name in engines:
        engine = registry.engine(name)
        for settings in engine.LADDER + (engine.LONG_LADDER if budget.long_ladders else ()):
            progress(f"measuring the error of {name}, {settings.label}")
            measurements.append(measure(reference, name, LADDER_SAMPLING, settings))
    seconds = _time(reference.scene, [m.run for m in measurements], budget, progress)
    return pd.DataFrame(_row(m, times) for m, times in zip(measurements, seconds, strict=True))


def _row(measurement: Measurement, seconds: list[float]) -> dict[str, object]:
    run, errors = measurement.run, measurement.errors
    times = np.array(seconds or [np.nan])
    row: dict[str, object] = {
        "engine": run.engine,
        "setting": run.settings.label if run.settings else "",
        "samples_a_turn": LADDER_SAMPLING.samples,
        "status": run.status.name,
        "reason": run.reason,
        "build_s": run.build_s,
        "solve_min_s": times.min(),
        "solve_median_s": np.median(times),
        "solve_spread_s": np.ptp(times),
        "timed_runs": len(seconds),
        "read_s": run.read_s,
    }
    if not errors.empty:
        for group, worst in errors.groupby("group")[["max", "rms"]].max(skipna=False).iterrows():
            row |= {f"{group}_max": worst["max"], f"{group}_rms": worst["rms"]}
    return row | {"counters": " ".join(f"{name}={count}" for name, count in run.counters.items())}


def _time(scene: Scene, runs: list[Run], budget: Budget, progress: Callable[[str], None]) -> list[list[float]]:
    """Return the seconds of every timed solve, by point; nothing but the solve is under the clock."""
    seconds: list[list[float]] = [[] for _ in runs]
    started, done = perf_counter(), 0
    while done < LEAST_ROUNDS or (done < budget.rounds and perf_counter() - started < budget.seconds):
        done += 1
        progress(f"timing, round {done}")
        for point, times in zip(runs, seconds, strict=True):
            if point.status is Status.ok and point.settings is not None:
                simulation = registry.engine(point.engine).build(scene, point.settings, LADDER_SAMPLING)
                before = perf_counter()
                simulation.solve()
                times.append(perf_counter() - before)
    return seconds
