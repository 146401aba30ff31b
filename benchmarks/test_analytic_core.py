"""How fast the analytic core is, beside the time to write its answer once: `pytest benchmarks`.

The table's figures in brackets are ratios within one run. `write_fresh` allocates and writes an array of the answer's
size, as `solve` must; `write_again` writes it into memory that is already there.
"""

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import analytic
import scenes
from scenes.motion import channels

ANGLES = np.linspace(0, 2 * np.pi, 360_000)
SCENE = scenes.load("toggle_press")
SHAPE = (len(channels(SCENE)), len(ANGLES))


@pytest.mark.benchmark(group="360,000 angles, every channel", min_rounds=15)
def test_solve(benchmark: BenchmarkFixture) -> None:
    benchmark(analytic.solve, SCENE, ANGLES)


@pytest.mark.benchmark(group="360,000 angles, every channel", min_rounds=15)
def test_write_fresh(benchmark: BenchmarkFixture) -> None:
    benchmark(np.full, SHAPE, 1.0)


@pytest.mark.benchmark(group="360,000 angles, every channel", min_rounds=15)
def test_write_again(benchmark: BenchmarkFixture) -> None:
    benchmark(np.empty(SHAPE).fill, 1.0)


@pytest.mark.parametrize("count", [361, 3_601, 36_001, 360_001])
@pytest.mark.benchmark(group="cost against the number of angles")
def test_count(benchmark: BenchmarkFixture, count: int) -> None:
    benchmark(analytic.solve, SCENE, np.linspace(0, 2 * np.pi, count))
