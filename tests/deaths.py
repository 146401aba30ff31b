"""Every way in which an engine can take its process down, or return what nobody can take; and engines that do so."""

import ctypes
import os
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import count
from multiprocessing import active_children, resource_tracker
from typing import Any, TypeAlias

import numpy as np
import psutil
import pytest

from compare.engines import registry
from scenes import Failure, Motion, Status

MEMORY = 2**30  # bytes, the limit in tests


class Odd(BaseException):
    """Not caught by `except Exception`."""


class Mute(Exception):  # noqa: N818
    """It has no text."""

    def __str__(self) -> str:
        raise SystemExit(4)


class Unsendable(Exception):  # noqa: N818
    """It does not pickle."""

    def __init__(self) -> None:
        super().__init__("not to be sent", lambda: None)


def _raise(error: BaseException) -> None:
    raise error


def _recurse() -> None:
    _recurse()


def _spin() -> None:
    while True:
        pass


def _talk() -> None:
    print("to the user", flush=True)
    os.write(1, b"by the system\n")
    os.write(2, b"as an error\n")
    os._exit(5)


def _fall_silent() -> None:
    os.closerange(3, 256)
    time.sleep(600)


def _half_an_answer() -> None:
    for descriptor in range(3, 64):
        with suppress(OSError):
            if stat.S_ISSOCK(os.fstat(descriptor).st_mode):  # the way back: a mebibyte is announced, and never comes
                os.write(descriptor, b"\x00\x10\x00\x00half")
    time.sleep(600)


def _end_the_group() -> None:
    os.killpg(0, signal.SIGTERM)
    time.sleep(600)


def begun(seconds: int, **options: Any) -> "subprocess.Popen[bytes]":
    return subprocess.Popen(["sleep", str(seconds)], **options)


Deaths: TypeAlias = Mapping[str, tuple[Callable[[], object], Status, str]]  # by name: how, its status, and why
TWELVE: Deaths = {
    "abort": (os.abort, Status.crashed, "its process ended by SIGABRT"),
    "segmentation fault": (lambda: ctypes.string_at(0), Status.crashed, "its process ended by SIGSEGV"),
    "exit": (lambda: os._exit(3), Status.crashed, "its process ended by exit status 3"),
    "SystemExit": (lambda: sys.exit("bye"), Status.crashed, "SystemExit: bye"),
    "hang in Python": (_spin, Status.timed_out, "of processor time"),
    "hang in C": (lambda: sum(count()), Status.timed_out, "of processor time"),
    "memory": (lambda: np.empty(4 * MEMORY, np.uint8), Status.crashed, "emory"),
    "recursion": (_recurse, Status.crashed, "RecursionError: maximum recursion depth exceeded"),
    "non-Exception": (lambda: _raise(Odd("not caught")), Status.crashed, "Odd: not caught"),
    "newlines": (lambda: _raise(RuntimeError("\n\n\n")), Status.crashed, "RuntimeError: no message"),
    "surrogates": (lambda: _raise(RuntimeError("of \ud800")), Status.crashed, "RuntimeError: of \\ud800"),
    "a megabyte": (lambda: _raise(RuntimeError("much " * 200_000)), Status.crashed, "…"),
}
FURTHER: Deaths = {
    "much talk": (_talk, Status.crashed, "its process ended by exit status 5"),
    "KeyboardInterrupt": (lambda: _raise(KeyboardInterrupt()), Status.crashed, "KeyboardInterrupt: no message"),
    "an exception without text": (lambda: _raise(Mute()), Status.crashed, "Mute: no message"),
    "an exception that cannot be sent": (lambda: _raise(Unsendable()), Status.crashed, "Unsendable: ('not to be sent'"),
    "a closed connection": (_fall_silent, Status.crashed, "its process was killed"),
    "an escape sequence": (lambda: _raise(Failure(Status.diverged, "\x1b[31m\n")), Status.diverged, "[31m"),
    "a Failure of no status": (lambda: _raise(Failure("odd", "why")), Status.crashed, "ValueError: 'odd' is"),  # type: ignore[arg-type]
    "its group": (_end_the_group, Status.crashed, "its process ended by SIGTERM"),
    "no motion": (lambda: None, Status.crashed, "TypeError: expected scenes.Motion, found NoneType"),
    "samples of functions": (
        lambda: Motion({"time": lambda: 0}),  # type: ignore[dict-item]
        Status.crashed,
        "time is of object, expected float64",
    ),
}
ASLEEP: Deaths = {  # which only the time on the wall ends
    "asleep": (lambda: time.sleep(600), Status.timed_out, "no answer within"),
    "half an answer": (_half_an_answer, Status.timed_out, "no answer within"),
    "asleep in C": (lambda: ctypes.PyDLL(None).sleep(600), Status.timed_out, "no answer within"),  # with Python's lock
}
DEATHS = {**TWELVE, **FURTHER, **ASLEEP}


def do(what: str) -> str:
    """Die, or answer, as an item of a process of its own."""
    if what in DEATHS:
        DEATHS[what][0]()
    return what.upper()


class Doomed:
    """A real engine that dies on the way to its result."""

    counters: Mapping[str, int] = {}
    residuals: Mapping[str, float] = {}

    def __init__(self, real: Any, death: str, stage: str) -> None:
        self._real, self._death, self._stage = real, death, stage

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real, name)

    def _reached(self, stage: str) -> Any:
        return DEATHS[self._death][0]() if stage == self._stage else None

    def build(self, *_: object) -> "Doomed":
        self._reached("build")
        return self

    def solve(self) -> None:
        self._reached("solve")

    def read(self) -> Any:
        return self._reached("read")


@contextmanager
def doomed(deaths: Mapping[str, str], stage: str = "solve") -> Iterator[None]:
    """Have engines die, each its death, under tight limits; afterwards no process may be left."""
    real = registry.engine

    def engine(name: str) -> Any:
        return Doomed(real(name), deaths[name], stage) if name in deaths else real(name)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(registry, "engine", engine)
        patch.setattr("compare.engines.runner.SECONDS", 0.5)
        patch.setattr("compare.engines.runner.SECONDS_EACH", 2e-5)
        patch.setattr("compare.engines.processes.isolation.WAIT", 2.0 if {*deaths.values()} & {*ASLEEP} else 1e3)
        patch.setattr("compare.engines.runner.MEMORY", MEMORY)
        yield
    assert active_children() == []
    assert children() == []


def children() -> list[int]:
    """Return the processes of this one that go on, but for multiprocessing's own, which begins with the first pool."""
    tracker = resource_tracker._resource_tracker._pid  # type: ignore[attr-defined]
    return [child.pid for child in psutil.Process().children() if child.pid != tracker and alive(child.pid)]


def alive(number: int) -> bool:
    with suppress(psutil.NoSuchProcess):
        return bool(psutil.Process(number).status() != psutil.STATUS_ZOMBIE)
    return False


def within(seconds: float, true: Callable[[], bool]) -> bool:
    end = time.monotonic() + seconds
    while not true() and time.monotonic() < end:
        time.sleep(0.02)
    return true()
