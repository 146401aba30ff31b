"""The drive in arbitrary precision: laws worked by hand, and SciPy's splines."""

from collections.abc import Iterator
from fractions import Fraction
from math import tau

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from scenes import Positions, Sampling
from scenes.scene import ConstantSpeed, Drive, MotionLaw

from .runs import EPS, Array

flint = pytest.importorskip("flint")

from sim_models.multiprecision.drive import Command, commands, law_of  # noqa: E402  (their engine is there)

EXACT = 1e-45  # of 50 digits, for numbers up to a hundred


@pytest.fixture(autouse=True)
def _fifty_digits() -> Iterator[None]:
    with flint.ctx.workdps(50):
        yield


def passes(drive: Drive, request: Sampling | Positions) -> Array:
    return np.array([[float(ball) for ball in command] for command in commands(law_of(drive), request)])


def off(command: Command, *expected: Fraction) -> float:
    """Return the largest difference of a command from a time, a position and its derivatives."""
    right = [flint.fmpq(number.numerator, number.denominator) for number in expected]
    return max(abs(float(ball - number)) for ball, number in zip(command, right, strict=True))


@pytest.mark.parametrize("times", [(0, 1, 3, 4), (0, 1, 2, 5, 6, 8)])
def test_a_cubic_has_no_knots(times: tuple[int, ...]) -> None:
    """Not-a-knot at both ends, any cubic is its own spline: s = t^3 - 5 t^2 + 2 t + 1."""
    law = MotionLaw("crank", times, tuple(t**3 - 5 * t**2 + 2 * t + 1 for t in times), periodic=False)
    of = law_of(law)
    for cycles in (Fraction(k, 7) for k in range(8)):
        t = cycles * times[-1]
        position, rate, acceleration = t**3 - 5 * t**2 + 2 * t + 1, 3 * t**2 - 10 * t + 2, 6 * t - 10
        assert off(of.at(cycles), t, position, rate, acceleration) <= EXACT


@pytest.mark.parametrize("gain", [0, 8])
def test_a_periodic_law_by_hand(gain: int) -> None:
    """0, 1, 0, -1 at whole instants: (1) has the solution M = -3 s. A gain adds its line, period after period."""
    table = [s + Fraction(gain, 4) * t for t, s in enumerate((0, 1, 0, -1, 0))]
    of = law_of(MotionLaw("crank", (0, 1, 2, 3, 4), tuple(map(float, table)), periodic=True))
    for turn in (0, 1, 5):
        for t, s, v, a in ((0, 0, Fraction(3, 2), 0), (1, 1, 0, -3), (3, -1, 0, 3)):
            position = s + Fraction(gain, 4) * (t + 4 * turn)
            expected = t + 4 * turn, position, v + Fraction(gain, 4), a
            assert off(of.at(turn + Fraction(t, 4)), *(Fraction(number) for number in expected)) <= EXACT
    # Half-way in the first step: 1/2 - 3 (1/8 - 1/2) / 6, 1 - 3 (3/4 - 1) / 6.
    half = Fraction(11, 16) + Fraction(gain, 8), Fraction(9, 8) + Fraction(gain, 4), Fraction(-3, 2)
    assert off(of.at(Fraction(1, 8)), Fraction(1, 2), *half) <= EXACT


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("entries", [4, 5, 12, 60])
def test_splines_are_those_of_scipy(entries: int, periodic: bool) -> None:
    random = np.random.default_rng(entries)
    times = np.concatenate([[0], np.cumsum(random.uniform(0.1, 1, entries - 1))])
    positions = random.normal(size=entries)
    if periodic:
        positions[-1] = positions[0]
    law = MotionLaw("crank", tuple(times.tolist()), tuple(positions.tolist()), periodic=periodic)
    spline = CubicSpline(times, positions, bc_type="periodic" if periodic else "not-a-knot")
    time, *found = passes(law, Sampling(97)).T
    for order, values in enumerate(found):
        expected = spline(time, order)
        # SciPy's doubles: some steps are ten times shorter than others, and lose that squared.
        assert np.abs(values - expected).max() <= 500 * EPS * np.abs(expected).max()


def test_a_constant_speed_by_hand() -> None:
    back = passes(ConstantSpeed("crank", -2.0, 0.5, None), Sampling(4, turns=2))
    quarters = np.arange(9) * tau / 4
    expected = np.transpose([quarters / 2, 0.5 - quarters, np.full(9, -2.0), np.zeros(9)])
    np.testing.assert_allclose(back, expected, rtol=4 * EPS, atol=0)
    once = passes(ConstantSpeed("table", 0.5, 1.0, 3.0), Sampling(4))
    assert once.tolist() == [[t, 1 + t / 2, 0.5, 0] for t in range(5)]
    at = passes(ConstantSpeed("table", 0.5, 1.0, 3.0), Positions((1.25, 3.0)))
    assert at.tolist() == [[0.5, 1.25, 0.5, 0], [4, 3, 0.5, 0]]
