"""Motion laws by formula: segments of named laws, from rest to rest, and sums of harmonics."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import accumulate, pairwise
from math import cos, gcd, inf, lcm, pi, sin
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .fields import Angle, Duration, Frequency, Position

Samples: TypeAlias = NDArray[np.float64]
SAME_INSTANT_TOL = 1e-9  # of a cycle; so close before a boundary counts as on it, whichever way it was rounded


class Driven(NamedTuple):
    """What the drive asks for, each of the shape of the instants: rad or m, and its derivatives by the time, s."""

    position: Samples
    rate: Samples
    acceleration: Samples


class Piece(NamedTuple):
    """A motion from an instant on, a polynomial and sines of the time; it goes on smoothly on both sides."""

    begin: float  # s
    polynomial: Sequence[float] | Samples  # rad or m by s^0, s^1, ...
    sines: Sequence[tuple[float, float, float]] = ()  # amplitude, rad or m; rate, rad/s; phase, rad
    lag: float = 0.0  # s, from its beginning to where its time is zero
    within: float = 1.0  # s, that its law takes, or its fastest sine

    def at(self, time: ArrayLike) -> Driven:
        """The position and its derivatives at an instant, s, or at many."""
        t = np.subtract(time, self.begin + self.lag)
        position = rate = acceleration = 0.0 * t
        # Horner's rule for a polynomial and its first two derivatives at once, from the highest power down. Each line
        # of it is the derivative of the one before: (p t + c)' = p' t + p, (p t + c)'' = p'' t + 2 p'.
        for c in reversed(self.polynomial):
            position, rate, acceleration = position * t + c, rate * t + position, acceleration * t + 2 * rate
        for size, omega, phase in self.sines:
            y, dy = size * np.sin(omega * t + phase), omega * size * np.cos(omega * t + phase)
            position, rate, acceleration = position + y, rate + dy, acceleration - omega * omega * y
        return Driven(position, rate, acceleration)

    def higher(self, time: ArrayLike) -> tuple[Samples, Samples]:
        """The third and the fourth derivative of the position by the time, likewise."""
        t = np.subtract(time, self.begin + self.lag)
        third = fourth = 0.0 * t
        for k in reversed(range(3, len(self.polynomial))):  # of a polynomial whose coefficients are those of the third
            c = k * (k - 1) * (k - 2) * self.polynomial[k]
            third, fourth = third * t + c, fourth * t + third
        for size, omega, phase in self.sines:
            cubed, angle = omega * omega * omega * size, omega * t + phase
            third, fourth = third - cubed * np.cos(angle), fourth + omega * cubed * np.sin(angle)
        return third, fourth

    def moved(self, begin: float, start: float, within: float = 1.0, rise: float = 1.0) -> "Piece":
        """The same from another instant and place on, and in other units of time, s, and way, rad or m."""
        # The new motion is y(T) = start + rise p((T - begin) / within). So the coefficient of T^k is divided by
        # within^k, and angular rates by `within`; phases do not change, since the lag is stretched with the time.
        polynomial = [rise * c / within**k + start * (k == 0) for k, c in enumerate(self.polynomial)]
        sines = [(rise * size, omega / within, phase) for size, omega, phase in self.sines]
        return Piece(begin + within * self.begin, polynomial, sines, within * self.lag, within * self.within)


def _law(*parts: tuple[float, float, float]) -> Sequence[Piece]:
    """A law whose acceleration is C sin(w t + p) in parts of lengths h, given by (h, w, p), integrated twice."""
    # But for C, a part has from its first rate v and way s on the rate v + (cos p - cos(w t + p)) / w and the way
    # s + sin p / w^2 + (v + cos p / w) t - sin(w t + p) / w^2, or s + v t + t^2 sin p / 2 where w is zero. C makes the
    # way one in the end: pi^2 / 2 of the harmonic, 2 pi of the cycloidal, 4 pi^2 / (4 + pi) of the modified sine and
    # 8 pi / (2 + pi) of the modified trapezoid.
    pieces, begin, way, rate = list[Piece](), 0.0, 0.0, 0.0
    for h, w, p in parts:
        law = ((way + sin(p) / w**2, rate + cos(p) / w), [(-1 / w**2, w, p)]) if w else ((way, rate, sin(p) / 2),)
        pieces.append(Piece(begin, *law))
        begin += h
        way, rate, _ = map(float, pieces[-1].at(begin))
    return [piece.moved(0.0, 0.0, rise=1 / way) for piece in pieces]


# Norton, Cam Design and Manufacturing Handbook, and VDI 2143: a unit of way in a unit of time x. The polynomials, which
# are 10 x^3 - 15 x^4 + 6 x^5 and 35 x^4 - 84 x^5 + 70 x^6 - 20 x^7, lose no digits as those of t = x - 1/2.
LAWS: Mapping[str, Sequence[Piece]] = {
    "harmonic": _law((1, pi, pi / 2)),
    "cycloidal": _law((1, 2 * pi, 0)),
    "polynomial_345": [Piece(0.0, (1 / 2, 15 / 8, 0, -5, 0, 6), lag=1 / 2)],
    "polynomial_4567": [Piece(0.0, (1 / 2, 35 / 16, 0, -35 / 4, 0, 21, 0, -20), lag=1 / 2)],
    "modified_sine": _law((1 / 8, 4 * pi, 0), (3 / 4, 4 / 3 * pi, pi / 2), (1 / 8, 4 * pi, -pi / 2)),
    "modified_trapezoid": _law(
        (1 / 8, 4 * pi, 0), (1 / 4, 0, pi / 2), (1 / 4, 4 * pi, pi / 2), (1 / 4, 0, -pi / 2), (1 / 8, 4 * pi, -pi / 2)
    ),
}
DWELL = [Piece(0.0, (0.0,), within=inf)]


class Timed(Protocol):
    """What is a function of the time, with its derivatives."""

    def at(self, time: ArrayLike) -> Driven:
        """What the drive asks for at instants of any shape, s, before zero and after the end too."""

    def higher(self, time: ArrayLike) -> tuple[Samples, Samples]:
        """The third and the fourth derivative of the position by the time, at instants of any shape, s."""


def derivatives(law: Timed, time: ArrayLike, order: int) -> Samples:
    """A law's position and its derivatives by the time up to an order, four at most, shape (order + 1, ...)."""
    every = [*law.at(time), *(law.higher(time) if order > 2 else ())]
    return np.array(np.broadcast_arrays(*every[: order + 1]))


class Law(Timed, Protocol):
    """What all motion laws have by the instants of a cycle at which they stand still, or are fastest."""

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""

    def still(self, order: int) -> ArrayLike:
        """Instants of a cycle, s, among them its ends and all where the first or the second derivative is zero."""

    @cached_property
    def peak_rate(self) -> float:
        """The largest |rate|, rad/s or m/s."""
        return float(np.abs(self.at(self.still(2)).rate).max())

    @cached_property
    def extent(self) -> tuple[float, float]:
        """The least and the largest position of a cycle, rad or m."""
        positions = self.at(self.still(1)).position
        return float(positions.min()), float(positions.max())

    def after(self, cycles: ArrayLike) -> Samples:
        """The positions, rad or m, after numbers of cycles, whole or not, of any shape."""
        return self.at(np.asarray(cycles, np.float64) * self.cycle).position


@dataclass(frozen=True)
class SegmentedLaw(Law):
    """Segments in a row, at rest before and after; or periodic, for ever, where each period may gain whole turns.

    What an instant on a boundary has is the later segment's; at the end of what is not periodic the last one's.
    """

    start: Position  # rad or m, when time is zero
    ends: tuple[Position | None, ...] = field(metadata={"path": "segments.*.to"})  # rad or m; None of a dwell
    durations: tuple[Duration, ...] = field(metadata={"path": "segments.*.within"})  # s
    laws: tuple[str | None, ...]  # of LAWS; None of a dwell
    periodic: bool  # whether a cycle can follow the one before

    @cached_property
    def boundaries(self) -> tuple[float, ...]:
        """When the segments begin, and when the last one ends, s."""
        return tuple(accumulate(self.durations, initial=0.0))

    @cached_property
    def positions(self) -> tuple[float, ...]:
        """Where the drive is at those instants, rad or m."""
        return tuple(accumulate(self.ends, lambda here, to: here if to is None else to, initial=self.start))

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""
        return self.boundaries[-1]

    def still(self, order: int) -> ArrayLike:
        """The boundaries, s, since no law turns back, or for the second the middles, where all are fastest."""
        return self.boundaries if order == 1 else [(begin + end) / 2 for begin, end in pairwise(self.boundaries)]

    @cached_property
    def pieces(self) -> Sequence[Piece]:
        """The pieces of a cycle, in the order of the time."""
        segments = zip(self.laws, self.durations, self.boundaries, pairwise(self.positions), strict=False)
        return [
            piece.moved(begin, here, within, there - here)
            for law, within, begin, (here, there) in segments
            for piece in (LAWS[law] if law else DWELL)
        ]

    def at(self, time: ArrayLike) -> Driven:
        """What the drive asks for at instants of any shape, s, before zero and after the end too."""
        # At a boundary the position is the boundary's own and the rate is zero, without the roundings of a polynomial
        # that is evaluated there: two segments that meet agree to the last bit. The acceleration may jump there, as
        # that of a harmonic law does, so it is the later segment's.
        places, time, last, periods, rests = self._placed(time)
        position, rate, acceleration = self._of_pieces(Piece.at, places, time, 3)
        positions = np.asarray(self.positions)
        position = np.where(rests, positions[last], position) + periods * (positions[-1] - positions[0])
        return Driven(position, np.where(rests, 0.0, rate), acceleration)

    def higher(self, time: ArrayLike) -> tuple[Samples, Samples]:
        """The third and the fourth derivative of the position by the time, at instants of any shape, s."""
        places, time, *_ = self._placed(time)
        third, fourth = self._of_pieces(Piece.higher, places, time, 2)
        return third, fourth

    def _placed(self, time: ArrayLike) -> tuple[Any, ...]:
        """By instant the number of its piece and the time in its cycle; the last boundary, how many cycles were before.

        And whether it is on that boundary. The first piece, and the one behind the last, are at rest.
        """
        time, ends = np.asarray(time, np.float64), np.asarray(self.boundaries)
        # The instants of samples are products such as 120 / 360 * cycle, and may be a rounding before or after the
        # boundary that they stand for. All within a hair are set on the boundary itself, which belongs to the later
        # piece.
        hair = SAME_INSTANT_TOL * self.cycle
        periods = np.floor((time + hair) / self.cycle) if self.periodic else np.zeros(time.shape)
        time = time - periods * self.cycle
        last = np.maximum(np.searchsorted(ends, time + hair, side="right") - 1, 0)
        rests = np.abs(time - ends[last]) <= hair
        time = np.where(rests, ends[last], time)
        # Piece 0 is the rest before the first segment, pieces 1 to n are the segments' own, piece n + 1 is the rest
        # after the last. The end itself lies before `cycle + hair`, so of a law that is not periodic it belongs to the
        # last segment.
        begins = [*(piece.begin for piece in self.pieces), self.cycle + hair]
        return np.searchsorted(begins, time, side="right"), time, last, periods, rests

    def _of_pieces(
        self, take: Callable[[Piece, Samples], Sequence[Samples]], places: Any, time: Any, count: int
    ) -> Samples:
        """What is taken from each instant's own piece, shape (count, ...)."""
        pieces, found = (self._rest(0), *self.pieces, self._rest(-1)), np.empty((count, *time.shape))
        for number in np.unique(places):
            found[:, places == number] = take(pieces[number], time[places == number])
        return found

    def _rest(self, end: int) -> Piece:
        return Piece(0.0, (self.positions[end],))


@dataclass(frozen=True)
class HarmonicLaw(Law):
    """A sum of sines about a position, for ever; its cycle is their least common period."""

    middle: Position = field(metadata={"path": "start"})  # rad or m
    amplitudes: tuple[Position, ...] = field(metadata={"path": "harmonics.*.0"})  # rad or m
    frequencies: tuple[Frequency, ...] = field(metadata={"path": "harmonics.*.1"})  # 1/s
    phases: tuple[Angle, ...] = field(metadata={"path": "harmonics.*.2"})  # rad
    periodic = True

    @cached_property
    def multiples(self) -> tuple[int, ...]:
        """How often each is in a cycle, by the digits of the frequencies as they are written."""
        # The common frequency is the greatest number of which all frequencies are whole multiples: with reduced
        # fractions the gcd of the numerators over the lcm of the denominators. The decimals as written count, since 0.1
        # as a double is a fraction over 2^55, by which no cycle would ever close.
        written = [Fraction(str(frequency)) for frequency in self.frequencies]
        common = Fraction(gcd(*(f.numerator for f in written)), lcm(*(f.denominator for f in written)))
        return tuple(int(f / common) for f in written)

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""
        return self.multiples[0] / self.frequencies[0]

    @property
    def pieces(self) -> Sequence[Piece]:
        """The one piece of any time."""
        sines = zip(self.amplitudes, (2 * pi * f for f in self.frequencies), self.phases, strict=True)
        return [Piece(0.0, (self.middle,), [*sines], within=1 / max(self.frequencies))]

    @property
    def start(self) -> float:
        """The position when time is zero, rad or m."""
        return float(self.at(0.0).position)

    def still(self, order: int) -> ArrayLike:
        """Instants, s, with all of a cycle where the derivative of an order is zero: a polynomial of exp(i w t)."""
        # A derivative of order m is the real part of the sum of c_n z^n, with z = exp(2 pi i t / cycle), and with c_n =
        # A_n n^m exp(i (phase_n + (m - 1) pi / 2)), because the m-th derivative of a sine is led by m quarter turns.
        # Times 2 z^N it is the polynomial with the coefficients c_N ... c_1, 0, conj c_1 ... conj c_N. Its roots on the
        # unit circle are the instants sought, all of them, which no search from samples guarantees. Roots off the
        # circle are kept too: their angles add instants at which nothing is special, and a largest value over the
        # instants is not changed by those.
        c = np.zeros(max(self.multiples) + 1, complex)
        for size, n, phase in zip(self.amplitudes, self.multiples, self.phases, strict=True):
            c[n] += size * n**order * np.exp(1j * (phase + (order - 1) * pi / 2))
        z = np.roots([*c[:0:-1], 0.0, *c[1:].conj()])
        return np.append(0.0, np.angle(z) / (2 * pi) * self.cycle)  # of sines that cancel there are no roots

    def at(self, time: ArrayLike) -> Driven:
        """What the drive asks for at instants of any shape, s."""
        return self.pieces[0].at(time)

    def higher(self, time: ArrayLike) -> tuple[Samples, Samples]:
        """The third and the fourth derivative of the position by the time, at instants of any shape, s."""
        return self.pieces[0].higher(time)
