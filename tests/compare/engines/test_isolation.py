"""Processes of their own: whatever happens in one is an outcome, and the others go on."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path
from threading import Thread

import psutil
import pytest

from compare.engines.processes import isolation
from compare.engines.processes.inside import Ended, Limits, _by_parent, descendants
from compare.engines.processes.isolation import isolated
from compare.engines.processes.stopping import Stopped, kept
from scenes import Status
from tests.comparisons import sampled
from tests.deaths import ASLEEP, DEATHS, MEMORY, TWELVE, alive, begun, children, do, within

ROOT = Path(__file__).parents[3]
LIMITS = Limits(seconds=0.5, memory=MEMORY)


def test_nothing_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(isolation, "WAIT", 1e3)  # on a busy machine too the processor time ends hangs
    items = ["a", *TWELVE, "b", "c"]
    results = dict(isolated(do, items, LIMITS, lambda: None))
    for death, (_, status, reason) in TWELVE.items():
        ended = results[death]
        assert isinstance(ended, Ended)
        assert (ended.status, ended.at_limit) == (status, death in ("hang in Python", "hang in C", "memory"))
        assert reason in ended.reason
        assert death != "memory" or "than its limit of 1 GiB" in ended.reason
    assert {item: results[item] for item in "abc"} == {"a": "A", "b": "B", "c": "C"}
    assert children() == []


def test_the_time_on_the_wall_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(isolation, "WAIT", 1.0)
    ended = Ended(Status.timed_out, "no answer within 0.2 s", at_limit=True)
    assert dict(isolated(do, [*ASLEEP], Limits(seconds=0.2), lambda: None)) == dict.fromkeys(ASLEEP, ended)


SECONDS = 987654  # by which the processes of these tests are known


def begin(how: str) -> None:
    """Begin a process, one in a session of its own, and one whose parent is gone; and end."""
    for options in ({}, {"start_new_session": True}):
        begun(SECONDS, **options)
    if not os.fork():
        begun(SECONDS)
        os._exit(0)
    if how in DEATHS:
        DEATHS[how][0]()


def sleeping() -> int:
    return sum(each.info["cmdline"] == ["sleep", str(SECONDS)] for each in psutil.process_iter(["cmdline"]))


@sampled(2)
@pytest.mark.parametrize("how", ["an answer", "abort", "asleep", "its group"])
def test_what_an_engine_began_ends_with_it(how: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also what is in another session, or nobody's child any more."""
    monkeypatch.setattr(isolation, "WAIT", 2.0)
    ((_, ended),) = isolated(begin, [how], Limits(0.5), lambda: None)
    assert (ended is None) == (how == "an answer")
    assert sleeping() == 0
    assert children() == []


def test_all_end_when_this_process_is_killed() -> None:
    """While an engine sleeps in C and holds the interpreter's lock, and another one waits."""
    code = (
        "from tests.compare.engines import test_isolation as t\n"
        "other = t.isolation.Worker(t.do)\n"
        "poll = lambda: print(t.sleeping(), *t.children(), flush=True)\n"
        "[*t.isolated(t.begin, ['asleep in C'], t.Limits(), poll)]"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, cwd=ROOT, text=True) as process:
        assert process.stdout is not None
        processes = next(line.split()[1:] for line in process.stdout if line.startswith("3 "))
        process.kill()
    assert len(processes) == 2
    assert within(5.0, lambda: sleeping() == 0 and not any(alive(int(each)) for each in processes))


def hoard(megabytes: int) -> None:
    code = f"import time; hoard = bytearray({megabytes} << 20); time.sleep(600)"
    for _ in range(2):
        subprocess.Popen([sys.executable, "-c", code])
    time.sleep(600)


def test_the_memory_of_what_an_engine_began_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of two processes has less than the limit."""
    monkeypatch.setattr(isolation, "LOOK", 0.1)
    ((_, ended),) = isolated(hoard, [80], Limits(60.0, memory=120 * 2**20), lambda: None)
    reason = "it and what it began needed more memory than its limit of 0.117 GiB"
    assert ended == Ended(Status.crashed, reason, at_limit=True)


def test_a_stop_ends_what_runs() -> None:
    def poll() -> None:
        if done:
            raise Stopped

    done: list[str] = []
    for item, _ in kept(isolated(do, ["a", "asleep in C", "b"], Limits(seconds=600.0, workers=1), poll)):
        done.append(item)
    assert done == ["a"]
    assert children() == []


def test_processes_that_are_begun_anew_answer_die_and_end_with_their_parent() -> None:
    """As they are off Linux, where no processor time of another process is known."""
    command = [sys.executable, "-m", "tests.spawned"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, cwd=ROOT, text=True) as process:
        assert process.stdout is not None
        *answers, begun = (process.stdout.readline().strip() for _ in range(5))
        process.kill()
    first, raised, *others = answers
    assert (first, *others) == ("a: A", "asleep: no answer within 0.3 s", "abort: its process ended by SIGABRT")
    assert re.fullmatch(r"SystemExit: SystemExit: bye \(tests/deaths.py, line \d+\)", raised)
    assert within(5.0, lambda: not alive(int(begun)))


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="of /proc")
def test_the_processes_below_one_are_found() -> None:
    """One below another that a thread has started; psutil looks at the parents of all processes of the machine."""
    command = [sys.executable, "-c", "import subprocess, sys; subprocess.run([sys.executable, '-c', 'input()'])"]
    started: list[subprocess.Popen[bytes]] = []
    thread = Thread(target=lambda: started.append(subprocess.Popen(command, stdin=subprocess.PIPE)))
    thread.start()
    thread.join()
    process = psutil.Process(started[0].pid)
    try:
        deadline = time.monotonic() + 20  # s, on a busy machine
        while not process.children() and time.monotonic() < deadline:
            time.sleep(0.02)
        below = [one.pid for one in process.children(recursive=True)]
        assert len(below) == 1
        assert descendants(process.pid) == below
        own = [one.pid for one in psutil.Process().children(recursive=True)]
        assert {process.pid, *below} <= {*own}
        assert sorted(descendants(os.getpid())) == sorted(own)
        assert _by_parent()[process.pid] == below  # of kernels without children
    finally:
        started[0].communicate(b"\n")
