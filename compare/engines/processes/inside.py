"""What goes on in a process that is not this one: it is begun and limited, then answers until its parent has gone."""

import faulthandler
import gc
import os
import pickle
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import parent_process
from multiprocessing.connection import Connection, wait
from pathlib import Path
from threading import Thread
from typing import TypeVar

from scenes import Status

from ..reasons import TRACEBACK, described
from ..threads import one_thread
from .guard import begin_guarded
from .messages import packed

LINUX = sys.platform == "linux"
OPEN: set["Connection[bytes, bytes]"] = set()  # ways to the processes of this one, which are no matter of theirs
Item = TypeVar("Item")
Result = TypeVar("Result")


@dataclass(frozen=True)
class Limits:
    """What one item may take."""

    seconds: float = 30.0  # of processor time, where that is known of another process
    memory: int = 3 * 2**30  # bytes of address space beyond what its process begins with; much of it is never touched
    workers: int = 2

    @property
    def gibibytes(self) -> str:
        """The limit of memory in words."""
        return f"its limit of {self.memory / 2**30:.3g} GiB"


@dataclass(frozen=True)
class Ended:
    """How an item ended that gave no result."""

    status: Status
    reason: str
    at_limit: bool = False  # of time or memory


def serve(connection: "Connection[bytes, bytes]", function: Callable[[Item], Result], parent: int) -> None:
    """Answer until the parent has gone."""
    _prepare(parent, connection.fileno())
    connection.send_bytes(packed(os.getpid()))
    # bytes of address space that it begins with
    size = int(Path("/proc/self/statm").read_text("ascii").split()[0]) * os.sysconf("SC_PAGE_SIZE") if LINUX else 0
    with one_thread(), suppress(EOFError):
        while True:
            limits, item = pickle.loads(connection.recv_bytes())
            _limit(size + limits.memory)
            connection.send_bytes(answer(function, item, limits))


def answer(function: Callable[[Item], Result], item: Item, limits: Limits) -> memoryview:
    """The function's result for an item, or how it ended whatever it raises, as bytes of a tuple."""
    try:
        return packed((function(item),))
    except MemoryError:
        reason = f"it needed more memory than there is, or than {limits.gibibytes}"
        ended = Ended(Status.crashed, reason, at_limit=True)
    except BaseException as error:  # also what ends a process, or its result cannot be sent
        ended = Ended(Status.crashed, described(error))
    return packed((ended,))


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
    if sys.platform == "win32":
        return
    import resource

    for limit, value in ((resource.RLIMIT_CORE, 0), (resource.RLIMIT_AS, memory))[: 1 + LINUX]:
        _, hard = resource.getrlimit(limit)
        resource.setrlimit(limit, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))
