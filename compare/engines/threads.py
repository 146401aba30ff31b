"""Linear algebra on one thread: an engine's matrices are small, and threads that share one wait for each other."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

VARIABLE = "OPENBLAS_NUM_THREADS"  # in the environment: read by the library when that is loaded


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold libraries to one thread, in this process and in those begun meanwhile; unless the environment has a number.

    Those that are loaded are held by `threadpoolctl`, those still to come by the environment.
    """
    if VARIABLE in os.environ:
        yield
        return
    before = {**os.environ}
    from threadpoolctl import threadpool_limits  # late: a command has its number from its first moment on

    for name in os.environ.keys() - before.keys():  # its import sets KMP_DUPLICATE_LIB_OK
        del os.environ[name]
    os.environ[VARIABLE] = "1"
    try:
        with threadpool_limits(1, "blas"):
            yield
    finally:
        os.environ.pop(VARIABLE, None)
