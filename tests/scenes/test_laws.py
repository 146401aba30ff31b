"""Motion laws by formula: their peaks, how they begin, end and join, sums of sines, and by integrals all of them."""

from collections.abc import Callable
from fractions import Fraction
from math import pi, sqrt

import numpy as np
import pytest

from scenes.drive import ConstantSpeed, DriveLaw, MotionLaw, Samples
from scenes.laws import LAWS, HarmonicLaw, SegmentedLaw, derivatives

# Of rate and acceleration, a unit of way in a unit of time; and the order of the first derivative that jumps at rest.
PEAKS = {
    "harmonic": (pi / 2, pi**2 / 2, 2),
    "cycloidal": (2, 2 * pi, 3),
    "polynomial_345": (15 / 8, 10 / sqrt(3), 3),
    "polynomial_4567": (35 / 16, 84 / (5 * sqrt(5)), 4),
    "modified_sine": (4 * pi / (4 + pi), 4 * pi**2 / (4 + pi), 3),
    "modified_trapezoid": (2, 8 * pi / (2 + pi), 3),
}
S = (1 - sqrt(33)) / 8
ROUNDED = 2e-14  # of ways and times of a few units, and their derivatives


def segments(law: str, *, periodic: bool, gain: float = 0.0) -> SegmentedLaw:
    """To 2 in half a second, a dwell of 0.1, and back in 0.3: boundaries that no double is."""
    return SegmentedLaw(0.0, (2.0, None, gain), (0.5, 0.1, 0.3), (law, None, law), periodic)


@pytest.mark.parametrize("name", LAWS)
def test_peaks_of_rate_and_acceleration(name: str) -> None:
    rate, acceleration, _ = PEAKS[name]
    law = SegmentedLaw(1.0, (-3.0,), (0.5,), (name,), periodic=False)  # a way of 4 in half the time
    driven = law.at(np.linspace(0, 0.5, 24001))  # where 84 / (5 sqrt 5) is, to a parabola's share of a step, squared
    assert abs(np.abs(driven.rate).max() / (8 * rate) - 1) <= ROUNDED
    assert abs(law.peak_rate / (8 * rate) - 1) <= ROUNDED
    assert 0 <= 1 - np.abs(driven.acceleration).max() / (16 * acceleration) + ROUNDED <= 1e-7
    assert law.extent == (-3, 1)


@pytest.mark.parametrize("name", LAWS)
def test_rates_and_accelerations_are_integrated_to_the_way(name: str) -> None:
    """By Gauss in each piece, exact for the polynomials and to rounding for the others; and all joins are smooth."""
    law = segments(name, periodic=False)
    x, w = np.polynomial.legendre.leggauss(20)
    for piece, end in zip(law.pieces, [*(piece.begin for piece in law.pieces[1:]), law.cycle], strict=True):
        length = end - piece.begin
        inside, first, last = (piece.at(t) for t in (piece.begin + length * (1 + x) / 2, piece.begin, end))
        assert abs(last.position - first.position - length / 2 * w @ inside.rate) <= ROUNDED
        assert abs(last.rate - first.rate - length / 2 * w @ inside.acceleration) <= ROUNDED * law.peak_rate
    assert law.at(law.boundaries).position.tolist() == [0, 2, 2, 0]
    assert not law.at(law.boundaries).rate.any()  # to the last digit, or a press force came and went by rounding
    for at in law.boundaries:
        before, after = law.at(at - 2e-9), law.at(at + 2e-9)
        scale = 4e-9 * np.array([1e-6, 200.0]) + ROUNDED  # of a rate next to rest, and an acceleration
        assert abs(before.position - after.position) <= scale[0]
        assert abs(before.rate - after.rate) <= scale[1]


@pytest.mark.parametrize("name", LAWS)
def test_what_jumps_at_rest(name: str) -> None:
    """A way that goes as x^n begins with a jump of the n-th derivative."""
    law = SegmentedLaw(0.0, (1.0,), (1.0,), (name,), periodic=False)
    for x, y in zip((0.01, 0.02), law.at([0.99, 0.98]).position, strict=True):
        assert abs(law.at(x).position + y - 1) <= 1e-15  # of one; the second half is the mirror image of the first
    small, twice = law.at([0.005, 0.01]).position
    assert abs(np.log2(twice / small) - PEAKS[name][2]) <= 0.05  # of the order: what the next one adds


def test_an_instant_on_a_boundary_is_the_later_segments() -> None:
    """However it is rounded; at the end the last one's, but of a periodic law the next first one's."""
    once, again = (segments("harmonic", periodic=periodic) for periodic in (False, True))
    out, back = (
        pi**2 / 2 * 2 / 0.25,
        -(pi**2) / 2 * 2 / 0.09,
    )  # the harmonic begins with these and ends with the opposite
    for law in (once, again):
        for at, expected in ((0.0, out), (0.5, 0.0), (0.6, back)):
            near = law.at([at - 1e-12, at, at + 1e-12]).acceleration
            assert np.abs(near - expected).max() <= 1e-8  # of a hundred: the jerk by 1e-12 s
    assert np.abs(once.at([0.9 - 1e-12, 0.9, 0.9 + 1e-12]).acceleration + back).max() <= 1e-8
    assert np.abs(again.at([0.9 - 1e-12, 0.9, 0.9 + 1e-12]).acceleration - out).max() <= 1e-8
    rest = once.at([-9.0, -0.1, 0.55, 1.0, 9.0])
    assert rest.position.tolist() == [0, 0, 2, 0, 0]
    assert not rest.rate.any()
    assert not rest.acceleration.any()


def test_a_periodic_law_gains_whole_turns() -> None:
    law = segments("polynomial_345", periodic=True, gain=2 * pi)
    time = np.array([0.03, 0.4, 0.55, 0.7])
    first, third = law.at(time), law.at(time + 2 * law.cycle)
    assert np.abs(third.position - first.position - 4 * pi).max() <= ROUNDED
    assert np.abs(third.acceleration - first.acceleration).max() <= 1e3 * ROUNDED  # its size
    assert np.abs(law.after(time / law.cycle) - first.position).max() <= ROUNDED


@pytest.mark.parametrize(
    ("sines", "multiples", "extent", "peak"),
    [
        ([(-2.0, 0.7, 0.3)], (1,), (-1, 3), 2 * 1.4 * pi),
        ([(1.0, 2.5, 0.0), (1.0, 2.5, pi / 2)], (1, 1), (1 - sqrt(2), 1 + sqrt(2)), 5 * pi * sqrt(2)),
        # With s = sin a it is 1/2 + s - s^2; its rate, by cos a (1 - 2 s), is largest where 4 s^2 - s - 2 = 0, at S.
        ([(1.0, 0.1, 0.0), (0.5, 0.2, pi / 2)], (1, 2), (-0.5, 1.75), 0.2 * pi * sqrt(1 - S**2) * (1 - 2 * S)),
        ([(1.0, 0.3, 0.0), (0.0, 0.2, 0.0)], (3, 2), (0, 2), 0.6 * pi),
    ],
)
def test_sums_of_sines(
    sines: list[tuple[float, float, float]], multiples: tuple[int, ...], extent: tuple[float, float], peak: float
) -> None:
    """About 1; the cycle is the least common period of the frequencies as written, where 0.3 / 0.1 is no integer."""
    law = HarmonicLaw(1.0, *zip(*sines, strict=True))
    assert law.multiples == multiples
    assert np.abs(np.array(law.extent) - extent).max() <= ROUNDED
    assert abs(law.peak_rate - peak) <= ROUNDED * peak
    time = np.array([0.2, 3.1])
    position, rate, acceleration = law.at(time)
    assert np.abs(position - law.at(time + 7 * law.cycle).position).max() <= 1e-13  # 70 turns of the angle, rounded
    h = 1e-3  # s; differences are off by h^2 times two more derivatives, of rates of 20 1/s
    before, after = law.at(time - h), law.at(time + h)
    assert np.abs((after.position - before.position) / (2 * h) - rate).max() <= 1e-3 * law.peak_rate
    assert np.abs((after.rate - before.rate) / (2 * h) - acceleration).max() <= 1e-3 * 20 * law.peak_rate


def test_frequencies_in_digits_as_written() -> None:
    law = HarmonicLaw(0.0, (1.0, 1.0, 1.0), (0.1, 0.3, 0.7), (0.0, 0.0, 0.0))
    assert (law.multiples, law.cycle) == ((1, 3, 7), 10.0)
    assert Fraction(0.3) / Fraction(0.1) != 3


# The third and the fourth derivative by x of a unit of way in a unit of time: of the formulas as printed (Norton).
HIGHER: dict[str, tuple[Callable[[Samples], Samples], Callable[[Samples], Samples]]] = {
    "harmonic": (lambda x: -(pi**3) / 2 * np.sin(pi * x), lambda x: -(pi**4) / 2 * np.cos(pi * x)),
    "cycloidal": (lambda x: 4 * pi**2 * np.cos(2 * pi * x), lambda x: -8 * pi**3 * np.sin(2 * pi * x)),
    "polynomial_345": (lambda x: 60 - 360 * x + 360 * x**2, lambda x: -360 + 720 * x),
    "polynomial_4567": (
        lambda x: 840 * x - 5040 * x**2 + 8400 * x**3 - 4200 * x**4,
        lambda x: 840 - 10080 * x + 25200 * x**2 - 16800 * x**3,
    ),
}


@pytest.mark.parametrize("name", HIGHER)
def test_third_and_fourth_derivatives_are_those_of_the_printed_formulas(name: str) -> None:
    x = np.linspace(0.003, 0.997, 41)
    found = derivatives(SegmentedLaw(1.0, (-3.0,), (0.5,), (name,), periodic=False), 0.5 * x, 4)
    for order, formula in zip((3, 4), HIGHER[name], strict=True):
        expected = -4 * formula(x) / 0.5**order
        assert np.abs(found[order] - expected).max() <= ROUNDED * 100 * np.abs(expected).max()  # of terms that cancel


def by_differences(law: DriveLaw, time: Samples, step: float) -> tuple[Samples, Samples]:
    """The derivatives of the acceleration, by five points: to the fourth power of the step."""
    far, near, at, *beyond = (law.at(time + k * step).acceleration for k in (-2, -1, 0, 1, 2))
    first = (far - 8 * near + 8 * beyond[0] - beyond[1]) / (12 * step)
    return first, (-far + 16 * near - 30 * at + 16 * beyond[0] - beyond[1]) / (12 * step**2)


LAWS_OF_ANY_KIND: dict[str, DriveLaw] = {
    **{name: segments(name, periodic=True, gain=1.0) for name in LAWS},
    "sines": HarmonicLaw(1.0, (2.0, -0.3), (1.0, 2.5), (0.3, -1.0)),
    "a spline": MotionLaw((0.0, 0.2, 0.3, 0.7, 0.9), (0.0, 1.0, 0.4, 0.3, 0.0), periodic=True),
    "a table once": MotionLaw((0.0, 0.2, 0.3, 0.7, 0.9), (0.0, 1.0, 0.4, 0.3, 2.0), periodic=False),
    "a speed": ConstantSpeed(3.0, 0.5, None),
}


@pytest.mark.parametrize("name", LAWS_OF_ANY_KIND)
def test_third_and_fourth_derivatives_are_those_of_the_acceleration(name: str) -> None:
    """In the third period too, off the instants where a piece ends; and the lower orders are the law's own."""
    law, step = LAWS_OF_ANY_KIND[name], 1e-3
    time = 2 * law.cycle * law.periodic + np.linspace(0, law.cycle, 1001)[1:-1]
    ends = np.array([piece.begin for piece in law.pieces] if not isinstance(law, ConstantSpeed) else [])
    off = np.abs(np.subtract.outer(time % law.cycle, [*ends, law.cycle])).min(axis=1)
    time = time[off > 3 * step]
    assert time.size > 100
    found, differences = derivatives(law, time, 4), by_differences(law, time, step)
    assert (found[:3] == np.array(law.at(time))).all()
    assert (derivatives(law, time, 1) == found[:2]).all()
    # The fastest sine has 4 pi / 0.3 s: a step's fourth power is 3e-6 of it over 30, and rounding 1e-9 by step^2.
    for value, expected, share in zip(found[3:], differences, (1e-6, 1e-4), strict=True):
        size = max(float(np.abs(found[3:]).max()), float(np.abs(found[2]).max()), 1.0)
        assert np.abs(value - expected).max() <= share * size


def test_the_third_derivative_of_a_spline_jumps_at_its_rows_alone() -> None:
    law = LAWS_OF_ANY_KIND["a spline"]
    third, fourth = law.higher(np.linspace(0.001, 0.899, 400))
    assert len(np.unique(third)) == 4
    assert not fourth.any()
