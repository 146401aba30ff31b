"""Processor time of the main job, of all its processes, over that of importing what it depends on.

`python -m benchmarks.main_job [RUNS]` prints a row a job. All take turns, so that a slow spell of the machine falls on
all of them; of each the fastest run counts.
"""

import sys
from collections.abc import Mapping, Sequence
from tempfile import TemporaryDirectory

from tests.killed import completed

IMPORTS = "import numpy, scipy, pandas, exudyn, pymunk, pint, pydantic"
JOBS: Mapping[str, Sequence[str]] = {
    "compare.run": ["-m", "compare.run"],
    "compare.run --engines analytic": ["-m", "compare.run", "--engines", "analytic"],
}
LIMITS: Mapping[str, float] = {"compare.run": 3.0, "compare.run --engines analytic": 1.5}


def ratios(runs: int = 5) -> Mapping[str, tuple[float, float]]:
    """Return by job its processor time, s, and that over the time of the imports.

    Args:
        runs: of each job and of the imports.
    """
    # The least of several runs is taken, not the mean: other programs only ever add time, so the fastest run is nearest
    # to what the job itself costs. The ratio to the imports makes a figure that another machine can be held to.
    imports, least = float("inf"), dict.fromkeys(JOBS, float("inf"))
    with TemporaryDirectory() as folder:
        for _ in range(runs):
            imports = min(imports, completed(["-c", IMPORTS]))
            for name, job in JOBS.items():
                least[name] = min(least[name], completed([*job, "--out", folder]))
    return {name: (time, time / imports) for name, time in least.items()}


if __name__ == "__main__":
    print("| job | processor time | over the imports | at most |")
    print("| --- | ---: | ---: | ---: |")
    for name, (time, ratio) in ratios(*map(int, sys.argv[1:])).items():
        print(f"| `{name}` | {time:.2f} s | {ratio:.2f} | {LIMITS[name]:g} |")
