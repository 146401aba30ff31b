"""Tasks on many machines by a Dask cluster, which is imported where one is asked for and nowhere else."""

import logging
import pickle
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, wait
from contextlib import contextmanager, suppress
from functools import partial
from importlib.util import find_spec
from socket import gethostname
from typing import TYPE_CHECKING, Any

from scenes import InputError, Status

from ..kept import version
from .inside import OWN, Ended, Item, Limits, Result, answer, outcome_of, packed
from .isolation import POLL, WAIT, Poll, isolated

if TYPE_CHECKING:
    from dask.distributed import Client

PATIENCE = 10  # s, for a scheduler and its workers to answer
KILLED = Ended(Status.crashed, "every worker's process that took it died")


@contextmanager
def cluster(scheduler: str) -> Iterator[Callable[..., Iterator[Any]]]:
    """Yield `spread` for the cluster with a scheduler, as `tcp://host:8786`, whose workers have this project installed.

    InputError where there is no Dask, or none answers there, or none of its workers.
    """
    if not find_spec("distributed"):
        raise InputError("--scheduler: dask is not installed: pip install 'linkage-crosscheck[dask]'")
    logging.disable()  # what Dask reports of workers that come and go is no matter of the user's
    try:
        # Whatever listens there may accept and stay silent: the first contact is made in a process that can be ended.
        ((_, greeted),) = isolated(_greet, [scheduler], Limits(PATIENCE / WAIT), lambda: None)
        if isinstance(greeted, Ended):  # whatever is there, if it sends something at all
            raise InputError(f"--scheduler {scheduler}: expected a Dask scheduler there, and none answers")
        with _client(scheduler) as client:
            try:
                client.wait_for_workers(1, timeout=PATIENCE)
            except TimeoutError:
                why = "expected workers there, and none is connected"
                raise InputError(f"--scheduler {scheduler}: {why}") from None
            yield partial(spread, client)
    finally:
        logging.disable(logging.NOTSET)


def _greet(scheduler: str) -> None:
    _client(scheduler).close()


def _client(scheduler: str) -> "Client":
    from dask.distributed import Client

    return Client(scheduler, timeout=PATIENCE, set_as_default=False)


def spread(
    client: "Client", function: Callable[[Item], Result], items: Iterable[Item], poll: Poll
) -> Iterator[tuple[Item, Result | Ended]]:
    """Yield every item with what the function returns for it on a worker, or how it ended, as they come.

    A task whose worker died runs again on another, as often as the scheduler allows. InputError where a worker has
    another version of this project or of what it needs, or the scheduler has gone.

    Args:
        client: of the cluster; see `cluster`.
        function: importable on every worker, or a partial of such a one.
        items: what it is called with, one after the other on each worker.
        poll: called again and again, and may raise: then what has not begun never will.
    """
    from dask.distributed import KilledWorker

    executor = client.get_executor(pure=False)
    try:
        # Function and item travel as one pickle beside a version: the worker compares versions before it opens the
        # pickle, whose classes may be others there.
        running = {executor.submit(_done, version(), packed((function, item))): item for item in items}
        while running:
            poll()
            for future in wait(running, POLL, FIRST_COMPLETED).done:
                item = running.pop(future)
                try:
                    outcome = outcome_of(pickle.loads(future.result()))
                except KilledWorker:
                    outcome = KILLED
                except CancelledError:
                    raise InputError("--scheduler: it has gone; what is done is kept for another run") from None
                yield item, outcome
    finally:
        with suppress(Exception):  # it has gone
            executor.shutdown(wait=False)


def _done(wanted: str, task: bytes) -> bytes:
    """Return the answer to a task, on a worker; another version of everything may give another."""
    if version() != wanted:
        raise InputError(f"workers: expected the same versions of everything, and one on {gethostname()} has others")
    function, item = pickle.loads(task)
    return answer(function, item, Limits(), OWN)
