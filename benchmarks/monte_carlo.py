"""What tolerances cost: `python -m benchmarks.monte_carlo [N]` prints a row for the toggle press and for the clamp.

Memory is the most that one process had. The last columns hold the 20 machines of the JSON file against runs of their
own, and the sampled standard deviations of the numbers that are called linear against those of the linear model.
"""

import sys
from json import loads
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from benchmarks.sizes import cost
from compare.judge.peaks.peaks import peaks
from compare.mechanics.reference import uncertified
from scenes import Sampling, load

MAX_UNEXPLAINED = 1e-3  # of the variance that the linear model may leave unexplained: 3 % of a standard deviation
SCENES = ("toggle_press", "double_toggle_clamp")


def main(count: str = "100000") -> None:
    """Print the table."""
    print("| scene | machines | wall | processor time | memory | 20 alone differ by | linear deviations are off by |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for scene in SCENES:
        with TemporaryDirectory() as folder:
            print(_row(scene, count, Path(folder)), flush=True)


def _row(scene: str, count: str, folder: Path) -> str:
    """Return what a run cost and found."""
    begin = perf_counter()
    status, *used = cost([scene, "--monte-carlo", count, "--out", str(folder)])
    wall = f"{perf_counter() - begin:.0f} s"
    if status:
        return f"| {scene} | ended with status {status} |"
    result = loads((folder / scene / "monte_carlo.json").read_text(encoding="utf-8"))
    # Where the linear model explains the variance to a thousandth, standard deviations by it and by sampling have to
    # agree to about the sampling error, 1 / sqrt(2 N) of a deviation: 0.2 % of 100,000 machines.
    moving = [
        number for number in result["numbers"] if number["deviation"] and number["unexplained"] <= MAX_UNEXPLAINED
    ]
    off = max(abs(number["linear"] / number["deviation"] - 1) for number in moving)
    cells = scene, f"{result['machines']:,}", wall, *used, f"{_alone(scene, result):.0e}", f"{100 * off:.2f} %"
    return f"| {' | '.join(cells)} |"


def _alone(scene: str, result: Any) -> float:
    """Return the largest difference of a machine in the file from a run of its own, relative to the number's size."""
    sizes, worst = {number["name"]: number["size"] for number in result["numbers"]}, 0.0
    for machine in result["picked"]:
        alone = {
            peak.name: peak.value for peak in peaks(uncertified(load(scene, machine["changes"])), Sampling(72), [])
        }
        worst = max([worst, *(abs(alone[name] - value) / sizes[name] for name, value in machine["numbers"].items())])
    return worst


if __name__ == "__main__":
    main(*sys.argv[1:])
