"""Every engine in a process of its own, kept warm from run to run, so that none takes a run of the others down."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from multiprocessing import current_process
from typing import Any, NamedTuple, TypeVar

from scenes import Request, Sampling, Scene, Settings

from . import registry, runner
from .isolation import Answer, Ended, Limits, Worker
from .runner import Run, Runs

SECONDS, MEMORY = 20.0, 2 * 2**30  # of processor time, and bytes, for a run of few samples: a hang ends soon
SECONDS_EACH = 1e-4  # more for every value asked for, or found on the way; the slowest settings take a tenth
LIMITS = Limits(SECONDS)  # of what is no run
MEMORY_EACH = 256  # bytes more for every one of those; a motion is 8
TRIES = 3  # processes that may crash on a scene before its engine is not begun anew


T = TypeVar("T")


class Job(NamedTuple):
    """What an engine's process is asked."""

    scene: Scene
    request: Request
    settings: Sequence[Settings]
    timed: bool  # for the times alone


def limits(job: Job) -> Limits:
    """Return what a job may take, which grows with the rows, or steps, and channels that it has."""
    cycles = job.request.turns if isinstance(job.request, Sampling) else 1
    rows = sum(max(job.request.count, cycles * (getattr(each, "steps", None) or 0)) for each in job.settings)
    values = rows * len(job.request.wanted(job.scene))
    return Limits(SECONDS + SECONDS_EACH * values, MEMORY + MEMORY_EACH * values)


class Workers:
    """Runs each engine in its process; what ends a process is a row of data."""

    def __init__(self, poll: Callable[[], None]) -> None:
        """Begin nothing yet; `poll` is called again and again while a run is waited for, and may raise."""
        self._poll = poll
        self._workers: dict[str, Worker[Callable[[], Any], Any]] = {}
        self._scene: Scene | None = None  # that was asked for last
        self._deaths: dict[str, list[Ended]] = {}  # by engine, on that scene

    def begin(self, name: str) -> Worker[Callable[[], Any], Any]:
        """Begin an engine's process, which imports the engine while nobody waits for it."""
        worker = self._workers[name] = Worker[Callable[[], Any], Any](_called)
        worker.ask(partial(_import, name), LIMITS)
        return worker

    def end(self) -> None:
        """End all processes."""
        for worker in self._workers.values():
            worker.end()

    def run(self, name: str, scene: Scene, request: Request, settings: Settings | None = None) -> Run:
        """Build, solve and read in the engine's process; see `runner.run`."""
        if registry.ENTRIES[name].missing:
            return runner.run(name, scene, request, settings)
        chosen: Settings = settings or registry.engine(name).DEFAULT
        (outcome,) = self._runs(name, Job(scene, request, (chosen,), timed=False))
        return outcome

    def timed(self, name: str, scene: Scene, request: Request, settings: Sequence[Settings]) -> list[Run]:
        """Build and solve one after the other in the engine's process, for the times alone; see `runner.timed`."""
        return self._runs(name, Job(scene, request, settings, timed=True))

    def asked(self, name: str, scene: Scene, function: Callable[[], T], limits: Limits = LIMITS) -> T | Ended:
        """Call a function in the engine's process, about a scene on which that has not ended too often."""
        if scene is not self._scene:
            self._scene, self._deaths = scene, {}
        deaths = self._deaths.setdefault(name, [])
        if refused := registry.refused(name):
            return refused
        if len(deaths) >= TRIES or any(death.at_limit for death in deaths):
            return replace(deaths[-1], reason=f"not run again, since {deaths[-1].reason}")
        outcome = self._outcome(name, function, limits)
        if isinstance(outcome, Answer):
            return outcome.result
        deaths.append(outcome)
        return outcome

    def _runs(self, name: str, job: Job) -> list[Run]:
        outcome = self.asked(name, job.scene, partial(_done, name, job), limits(job))
        if not isinstance(outcome, Ended):
            return outcome
        version = registry.ENTRIES[name].version
        return [Run(name, each, outcome.status, outcome.reason, "isolation", version) for each in job.settings]

    def _outcome(self, name: str, function: Callable[[], T], limits: Limits) -> Answer[T] | Ended:
        worker = self._workers.get(name) or self.begin(name)
        try:
            outcome = worker.wait(self._poll) if worker.busy else None  # with the import
            if not isinstance(outcome, Ended):
                worker.ask(function, limits)
                outcome = worker.wait(self._poll)
        except BaseException:
            self._end(name)
            raise
        if isinstance(outcome, Ended):
            self._end(name)
        return outcome

    def _end(self, name: str) -> None:
        self._workers.pop(name).end()


def _called(function: Callable[[], T]) -> T:
    return function()


def _import(name: str) -> None:
    registry.imported(name).version()


def _done(name: str, job: Job) -> list[Run]:
    return [runner.attempt(name, job.scene, job.request, each, reads=not job.timed) for each in job.settings]


@contextmanager
def workers(engines: Iterable[str], poll: Callable[[], None]) -> Iterator[Runs]:
    """Yield what runs engines in processes of their own, which are begun now and ended afterwards.

    In a process that may have none of its own, as a worker of the caller's, engines run in that.

    Args:
        engines: their names; those that are not installed begin no process.
        poll: called again and again while a run is waited for; it may raise, which ends the engine's process.
    """
    if current_process().daemon:
        yield runner
        return
    begun = Workers(poll)
    try:
        for name in dict.fromkeys(engines):
            if not registry.ENTRIES[name].missing and not registry.refused(name):
                begun.begin(name)
        yield begun
    finally:
        begun.end()
