"""What mutated scenes cost in the whole pipeline: `python -m benchmarks.mutated_runs [--count N] [--out FILE]`.

As many mutated scenes as asked for that load are run, each in a process of its own, by `python -m compare.run SCENE
--samples 36`. None may end in a traceback or with another exit status than 0, 1 or 2, or take more than 20 s of the
processor or 1 GB. Rows go to a CSV file as they come, so that a run that was stopped goes on; the scenes lie beside it.
300 take an hour.
"""

import argparse
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory, TemporaryFile
from threading import Timer
from typing import NamedTuple

import pandas as pd

import scenes
from scenes.errors import one_line
from tests.faults.mutated_scenes import slightly_mutated

OUT = Path(__file__).parents[1] / "results" / "mutated_runs.csv"
MAX_SECONDS, MAX_MB = 20.0, 1000.0
PATIENCE = 300.0  # s, of the clock


class Run(NamedTuple):
    """One run of the pipeline."""

    number: int
    scene: str
    status: int  # of the process; negative where a signal ended it
    seconds: float  # of the processor, with its workers that have ended
    megabytes: float  # of the largest of its processes
    traceback: bool
    last_line: str  # that it wrote as an error


def main() -> None:
    """Run the scenes that are not in the file yet, and print what is out of bounds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    folder = options.out.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    done = set(pd.read_csv(options.out)["number"]) if options.out.exists() else set()
    for number, file in loadable(folder, options.count):
        if number not in done:
            made = run(number, file)
            pd.DataFrame([made]).to_csv(options.out, mode="a", header=not options.out.exists(), index=False)
            print(f"{number}: {file.name}: {made.status}, {made.seconds:.1f} s, {made.megabytes:.0f} MB", flush=True)
    report(pd.read_csv(options.out))


def loadable(folder: Path, count: int) -> Iterator[tuple[int, Path]]:
    """Write so many mutated scenes as load, and yield the number and the file of each."""
    number = found = 0
    while found < count:
        file = folder / f"{number}.toml"
        file.write_bytes(slightly_mutated(Random(number)))
        try:
            scenes.load(file)
        except scenes.InputError:
            file.unlink()
        else:
            yield number, file
            found += 1
        number += 1


def run(number: int, file: Path) -> Run:
    """Run one scene through the whole pipeline."""
    with TemporaryDirectory() as out, TemporaryFile("w+") as errors:
        command = [sys.executable, "-m", "compare.run", str(file), "--samples", "36", "--out", out]
        # A session of its own, so that the timer can kill the run with all its workers: else those would go on beside
        # the next runs, and their memory would count as these runs' own.
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True)
        timer = Timer(PATIENCE, os.killpg, (process.pid, signal.SIGKILL))
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = status = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        text = errors.read()
    last = one_line((text.strip().splitlines() or [""])[-1])
    seconds, megabytes = usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024
    return Run(number, scenes.load(file).name, status, seconds, megabytes, "Traceback" in text, last)


def report(table: pd.DataFrame) -> None:
    """Print how the runs ended, and those out of bounds."""
    ends = table.groupby("status")
    print(ends.agg(runs=("number", "count"), seconds=("seconds", "max"), megabytes=("megabytes", "max")))
    kept = (table["seconds"] <= MAX_SECONDS) & (table["megabytes"] <= MAX_MB) & ~table["traceback"]
    bad = table[~(kept & table["status"].isin((0, 1, 2)))]
    print(f"{len(bad)} of {len(table)} are out of bounds" + (f":\n{bad.to_string(index=False)}" if len(bad) else ""))


if __name__ == "__main__":
    main()
