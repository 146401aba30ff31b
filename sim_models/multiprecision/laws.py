"""Motion laws by formula in arbitrary precision: a second implementation of `scenes.laws`.

There the acceleration is integrated from end to end; here are the formulas that Norton, Cam Design, prints for laws of
sine, constant and cosine acceleration, of the first half, whose mirror image is the other; of polynomials the integral.
"""

from bisect import bisect_right
from collections.abc import Mapping
from fractions import Fraction
from itertools import accumulate
from math import gcd, lcm
from typing import NamedTuple

from flint import arb, arb_poly, fmpq

from scenes.laws import SAME_INSTANT, HarmonicLaw, SegmentedLaw

# By name the shares b, c and d of sine, constant and cosine; or the power n of a rate that goes with (x - x^2)^n.
SHARES: Mapping[str, tuple[Fraction, Fraction, Fraction]] = {
    "harmonic": (Fraction(0), Fraction(0), Fraction(1)),
    "cycloidal": (Fraction(1, 2), Fraction(0), Fraction(1, 2)),
    "modified_sine": (Fraction(1, 4), Fraction(0), Fraction(3, 4)),
    "modified_trapezoid": (Fraction(1, 4), Fraction(1, 2), Fraction(1, 4)),
}
POWERS: Mapping[str, int] = {"polynomial_345": 2, "polynomial_4567": 3}


class Command(NamedTuple):
    """What the drive asks for at one instant: time, s; position, rad or m; and its derivatives by the time."""

    time: arb
    position: arb
    rate: arb
    acceleration: arb


class SegmentsLaw:
    """Segments in a row; `travel` is the way between their extreme ends, `pace` their steepest chord."""

    def __init__(self, drive: SegmentedLaw) -> None:
        self._segments, self._periodic = drive.segments, drive.periodic
        self._ends = [*accumulate((Fraction(segment.within) for segment in drive.segments), initial=Fraction(0))]
        self._positions = [arb(drive.start)]
        for segment in drive.segments:
            self._positions.append(self._positions[-1] if segment.to is None else arb(segment.to))
        ways = zip(self._positions[1:], self._positions, drive.segments, strict=False)
        self.pace = max((abs(there - here) / segment.within for there, here, segment in ways), key=float)
        self.travel = max(self._positions, key=float) - min(self._positions, key=float)

    def at(self, cycles: Fraction) -> Command:
        """Return the command after a number of cycles: on a boundary, or so near to one, the later segment's."""
        hair = Fraction(SAME_INSTANT)
        periods = (cycles + hair) // 1 if self._periodic else 0
        time = (cycles - periods) * self._ends[-1]
        i = min(bisect_right(self._ends, time + hair * self._ends[-1]), len(self._segments)) - 1
        segment, (here, there) = self._segments[i], self._positions[i : i + 2]
        within = ball(Fraction(segment.within))
        s, v, a = unit_law(segment.law, (time - self._ends[i]) / Fraction(segment.within))
        rise, gain = there - here, periods * (self._positions[-1] - self._positions[0])
        return Command(ball(cycles * self._ends[-1]), here + gain + rise * s, rise * v / within, rise * a / within**2)


def unit_law(law: str | None, x: Fraction) -> tuple[arb, arb, arb]:
    """Return way, rate and acceleration of a law of unit way at a share of its time, which may be beyond its ends."""
    if law is None:
        return arb(0), arb(0), arb(0)
    if law in POWERS:
        rate = arb_poly([0, 1, -1]) ** POWERS[law]
        way, at = rate.integral(), ball(x)
        return way(at) / way(1), rate(at) / way(1), rate.derivative()(at) / way(1)
    if 2 * x > 1:
        s, v, a = unit_law(law, 1 - x)
        return 1 - s, v, -a
    return _first_half(*SHARES[law], x)


def _first_half(b: Fraction, c: Fraction, d: Fraction, x: Fraction) -> tuple[arb, arb, arb]:
    """Return way, rate and acceleration where that is by shares sine, constant and cosine, up to half the time."""
    p, X, B, c_, D = arb.pi(), ball(x), ball(b), ball(c), ball(d)
    C = 4 * p**2 / ((p**2 - 8) * (B**2 - D**2) - 2 * p * (p - 2) * B + p**2)
    K = B**2 * (arb(1) / 8 - 1 / p**2)
    if b and 2 * x < b:
        turn = p * X / B
        return C * (B * X / p - (B / p) ** 2 * turn.sin()), C * B / p * (1 - turn.cos()), C * turn.sin()
    if 2 * x < 1 - d:
        return C * (X**2 / 2 + B * (1 / p - arb(1) / 2) * X + K), C * (X + B * (1 / p - arb(1) / 2)), C
    turn, slope = p / D * (X - (1 - D) / 2), B / p + c_ / 2
    way = slope * X + (D / p) ** 2 + K - (1 - D) ** 2 / 8 - (D / p) ** 2 * turn.cos()
    return C * way, C * (slope + D / p * turn.sin()), C * turn.cos()


class SinesLaw:
    """A sum of sines, of frequencies as they are written; `travel` and `pace` are those of all at once."""

    def __init__(self, drive: HarmonicLaw) -> None:
        frequencies = [Fraction(str(frequency)) for frequency in drive.frequencies]
        self._period = Fraction(lcm(*(f.denominator for f in frequencies)), gcd(*(f.numerator for f in frequencies)))
        self._middle = arb(drive.middle)
        self._sines = [*zip(map(arb, drive.amplitudes), frequencies, map(arb, drive.phases), strict=True)]
        self.travel = sum((2 * abs(size) for size, *_ in self._sines), arb(0))
        self.pace = sum((abs(size) * 2 * arb.pi() * ball(f) for size, f, _ in self._sines), arb(0))

    def at(self, cycles: Fraction) -> Command:
        """Return the command after a number of cycles, whole or not."""
        time, position, rate, acceleration = cycles * self._period, self._middle, arb(0), arb(0)
        for size, frequency, phase in self._sines:
            omega = 2 * arb.pi() * ball(frequency)
            turn = 2 * arb.pi() * ball(frequency * time % 1) + phase
            position, rate = position + size * turn.sin(), rate + size * omega * turn.cos()
            acceleration -= size * omega**2 * turn.sin()
        return Command(ball(time), position, rate, acceleration)


def ball(exact: Fraction) -> arb:
    """Return a number as a ball."""
    return arb(fmpq(exact.numerator, exact.denominator))
