"""Runs of the command line that are killed, and what they leave."""

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from signal import SIGKILL
from time import sleep

import psutil

from tests.deaths import alive, within

CHANGING = ("speed.csv", "summary.json", "report.html", "family.html", "stability.csv", "hard.csv")  # they have times
PATIENCE = 10.0  # s, for the processes of a killed run to end


@dataclass(frozen=True)
class Killed:
    after: float  # s, of processor time
    finished: bool  # before that
    result: str  # 'older', 'new', or what is wrong with the files
    left: tuple[str, ...]  # what else is in the folder
    processes: int  # that went on


def completed(job: Sequence[str]) -> float:
    """Have Python run a job to its end, and return the processor time that it takes, s."""
    started = os.times()
    subprocess.run([sys.executable, *job], check=True, capture_output=True)
    ended = os.times()
    return ended.children_user + ended.children_system - started.children_user - started.children_system


def digests(folder: Path) -> Mapping[str, str]:
    return {path.name: sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


def killed(job: Sequence[str], place: Path, after: float) -> Killed:
    """Start a job whose older result is in `place`, and kill its first process after so much processor time, s.

    A moment by the clock on the wall would come early in a run on a busy machine.
    """
    older = digests(place)
    process = subprocess.Popen(
        [sys.executable, *job], start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    while process.poll() is None and sum(map(spent, of_session(process.pid))) < after:
        sleep(0.02)
    finished = process.poll() is not None
    process.kill()
    process.wait()
    within(PATIENCE, lambda: not [*of_session(process.pid)])
    others = [*of_session(process.pid)]
    for other in others:
        with suppress(ProcessLookupError):
            os.kill(other, SIGKILL)
    left = tuple(sorted(path.name for path in place.parent.iterdir() if path != place))
    return Killed(after, finished, compared(older, place), left, len(others))


def of_session(leader: int) -> Iterator[int]:
    """Yield the processes of a session, but those that have ended and nobody waited for."""
    for process in psutil.pids():
        with suppress(OSError):
            if os.getsid(process) == leader and alive(process):
                yield process


def spent(process: int) -> float:
    """Return the processor time of a process and of those that it waited for, s; zero of one that has ended."""
    with suppress(psutil.NoSuchProcess):
        return float(sum(psutil.Process(process).cpu_times()[:4]))
    return 0.0


def compared(older: Mapping[str, str], place: Path) -> str:
    """Return whether a folder holds the older result or a whole new one; their motions and errors are the same."""
    if not place.is_dir():
        return "gone"
    now = digests(place)
    if now == older:
        return "older"
    differ = [name for name in {*now, *older} if name not in CHANGING and now.get(name) != older.get(name)]
    cut = [page.name for page in place.glob("*.html") if not page.read_text(encoding="utf-8").endswith("</html>\n")]
    mixed = [name for name in now if name in CHANGING and now[name] == older.get(name)]
    return "new" if now.keys() == older.keys() and not (differ or cut or mixed) else f"{differ=} {cut=} {mixed=}"
