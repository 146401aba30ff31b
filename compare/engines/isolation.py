"""Processes for what may crash, hang or eat all memory; whatever happens there is an outcome here."""

import faulthandler
import gc
import os
import pickle
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import ForkingPickler
from pathlib import Path
from threading import Thread
from time import monotonic
from types import MappingProxyType
from typing import Any, Generic, TypeVar

from scenes import InputError, Status

from .guard import begin_guarded, descendants, memory
from .messages import Messages
from .reasons import TRACEBACK, described

LINUX = sys.platform == "linux"
CONTEXT = get_context("fork") if LINUX else get_context("spawn")  # a fork takes milliseconds; elsewhere it is not safe
SIGNALS: Mapping[int, str] = {each.value: each.name for each in signal.Signals}
Item = TypeVar("Item")
Result = TypeVar("Result")

OPEN: set["Connection[bytes, bytes]"] = set()  # ways to the processes of this one, which are no matter of theirs
POLL = 0.2  # s, between two looks at whether the user asked to stop
LOOK = 1.0  # s, between two looks at what processes of an engine's own take
PATIENCE = 2.0  # s, for a guard to end its processes
WAIT = 3.0  # times the processor time: how long an item may take in all, on a busy machine or asleep


def _read_only(mapping: Mapping[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(mapping)


ForkingPickler.register(MappingProxyType, lambda mapping: (_read_only, (dict(mapping),)))  # scenes hold them


@dataclass(frozen=True)
class Limits:
    """What one item may take."""

    seconds: float = 30.0  # of processor time, where that is known of another process
    memory: int = 3 * 2**30  # bytes of address space beyond what its process begins with; much of it is never touched
    workers: int = 2


@dataclass(frozen=True)
class Ended:
    """How an item ended that gave no result."""

    status: Status
    reason: str
    at_limit: bool = False  # of time or memory


class Worker(Generic[Item, Result]):
    """A process that calls one function with what it is asked, one after the other, until it dies or is ended."""

    def __init__(self, function: Callable[[Item], Result]) -> None:
        """Begin the process.

        Raises:
            InputError: the system allows no further one.
        """
        try:
            self.connection, theirs = CONTEXT.Pipe()
            OPEN.add(self.connection)
            self._process = CONTEXT.Process(target=_serve, args=(theirs, function, os.getpid()), daemon=True)
            with uninterrupted(signal.SIGINT, signal.SIGTERM):
                self._process.start()
        except OSError as error:
            raise InputError(f"engines: no process can be begun for them: {error.strerror}") from error
        theirs.close()
        self._limits, self._due, self._look, self._used = Limits(), 0.0, 0.0, 0.0
        self._messages = Messages(self.connection)
        self._engine = 0  # the process that answers, once it has sent its number
        self.busy = False  # whether it was asked for something of which the outcome is not known
        self.outcome: Result | Ended

    def ask(self, item: Item, limits: Limits) -> None:
        """Have the function called, when the outcome of the last time is known."""
        self.busy = True
        self._limits, self._due, self._used = limits, monotonic() + WAIT * limits.seconds, self._processor_time()
        self._look = monotonic() + LOOK
        with suppress(OSError):  # its process has died, which is the outcome
            self.connection.send_bytes(ForkingPickler.dumps((limits, item)))

    def wait(self, poll: Callable[[], None]) -> Result | Ended:
        """Return what came of it, once that is known. `poll` is called again and again; it may raise."""
        wait([self.connection], POLL)
        while not self.done():
            poll()
            wait([self.connection], POLL)
        return self.outcome

    def done(self) -> bool:
        """Return whether it is known what came of it, which is `outcome` then."""
        if ended := self._ended():
            self.end()
            self.outcome, self.busy = ended, False
        return not self.busy

    def end(self) -> None:
        """End the process, whatever it is doing, and all that it began."""
        if LINUX:
            self._process.terminate()  # its guard, which ends the others
            self._process.join(PATIENCE)
        self._process.kill()
        self._process.join()
        OPEN.discard(self.connection)
        self.connection.close()

    def _ended(self) -> Ended | None:
        """Take what the process has sent, and return how it ended where no answer is to come."""
        try:
            while self.busy and (message := self._messages.next(self._limits.memory)) is not None:
                if self._engine:
                    (self.outcome,), self.busy = message, False
                else:
                    self._engine = message
        except (EOFError, OSError):
            return self._died()
        except Exception as error:
            return Ended(Status.crashed, f"its result cannot be read: {described(error)}")
        if self.busy and self._process.exitcode is not None and not self.connection.poll():
            return self._died()
        return self._beyond() if self.busy else None

    def _beyond(self) -> Ended | None:
        """Return which limit it is beyond."""
        if monotonic() >= self._look:
            self._look = monotonic() + LOOK
            processes = descendants(self._process.pid or 0) if LINUX else []  # one of them answers
            if len(processes) > 1 and sum(map(memory, processes)) > self._limits.memory:
                reason = f"it and what it began needed more memory {_than(self._limits)}"
                return Ended(Status.crashed, reason, at_limit=True)
        seconds = self._limits.seconds
        if monotonic() >= self._due:
            return Ended(Status.timed_out, f"no answer within {WAIT * seconds:.3g} s", at_limit=True)
        if self._processor_time() - self._used >= seconds:
            return Ended(Status.timed_out, f"no answer within {seconds:.3g} s of processor time", at_limit=True)
        return None

    def _processor_time(self) -> float:
        """Return what the process has used, s. A limit by `setrlimit` would make its own clock go by ticks of 4 ms."""
        try:
            clock = ~self._engine << 3 | 2  # of clock_getcpuclockid(3)
            return time.clock_gettime(clock) if LINUX and self._engine else 0.0
        except OSError:  # it has just ended
            return 0.0

    def _died(self) -> Ended:
        """Return how it ended that gave no answer; it may go on, its connection closed."""
        self.end()  # which leaves the exit code of what has ended
        code = self._process.exitcode or 0
        cause = SIGNALS.get(-code, f"exit status {code}")
        if cause == "SIGKILL":
            return Ended(Status.crashed, "its process was killed, as where memory runs out, or fell silent")
        return Ended(Status.crashed, f"its process ended by {cause}")


def isolated(
    function: Callable[[Item], Result], items: Sequence[Item], limits: Limits, poll: Callable[[], None]
) -> Iterator[tuple[Item, Result | Ended]]:
    """Yield every item with what the function returns for it, or how it ended, as they come.

    `poll` is called again and again and may raise: then no more is begun, and what runs is ended.
    """
    left, idle, busy = list(reversed(items)), list[Worker[Item, Result]](), dict[Worker[Item, Result], Item]()
    try:
        while left or busy:
            poll()
            while left and len(busy) < limits.workers:
                worker = idle.pop() if idle else Worker(function)
                busy[worker] = left.pop()
                worker.ask(busy[worker], limits)
            wait([worker.connection for worker in busy], POLL)
            for worker, item in [*busy.items()]:
                if not worker.done():
                    continue
                del busy[worker]
                if isinstance(worker.outcome, Ended):  # whatever state it is in
                    worker.end()
                else:
                    idle.append(worker)
                yield item, worker.outcome
    finally:
        for worker in (*idle, *busy):
            worker.end()


def _than(limits: Limits) -> str:
    return f"than its limit of {limits.memory / 2**30:.3g} GiB"


@contextmanager
def uninterrupted(*signals: signal.Signals) -> Iterator[None]:
    """Have signals wait, so that they do not reach a process that has its parent's handlers still."""
    if not LINUX:
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


# --- in the process ---------------------------------------------------------------------------------------------------


def _serve(connection: "Connection[bytes, bytes]", function: Callable[[Item], Result], parent: int) -> None:
    """Answer until the parent has gone."""
    _prepare(parent, connection.fileno())
    connection.send_bytes(ForkingPickler.dumps(os.getpid()))
    # bytes of address space that it begins with
    size = int(Path("/proc/self/statm").read_text("ascii").split()[0]) * os.sysconf("SC_PAGE_SIZE") if LINUX else 0
    while True:
        try:
            limits, item = pickle.loads(connection.recv_bytes())
        except EOFError:
            return
        _limit(size + limits.memory)
        connection.send_bytes(answer(function, item, limits))


def answer(function: Callable[[Item], Result], item: Item, limits: Limits) -> memoryview:
    """Return what the function returns for an item, or how it ended, as bytes of a tuple; whatever it raises."""
    try:
        return ForkingPickler.dumps((function(item),))
    except MemoryError:
        ended = Ended(Status.crashed, f"it needed more memory than there is, or {_than(limits)}", at_limit=True)
    except BaseException as error:  # also what ends a process, or its result cannot be sent
        ended = Ended(Status.crashed, described(error))
    return ForkingPickler.dumps((ended,))


def _prepare(parent: int, connection: int) -> None:
    """End with the parent or by SIGTERM, leave Ctrl-C to the parent, and print nothing but tracebacks on request."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    faulthandler.disable()
    nowhere, shown = os.open(os.devnull, os.O_RDWR), bool(os.environ.get(TRACEBACK))
    for stream in range(2 if shown else 3):
        os.dup2(nowhere, stream)
    sys.stdout = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - as long as the process is
    sys.stderr = sys.stderr if shown else sys.stdout
    gc.freeze()  # what came from the parent is not looked at again, and so not copied
    if LINUX:
        for each in OPEN:
            each.close()
        begin_guarded(parent, connection)
    else:
        Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)


def _limit(memory: int) -> None:
    """Let the process have so much address space, and leave no file where it crashes."""
    try:
        import resource
    except ImportError:  # not on Windows
        return
    for limit, value in ((resource.RLIMIT_CORE, 0), *([(resource.RLIMIT_AS, memory)] if LINUX else [])):
        _, hard = resource.getrlimit(limit)
        resource.setrlimit(limit, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))
