"""Runs one engine on one scene. However it ends, the outcome is a row of data."""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from time import perf_counter, process_time
from typing import Any, TypeAlias, TypeVar

import numpy as np

from scenes import Engine, Failure, Motion, Request, Rows, Sampling, Scene, Settings, Status
from scenes.arguments import unmasked
from scenes.channels import Role
from scenes.model.engine import refuse_unknown

from . import registry
from .outside import unpacked
from .processes.inside import Ended, Limits
from .processes.messages import NUMBERS
from .reasons import described, text_of
from .threads import one_thread

SECONDS, MEMORY = 20.0, 2 * 2**30  # of processor time, and bytes, for a run of few samples: a hang ends soon
SECONDS_EACH = 1e-4  # more for every value asked for, or found on the way; the slowest settings take a tenth
MEMORY_EACH = 256  # bytes more for every one of those; a motion is 8
LIMITS = Limits(SECONDS)  # of what is no run
MAX_NUMBER = 1e30  # its square is a double
T = TypeVar("T")
Several: TypeAlias = Sequence[Settings | None]
MIN_TIME = 1e-6  # s, of the clock: what takes less is taken for that, since times are divided by one another
INSTANT_TOL = 1e-9  # of a cycle: what adding up steps loses is far less, a step too many or too few is far more


@dataclass(frozen=True)
class Run:
    """How one run ended and what it gave."""

    engine: str
    settings: Settings | None
    status: Status
    reason: str = ""
    found_by: str = ""  # who noticed that it is not ok: the engine, its isolation, the checks, or the reference
    version: str = ""
    motion: Motion | None = None
    build_s: float = float("nan")  # of processor time, as solve and read
    solve_s: float = float("nan")
    read_s: float = float("nan")
    wall_s: float = float("nan")  # of the solve, by a clock on the wall
    counters: Mapping[str, int] = field(default_factory=dict)
    residuals: Mapping[str, float] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Return the time of build, solve and read together, s."""
        return self.build_s + self.solve_s + self.read_s


def limits(scene: Scene, request: Request, settings: Several) -> Limits:
    """The limits of runs, which grow with the rows, or steps, and channels that they have."""
    cycles = request.turns if isinstance(request, Sampling) else 1
    rows = sum(max(request.count, cycles * (getattr(each, "steps", None) or 0)) for each in settings)
    values = rows * len(request.wanted(scene))
    return Limits(SECONDS + SECONDS_EACH * values, MEMORY + MEMORY_EACH * values)


class Runs:
    """Runs engines in this process; `processes.workers.Workers` runs each in one of its own."""

    apart = 0.0  # s of processor time that runs took in other processes

    def run(self, name: str, scene: Scene, request: Request, settings: Settings | None = None) -> Run:
        """Build, solve and read, each timed apart, at the default settings if None; `complete` looks at what comes."""
        if settings is None and not registry.ENTRIES[name].missing:
            settings = registry.engine(name).DEFAULT  # which has a part in the limits
        (ended,) = self._runs(name, scene, request, [settings], reads=True)
        return ended

    def timed(self, name: str, scene: Scene, request: Request, settings: Sequence[Settings]) -> list[Run]:
        """Build and solve one after the other, for the times alone: no motion is read."""
        return self._runs(name, scene, request, settings, reads=False)

    def asked(self, name: str, scene: Scene, function: Callable[[], T], limits: Limits = LIMITS) -> T | Ended:  # noqa: ARG002
        """Call a function where the engine is, about a scene; limits are those of a process of its own."""
        try:
            with one_thread():
                return function()
        except MemoryError as error:
            return Ended(Status.crashed, described(error))

    def _runs(self, name: str, scene: Scene, request: Request, settings: Several, *, reads: bool) -> list[Run]:
        entry = registry.ENTRIES[name]
        asked = [Run(name, each, Status.unsupported, entry.missing or "", "engine", entry.version) for each in settings]
        if entry.missing:
            return asked
        solve = partial(_attempts, name, scene, request, settings, reads=reads)
        answer = self.asked(name, scene, solve, limits(scene, request, settings))
        if not isinstance(answer, Ended):
            try:
                return [_completed(run, told, reads=reads) for run, told in zip(asked, answer, strict=True)]
            except Exception as error:  # whatever an engine has sent in the place of an answer
                answer = Ended(Status.crashed, f"its answer is none: {described(error)}")
        return [replace(run, status=answer.status, reason=answer.reason, found_by="isolation") for run in asked]


HERE = Runs()
run = HERE.run


# What is asked for is known here; an engine's process tells how it went and gives numbers, which are looked at one by
# one. So no engine answers for another, or for other settings, whatever it sends.

Told: TypeAlias = Mapping[str, Any]  # numbers, text and arrays of numbers: fields of `Run`
TIMES = ("build_s", "solve_s", "read_s", "wall_s")


def _attempts(name: str, scene: Scene, request: Request, settings: Several, *, reads: bool) -> list[Told]:
    """How the runs at some settings went, where the engine is."""
    told: list[Told] = []
    for each in settings:
        known = {}
        try:
            engine = registry.imported(name)
            known["version"] = text_of(engine.version())
            told.append(known | _solved(engine, scene, request, each, reads=reads))  # no clock times an import
        except MemoryError:
            raise
        except Exception as error:  # an engine's own fault is an outcome to report, the other engines go on
            told.append(known | {"status": Status.crashed.name, "reason": described(error)})
    return told


def _completed(asked: Run, told: Told, *, reads: bool) -> Run:
    """Return the run that was asked for as it is told, or raise whatever is wrong with that."""
    ended = replace(asked, version=text_of(told.get("version", asked.version)), status=Status[told["status"]])
    motion = told.get("motion") and _motion(**told["motion"])
    if ended.status is not Status.ok:
        return replace(ended, reason=text_of(told["reason"]), motion=motion)
    if (motion is None) == reads:
        raise ValueError("it is ok, without a motion" if reads else "a motion that was not asked for")
    seconds: Any = {name: min(max(MIN_TIME, float(told[name])), MAX_NUMBER) for name in TIMES}
    return replace(
        ended,
        found_by="",
        motion=motion,
        counters={text_of(counted): int(np.int64(count)) for counted, count in told["counters"].items()},
        residuals={text_of(checked): float(residual) for checked, residual in told["residuals"].items()},
        **seconds,
    )


def _motion(samples: Mapping[str, Any], unsupported: Mapping[str, str]) -> Motion:
    if not all(isinstance(each, np.ndarray) for each in samples.values()):
        raise TypeError("expected arrays")
    return Motion(dict(samples), {channel: text_of(reason) for channel, reason in unsupported.items()})


def processor_time() -> float:
    """Return the processor time of this process, s, by a clock whose ticks stay fine under `ulimit -t`."""
    if sys.platform == "win32":
        return process_time()
    import resource  # not on Windows

    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def _solved(
    engine: Engine[Any], scene: Scene, request: Request, settings: Settings | None, *, reads: bool
) -> dict[str, Any]:
    """How a run went that came to an end of the engine's own."""
    # Three clocks: build, solve and read-out of the motion, each in processor time, and the solve on the wall besides.
    # Imports are over before the first one starts.
    received = None if settings is None else unpacked(settings)
    try:
        started = processor_time()
        refuse_unknown(engine, scene)
        simulation = engine.build(scene, received, request)
        on_wall, built = perf_counter(), processor_time()
        simulation.solve()
        solved, done_on_wall = processor_time(), perf_counter()
        returned = simulation.read() if reads else None
        read = processor_time()
    except Failure as failure:
        status = Status(failure.status)
        if status is Status.ok:
            raise ValueError("a failure is expected to have another status than ok") from failure
        motion = None if failure.motion is None else _plain(failure.motion)
        return {"status": status.name, "reason": text_of(failure.reason), "motion": motion}
    counters, residuals = (getattr(simulation, name, {}) for name in ("counters", "residuals"))
    seconds = (built - started, solved - built, read - solved, done_on_wall - on_wall)
    return {
        "status": Status.ok.name,
        "motion": _plain(returned) if reads else None,
        "counters": {text_of(counted): int(np.int64(int(count))) for counted, count in counters.items()},
        "residuals": {text_of(checked): float(residual) for checked, residual in residuals.items()},
        **dict(zip(TIMES, seconds, strict=True)),
    }


def _plain(motion: object) -> dict[str, Any]:
    """Return an engine's motion as arrays of numbers and clean text, whatever classes of its own it took for them."""
    if not isinstance(motion, Motion):
        raise TypeError(f"expected scenes.Motion, found {type(motion).__name__}")
    named = {
        channel: unmasked(channel, samples) for channel, samples in motion.samples.items() if isinstance(channel, str)
    }
    for channel, samples in named.items():
        if samples.dtype.kind not in NUMBERS:
            raise TypeError(f"{channel} is of {samples.dtype}, expected float64")
    return {
        "samples": {str.__str__(channel): samples for channel, samples in named.items()},
        "unsupported": {text_of(channel): text_of(reason) for channel, reason in motion.unsupported.items()},
    }


def complete(outcome: Run, scene: Scene, request: Rows) -> Run:
    """Restrict a run's motion to the channels asked for, and correct its status where the motion is not whole."""
    if outcome.motion is None:
        return outcome
    samples, reasons = outcome.motion.samples, outcome.motion.unsupported
    given = (scene.channels[name] for name in (*samples, *reasons) if name in scene.channels)
    asked = {*request.wanted(scene), *(row.name for row in given if row.role is Role.own)}  # which nobody has to give
    motion = Motion({c: samples[c] for c in samples if c in asked}, {c: reasons[c] for c in reasons if c in asked})
    if outcome.status is not Status.ok:
        return replace(outcome, motion=_usable(motion, scene, request))
    try:
        _check_complete(scene, request, motion, everything=outcome.engine in registry.OWN)
    except Failure as failure:
        known = _usable(failure.motion, scene, request)
        return replace(outcome, status=failure.status, reason=failure.reason, found_by="checks", motion=known)
    return replace(outcome, motion=motion)


def _usable(motion: Motion | None, scene: Scene, request: Rows) -> Motion | None:
    """Return a motion with time and drive that is all numbers, as many as asked for, or None."""
    if motion is None or not all(name in motion for name in scene.channels.names(Role.time, Role.input)):
        return None
    whole = all(values.dtype == np.float64 and values.shape == (request.count,) for values in motion.samples.values())
    return motion if whole and (np.abs([*motion.samples.values()]) <= MAX_NUMBER).all() else None


def _check_complete(scene: Scene, request: Rows, motion: Motion, *, everything: bool) -> None:
    """Refuse a result that is short, holds NaN, is of other instants, repeats rows, or lacks a channel."""
    wanted = request.wanted(scene)
    rows = {name: scene.channels[name] for name in wanted}
    given = {row.measured for name, row in rows.items() if name in motion}
    for channel in wanted:
        if channel not in motion:
            if channel not in motion.unsupported:
                raise Failure(Status.crashed, f"the engine returned no {channel} and gave no reason")
            # it may where the engine gives not every quantity, and none such of another joint
            if everything or rows[channel].measured in given or rows[channel].role in (Role.time, Role.input):
                why = f"{channel} is missing, which the engine gives elsewhere: {motion.unsupported[channel]}"
                raise Failure(Status.unsupported, why, motion)
            continue
        values = motion[channel]
        if values.dtype != np.float64:  # the reference would be evaluated at its precision
            raise Failure(Status.crashed, f"{channel} is of {values.dtype}, expected float64")
        if values.shape != (request.count,):
            raise Failure(Status.crashed, f"{channel} is of shape {values.shape}, expected {(request.count,)}")
        bad = ~(np.abs(values) <= MAX_NUMBER)
        if bad.any():
            value, where = values[bad.argmax()], scene.where(float(request.commanded(scene)[bad.argmax()]))
            if np.isfinite(value):
                raise Failure(Status.diverged, f"{channel} is {value:.3g} at {where}")
            raise Failure(Status.nonfinite, f"{channel} is not finite at {where}")
    if not (np.diff(motion["time"]) > 0).all():
        raise Failure(Status.inconsistent, "the engine's instants do not increase from sample to sample", motion)
    late = np.abs(motion["time"] - request.times(scene)).max()
    if not late <= INSTANT_TOL * scene.cycle:
        why = f"the engine's samples are off the instants asked for, by up to {late:.3g} s"
        raise Failure(Status.inconsistent, why, motion)
    _check_rows(scene, request, motion)


def _check_rows(scene: Scene, request: Rows, motion: Motion) -> None:
    """Refuse a row that repeats the one before in all that moves, while the drive does not stand still."""
    commanded = request.commanded(scene)
    # A row that is returned twice is an engine that did not step. All channels have to be equal at once: some may well
    # be so on both sides of a dead point.
    moves = scene.channels.names(Role.kinematic)
    if not all(channel in motion for channel in moves):  # a few may be the same on both sides of a dead point
        return
    rows = np.array([motion[channel] for channel in moves])
    repeated = (np.diff(rows) == 0).all(axis=0) & (
        np.abs(np.diff(commanded)) > INSTANT_TOL * max(drive.span for drive in scene.drives)
    )
    if repeated.any():
        where = scene.where(float(commanded[1:][repeated.argmax()]))
        raise Failure(Status.inconsistent, f"a row repeats the one before, though the drive moves, at {where}", motion)
