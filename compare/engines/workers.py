"""Every engine in a process of its own, kept warm from run to run, so that none takes a run of the others down."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from multiprocessing import current_process
from operator import call
from typing import Any, TypeVar

from scenes import Request, Sampling, Scene, Settings

from . import registry, runner
from .isolation import Ended, Limits, Worker
from .runner import Run, Runs

SECONDS, MEMORY = 20.0, 2 * 2**30  # of processor time, and bytes, for a run of few samples: a hang ends soon
SECONDS_EACH = 1e-4  # more for every value asked for, or found on the way; the slowest settings take a tenth
LIMITS = Limits(SECONDS)  # of what is no run
MEMORY_EACH = 256  # bytes more for every one of those; a motion is 8
TRIES = 3  # processes that may crash on a scene before its engine is not begun anew


T = TypeVar("T")


def limits(scene: Scene, request: Request, settings: Sequence[Settings]) -> Limits:
    """Return what runs may take, which grows with the rows, or steps, and channels that they have."""
    cycles = request.turns if isinstance(request, Sampling) else 1
    rows = sum(max(request.count, cycles * (getattr(each, "steps", None) or 0)) for each in settings)
    values = rows * len(request.wanted(scene))
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
        worker = self._workers[name] = Worker[Callable[[], Any], Any](call)
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
        (outcome,) = self._runs(name, scene, request, (chosen,), reads=True)
        return outcome

    def timed(self, name: str, scene: Scene, request: Request, settings: Sequence[Settings]) -> list[Run]:
        """Build and solve one after the other in the engine's process, for the times alone; see `runner.timed`."""
        return self._runs(name, scene, request, settings, reads=False)

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
        if isinstance(outcome, Ended):
            deaths.append(outcome)
        return outcome

    def _runs(
        self, name: str, scene: Scene, request: Request, settings: Sequence[Settings], *, reads: bool
    ) -> list[Run]:
        attempts = [partial(runner.attempt, name, scene, request, each, reads=reads) for each in settings]
        outcome = self.asked(name, scene, partial(_all, attempts), limits(scene, request, settings))
        if not isinstance(outcome, Ended):
            return outcome
        version = registry.ENTRIES[name].version
        return [Run(name, each, outcome.status, outcome.reason, "isolation", version) for each in settings]

    def _outcome(self, name: str, function: Callable[[], T], limits: Limits) -> T | Ended:
        worker = self._workers.get(name) or self.begin(name)
        try:
            if worker.busy:  # with the import
                worker.wait(self._poll)
            if not isinstance(worker.outcome, Ended):
                worker.ask(function, limits)
                worker.wait(self._poll)
        finally:
            if worker.busy or isinstance(worker.outcome, Ended):
                self._workers.pop(name).end()
        return worker.outcome


def _import(name: str) -> None:
    registry.imported(name).version()


def _all(functions: Sequence[Callable[[], T]]) -> list[T]:
    return [*map(call, functions)]


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
