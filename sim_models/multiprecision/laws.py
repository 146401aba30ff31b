"""Motion laws by formula in arbitrary precision, a second implementation of `scenes.laws`.

There an acceleration is integrated; here are printed formulas of the way, for a time that is a power series: rates and
accelerations are further coefficients.
"""

from bisect import bisect_right
from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import accumulate
from math import gcd, lcm
from typing import Any, NamedTuple

from flint import arb, arb_series, fmpq

from scenes.laws import SAME_INSTANT, HarmonicLaw, SegmentedLaw

# The way of the first half, of which the other is the mirror image, at a share x of the time; each up to a share.
# The polynomials, the modified sine and the modified trapezoid of Norton, Cam Design, with their numbers by pi = p.
FIRST_HALVES: Mapping[str, Mapping[Fraction, Callable[[Any, Any], Any]]] = {
    "harmonic": {Fraction(1, 2): lambda x, p: (1 - (p * x).cos()) / 2},
    "cycloidal": {Fraction(1, 2): lambda x, p: x - (2 * p * x).sin() / (2 * p)},
    "polynomial_345": {Fraction(1, 2): lambda x, _: 10 * x**3 - 15 * x**4 + 6 * x**5},
    "polynomial_4567": {Fraction(1, 2): lambda x, _: 35 * x**4 - 84 * x**5 + 70 * x**6 - 20 * x**7},
    "modified_sine": {
        Fraction(1, 8): lambda x, p: (p * x - (4 * p * x).sin() / 4) / (4 + p),
        Fraction(1, 2): lambda x, p: (2 + p * x - 9 * (p * (4 * x + 1) / 3).sin() / 4) / (4 + p),
    },
    "modified_trapezoid": {
        Fraction(1, 8): lambda x, p: (2 * x - (4 * p * x).sin() / (2 * p)) / (2 + p),
        Fraction(3, 8): lambda x, p: (4 * p * x**2 + (2 - p) * x + p / 16 - 1 / (2 * p)) / (2 + p),
        Fraction(1, 2): lambda x, p: (2 * (1 + p) * x + (4 * p * x).sin() / (2 * p) - p / 2) / (2 + p),
    },
}


class Command(NamedTuple):
    """What the drive asks for at one instant: time, s; position, rad or m; and its derivatives by the time."""

    time: arb
    position: arb
    rate: arb
    acceleration: arb


class SegmentsLaw:
    """Segments in a row."""

    def __init__(self, drive: SegmentedLaw) -> None:
        self._laws, self._periodic, self._durations = drive.laws, drive.periodic, [*map(Fraction, drive.durations)]
        self._ends = [*accumulate(self._durations, initial=Fraction(0))]
        self._positions = [arb(drive.start)]
        for end in drive.ends:
            self._positions.append(self._positions[-1] if end is None else arb(end))

    def at(self, cycles: Fraction) -> Command:
        """Return the command after a number of cycles: on a boundary, or so near to one, the later segment's."""
        hair = Fraction(SAME_INSTANT) * self._ends[-1]
        periods = (cycles + Fraction(SAME_INSTANT)) // 1 if self._periodic else 0
        time = (cycles - periods) * self._ends[-1]
        last = bisect_right(self._ends, time + hair) - 1
        i = min(last, len(self._laws) - 1)
        law, within, (here, there) = self._laws[i], self._durations[i], self._positions[i : i + 2]
        time = self._ends[last] if abs(time - self._ends[last]) <= hair else time
        x = (time - self._ends[i]) / within
        start = here + periods * (self._positions[-1] - self._positions[0])
        way = _way(law, x, ball(1 / within)) if law else _series(arb(0), arb(0))
        return _command(cycles * self._ends[-1], start + (there - here) * way)


def _way(law: str, x: Fraction, pace: arb) -> arb_series:
    if 2 * x > 1:
        return 1 - _way(law, 1 - x, -pace)
    formula = next(formula for end, formula in FIRST_HALVES[law].items() if x <= end)
    return arb_series(formula(_series(ball(x), pace), arb.pi()))


class SinesLaw:
    """A sum of sines, of frequencies as they are written."""

    def __init__(self, drive: HarmonicLaw) -> None:
        frequencies = [Fraction(str(frequency)) for frequency in drive.frequencies]
        self._period = Fraction(lcm(*(f.denominator for f in frequencies)), gcd(*(f.numerator for f in frequencies)))
        self._middle = arb(drive.middle)
        self._sines = [*zip(map(arb, drive.amplitudes), frequencies, map(arb, drive.phases), strict=True)]

    def at(self, cycles: Fraction) -> Command:
        """Return the command after a number of cycles, whole or not."""
        time, position = cycles * self._period, _series(self._middle, arb(0))
        for size, f, phase in self._sines:
            position += size * (2 * arb.pi() * _series(ball(f * time % 1), ball(f)) + phase).sin()
        return _command(time, position)


def _series(value: arb, rate: arb) -> arb_series:
    return arb_series([value, rate], prec=3)


def _command(time: Fraction, position: arb_series) -> Command:
    return Command(ball(time), position[0], position[1], 2 * position[2])


def ball(exact: Fraction) -> arb:
    """Return a number as a ball."""
    return arb(fmpq(exact.numerator, exact.denominator))
