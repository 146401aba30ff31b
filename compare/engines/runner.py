"""Runs one engine on one scene. However it ends, the outcome is a row of data."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from time import perf_counter

import numpy as np

from scenes import Failure, Motion, Request, Scene, Settings, Status

from . import registry

ON_TIME = 1e-9  # of a cycle: what adding up steps loses is far less, a step too many or too few is far more


@dataclass(frozen=True)
class Run:
    """How one run ended and what it gave."""

    engine: str
    settings: Settings | None
    status: Status
    reason: str = ""
    found_by: str = ""  # who noticed that it is not ok: the engine, the checks of its output, or the reference
    version: str = ""
    motion: Motion | None = None
    build_s: float = float("nan")
    solve_s: float = float("nan")
    read_s: float = float("nan")
    counters: Mapping[str, int] = field(default_factory=dict)
    residuals: Mapping[str, float] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Return the time of build, solve and read together, s."""
        return self.build_s + self.solve_s + self.read_s


def run(name: str, scene: Scene, request: Request, settings: Settings | None = None) -> Run:
    """Build, solve and read, each timed apart; `settings` of None means the engine's default."""
    entry = registry.ENTRIES[name]
    failed = Run(name, settings, Status.unsupported, entry.missing or "", "engine", entry.version)
    if entry.missing:
        return failed
    try:
        engine = registry.engine(name)
        settings = settings or engine.DEFAULT
        failed = replace(failed, settings=settings, version=engine.version())  # imports what no clock shall time
        started = perf_counter()
        simulation = engine.build(scene, settings, request)
        built = perf_counter()
        simulation.solve()
        solved = perf_counter()
        motion = simulation.read()
        read = perf_counter()
        _check_complete(scene, request, motion)
    except Failure as failure:
        return replace(failed, status=failure.status, reason=failure.reason, motion=_finite(failure.motion))
    except Exception as error:  # an engine's own fault is an outcome to report, the other engines go on
        text = (str(error) or "no message").strip().splitlines()[0]
        return replace(failed, status=Status.crashed, reason=f"{type(error).__name__}: {text}")
    return replace(
        failed,
        status=Status.ok,
        found_by="",
        motion=motion,
        build_s=built - started,
        solve_s=solved - built,
        read_s=read - solved,
        counters=simulation.counters,
        residuals=simulation.residuals,
    )


def _finite(motion: Motion | None) -> Motion | None:
    """Return a motion that is all numbers, or None."""
    return motion if motion is not None and np.isfinite([*motion.samples.values()]).all() else None


def _check_complete(scene: Scene, request: Request, motion: Motion) -> None:
    """Refuse a result that is short, holds NaN, is of other instants, or drops a channel without a word."""
    for channel in request.wanted(scene):
        if channel not in motion:
            if channel not in motion.unsupported:
                raise Failure(Status.crashed, f"the engine returned no {channel} and gave no reason")
            continue
        values = motion[channel]
        if values.dtype != np.float64:  # the reference would be evaluated at its precision
            raise Failure(Status.crashed, f"{channel} is of {values.dtype}, expected float64")
        if values.shape != (request.count,):
            raise Failure(Status.crashed, f"{channel} has {len(values)} samples, expected {request.count}")
        bad = ~np.isfinite(values)
        if bad.any():
            where = scene.where(float(request.commanded(scene)[bad.argmax()]))
            raise Failure(Status.nonfinite, f"{channel} is not finite at {where}")
    late = np.abs(motion["time"] - request.times(scene)).max()
    if not late <= ON_TIME * scene.drive.cycle:
        raise Failure(Status.crashed, f"the engine's samples are off the instants asked for, by up to {late:.3g} s")
