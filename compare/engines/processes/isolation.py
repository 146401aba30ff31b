"""Processes for what may crash, hang or eat all memory; whatever happens there is an outcome here.

No library's pool serves: with pebble, loky and `concurrent.futures`, what an engine began goes on after its end, an
engine asleep in C goes on after its parent was killed, half an answer hangs the pool, and time is limited on the wall
alone.
"""

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import wait
from time import monotonic
from typing import Any, Generic, TypeAlias

from scenes import InputError, Status

from ..reasons import described
from .inside import (
    LINUX,
    OWN,
    Encoding,
    Ended,
    Item,
    Limits,
    Result,
    descendants,
    memory,
    outcome_of,
    packed,
    serve,
)

CONTEXT = get_context("fork") if LINUX else get_context("spawn")  # a fork takes milliseconds; elsewhere it is not safe
SIGNALS: Mapping[int, str] = {each.value: each.name for each in signal.Signals}
POLL = 0.2  # s, between two looks at whether the user asked to stop
LOOK = 1.0  # s, between two looks at what processes of an engine's own take
PATIENCE = 2.0  # s, for a guard to end its processes
Poll: TypeAlias = Callable[[], None]  # called again and again while something is waited for; it may raise
WAIT = 3.0  # times the processor time: how long an item may take in all, on a busy machine or asleep
CHUNK, HEAD = 2**20, 4  # bytes of a message that are taken at a time, and that its size has


class Worker(Generic[Item, Result]):
    """A process that calls one function with what it is asked, one after the other, until it dies or is ended."""

    def __init__(self, function: Callable[[Item], Result], language: Encoding = OWN) -> None:
        """Begin the process; InputError where the system allows no further one.

        Args:
            function: what it calls.
            language: of its answers; `PLAIN` where anybody's code runs in it.
        """
        try:
            self.connection, theirs = CONTEXT.Pipe()
            self._process = CONTEXT.Process(target=serve, args=(theirs, function, os.getpid(), language), daemon=True)
            with uninterrupted():
                self._process.start()
        except OSError as error:
            raise InputError(f"engines: no process can be begun for them: {error.strerror}") from error
        theirs.close()
        self._language = language
        self._come = bytearray()  # of a message
        self._engine = 0  # the process that answers, once it has sent its number
        self.busy = False  # whether it was asked for something of which the outcome is not known
        self.taken = 0.0  # s of processor time that it has taken for the last item; on the wall where no other is known
        self.outcome: Result | Ended

    def ask(self, item: Item, limits: Limits) -> None:
        """Have the function called, when the outcome of the last time is known."""
        self.busy, self._limits, self._used, self.taken = True, limits, self._processor_time(), 0.0
        self._asked = monotonic()
        self._due, self._look = self._asked + WAIT * limits.seconds, self._asked + LOOK
        with suppress(OSError):  # its process has died, which is the outcome
            self.connection.send_bytes(packed((limits, item)))

    def wait(self, poll: Poll) -> Result | Ended:
        """Wait for the outcome."""
        while not self.done():
            poll()
            wait([self.connection], POLL)
        return self.outcome

    def done(self) -> bool:
        """Return whether the outcome is available, as `outcome`."""
        if self.busy and (ended := self._ended()):
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
        self.connection.close()

    def _ended(self) -> Ended | None:
        """Take what the process has sent, and return how it ended where no answer is to come."""
        self.taken = max(self.taken, self._processor_time() - self._used) if LINUX else monotonic() - self._asked
        try:
            while self.busy and (message := self._message()) is not None:
                if self._engine:
                    self.outcome, self.busy = outcome_of(message), False
                else:
                    self._engine = int(message)
        except (EOFError, OSError):
            return self._died()
        except Exception as error:
            return Ended(Status.crashed, f"its result cannot be read: {described(error)}")
        if self.busy and self._process.exitcode is not None and not self.connection.poll():
            return self._died()
        return self._beyond() if self.busy else None

    def _message(self) -> Any:
        """What was sent, once it is whole, None before that: half a message holds nobody up."""
        if self.connection.poll():
            if sys.platform == "win32":
                return self._language.read(self.connection.recv_bytes())
            if not (more := os.read(self.connection.fileno(), CHUNK)):
                raise EOFError
            self._come += more
        # Messages are reassembled from chunks: a blocking read of a whole message would hang on a process that stops in
        # the middle of it. The size is checked before anything of that size is allocated.
        end = HEAD + int.from_bytes(self._come[:HEAD], "big", signed=True)  # as `multiprocessing` sends it
        if not HEAD <= end <= HEAD + self._limits.memory:
            raise ValueError("it is too large")
        if len(self._come) < end:
            return None
        message, self._come = bytes(self._come[HEAD:end]), self._come[end:]
        return self._language.read(message)

    def _beyond(self) -> Ended | None:
        if monotonic() >= self._look:
            self._look = monotonic() + LOOK
            processes = descendants(self._process.pid or 0) if LINUX else []  # one of them answers
            if len(processes) > 1 and sum(map(memory, processes)) > self._limits.memory:
                reason = f"it and what it began needed more memory than {self._limits.gibibytes}"
                return Ended(Status.crashed, reason, at_limit=True)
        seconds = self._limits.seconds
        # Two limits: processor time for an engine that computes, WAIT times as much on the wall for one that sleeps or
        # whose processor is taken by others. A limit on the wall alone would fail runs on a busy machine.
        if monotonic() >= self._due:
            return Ended(Status.timed_out, f"no answer within {WAIT * seconds:.3g} s", at_limit=True)
        if self._processor_time() - self._used >= seconds:
            return Ended(Status.timed_out, f"no answer within {seconds:.3g} s of processor time", at_limit=True)
        return None

    def _processor_time(self) -> float:
        """Seconds that the process has used. A limit by `setrlimit` would make its own clock go by ticks of 4 ms."""
        with suppress(OSError):  # it has just ended
            # The POSIX clock of another process, to the nanosecond; /proc/PID/stat counts ticks of 10 ms.
            clock = ~self._engine << 3 | 2  # of clock_getcpuclockid(3)
            return time.clock_gettime(clock) if LINUX and self._engine else 0.0
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
    function: Callable[[Item], Result], items: Sequence[Item], limits: Limits, poll: Poll, language: Encoding = OWN
) -> Iterator[tuple[Item, Result | Ended]]:
    """Yield every item with what the function returns for it, or how it ended; where `poll` raises, all ends.

    The language is as for `Worker`.
    """
    # Workers are reused after a result and replaced after a failure, whose process may be in any state.
    left, idle, busy = list(reversed(items)), list[Worker[Item, Result]](), dict[Worker[Item, Result], Item]()
    try:
        while left or busy:
            poll()
            while left and len(busy) < limits.workers:
                worker = idle.pop() if idle else Worker(function, language)
                busy[worker] = left.pop()
                worker.ask(busy[worker], limits)
            wait([worker.connection for worker in busy], POLL)
            for worker in filter(Worker.done, [*busy]):
                item = busy.pop(worker)
                if isinstance(worker.outcome, Ended):  # whatever state it is in
                    worker.end()
                else:
                    idle.append(worker)
                yield item, worker.outcome
    finally:
        for worker in (*idle, *busy):
            worker.end()


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Have stops wait, so that they do not reach a process that has its parent's handlers still."""
    if not LINUX:
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
