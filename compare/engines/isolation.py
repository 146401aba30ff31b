"""Runs what may crash, hang or eat all memory in processes of its own; whatever happens there is an outcome here."""

import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from math import ceil
from multiprocessing import get_context
from time import process_time
from typing import TypeVar

from pebble import ProcessExpired, ProcessPool

from scenes import Status

SIGXCPU = getattr(signal, "SIGXCPU", 24)  # which Windows lacks
Item = TypeVar("Item")
Result = TypeVar("Result")

POLL = 0.2  # s, between two looks at whether the user asked to stop
WAIT = 10.0  # times the processor time: how long an item may take in all, on a busy machine or asleep


@dataclass(frozen=True)
class Limits:
    """What one item may take."""

    seconds: float = 30.0  # of processor time
    memory: int = 3 * 2**30  # bytes of address space, of which much is reserved and never touched
    workers: int = 2


@dataclass(frozen=True)
class Ended:
    """How an item ended that gave no result."""

    status: Status
    reason: str


def isolated(
    function: Callable[[Item], Result], items: Sequence[Item], limits: Limits, poll: Callable[[], None]
) -> Iterator[tuple[Item, Result | Ended]]:
    """Yield every item with what the function returns for it, or how it ended, as they come.

    `poll` is called again and again and may raise: then no more is begun, and what runs is ended.
    """
    with ProcessPool(
        limits.workers, initializer=_limit, initargs=(limits.memory,), context=get_context("spawn")
    ) as pool:
        try:
            pending: dict[Future[Result], Item] = {
                pool.schedule(_within, args=[limits.seconds, function, item], timeout=WAIT * limits.seconds): item
                for item in items
            }
            while pending:
                poll()
                for future in wait(pending, POLL, FIRST_COMPLETED).done:
                    yield pending.pop(future), _outcome(future.result, limits)
        finally:
            pool.stop()  # type: ignore[no-untyped-call]  # does nothing to a pool that has finished


def _limit(memory: int) -> None:
    """Prepare a worker: Ctrl-C is for the process that waits for it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        import resource
    except ImportError:  # not on Windows
        return
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # a crash is expected and leaves no file


def _within(seconds: float, function: Callable[[Item], Result], item: Item) -> Result:
    """Call a function; the process is ended by SIGXCPU when that has taken so much processor time."""
    try:
        import resource
    except ImportError:
        return function(item)
    resource.setrlimit(resource.RLIMIT_CPU, (ceil(process_time() + seconds), resource.RLIM_INFINITY))
    return function(item)


def _outcome(result: Callable[[], Result], limits: Limits) -> Result | Ended:
    try:
        return result()
    except TimeoutError:
        return Ended(Status.timed_out, f"no answer within {WAIT * limits.seconds:g} s")
    except ProcessExpired as error:
        if error.exitcode == -SIGXCPU:
            return Ended(Status.timed_out, f"no answer within {limits.seconds:g} s of processor time")
        return Ended(Status.crashed, f"its process ended by {_cause(error.exitcode)}")
    except MemoryError:
        return Ended(Status.crashed, f"it needed more than {limits.memory / 2**30:g} GiB of memory")
    except Exception as error:
        return Ended(Status.crashed, f"{type(error).__name__}: {str(error).strip().partition(chr(10))[0]}")


def _cause(exitcode: int) -> str:
    return signal.Signals(-exitcode).name if exitcode < 0 else f"exit status {exitcode}"
