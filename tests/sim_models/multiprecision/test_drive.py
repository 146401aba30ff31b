"""The drive in arbitrary precision: laws worked by hand; test_shared_input.py has SciPy's splines."""

from collections.abc import Iterator
from fractions import Fraction

import pytest

from scenes.scene import MotionLaw

flint = pytest.importorskip("flint")

from sim_models.multiprecision.drive import Command, law_of  # noqa: E402  (their engine is there)

EXACT = 1e-45  # of 50 digits, for numbers up to a hundred


@pytest.fixture(autouse=True)
def _fifty_digits() -> Iterator[None]:
    with flint.ctx.workdps(50):
        yield


def off(command: Command, *expected: Fraction) -> float:
    """Return the largest difference of a command from a time, a position and its derivatives."""
    right = [flint.fmpq(number.numerator, number.denominator) for number in expected]
    return max(abs(float(ball - number)) for ball, number in zip(command, right, strict=True))


@pytest.mark.parametrize("times", [(0, 1, 3, 4), (0, 1, 2, 5, 6, 8)])
def test_a_cubic_has_no_knots(times: tuple[int, ...]) -> None:
    """Not-a-knot at both ends, any cubic is its own spline: s = t^3 - 5 t^2 + 2 t + 1."""
    law = MotionLaw(times, tuple(t**3 - 5 * t**2 + 2 * t + 1 for t in times), periodic=False)
    of = law_of(law)
    for cycles in (Fraction(k, 7) for k in range(8)):
        t = cycles * times[-1]
        position, rate, acceleration = t**3 - 5 * t**2 + 2 * t + 1, 3 * t**2 - 10 * t + 2, 6 * t - 10
        assert off(of(cycles), t, position, rate, acceleration) <= EXACT


@pytest.mark.parametrize("gain", [0, 8])
def test_a_periodic_law_by_hand(gain: int) -> None:
    """0, 1, 0, -1 at whole instants: (1) has the solution M = -3 s. A gain adds its line, period after period."""
    table = [s + Fraction(gain, 4) * t for t, s in enumerate((0, 1, 0, -1, 0))]
    of = law_of(MotionLaw((0, 1, 2, 3, 4), tuple(map(float, table)), periodic=True))
    for turn in (0, 1, 5):
        for t, s, v, a in ((0, 0, Fraction(3, 2), 0), (1, 1, 0, -3), (3, -1, 0, 3)):
            position = s + Fraction(gain, 4) * (t + 4 * turn)
            expected = t + 4 * turn, position, v + Fraction(gain, 4), a
            assert off(of(turn + Fraction(t, 4)), *(Fraction(number) for number in expected)) <= EXACT
    # Half-way in the first step: 1/2 - 3 (1/8 - 1/2) / 6, 1 - 3 (3/4 - 1) / 6.
    half = Fraction(11, 16) + Fraction(gain, 8), Fraction(9, 8) + Fraction(gain, 4), Fraction(-3, 2)
    assert off(of(Fraction(1, 8)), Fraction(1, 2), *half) <= EXACT
