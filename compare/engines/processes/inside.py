"""The worker process: its limits, its request loop, and the guard that ends all that it began.

Its parent is the guard, which runs only the code below and ends every process that the worker began. The guard is a
subreaper (Linux): a process below it whose parent has gone becomes its child, in whatever group or session it is. The
guarded process leads a group of its own, so that a signal to its group reaches no other.
"""

import faulthandler
import gc
import os
import pickle
import signal
import sys
import warnings
from collections.abc import Callable
from contextlib import suppress
from ctypes import CDLL
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing import parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.reduction import ForkingPickler
from pathlib import Path
from stat import S_ISSOCK
from threading import Thread
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from scenes import Scene, Status

from .. import TRACEBACK
from ..reasons import described, text_of
from ..threads import one_thread
from . import messages

LINUX = sys.platform == "linux"
PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36  # of Linux' sys/prctl.h
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


class Encoding(NamedTuple):
    """How answers are written in a process, and read by its parent."""

    written: Callable[[Any], bytes]
    read: Callable[[bytes], Any]


def serve(
    connection: "Connection[bytes, bytes]", function: Callable[[Item], Result], parent: int, language: Encoding
) -> None:
    """Answer until the parent has gone."""
    _prepare(parent, connection.fileno())
    connection.send_bytes(language.written(os.getpid()))
    # bytes of address space that it begins with
    size = int(Path("/proc/self/statm").read_text("ascii").split()[0]) * os.sysconf("SC_PAGE_SIZE") if LINUX else 0
    with one_thread(), suppress(EOFError):
        while True:
            limits, item = pickle.loads(connection.recv_bytes())
            if LINUX:
                _limit("RLIMIT_AS", size + limits.memory)
            connection.send_bytes(answer(function, item, limits, language))


def answer(function: Callable[[Item], Result], item: Item, limits: Limits, language: "Encoding") -> bytes:
    """The function's result for an item, or how it ended whatever it raises, in a message; see `outcome_of`."""
    try:
        return language.written([function(item)])
    except MemoryError:
        reason = f"it needed more memory than there is, or than {limits.gibibytes}"
        return language.written([None, reason, True])
    except BaseException as error:  # also what ends a process, or its result cannot be sent
        return language.written([None, described(error), False])


def outcome_of(message: Any) -> Any:
    """What a message has that `answer` wrote, or raise what is wrong with it."""
    result, *why = message
    if not why:
        return result
    reason, at_limit = why
    return Ended(Status.crashed, text_of(reason), at_limit=at_limit is True)


def packed(message: object) -> bytes:
    """A pickle of a message, for those that read it to believe: whoever writes it has code run there."""
    return bytes(ForkingPickler.dumps(message))


OWN = Encoding(packed, pickle.loads)  # between processes of this project's own code
PLAIN = Encoding(messages.written, messages.read)  # of a process with anybody's code: numbers and text


def _read_only(mapping: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(mapping)


ForkingPickler.register(MappingProxyType, lambda mapping: (_read_only, (dict(mapping),)))  # scenes hold them


# Run after run is of one scene: it is written once, and what reads it keeps what it read, with all that was found of it
# since. To write and to read one takes as long as a closed form's run.
_sent: tuple[Scene | None, bytes] = (None, b"")  # the last, as it was when it was sent first


def _to_send(scene: Scene) -> tuple[Callable[[bytes], Scene], tuple[bytes]]:
    global _sent
    known = _sent if _sent[0] is scene else (scene, packed(vars(scene)))
    _sent = known
    return _received, (known[1],)


@lru_cache(1)
def _received(fields: bytes) -> Scene:
    scene = Scene.__new__(Scene)
    vars(scene).update(pickle.loads(fields))
    return scene


ForkingPickler.register(Scene, _to_send)


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
    warnings.simplefilter("ignore")  # which would end a run under `-W error`, and are shown nowhere
    gc.freeze()  # what came from the parent is not looked at again, and so not copied
    if sys.platform != "win32":
        _limit("RLIMIT_CORE", 0)  # no file is left where it crashes
    if LINUX:
        _leave_sockets(nowhere, connection)
        _begin_guarded(parent, connection)
    else:
        Thread(target=_end_with_parent, daemon=True).start()


# A fork inherits all open sockets. An engine's code could write into another engine's pipe, and the parent would take
# that for an answer.
def _leave_sockets(nowhere: int, connection: int) -> None:
    """Close all connections but its own: the others lead to other engines, or to a reader that trusts the parent.

    Their numbers stay taken, as somebody may close them yet.
    """
    for number in [int(link.name) for link in Path("/proc/self/fd").iterdir()]:
        with suppress(OSError):  # of the list itself
            if number != connection and S_ISSOCK(os.fstat(number).st_mode):
                os.dup2(nowhere, number)


def _limit(limit: str, value: int) -> None:
    import resource  # not on Windows

    number = getattr(resource, limit)
    _, hard = resource.getrlimit(number)
    resource.setrlimit(number, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)


# --- the guard --------------------------------------------------------------------------------------------------------


# Two processes for each worker. The first stays behind as the guard: it is a subreaper, so that every orphan below it
# becomes its child, and it ends them all when the worker ends, when its own parent dies (parent death signal) or by
# SIGTERM. Killing by process group alone would miss children that made a session of their own. The guard ends by the
# same signal or status as the worker, which the parent then reads as the worker's. SIGKILL of the guard itself ends the
# worker by its parent death signal, but not what the worker began.
def _begin_guarded(parent: int, connection: int) -> None:
    """Return in a new process. Its guard, this one, ends when and as that ends, or by SIGTERM, or with its parent."""
    system, awaited = CDLL(None), {signal.SIGTERM, signal.SIGCHLD}
    signal.pthread_sigmask(signal.SIG_BLOCK, awaited)
    system.prctl(PR_SET_CHILD_SUBREAPER, 1)
    _end_with(system, parent, signal.SIGTERM)
    guard, guarded = os.getpid(), os.fork()
    if not guarded:
        os.setpgid(0, 0)
        _end_with(system, guard, signal.SIGKILL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, awaited)
        return
    os.close(connection)  # which the new process alone has open
    ended = status = 0
    while ended != guarded and signal.sigwait(awaited) == signal.SIGCHLD:
        ended, status = os.waitpid(guarded, os.WNOHANG)
    if not ended:
        os.kill(guarded, signal.SIGKILL)
        _, status = os.waitpid(guarded, 0)
    with suppress(ChildProcessError):  # none is left
        while True:
            # Children may fork while the list is read: kill, reap one, list again, until there is no child left.
            os.waitpid(-1, os.WNOHANG)
            for each in descendants(guard):
                with suppress(ProcessLookupError):
                    os.kill(each, signal.SIGKILL)
            os.waitpid(-1, 0)
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        if number != signal.SIGKILL:
            signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {number})
        os.kill(guard, number)
    os._exit(os.WEXITSTATUS(status))


def _end_with(system: CDLL, parent: int, sent: signal.Signals) -> None:
    """Have this process get a signal when its parent dies; it may have died before."""
    system.prctl(PR_SET_PDEATHSIG, sent)
    if os.getppid() != parent:
        os._exit(1)


def descendants(process: int) -> list[int]:
    """Return the processes below one, those of whom others are below first."""
    # Breadth first: the list grows while it is walked, parents before their children.
    children = Path("/proc/self/task", str(os.getpid()), "children").exists()  # kernels may be built without
    below, known = _children if children else _by_parent().get, [process]
    for each in known:
        known += below(each) or ()
    return known[1:]


def _children(process: int) -> list[int]:
    """Return the processes that each thread of a process has started."""
    found: list[int] = []
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        with suppress(OSError):  # it has gone
            found += map(int, task.read_text("ascii").split())
    return found


def _by_parent() -> dict[int, list[int]]:
    """Return the processes below each, of all processes of the machine."""
    below: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has gone
            parent = int(stat.read_text("utf-8", "replace").rpartition(")")[2].split()[1])
            below.setdefault(parent, []).append(int(stat.parent.name))
    return below


def memory(process: int) -> int:
    """Return the bytes that a process has for itself, and its share of what it has with others; 0 where it has gone."""
    with suppress(OSError):
        lines = Path(f"/proc/{process}/smaps_rollup").read_text("ascii").splitlines()
        return 1024 * next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)
    return 0
