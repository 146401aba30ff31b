"""What runs of any size cost: `python -m benchmarks.sizes [CASE ...]` prints a table of time, memory and page.

Time is processor time, of all processes; memory is the most that one process had; bodies are those that move.
"""

import os
import sys
from collections.abc import Mapping, Sequence
from json import loads
from pathlib import Path
from subprocess import DEVNULL, Popen
from tempfile import TemporaryDirectory

from scenes import load
from tests.chain import chain

ROWS: Mapping[str, Sequence[str]] = {
    "360 samples": ["--samples", "360"],
    "3600 samples": ["--samples", "3600"],
    "36000 samples": ["--samples", "36000"],
    "10 turns": ["--turns", "10"],
    "100 turns": ["--turns", "100"],
    "1000 turns": ["--turns", "1000"],
}
CHAINS: Mapping[str, int] = {f"{1 + 2 * dyads} bodies": dyads for dyads in (2, 5, 10, 25)}


def main(cases: Sequence[str]) -> None:
    """Print a row of the table for every case, or for those named."""
    print("| run | rows | bodies | processor time | memory | page | engines |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | --- |")
    for case in cases or (*ROWS, *CHAINS):
        with TemporaryDirectory() as folder:
            scene = str(chain(CHAINS[case], Path(folder))) if case in CHAINS else "toggle_press"
            print(_row(case, scene, ROWS.get(case, ()), Path(folder)), flush=True)


def _row(case: str, scene: str, arguments: Sequence[str], folder: Path) -> str:
    """Return what a run cost, and how it ended."""
    status, time, memory = cost([scene, *arguments, "--out", str(folder)])
    if status:
        return f"| {case} | ended with status {status} |"
    results = folder / Path(scene).stem
    summary = loads((results / "summary.json").read_text(encoding="utf-8"))
    rows = summary["sampling"]["samples"] * summary["sampling"]["turns"] + 1
    statuses = ", ".join(f"{engine} {run['status']}" for engine, run in summary["engines"].items())
    page = (results / "report.html").stat().st_size / 1e6
    cells = case, f"{rows:,}", f"{len(load(scene).bodies)}", time, memory, f"{page:.2f} MB", statuses
    return f"| {' | '.join(cells)} |"


def cost(arguments: Sequence[str]) -> tuple[int, str, str]:
    """Run the command line as a process of its own, and return its status, processor time and memory."""
    process = Popen([sys.executable, "-m", "compare.run", *arguments], stdout=DEVNULL)
    # `wait4` alone tells what one child used; `getrusage` would add up all children that have ended, and its memory
    # would be the largest of all cases. `ru_maxrss` is in KiB on Linux, of the child or of the largest of its own
    # children.
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)  # it is waited for
    return process.returncode, f"{used.ru_utime + used.ru_stime:.0f} s", f"{used.ru_maxrss / 1024:.0f} MB"


if __name__ == "__main__":
    main(sys.argv[1:])
