"""Every engine in a process of its own, kept warm from run to run, so that none takes a run of the others down."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from math import isnan
from multiprocessing import current_process
from operator import call
from threading import Lock, Timer
from typing import Any, TypeVar

from scenes import Request, Scene

from .. import registry
from ..runner import HERE, LIMITS, Run, Runs, Several
from ..threads import one_thread
from .inside import PLAIN, Ended, Limits
from .isolation import Poll, Worker

MAX_TRIES = 3  # processes that may crash on a scene before its engine is not begun anew
IDLE = 20.0  # s without a task, after which processes that are kept for the next one end

T = TypeVar("T")


class Workers(Runs):
    """Runs each engine in its process; what ends a process is a row of data."""

    def __init__(self, poll: Poll) -> None:
        self._poll = poll
        self._workers: dict[str, Worker[Callable[[], Any], Any]] = {}
        self._taken = 0.0  # s, by what was asked for last, see `Worker.taken`
        self._scene: Scene | None = None  # that was asked for last
        self._deaths: dict[str, list[Ended]] = {}  # by engine, on that scene

    def _runs(self, name: str, scene: Scene, request: Request, settings: Several, *, reads: bool) -> list[Run]:
        self._taken = 0.0
        ended = super()._runs(name, scene, request, settings, reads=reads)
        seconds = sum(run.seconds for run in ended)
        self.apart += self._taken if isnan(seconds) else seconds  # a run that failed has no times
        return ended

    def begin(self, name: str) -> Worker[Callable[[], Any], Any]:
        """Begin an engine's process, which imports the engine while nobody waits for it."""
        worker = self._workers[name] = Worker[Callable[[], Any], Any](call, PLAIN)
        worker.ask(partial(_import, name), LIMITS)
        return worker

    def end(self) -> None:
        """End all processes."""
        for worker in self._workers.values():
            worker.end()

    def asked(self, name: str, scene: Scene, function: Callable[[], T], limits: Limits = LIMITS) -> T | Ended:
        """Call a function in the engine's process, about a scene on which that has not ended too often."""
        if scene is not self._scene:
            self._scene, self._deaths = scene, {}
        deaths = self._deaths.setdefault(name, [])
        if refused := registry.refused(name):
            return refused
        # A crash may be chance and is tried again; a limit of time or memory that was reached would be reached again.
        if len(deaths) >= MAX_TRIES or any(death.at_limit for death in deaths):
            return replace(deaths[-1], reason=f"not run again, since {deaths[-1].reason}")
        outcome = self._outcome(name, function, limits)
        if isinstance(outcome, Ended):
            deaths.append(outcome)
        return outcome

    def _outcome(self, name: str, function: Callable[[], T], limits: Limits) -> T | Ended:
        worker = self._workers.get(name) or self.begin(name)
        try:
            if worker.busy:  # with the import
                worker.wait(self._poll)
            if not isinstance(worker.outcome, Ended):
                worker.ask(function, limits)
                worker.wait(self._poll)
        finally:
            self._taken = worker.taken
            if worker.busy or isinstance(worker.outcome, Ended):
                self._workers.pop(name).end()
        return worker.outcome


def _import(name: str) -> None:
    registry.imported(name).version()


@contextmanager
def workers(engines: Iterable[str], poll: Poll) -> Iterator[Runs]:
    """Yield what runs engines in processes of their own, which are begun now and ended afterwards.

    In a process that may have none of its own, as a worker of the caller's, engines run in that.
    """
    with one_thread():
        if current_process().daemon:
            yield HERE
            return
        begun = Workers(poll)
        try:
            for name in dict.fromkeys(engines):
                if not registry.ENTRIES[name].missing and not registry.refused(name):
                    begun.begin(name)
            yield begun
        finally:
            begun.end()


class Lasting:
    """What runs engines for one task after the other of a process that goes on, as a worker of a cluster does."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._begun = ExitStack()
        self._runs: Runs | None = None
        self._ending = Timer(IDLE, self._end)

    @contextmanager
    def runs(self, engines: tuple[str, ...]) -> Iterator[Runs]:
        """Yield what runs engines, these by name without delay; another thread's task waits until this one is done."""
        with self._lock:
            self._ending.cancel()
            self._runs = self._runs or self._begun.enter_context(workers(engines, lambda: None))
            try:
                yield self._runs
            finally:
                self._ending = Timer(IDLE, self._end)
                self._ending.daemon = True
                self._ending.start()

    def _end(self) -> None:
        with self._lock:
            self._begun.close()
            self._runs = None
