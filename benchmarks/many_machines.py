"""What many machines, few positions, streams and derivatives cost: `python -m benchmarks.many_machines [--publish]`.

Processor time, the least of some rounds in turn, so that a busy machine is so for all; what counts are the ratios. It
takes two minutes; with `--publish`, which writes `results/published/many_machines.md`, the benchmarks of tolerances,
of the main job and of families run too, for a quarter of an hour.
"""

import argparse
import subprocess
import sys
from collections.abc import Callable, Mapping
from functools import partial
from math import inf, pi
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from timeit import timeit

import numpy as np

import analytic
import scenes
from scenes import Scene
from tests.chain import chain

ROUNDS = 5
PUBLISHED = Path(__file__).parents[1] / "results" / "published" / "many_machines.md"
OTHERS = {
    "Tolerances": ("benchmarks.monte_carlo", "100000"),
    "The main job": ("benchmarks.main_job", "5"),
    "Families": ("benchmarks.members", "--members", "200"),
}
STREAM = """
import sys
from math import pi
from pathlib import Path
from time import process_time
import analytic, scenes
scene, began = scenes.load("toggle_press"), process_time()
taken = [analytic.Extremes("drive.torque"), analytic.Integral("drive.torque")]
analytic.reduce_many(scene, {}, analytic.Grid(0, 2 * pi, int(sys.argv[1])), taken)
status = dict(line.split(":") for line in Path("/proc/self/status").read_text().splitlines())
print(process_time() - began, int(status["VmHWM"].split()[0]) / 1024)
"""


def main() -> None:
    """Print the table, or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--publish", action="store_true")
    options = parser.parse_args()
    rows = [*positions_of_many(), *every_channel(), *few_positions(), *streams(), *derivatives()]
    lines = [("what", "measured", "in units of", "ratio"), ("---", "---", "---", "---:"), *rows]
    table = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
    print(table)
    if options.publish:
        sections = ["# Many machines", "Made by `python -m benchmarks.many_machines --publish`.", table]
        for title, job in OTHERS.items():
            run = subprocess.run([sys.executable, "-m", *job], check=True, capture_output=True, text=True)
            sections += [f"## {title}", f"`python -m {' '.join(job)}`", run.stdout.strip()]
        PUBLISHED.write_text("\n\n".join(sections) + "\n", encoding="utf-8")


def seconds(jobs: Mapping[str, Callable[[], object]], rounds: int = ROUNDS, times: int = 1) -> dict[str, float]:
    """Return the least processor time of each job, s; they take turns, each so many times in a row."""
    least = dict.fromkeys(jobs, inf)
    for _ in range(rounds):
        for name, job in jobs.items():
            least[name] = min(least[name], timeit(job, timer=process_time, number=times) / times)
    return least


def spread(scene: Scene, count: int) -> dict[str, np.ndarray]:
    """Return lengths and points of machines that are a ten-thousandth off."""
    draw = np.random.default_rng(0)
    wanted = {path: n.value / scene.size(n) for path, n in scene.numbers.items() if "length" in path}
    return {path: value * (1 + 1e-4 * draw.uniform(-1, 1, count)) for path, value in wanted.items()}


def positions_of_many() -> list[tuple[str, str, str, str]]:
    """Time 64 machines of 19 moving joints at 200 angles, positions alone."""
    with TemporaryDirectory() as folder:
        scene = scenes.load(chain(9, Path(folder)))
    wanted = {f"{point}.{q}" for point in scene.moving_points for q in "xy"}
    angles, changes = np.linspace(0, 2 * pi, 200), spread(scene, 64)
    solve, many = analytic.solver(scene, wanted), analytic.many_solver(scene, changes, wanted)
    fast = analytic.fast_solver(scene, wanted, compiled=True).many_solver(changes)
    fast(angles)
    took = seconds(
        {
            "long": lambda: solve(np.linspace(0, 2 * pi, 72_000)),
            "solve_many": lambda: analytic.solve_many(scene, changes, angles, channels=wanted),
            "prepared": lambda: many(angles),
            "prepared, machine code": lambda: fast(angles),
        }
    )
    # The yardstick is what a position of one machine costs in a run so long that calls and their overhead do not count.
    unit, name = took.pop("long") / 72_000 * 200, "200 positions of one long run"
    size = f"64 machines x 200 angles, {len(scene.moving_points)} joints"
    return [(f"{size}, {what}", *share(time / 64, unit, name)) for what, time in took.items()]


def every_channel() -> list[tuple[str, str, str, str]]:
    """Time 4096 toggle presses at 360 angles, all channels."""
    scene, angles = scenes.load("toggle_press"), np.linspace(0, 2 * pi, 360)
    wanted = set(scene.channels.names())
    changes, size = spread(scene, 4096), 4096 * 360
    solve, fast = analytic.solver(scene, wanted), analytic.fast_solver(scene, wanted, compiled=True)
    fast.many(changes, angles)
    took = seconds(
        {
            "long": lambda: solve(np.linspace(0, 2 * pi, 360_000)),
            "many": lambda: analytic.solve_many(scene, changes, angles, channels=wanted),
            "compiled": lambda: fast.many(changes, angles),
            "writing": lambda: np.full((len(wanted), size), 1.0),
        }
    )
    long, writing = took["long"] / 360_000, took["writing"] / size
    return [
        ("4096 machines x 360 angles, every channel, a position", *share(took["many"] / size, long, "one long run's")),
        ("the same, machine code", *share(took["compiled"] / size, writing, "writing the answer")),
    ]


def few_positions() -> list[tuple[str, str, str, str]]:
    """Time a prepared solver of the toggle press at one position and at 72."""
    scene = scenes.load("toggle_press")
    solvers: dict[str, Callable[[np.ndarray], object]] = {
        "the core": analytic.solver(scene),
        "machine code": analytic.fast_solver(scene, compiled=True),
        "NumPy in a straight line": analytic.fast_solver(scene, compiled=False),
    }
    rows = []
    for count in (1, 72):
        angles = np.linspace(0, 6, count)
        took = seconds({name: partial(solve, angles) for name, solve in solvers.items()}, times=200)
        core = took.pop("the core")
        some = "one position" if count == 1 else f"{count} positions"
        rows += [(f"{some}, {name}", *share(time, core, "the core")) for name, time in took.items()]
    return rows


def streams() -> list[tuple[str, str, str, str]]:
    """Time reductions of a million and of a hundred million positions, each in a process of its own."""
    found = []
    for count in (10**6, 10**8):
        run = subprocess.run([sys.executable, "-c", STREAM, str(count)], check=True, capture_output=True, text=True)
        found.append([float(number) for number in run.stdout.split()])
    (million, _), (all_, megabytes) = found
    what = f"1e8 positions, extremes and integral of the torque, {megabytes:.0f} MB: a position"
    return [(what, *share(all_ / 1e8, million / 1e6, "of 1e6 positions"))]


def derivatives() -> list[tuple[str, str, str, str]]:
    """Time the derivatives of all channels of the toggle press by all its numbers."""
    scene, angles = scenes.load("toggle_press"), np.linspace(0, 6, 8000)
    paths = [path for path in scene.numbers if not path.startswith("drive.")]
    solve = analytic.solver(scene)
    took = seconds(
        {
            "solve": lambda: solve(angles),
            "few": lambda: analytic.derivatives(scene, paths, angles[:2]),
            "derivatives": lambda: analytic.derivatives(scene, paths, angles),
        }
    )
    # At two positions the work is the preparation alone, which is taken off; what is left grows with the positions and
    # is compared with a plain solve of as many.
    each = (took["derivatives"] - took["few"]) / len(paths)
    return [
        (
            f"derivatives of all channels by {len(paths)} numbers, 8000 angles, a number",
            *share(each, took["solve"], "a plain solve"),
        ),
        ("what they take to prepare", *share(took["few"], took["solve"], "a plain solve of 8000 angles")),
    ]


def share(seconds: float, unit: float, name: str) -> tuple[str, str, str]:
    """Return a time, what it is compared with, and the ratio."""
    size, symbol = next((s, n) for s, n in ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"), (0.0, "ns")) if seconds >= s)
    return f"{seconds / (size or 1e-9):.3g} {symbol}", name, f"{seconds / unit:.2f}"


if __name__ == "__main__":
    main()
