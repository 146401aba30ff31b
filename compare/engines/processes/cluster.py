"""Tasks on many cores and machines by Dask, which is imported where they are asked for and nowhere else.

A task whose worker died runs again on another. Of one that was on several such workers it is not known whether it is to
blame, or another that they had: it is tried once more by itself, and then given up.
"""

import logging
import pickle
import signal
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from multiprocessing import resource_tracker
from queue import Empty, SimpleQueue
from socket import gethostname
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from scenes import InputError, Status

from ..kept import version
from .inside import Ended, Item, Limits, Result, answer, packed
from .isolation import POLL, WAIT, Poll, isolated, uninterrupted

if TYPE_CHECKING:
    from dask.distributed import Client

PATIENCE = 10  # s, for a scheduler and its workers to answer
HERE = "127.0.0.1"  # nothing listens to other machines
KILLED = Ended(Status.crashed, "every worker's process that took it died")
SETTINGS = {
    "distributed.worker.daemon": False,  # a worker has processes of its own, the engines'
    "distributed.scheduler.worker-saturation": 1.0,  # no task waits on a worker while another is idle
    "distributed.scheduler.allowed-failures": 1,  # a task is given up with the second worker that dies with it
    "distributed.worker.profile.enabled": False,  # what watches the workers took a fifth of their time
    "distributed.admin.tick.interval": "1 s",
    "distributed.admin.system-monitor.interval": "10 s",
}


def check_installed() -> None:
    """Raise InputError where there is no Dask."""
    if not find_spec("distributed"):
        raise InputError("--workers, --scheduler: dask is not installed: pip install 'linkage-crosscheck[dask]'")


@contextmanager
def cluster(workers: int, scheduler: str = "") -> Iterator["Client"]:
    """Yield a client of a cluster: of one that runs elsewhere, or of processes here, which end with it.

    Args:
        workers: how many processes to begin on this machine, where no scheduler is given.
        scheduler: address of a cluster's scheduler, as `tcp://host:8786`; its workers have this project installed.
    """
    check_installed()
    logging.disable()  # what Dask reports of workers that come and go is no matter of the user's
    try:
        with _elsewhere(scheduler) if scheduler else _here(workers) as client:
            yield client
    finally:
        logging.disable(logging.NOTSET)


@contextmanager
def _here(workers: int) -> Iterator["Client"]:
    import dask
    from dask.distributed import Client, LocalCluster

    with (
        TemporaryDirectory(prefix="linkage-", ignore_cleanup_errors=True) as scratch,
        dask.config.set(SETTINGS | {"temporary-directory": scratch}),
    ):
        resource_tracker.ensure_running()  # which lets Ctrl-C through to the thread that begins it, and its processes
        with uninterrupted(signal.SIGINT):
            begun = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                host=HERE,
                dashboard_address=f"{HERE}:0",
                scheduler_kwargs={"dashboard": False},
                memory_limit=0,  # engines have limits of their own
                silence_logs=logging.CRITICAL,
            )
        with begun, Client(begun, set_as_default=False) as client:
            yield client


@contextmanager
def _elsewhere(scheduler: str) -> Iterator["Client"]:
    from dask.distributed import Client

    ((_, greeted),) = isolated(_greet, [scheduler], Limits(PATIENCE / WAIT), lambda: None)
    if isinstance(greeted, Ended):  # whatever is there, if it sends something at all
        raise InputError(f"--scheduler {scheduler}: expected a Dask scheduler there, and none answers")
    with Client(scheduler, timeout=PATIENCE, set_as_default=False) as client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError:
            raise InputError(f"--scheduler {scheduler}: expected workers there, and none is connected") from None
        yield client


def _greet(scheduler: str) -> None:
    from dask.distributed import Client

    Client(scheduler, timeout=PATIENCE, set_as_default=False).close()


def spread(
    function: Callable[[Item], Result], items: Iterable[Item], client: "Client", poll: Poll, again: bool = True
) -> Iterator[tuple[Item, Result | Ended]]:
    """Yield every item with what the function returns for it on a worker, or how it ended, as they come.

    InputError where a worker has another version of this project or of what it needs, or the scheduler has gone.

    Args:
        function: importable on every worker, or a partial of such a one.
        items: what it is called with, one after the other on each worker.
        client: of the cluster; see `cluster`.
        poll: called again and again, and may raise: then what has not begun never will.
        again: whether what was on several workers that died is tried once more, by itself.
    """
    from dask.distributed import KilledWorker

    blamed: list[Item] = []
    done = SimpleQueue[Any]()
    running: dict[Any, Item] = {}
    try:
        for item in items:
            future = client.submit(_done, version(), bytes(packed((function, item))), pure=False)
            running[future] = item
            future.add_done_callback(done.put)
        while running:
            poll()
            try:
                future = done.get(timeout=POLL)
            except Empty:
                if client.cluster is not None:  # one that dies while it begins is not begun anew by itself
                    client.cluster.scale(len(client.cluster.worker_spec))
                continue
            item = running.pop(future)
            try:
                (outcome,) = pickle.loads(future.result())
            except KilledWorker:
                outcome = KILLED
            except CancelledError:
                raise InputError("--scheduler: it has gone; what is done is kept for another run") from None
            future.release()  # as its __del__ does, where Python would drop Ctrl-C
            if outcome is KILLED and again:
                blamed.append(item)
            else:
                yield item, outcome
    finally:
        with suppress(Exception):  # it has gone
            client.cancel(list(running))
    for item in blamed:
        yield from spread(function, [item], client, poll, again=False)


def _done(wanted: str, task: bytes) -> bytes:
    """Return the answer to a task, on a worker; another version of everything may give another."""
    if version() != wanted:
        raise InputError(f"workers: expected the same versions of everything, and one on {gethostname()} has others")
    function, item = pickle.loads(task)
    return bytes(answer(function, item, Limits()))
