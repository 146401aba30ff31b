"""What makes the main job cheap, without a clock: `python -m benchmarks.main_job` measures."""

import subprocess
import sys
from pathlib import Path

WITHOUT = {  # packages, the part of plotly that checks figures, what is for families, failures and `--check`
    *("dask", "exudyn", "flint", "narwhals", "numpy.ma", "pandas", "pint"),
    *("plotly.graph_objects", "pymunk", "rich", "scipy"),
    *("compare.measure.many.family", "compare.judge.canaries", "compare.measure.hard.case", "compare.judge.triage"),
}
CODE = "import sys; from compare.run import main; main(sys.argv[1:]); print(*sys.modules)"


def test_packages_that_the_job_does_without_are_not_imported(tmp_path: Path) -> None:
    job = [sys.executable, "-c", CODE, "--engines", "analytic", "--samples", "8", "--out", str(tmp_path)]
    printed = subprocess.run(job, check=True, capture_output=True, text=True).stdout
    loaded = {*printed.splitlines()[-1].split()}
    assert {"numpy", "jinja2", "analytic"} <= loaded
    assert not WITHOUT & loaded
