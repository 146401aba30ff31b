"""How fast the analytic core is, beside the time to write its answer once, and how it grows: `pytest benchmarks`.

The table's figures in brackets are ratios within one run. `write_fresh` allocates and writes an array of the answer's
size, as `solve` must; `write_again` writes it into memory that is already there.
"""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

import analytic
import scenes
from benchmarks.many_machines import seconds
from tests.chain import chain

ANGLES = np.linspace(0, 2 * np.pi, 360_000)
SCENE = scenes.load("toggle_press")
SHAPE = (len(SCENE.channels.names()), len(ANGLES))


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


# --- cost against the number of dyads ---------------------------------------------------------------------------------

LENGTHS = (1, 2, 4, 8, 16)  # of the chain, dyads
ROUNDS = 100
DEGREES = ANGLES[::1000]  # few enough that the answer stays in memory at hand: fresh pages cost more than the dyads


@pytest.mark.parametrize("dyads", LENGTHS)
@pytest.mark.benchmark(group="cost against the number of dyads, 360 angles")
def test_dyads(benchmark: BenchmarkFixture, dyads: int, tmp_path: Path) -> None:
    benchmark(analytic.solver(scenes.load(chain(dyads, tmp_path))), DEGREES)


def test_cost_is_linear_in_dyads(tmp_path: Path) -> None:
    """The time is a line over the number of dyads, and the last dyads cost no more each than the first."""
    solvers = {dyads: analytic.solver(scenes.load(chain(dyads, tmp_path))) for dyads in LENGTHS}
    jobs = {str(dyads): partial(solve, DEGREES) for dyads, solve in solvers.items()}
    took = np.array([*seconds(jobs, ROUNDS).values()])
    # Linear cost: a straight line fits, and the slope between the longest chains is that between short ones. The line
    # alone would let a small quadratic part through, the slopes alone would fail by the noise of one length.
    slope, offset = np.polyfit(LENGTHS, took, 1)
    residual = np.abs(took - offset - slope * np.array(LENGTHS)).max()
    each = np.diff(took) / np.diff(LENGTHS)
    print(f"\n{1e3 * slope:.3f} ms a dyad, {1e3 * offset:.3f} ms besides, off the line by {1e3 * residual:.3f} ms")
    print("ms a dyad, from chain to chain:", np.round(1e3 * each, 3))
    assert residual <= 0.1 * took[-1]
    assert each[-1] <= 1.5 * each[1]  # from 8 to 16 dyads as from 2 to 4, but for the caches
