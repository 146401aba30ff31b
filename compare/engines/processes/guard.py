"""A process that ends with all that it began, whatever became of that: its parent is its guard.

The guard runs nothing but what is here. What the guarded process began, and they in turn, are children of the guard
once their own parents have gone (it is a subreaper, of Linux), in whatever group or session they are. The guarded
process leads a group of its own, so that a signal to its group reaches no other.
"""

import os
import signal
from contextlib import suppress
from ctypes import CDLL
from pathlib import Path

PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36  # of Linux' sys/prctl.h


def begin_guarded(parent: int, own: int) -> None:
    """Return in a new process. Its guard, this one, ends when and as that ends, or by SIGTERM.

    Args:
        parent: without which the guard ends too.
        own: file that the new process alone has open.
    """
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
    os.close(own)
    ended = status = 0
    while ended != guarded and signal.sigwait(awaited) == signal.SIGCHLD:
        ended, status = os.waitpid(guarded, os.WNOHANG)
    if not ended:
        os.kill(guarded, signal.SIGKILL)
        _, status = os.waitpid(guarded, 0)
    with suppress(ChildProcessError):  # none is left
        while True:
            os.waitpid(-1, os.WNOHANG)
            for each in descendants(guard):
                with suppress(ProcessLookupError):
                    os.kill(each, signal.SIGKILL)
            os.waitpid(-1, 0)
    if os.WIFSIGNALED(status):
        _die_by(os.WTERMSIG(status))
    os._exit(os.WEXITSTATUS(status))


def _die_by(number: int) -> None:
    """End by a signal, and leave no file."""
    import resource  # not on Windows

    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if number != signal.SIGKILL:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {number})
    os.kill(os.getpid(), number)


def _end_with(system: CDLL, parent: int, by: signal.Signals) -> None:
    """Have this process get a signal when its parent dies; it may have died before."""
    system.prctl(PR_SET_PDEATHSIG, by)
    if os.getppid() != parent:
        os._exit(1)


def descendants(process: int) -> list[int]:
    """Return the processes below one, those of whom others are below first."""
    below: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has gone
            parent = int(stat.read_text("utf-8", "replace").rpartition(")")[2].split()[1])
            below.setdefault(parent, []).append(int(stat.parent.name))
    known = [process]
    for each in known:
        known += below.get(each, ())
    return known[1:]


def memory(process: int) -> int:
    """Return the bytes that a process has for itself, and its share of what it has with others; 0 where it has gone."""
    with suppress(OSError):
        lines = Path(f"/proc/{process}/smaps_rollup").read_text("ascii").splitlines()
        return 1024 * next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)
    return 0
