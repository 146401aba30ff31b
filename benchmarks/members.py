"""What a member of a family costs: `python -m benchmarks.members [--members N]`.

By stage in processor time, and in bytes; then the family by one worker, by two, and by two of which one is killed: from
its first members to its last the processor time of the command and of its workers, and the time on the wall; and what
that would be on two cores that do nothing else: one worker has a core to itself, two share both with the command.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial
from multiprocessing.reduction import ForkingPickler
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np
import psutil

import analytic
from benchmarks import many_machines
from compare.engines.registry import DEFAULT_ENGINES, ORACLE
from compare.engines.runner import HERE, run
from compare.judge.floor import FLOOR_SAMPLES
from compare.measure.many.family import Asked, solved_member
from scenes import Sampling, load, with_changes

SCENE, PATH = "toggle_press", "bodies.rocker.lengths.O-P3"
MIN_LENGTH, MAX_LENGTH = 285.0, 315.0
MACHINES = 2048


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--members", type=int, default=40)
    options = parser.parse_args()
    stages()
    print("\n| workers | processor time a member: of the command | of workers | wall | on two free cores | table |")
    print("| --- | ---: | ---: | ---: | ---: | --- |")
    job = [SCENE, "--vary", f"{PATH}={MIN_LENGTH:g}:{MAX_LENGTH:g}:{options.members}"]
    with TemporaryDirectory() as folder:
        first = Path(folder) / "1"
        for workers, kill in ((1, False), (2, False), (2, True)):
            out = Path(folder) / f"{workers}{kill or ''}" if workers > 1 else first
            print(family(job, workers, out, first, kill=kill), flush=True)


def stages() -> None:
    """Print what one member costs, stage by stage."""
    change = {PATH: MIN_LENGTH}
    drawn, sampling = load(SCENE), Sampling(360)
    scene = with_changes(drawn, change)
    position, time = sampling.commanded(scene), sampling.times(scene)
    costs = {
        "its scene made": least(lambda: with_changes(drawn, change)),
        "a solver prepared, 360 positions, all channels": least(lambda: analytic.solver(scene)(position, time)),
    }
    for what, channels in (("all channels", None), ("the output alone", {f"{scene.output}.y"})):
        changes = {PATH: np.linspace(0.999, 1.001, MACHINES) * MIN_LENGTH}
        seconds = least(partial(analytic.solve_many, scene, changes, position, channels=channels)) / MACHINES
        costs[f"one of {MACHINES} by `solve_many`, 360 positions, {what}"] = seconds
    for engine in DEFAULT_ENGINES[1:]:
        costs[f"{engine}, 360 samples"] = least(partial(run, engine, scene, sampling))
    costs[f"arbitrary precision, {FLOOR_SAMPLES} samples"] = least(lambda: run(ORACLE, scene, Sampling(FLOOR_SAMPLES)))
    asked = Asked(drawn, DEFAULT_ENGINES, sampling)
    whole = least(lambda: solved_member(asked, change, scene, HERE, lambda _: None))
    costs["all of a member, judged"] = whole
    print("| of a member | processor time |\n| --- | ---: |")
    for stage, seconds in costs.items():
        print(f"| {stage} | {1e3 * seconds:.2f} ms |")
    packed = ForkingPickler.dumps(solved_member(asked, change, scene, HERE, lambda _: None))
    print(f"\n{len(packed) / 1e6:.2f} MB a member with all motions")


def least(do: Callable[[], object]) -> float:
    """Return the least processor time of several rounds, s."""
    return many_machines.seconds({"": do})[""]


def family(job: Sequence[str], workers: int, out: Path, like: Path, *, kill: bool) -> str:
    """Run a family, kill one of its workers half-way if asked, and return a row of the table."""
    command = [sys.executable, "-m", "compare.run", *job, "--workers", str(workers), "--out", str(out)]
    marks = []
    with Popen(command, stdout=PIPE, stderr=DEVNULL, text=True) as process:
        assert process.stdout is not None
        command_process = psutil.Process(process.pid)
        members = int(job[-1].rpartition(":")[2])
        for number, _ in enumerate(line for line in process.stdout if " ok " in line):
            # The first members carry the start of the workers, the last ones wait for each other: processor time is
            # read after one member of each worker and before the last two, and is shared out over the members between.
            if number in (workers, members - 2):
                marks.append(
                    (number, perf_counter(), used([command_process]), used(command_process.children(recursive=True)))
                )
            if kill and number == members // 2:
                command_process.children()[0].children()[0].kill()  # its parent is its guard
    (n, *before), (m, *after) = marks
    on_wall, of_command, of_workers = ((b - a) / (m - n) for a, b in zip(before, after, strict=True))
    tables = [next(where.glob("*/family.csv")).read_bytes() for where in (out, like)]
    same = "the same" if tables[0] == tables[1] else "ANOTHER"
    told = f"{workers}, one killed" if kill else f"{workers}"
    # On two free cores one worker has one of them to itself while the command uses the other. Two workers and the
    # command share both cores, so a member takes half of all the processor time.
    free = of_workers if workers == 1 else (of_command + of_workers) / 2
    cells = [f"{seconds:.3f} s" for seconds in (of_command, of_workers, on_wall, free)]
    if kill:  # a killed process takes its time along
        cells = ["–"] * 4
    return " | ".join((f"| {told}", *cells, f"{same}, {len(tables[0].splitlines()) - 1} members |"))


def used(processes: Sequence[psutil.Process]) -> float:
    """Return the processor time of processes, s."""
    return sum(sum(each.cpu_times()[:2]) for each in processes)


if __name__ == "__main__":
    main()
