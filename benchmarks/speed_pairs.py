"""What this checkout takes beside another one: `python -m benchmarks.speed_pairs --against PATH [--rounds N]`.

Processor time, user and system, of one thread. Jobs of both checkouts take turns, so that a slow spell falls on both.
Of functions the least of each counts, of commands the median, and the ratio is that of the pairs. A job that the other
checkout does not know has no figure there. Each job is a process of its own, in the checkout's folder, by this
interpreter; byte code is written, and commands are run once before, since a checkout that lacks it is slower to start.
"""

import argparse
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from math import inf, nan
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import TypeVar

Job = TypeVar("Job")

LEAST = """
from time import process_time
import numpy as np
import analytic, scenes
from scenes import Sampling

def least(job, times=1, rounds=7):
    best = float("inf")
    for _ in range(rounds):
        began = process_time()
        for _ in range(times):
            job()
        best = min(best, (process_time() - began) / times)
    return best
"""
LARGER = """
scene, turn = scenes.load("{name}"), Sampling(359)
solve, angles, times = analytic.solver(scene), turn.commanded(scene), turn.times(scene)
"""
MACHINES = """
from compare.mechanics.reference import uncertified
from compare.measure.many.machines import draws, machines
scene = scenes.load("toggle_press")
reference, drawn = uncertified(scene), draws(scene, 0, 0, 256)
machines(reference, drawn)
print(least(lambda: machines(reference, drawn)) / 256)
"""
CODE = """
scene, angle = scenes.load("toggle_press"), np.array([1.0])
fast = analytic.fast_solver(scene)
fast(angle)
print(least(lambda: fast(angle), 2000))
"""
CALLS = """
solve, angles = analytic.solver(scenes.load("toggle_press")), np.linspace(0, 6, 10_000)
for _ in range(5):
    solve(angles)
print(least(lambda: solve(angles)) / 10_000)
"""
STREAM = """
scene, grid = scenes.load("toggle_press"), analytic.Grid(0, 6, 10**6)
try:
    analytic.fast_solver(scene, {"drive.torque"}, compiled=True)([1.0])
except TypeError:
    pass
taken = [analytic.Extremes("drive.torque"), analytic.Integral("drive.torque")]
print(least(lambda: analytic.reduce_many(scene, {}, grid, taken), rounds=3) / 10**6)
"""
# job: its text, which prints s, and the unit of the table, s
FUNCTIONS: Mapping[str, tuple[str, str, float]] = {
    **{
        f"{name}, all channels, 360 positions: each": (
            LARGER.format(name=name) + "print(least(lambda: solve(angles, times)) / 360)",
            "us",
            1e-6,
        )
        for name in ("class_iii", "scissor_lift")
    },
    "class_iii, all channels, one position": (
        LARGER.format(name="class_iii") + "print(least(lambda: solve(angles[:1], times[:1]), 20))",
        "ms",
        1e-3,
    ),
    "machine code, one position": (CODE, "us", 1e-6),
    "a solver's fifth call of 10,000 positions and the next: each": (CALLS, "ns", 1e-9),
    "reductions of 1,000,000 positions: each": (STREAM, "ns", 1e-9),
    "toggle presses by --monte-carlo: each": (MACHINES, "us", 1e-6),
}
# job: the arguments of the command line here, and there, where the other checkout may lack an option
COMMANDS: Mapping[str, tuple[Sequence[str], Sequence[str]]] = {
    "compare.run --list": (["--list"], ["--list"]),
    "compare.run": ([], []),
    "compare.run --no-speed, before with the table": (["--no-speed"], []),
    "compare.run class_iii": (["class_iii"], ["class_iii"]),
}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--against", type=Path, required=True, metavar="PATH", help="another checkout")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="", metavar="TEXT", help="jobs with this in their names")
    options = parser.parse_args()
    checkouts = [options.against.resolve(), Path(__file__).parents[1]]
    print("| job | before | now | ratio |")
    print("| --- | ---: | ---: | ---: |")
    for name, (job, unit, size) in chosen(FUNCTIONS, options.only):
        least = [inf, inf]
        for _ in range(options.rounds):
            least = [min(best, printed(place, LEAST + job)) for best, place in zip(least, checkouts, strict=True)]
        print(row(name, least, unit, size), flush=True)
    for name, (here, there) in chosen(COMMANDS, options.only):
        jobs = [*zip(checkouts, (there, here), strict=True)]
        _, *rounds = ([spent(*job) for job in jobs] for _ in range(options.rounds + 1))  # the first writes byte code
        print(row(name, [median(times) for times in zip(*rounds, strict=True)], "s", 1.0, rounds), flush=True)


def chosen(jobs: Mapping[str, Job], only: str) -> list[tuple[str, Job]]:
    """The jobs with a text in their names."""
    return [(name, job) for name, job in jobs.items() if only in name]


def row(name: str, times: Sequence[float], unit: str, size: float, rounds: Sequence[Sequence[float]] = ()) -> str:
    """A row of the table: times, s, in a unit, and their ratio; of rounds the median ratio, and from where to where."""
    before, now = (f"{time / size:.3g} {unit}" if time < inf else "none" for time in times)
    ratios = sorted(here / there for there, here in rounds) or [times[1] / times[0] if times[0] < inf else nan]
    spread = f" ({ratios[0]:.2f} to {ratios[-1]:.2f}, {len(rounds)} pairs)" if rounds else ""
    return f"| {name} | {before} | {now} | {median(ratios):.3f}{spread} |"


def printed(checkout: Path, job: str) -> float:
    """The number that a job prints last; infinite where it fails."""
    run = subprocess.run([sys.executable, "-c", job], cwd=checkout, env=alone(checkout), capture_output=True, text=True)
    return float(run.stdout.split()[-1]) if run.returncode == 0 else inf


def spent(checkout: Path, arguments: Sequence[str]) -> float:
    """The processor time of the command line, of all its processes, s; infinite where it fails."""
    with TemporaryDirectory() as folder:
        job = [sys.executable, "-m", "compare.run", *arguments, *([] if "--list" in arguments else ["--out", folder])]
        began = os.times()
        run = subprocess.run(job, cwd=checkout, env=alone(checkout), capture_output=True)
        ended = os.times()
    used = ended.children_user + ended.children_system - began.children_user - began.children_system
    return used if run.returncode == 0 else inf


def alone(checkout: Path) -> dict[str, str]:
    """The environment of a job: one thread, byte code, and the packages of its checkout before any others."""
    known = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {**known, "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(checkout)}


if __name__ == "__main__":
    main()
