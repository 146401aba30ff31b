"""Ctrl-C without loss.

The first asks to stop at the next safe point and to keep what is done, the second stops at once.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from signal import SIGINT, signal
from types import FrameType
from typing import TypeAlias, TypeVar

Progress: TypeAlias = Callable[[str], None]  # called with what is being done, again and again; it may raise
T = TypeVar("T")


class Stopped(KeyboardInterrupt):
    """The user asked to stop. Raised where progress is reported, since there nothing is half done."""


@contextmanager
def stoppable() -> Iterator[Callable[[], bool]]:
    """Yield a function: whether the user asked to stop; where that is asked again, KeyboardInterrupt is raised."""
    asked = 0

    def ask(_signal: int, _frame: FrameType | None) -> None:
        nonlocal asked
        asked += 1
        if asked > 1:
            raise KeyboardInterrupt

    before = signal(SIGINT, ask)
    try:
        yield lambda: asked > 0
    finally:
        signal(SIGINT, before)


def kept(items: Iterable[T]) -> Iterator[T]:
    """Yield items as they come, and no more once the user asked to stop."""
    with suppress(Stopped):
        yield from items
