"""Processes for what may crash, hang or eat all memory; whatever happens there is an outcome here."""

import faulthandler
import gc
import io
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
from .reasons import TRACEBACK, described

LINUX = sys.platform == "linux"
CONTEXT = get_context("fork") if LINUX else get_context("spawn")  # a fork takes milliseconds; elsewhere it is not safe
SIGNALS: Mapping[int, str] = {each.value: each.name for each in signal.Signals}
Item = TypeVar("Item")
Result = TypeVar("Result")

OPEN: set["Connection[bytes, bytes]"] = set()  # ways to the processes of this one, which are no matter of theirs
POLL = 0.2  # s, between two looks at whether the user asked to stop
LOOK = 1.0  # s, between two looks at what processes of an engine's own take
CHUNK, HEAD = 2**20, 4  # bytes of an answer that are taken at a time, and that its size has
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


@dataclass(frozen=True)
class Answer(Generic[Result]):
    """What the function returned."""

    result: Result


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
        self._engine, self._said = 0, bytearray()  # the process that answers, once it has told; what came of a message
        self.busy = False  # whether it was asked for something whose outcome is not known

    def ask(self, item: Item, limits: Limits) -> None:
        """Have the function called, when the outcome of the last time is known."""
        self.busy = True
        self._limits, self._due, self._used = limits, monotonic() + WAIT * limits.seconds, self._processor_time()
        self._look = monotonic() + LOOK
        with suppress(OSError):  # its process has died, which is the outcome
            self.connection.send_bytes(ForkingPickler.dumps((limits, item)))

    def outcome(self) -> Answer[Result] | Ended | None:
        """Return what came of it, or None while the function is running."""
        outcome = self._outcome()
        self.busy = outcome is None
        return outcome

    def wait(self, poll: Callable[[], None]) -> Answer[Result] | Ended:
        """Return what came of it, once that is known. `poll` is called again and again; it may raise."""
        while True:
            wait([self.connection], POLL)
            if (outcome := self.outcome()) is not None:
                return outcome
            poll()

    def end(self) -> None:
        """End the process, whatever it is doing, and all that it began."""
        if LINUX:
            self._process.terminate()  # its guard, which ends the others
            self._process.join(PATIENCE)
        self._process.kill()
        self._process.join()
        OPEN.discard(self.connection)
        self.connection.close()

    def _outcome(self) -> Answer[Result] | Ended | None:
        try:
            while (message := self._message()) is not None:
                if self._engine:
                    answer: Answer[Result] | Ended = _Reader(io.BytesIO(message)).load()
                    return answer
                self._engine = int.from_bytes(message, "big")
        except (EOFError, OSError):
            return self._died()
        except Exception as error:
            return Ended(Status.crashed, f"its result cannot be read: {described(error)}")
        if self._process.exitcode is not None and not self.connection.poll():
            return self._died()
        if monotonic() >= self._look:
            self._look = monotonic() + LOOK
            if self._memory() > self._limits.memory:
                reason = f"it and what it began needed more memory {_than(self._limits)}"
                return Ended(Status.crashed, reason, at_limit=True)
        if monotonic() >= self._due:
            return self._late(f"{WAIT * self._limits.seconds:.3g} s")
        if self._processor_time() - self._used >= self._limits.seconds:
            return self._late(f"{self._limits.seconds:.3g} s of processor time")
        return None

    def _late(self, time: str) -> Ended:
        self.end()
        return Ended(Status.timed_out, f"no answer within {time}", at_limit=True)

    def _message(self) -> bytes | None:
        """Return the next message once it is whole, and wait for no more than is there.

        Raises:
            EOFError: there will be none.
        """
        if self.connection.poll():
            if sys.platform == "win32":
                return self.connection.recv_bytes()
            if not (more := os.read(self.connection.fileno(), CHUNK)):
                raise EOFError
            self._said += more
        size = int.from_bytes(self._said[:HEAD], "big", signed=True)  # as `multiprocessing` sends it
        if not 0 <= size <= self._limits.memory:
            raise ValueError("it is too large")
        if len(self._said) < HEAD + size or not self._said:
            return None
        message = bytes(self._said[HEAD : HEAD + size])
        del self._said[: HEAD + size]
        return message

    def _memory(self) -> int:
        """Return the bytes that the process and those that it began have, where it began any."""
        processes = descendants(self._process.pid or 0) if LINUX else []
        return sum(map(memory, processes)) if len(processes) > 1 else 0

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
                outcome = worker.outcome()
                if outcome is None:
                    continue
                del busy[worker]
                if isinstance(outcome, Answer):
                    idle.append(worker)
                else:  # whatever state it is in
                    worker.end()
                yield item, outcome.result if isinstance(outcome, Answer) else outcome
    finally:
        for worker in (*idle, *busy):
            worker.end()


def _than(limits: Limits) -> str:
    return f"than its limit of {limits.memory / 2**30:.3g} GiB"


class _Reader(pickle.Unpickler):
    """Reads what another process sends, and imports nothing for it: an engine's own code stays there."""

    def find_class(self, module: str, name: str) -> Any:
        """Return a class or function of what is imported here.

        Raises:
            UnpicklingError: it is of anything else.
        """
        if module not in sys.modules:
            raise pickle.UnpicklingError(f"{name} of {module} is not known outside of it")
        return super().find_class(module, name)


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
    connection.send_bytes(os.getpid().to_bytes(8, "big"))
    size = _address_space()
    while True:
        try:
            limits, item = pickle.loads(connection.recv_bytes())
        except EOFError:
            return
        _limit(size + limits.memory)
        connection.send_bytes(answer(function, item, limits))


def answer(function: Callable[[Item], Result], item: Item, limits: Limits) -> memoryview:
    """Return what the function returns for an item, or how it ended, as bytes to be sent; whatever it raises."""
    outcome: Answer[Result] | Ended
    try:
        return ForkingPickler.dumps(Answer(function(item)))
    except MemoryError:
        outcome = Ended(Status.crashed, f"it needed more memory than there is, or {_than(limits)}", at_limit=True)
    except BaseException as error:  # also what ends a process, or its result cannot be sent
        outcome = Ended(Status.crashed, described(error))
    return ForkingPickler.dumps(outcome)


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


def _address_space() -> int:
    """Return the bytes of address space that the process has, where that is known."""
    if not LINUX:
        return 0
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0]) * os.sysconf("SC_PAGE_SIZE")


def _limit(memory: int) -> None:
    """Let the process have so much address space, and leave no file where it crashes."""
    try:
        import resource
    except ImportError:  # not on Windows
        return
    for limit, value in ((resource.RLIMIT_CORE, 0), *([(resource.RLIMIT_AS, memory)] if LINUX else [])):
        _, hard = resource.getrlimit(limit)
        resource.setrlimit(limit, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))
