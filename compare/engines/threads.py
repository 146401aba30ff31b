"""Linear algebra on one thread: an engine's matrices are small, and threads that share one wait for each other."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

VARIABLE = "OPENBLAS_NUM_THREADS"  # in the environment: read by the library when that is loaded


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold libraries to one thread, in this process and in those begun meanwhile; unless the environment has a number.

    Those that are loaded are held by `threadpoolctl`, those still to come by the environment.
    """
    if VARIABLE in os.environ:
        yield
        return
    os.environ[VARIABLE] = "1"
    try:
        with _loaded(len(sys.modules)).limit(limits=1, user_api="blas"):
            yield
    finally:
        os.environ.pop(VARIABLE, None)


@cache
def _loaded(_: int) -> "ThreadpoolController":
    """Return the libraries that so many modules have brought: a look at them takes 2 ms."""
    before = {**os.environ}
    from threadpoolctl import ThreadpoolController  # late: a command has its number from its first moment on

    for name in os.environ.keys() - before.keys():  # which its import sets
        del os.environ[name]
    return ThreadpoolController()
