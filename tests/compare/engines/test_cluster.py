"""Tasks spread over a cluster: every outcome comes back, a stop begins no more; engines stay for the next task."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from signal import SIGKILL
from threading import Event, Thread
from time import monotonic
from typing import TYPE_CHECKING

import psutil
import pytest

from compare.engines.processes import cluster
from compare.engines.processes.cluster import spread
from compare.engines.processes.inside import Ended
from compare.engines.processes.stopping import Stopped, kept
from compare.engines.processes.workers import Lasting
from compare.measure.many.family import Asked
from compare.measure.many.going_on import going_on, kept_members
from compare.measure.many.grid import grid, variation
from compare.run import main
from scenes import InputError, Sampling, Status, load
from tests.comparisons import SLOW, sampled
from tests.deaths import DEATHS, children, do, within

if TYPE_CHECKING:
    from dask.distributed import Client

RAISED = ("recursion", "SystemExit", "non-Exception", "newlines", "an exception that cannot be sent")
done: list[str] = []
go_on = Event()


@contextmanager
def one_worker(*, processes: bool) -> Iterator["Client"]:
    import dask
    from dask.distributed import Client, LocalCluster

    settings = {"distributed.scheduler.allowed-failures": 0}
    options = {"dashboard_address": "127.0.0.1:0", "scheduler_kwargs": {"dashboard": False}, "memory_limit": 0}
    with (
        dask.config.set(settings),
        LocalCluster(n_workers=1, threads_per_worker=1, processes=processes, protocol="tcp://", **options) as here,
        Client(here, set_as_default=False) as known,
    ):
        yield known


@pytest.fixture(scope="module")
def client() -> Iterator["Client"]:
    """Yield a client of one worker in this process, a thread."""
    with one_worker(processes=False) as client:
        yield client


def wait(what: str) -> str:
    done.append(what)
    if what != "first":
        go_on.wait(60.0)
    return what


def test_every_outcome_comes_back(client: "Client") -> None:
    outcomes = dict(spread(client, do, ["a", *RAISED, "b"], lambda: None))
    assert (outcomes.pop("a"), outcomes.pop("b")) == ("A", "B")
    assert outcomes.keys() == {*RAISED}
    for name, ended in outcomes.items():
        assert isinstance(ended, Ended)
        assert (ended.status, DEATHS[name][2] in ended.reason) == (Status.crashed, True)


def test_what_tests_begin_listens_on_this_computer_alone(client: "Client") -> None:
    """Whoever reaches a scheduler or a worker runs code there."""
    assert client.cluster.scheduler_address.startswith("tcp://127.0.0.1:")
    here = psutil.Process().net_connections("tcp")
    assert {each.laddr.ip for each in here if each.status == psutil.CONN_LISTEN} == {"127.0.0.1"}


def test_a_stop_begins_no_more(client: "Client") -> None:
    def poll() -> None:
        if answers:
            raise Stopped

    answers: list[str] = []
    for item, _ in kept(spread(client, wait, ["first", "running", *(f"never {n}" for n in range(5))], poll)):
        answers.append(item)
    assert within(60.0, lambda: len(client.cluster.scheduler.tasks) <= 2)  # a moment later the scheduler knows
    (worker,) = client.cluster.workers.values()
    assert within(
        60.0, lambda: not any(task.state == "ready" for task in worker.state.tasks.values())
    )  # the worker too
    go_on.set()
    assert answers == ["first"]
    assert dict(spread(client, do, ["a"], lambda: None)) == {"a": "A"}
    begun = {*done} - {"first", "running"}
    assert len(begun) <= 1, "a worker has one that waits at most, of those that are called off in any order"


def test_a_worker_of_another_version_is_refused(client: "Client", monkeypatch: pytest.MonkeyPatch) -> None:
    versions = iter(["here", "there"])
    monkeypatch.setattr(cluster, "version", lambda: next(versions))
    with pytest.raises(InputError, match=r"^workers: expected the same versions .* has others"):
        list(spread(client, do, ["a"], lambda: None))


def test_what_is_missing_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Before anything is solved or written."""
    monkeypatch.setattr(cluster, "find_spec", lambda _: None)
    varied = ["four_bar", "--vary", "drive.speed=1:2:2", "--out", str(tmp_path / "out")]
    assert main([*varied, "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert capsys.readouterr() == (
        "",
        "--scheduler: dask is not installed: pip install 'linkage-crosscheck[dask]'\n",
    )
    assert not [*tmp_path.iterdir()]


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


@sampled(2)
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
        with pytest.raises(InputError, match=line), cluster.cluster(address):
            pytest.fail("it answers")
        assert monotonic() - began < 2 * 3.0 + 4.0  # an import of Dask, on a busy machine
    for peer in peers:
        peer.close()
    assert children() == []


def test_a_scheduler_takes_a_family(client: "Client", tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of which a member that cannot run is one, as without it."""
    monkeypatch.setattr("compare.engines.processes.workers.IDLE", 0.01)
    scene, changes = load("four_bar"), grid([variation("bodies.rocker.lengths.C-B=2:250:2")])
    asked = Asked(scene, ["analytic"], Sampling(24))
    with cluster.cluster(client.cluster.scheduler_address) as by_workers:
        members = [*going_on(kept_members(tmp_path, scene, asked), asked, changes, by_workers, lambda _: None)]
    assert {m.changes["bodies.rocker.lengths.C-B"]: m.status for m in members} == {2: "cannot_assemble", 250: "ok"}
    assert within(5.0, lambda: children() == [])


def kill(what: str) -> str:
    if what == "kill":
        os.kill(os.getpid(), SIGKILL)
    return what.upper()


@SLOW
def test_a_task_that_kills_its_worker_is_an_outcome() -> None:
    with one_worker(processes=True) as client:
        for item, outcome in (("kill", cluster.KILLED), ("a", "A")):
            assert dict(spread(client, kill, [item], lambda: None)) == {item: outcome}
    assert within(5.0, lambda: children() == [])


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
