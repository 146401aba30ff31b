"""Engines' processes that are begun by one task and still there for the next: beginning them costs half of a task."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from threading import Lock, Timer

from .runner import Runs
from .workers import workers

IDLE = 20.0  # s without a task, after which they end


class Lasting:
    """What runs engines for one task after the other of a process that goes on, as a worker of a cluster does."""

    def __init__(self) -> None:
        """Begin nothing yet."""
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
