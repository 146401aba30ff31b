"""Tasks spread over workers: every outcome comes back, a stop begins no more, and engines stay for the next task."""

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread
from time import monotonic
from typing import TYPE_CHECKING

import pytest

from compare.engines.processes import cluster
from compare.engines.processes.cluster import check_installed, spread
from compare.engines.processes.inside import Ended
from compare.engines.processes.stopping import Stopped, kept
from compare.engines.processes.workers import Lasting
from scenes import InputError, Sampling, Status, load
from tests.deaths import DEATHS, children, do, within

if TYPE_CHECKING:
    from dask.distributed import Client

RAISED = ("recursion", "SystemExit", "non-Exception", "newlines", "an exception that cannot be sent")
done: list[str] = []
go_on = Event()


@pytest.fixture(scope="module")
def client() -> Iterator["Client"]:
    """Yield a client of one worker in this process, a thread."""
    from dask.distributed import Client, LocalCluster

    options = {"dashboard_address": "127.0.0.1:0", "scheduler_kwargs": {"dashboard": False}, "memory_limit": 0}
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, **options) as here, Client(here) as known:
        yield known


def wait(what: str) -> str:
    done.append(what)
    if what != "first":
        go_on.wait(60.0)
    return what


def test_every_outcome_comes_back(client: "Client") -> None:
    outcomes = dict(spread(do, ["a", *RAISED, "b"], client, lambda: None))
    assert (outcomes.pop("a"), outcomes.pop("b")) == ("A", "B")
    assert outcomes.keys() == {*RAISED}
    for name, ended in outcomes.items():
        assert isinstance(ended, Ended)
        assert (ended.status, DEATHS[name][2] in ended.reason) == (Status.crashed, True)


def test_a_stop_begins_no_more(client: "Client") -> None:
    def poll() -> None:
        if answers:
            raise Stopped

    answers: list[str] = []
    for item, _ in kept(spread(wait, ["first", "running", *(f"never {n}" for n in range(5))], client, poll)):
        answers.append(item)
    assert within(5.0, lambda: len(client.cluster.scheduler.tasks) <= 2)  # a moment later the scheduler knows
    go_on.set()
    assert answers == ["first"]
    assert dict(spread(do, ["a"], client, lambda: None)) == {"a": "A"}
    assert set(done) <= {"first", "running", "never 0"}, "a worker has one that waits at most"


def test_a_worker_of_another_version_is_refused(client: "Client", monkeypatch: pytest.MonkeyPatch) -> None:
    versions = iter(["here", "there"])
    monkeypatch.setattr(cluster, "version", lambda: next(versions))
    with pytest.raises(InputError, match=r"^workers: expected the same versions .* has others"):
        list(spread(do, ["a"], client, lambda: None))


def test_what_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "find_spec", lambda _: None)
    with pytest.raises(InputError, match=r"dask is not installed: pip install 'linkage-crosscheck\[dask\]'"):
        check_installed()


REPLIES = {
    "nothing": b"",
    "a web page": b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n",
    "anything": (2**62).to_bytes(8, "little") * 100,
}


def answer(server: socket.socket, reply: bytes, peers: list[socket.socket]) -> None:
    with suppress(OSError):  # until it is closed
        while True:
            peer, _ = server.accept()
            peers.append(peer)  # which stays open
            if reply:
                peer.recv(1000)
                peer.sendall(reply)
                peer.close()


@pytest.mark.parametrize("what", [*REPLIES, "nobody"])
def test_what_is_no_scheduler_is_named_in_time(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A peer that says nothing, a web server, one that says anything, and a port where nobody listens."""
    monkeypatch.setattr(cluster, "PATIENCE", 3.0)
    peers: list[socket.socket] = []
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1] if what in REPLIES else 1
        Thread(target=answer, args=(server, REPLIES.get(what, b""), peers), daemon=True).start()
        began, address = monotonic(), f"tcp://127.0.0.1:{port}"
        line = f"^--scheduler {address}: expected a Dask scheduler there, and none answer"
        with pytest.raises(InputError, match=line), cluster.cluster(0, address):
            pytest.fail("it answers")
        assert monotonic() - began < 2 * 3.0 + 4.0  # an import of Dask, on a busy machine
    for peer in peers:
        peer.close()
    assert children() == []


def test_a_scheduler_that_runs_elsewhere(tmp_path: Path) -> None:
    code = (
        "from dask.distributed import LocalCluster\n"
        "if __name__ == '__main__':\n"
        "    with LocalCluster(n_workers=1, processes=False, dashboard_address=None, protocol='tcp://') as here:\n"
        "        print(here.scheduler_address, flush=True); input()\n"
    )
    command, pipe = [sys.executable, "-c", code], subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, cwd=tmp_path, text=True) as other:
        assert other.stdout is not None
        address = other.stdout.readline().strip()
        assert address.startswith("tcp://")
        with cluster.cluster(0, address) as client:
            assert dict(spread(str.upper, ["a"], client, lambda: None)) == {"a": "A"}
        other.kill()


def test_engines_stay_for_the_next_task_and_end_after_the_last(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compare.engines.processes.workers.IDLE", 600.0)
    lasting, scene = Lasting(), load("four_bar")
    begun = []
    for engines in (("analytic",), ("analytic",), ("analytic", "pymunk")):
        with lasting.runs(engines) as runs:
            assert {runs.run(engine, scene, Sampling(24)).status for engine in engines} == {Status.ok}
            begun.append(children())
    assert begun[0] == begun[1]
    assert [len(each) for each in begun] == [1, 1, 2]
    monkeypatch.setattr("compare.engines.processes.workers.IDLE", 0.01)
    with lasting.runs(("analytic", "pymunk")):
        assert children() == begun[2]
    assert within(5.0, lambda: children() == [])
