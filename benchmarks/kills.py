"""Kill -9 at random moments: `python -m benchmarks.kills [--moments N] [--jobs NAME,...]`.

An older, complete result is in place each time. It must be whole after the kill, or a new one must; no process may go
on, and the next whole run must leave nothing else. The main run and the family take 30 moments in ten minutes;
`--full` takes four minutes a moment, of one engine (`--jobs full_of_one`) a quarter of that.
"""

import argparse
import random
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.killed import compared, completed, digests, killed

INDEX = "index.html"  # over all reports of the folder
JOBS = {
    "main": ["toggle_press"],
    "family": ["toggle_press", "--vary", "bodies.rocker.lengths.O-P3=290:310:3", "--samples", "72"],
    "full": ["toggle_press", "--full"],
    "full_of_one": ["toggle_press", "--full", "--engines", "exudyn", "--samples", "72"],
}


def main() -> int:
    """Print a line a kill, and return 1 if one of them broke something."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moments", type=int, default=30)
    parser.add_argument("--jobs", default="main,family,full")
    options = parser.parse_args()
    draw = random.Random(0)
    return 1 if sum(broken(name, options.moments, draw) for name in options.jobs.split(",")) else 0


def broken(name: str, moments: int, draw: random.Random) -> int:
    """Kill a job at random moments, and return how many kills broke something."""
    count = 0
    with TemporaryDirectory() as folder:
        place, job = Path(folder) / "toggle_press", ["-m", "compare.run", *JOBS[name], "--out", folder]
        whole = completed(job)
        print(f"{name}: a whole run takes {whole:.1f} s of processor time", flush=True)
        for _ in range(moments):
            # Moments are uniform over the processor time of a whole run, by a seed that is fixed, so that the same
            # moments come again.
            found = killed(job, place, draw.uniform(0, whole))
            after, rest = "new", set[str]()
            if "--full" not in job:  # of which the next whole run comes at the end
                after, rest = next_run(job, place)
            whole_both = {found.result, after} <= {"older", "new"}  # a family has no times: its next may be the same
            fine = whole_both and not found.processes and not rest
            count += not fine
            told = "" if fine else f"; BROKEN: {after}, {sorted(rest)}"
            print(f"{name}: {found}{told}", flush=True)
        if "--full" in job:
            after, rest = next_run(job, place)
            print(f"{name}: the next run: {after}, beside it {sorted(rest)}")
            count += after != "new" or bool(rest)
        print(f"{name}: {count} of {moments} kills broke something", flush=True)
    return count


def next_run(job: Sequence[str], place: Path) -> tuple[str, set[str]]:
    """Run a job to its end, and return what its result is then, and the names of what is left beside it."""
    older = digests(place)
    completed(job)
    return compared(older, place), {path.name for path in place.parent.iterdir()} - {place.name, INDEX}


if __name__ == "__main__":
    raise SystemExit(main())
