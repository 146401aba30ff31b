"""Splines against SciPy's, which have the same conditions at their ends, and what needs no SciPy."""

import subprocess
import sys

import numpy as np
import pytest
from scipy import interpolate

from scenes.splines import cubic_spline


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("count", [3, 4, 5, 12])
def test_a_spline_is_that_of_scipy(count: int, *, periodic: bool) -> None:
    """Within roundings, whose sizes go with the ratio of the longest step to the shortest, 30 at most."""
    chance = np.random.default_rng(count)
    x = np.cumsum([0.0, *chance.uniform(0.03, 1, count - 1)])
    y = chance.normal(size=count)
    if periodic:
        y[-1] = y[0]
    right = interpolate.CubicSpline(x, y, bc_type="periodic" if periodic else "not-a-knot")
    found, places = cubic_spline(x, y, periodic=periodic), np.linspace(-x[-1], 2 * x[-1], 200)
    for order in range(3):
        expected = right(places, order)
        assert np.abs(found(places, order) - expected).max() <= 1e-12 * np.abs(expected).max()
    turns = right.derivative().solve(0.5, extrapolate=False)
    assert np.sort(found.still(1, 0.5)) == pytest.approx(np.unique(turns), abs=1e-9 * x[-1])


def test_two_points_are_a_line() -> None:
    line = cubic_spline(np.array([0.0, 2.0]), np.array([1.0, 5.0]), periodic=False)
    assert line(np.array([-1.0, 0.5, 3.0])) == pytest.approx([-1.0, 2.0, 7.0], rel=1e-15)
    assert line(np.array([0.5]), 1) == pytest.approx([2.0], rel=1e-15)


def test_scenes_are_listed_without_scipy() -> None:
    """One of them has a spline; SciPy takes twice as long to import as all else."""
    job = "import sys, compare.run; compare.run.main(['list']); print({'scipy', 'numpy.ma'} & {*sys.modules})"
    listed = subprocess.run([sys.executable, "-c", job], check=True, capture_output=True, text=True).stdout
    assert "servo_press" in listed
    assert listed.splitlines()[-1] == "set()"
