"""Motion laws by formula: segments of named laws, from rest to rest, and sums of harmonics.

The laws are those of Norton, Cam Design and Manufacturing Handbook, and of VDI 2143: each takes a unit of way in a unit
of time. Between two instants each is a polynomial and a sine of the time, a `Piece`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import accumulate, pairwise
from math import cos, gcd, lcm, pi, sin
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .fields import Angle, Duration, Frequency, Position

Samples: TypeAlias = NDArray[np.float64]
SAME_INSTANT = 1e-9  # of a cycle; so close before a boundary counts as on it, whichever way it was rounded


class Driven(NamedTuple):
    """What the drive asks for, each of the shape of the instants: rad or m, and its derivatives by the time, s."""

    position: Samples
    rate: Samples
    acceleration: Samples


class Piece(NamedTuple):
    """A motion from an instant on, a polynomial and waves of the time; it goes on smoothly on both sides."""

    begin: float  # s
    polynomial: Sequence[float]  # rad or m by s^0, s^1, ...
    waves: Sequence[tuple[float, float, float]] = ()  # amplitude, rad or m; rate, rad/s; phase, rad
    lag: float = 0.0  # s, from its beginning to where its time is zero

    def at(self, time: ArrayLike) -> Driven:
        """The position and its derivatives at an instant, s, or at many."""
        t = np.subtract(time, self.begin + self.lag)
        position = rate = acceleration = 0.0 * t
        for c in reversed(self.polynomial):
            position, rate, acceleration = position * t + c, rate * t + position, acceleration * t + 2 * rate
        for size, omega, phase in self.waves:
            across, along = size * np.sin(omega * t + phase), omega * size * np.cos(omega * t + phase)
            position, rate, acceleration = position + across, rate + along, acceleration - omega**2 * across
        return Driven(position, rate, acceleration)

    def scaled(self, begin: float, start: float, within: float, rise: float) -> "Piece":
        """A part of a law of units of time and way as it is in a segment."""
        polynomial = [rise * c / within**k for k, c in enumerate(self.polynomial)]
        waves = [(rise * size, omega / within, phase) for size, omega, phase in self.waves]
        return Piece(begin + within * self.begin, (start + polynomial[0], *polynomial[1:]), waves, within * self.lag)

    def later(self, time: float, gain: float) -> "Piece":
        """The same motion so much later, s, and further on, rad or m."""
        start, *others = self.polynomial
        return self._replace(begin=self.begin + time, polynomial=(start + gain, *others))


def _law(*parts: tuple[float, float, float]) -> tuple[Piece, ...]:
    """A law whose acceleration is C sin(w t + p) in parts of lengths h, given by (h, w, p), integrated twice.

    From its rate v and its way s at its beginning each part takes, but for C, v + (cos p - cos(w t + p)) / w and
    s + sin p / w^2 + (v + cos p / w) t - sin(w t + p) / w^2; where w is zero v + t sin p and s + v t + t^2 sin p / 2.
    The way of one in the end gives C: pi^2 / 2 of the harmonic, 2 pi of the cycloidal, 4 pi^2 / (4 + pi) of the
    modified sine and 8 pi / (2 + pi) of the modified trapezoid.
    """
    pieces, at, rate, way = list[Piece](), 0.0, 0.0, 0.0
    for h, w, p in parts:
        if w:
            pieces.append(Piece(at, (way + sin(p) / w**2, rate + cos(p) / w), [(-1 / w**2, w, p)]))
        else:
            pieces.append(Piece(at, (way, rate, sin(p) / 2)))
        at += h
        way, rate, _ = map(float, pieces[-1].at(at))
    return tuple(piece.scaled(0.0, 0.0, 1.0, 1 / way) for piece in pieces)


# Of x = 1/2 + t, 10 x^3 - 15 x^4 + 6 x^5 and 35 x^4 - 84 x^5 + 70 x^6 - 20 x^7 are polynomials that lose no digits.
LAWS: Mapping[str, tuple[Piece, ...]] = {
    "harmonic": _law((1, pi, pi / 2)),
    "cycloidal": _law((1, 2 * pi, 0)),
    "polynomial_345": (Piece(0.0, (1 / 2, 15 / 8, 0, -5, 0, 6), lag=1 / 2),),
    "polynomial_4567": (Piece(0.0, (1 / 2, 35 / 16, 0, -35 / 4, 0, 21, 0, -20), lag=1 / 2),),
    "modified_sine": _law((1 / 8, 4 * pi, 0), (3 / 4, 4 / 3 * pi, pi / 2), (1 / 8, 4 * pi, -pi / 2)),
    "modified_trapezoid": _law(
        (1 / 8, 4 * pi, 0), (1 / 4, 0, pi / 2), (1 / 4, 4 * pi, pi / 2), (1 / 4, 0, -pi / 2), (1 / 8, 4 * pi, -pi / 2)
    ),
}


@dataclass(frozen=True)
class Segment:
    """A part of a motion, from rest to rest."""

    to: Position | None  # rad or m; None for a dwell
    within: Duration  # s
    law: str | None  # of LAWS; None for a dwell


@dataclass(frozen=True)
class SegmentedLaw:
    """Segments in a row, at rest before and after; or periodic, for ever, where each period may gain whole turns.

    What an instant on a boundary has is the later segment's; at the end of what is not periodic the last one's.
    """

    body: str
    start: Position  # rad or m, when time is zero
    segments: tuple[Segment, ...]
    periodic: bool

    @property
    def repeats(self) -> bool:
        """Whether a cycle can follow the one before."""
        return self.periodic

    @cached_property
    def boundaries(self) -> tuple[float, ...]:
        """When the segments begin, and when the last one ends, s."""
        return tuple(accumulate((segment.within for segment in self.segments), initial=0.0))

    @cached_property
    def positions(self) -> tuple[float, ...]:
        """Where the drive is at those instants, rad or m."""
        ends = (segment.to for segment in self.segments)
        return tuple(accumulate(ends, lambda here, to: here if to is None else to, initial=self.start))

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""
        return self.boundaries[-1]

    @cached_property
    def peak_rate(self) -> float:
        """The largest |rate|, rad/s or m/s: every law has its own half-way."""
        return float(np.abs(self.at([(one + other) / 2 for one, other in pairwise(self.boundaries)]).rate).max())

    @property
    def extent(self) -> tuple[float, float]:
        """The least and the largest position of a cycle, rad or m: no law turns back."""
        return min(self.positions), max(self.positions)

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The pieces of a cycle, in the order of the time."""
        ways = zip(self.segments, self.boundaries, pairwise(self.positions), strict=False)
        return tuple(
            piece.scaled(begin, here, segment.within, there - here)
            for segment, begin, (here, there) in ways
            for piece in (LAWS[segment.law] if segment.law else (Piece(0.0, (0.0,)),))
        )

    def through(self, cycles: int) -> Sequence[Piece]:
        """The pieces of so many cycles, and if it is periodic the first of the next one, to which their end belongs."""
        gain = self.positions[-1] - self.positions[0]
        every = [piece.later(n * self.cycle, n * gain) for n in range(cycles + 1) for piece in self.pieces]
        return every[: cycles * len(self.pieces) + self.periodic]

    def after(self, cycles: ArrayLike) -> Samples:
        """The positions, rad or m, after numbers of cycles, whole or not, of any shape."""
        return self.at(np.asarray(cycles, np.float64) * self.cycle).position

    def at(self, time: ArrayLike) -> Driven:
        """What the drive asks for at instants of any shape, s, before zero and after the end too."""
        time, cycle, hair = np.asarray(time, np.float64), self.cycle, SAME_INSTANT * self.cycle
        periods = np.floor((time + hair) / cycle) if self.periodic else np.zeros(time.shape)
        time = time - periods * cycle
        pieces = Piece(0.0, self.positions[:1]), *self.pieces, Piece(cycle, self.positions[-1:])
        begins = [*(piece.begin - hair for piece in self.pieces), np.inf if self.periodic else cycle + hair]
        own, driven = np.searchsorted(begins, time, side="right"), np.empty((3, *time.shape))
        for number in np.unique(own):
            driven[:, own == number] = pieces[number].at(time[own == number])
        driven[0] += periods * (self.positions[-1] - self.positions[0])
        return Driven(*driven)


@dataclass(frozen=True)
class HarmonicLaw:
    """A sum of sines about a position, for ever; its cycle is their least common period."""

    body: str
    middle: Position = field(metadata={"path": "start"})  # rad or m
    amplitudes: tuple[Position, ...] = field(metadata={"path": "harmonics.*.0"})  # rad or m
    frequencies: tuple[Frequency, ...] = field(metadata={"path": "harmonics.*.1"})  # 1/s
    phases: tuple[Angle, ...] = field(metadata={"path": "harmonics.*.2"})  # rad, of a sine
    repeats = True

    @cached_property
    def fundamental(self) -> Fraction:
        """The frequency, 1/s, of which all are whole multiples, in the digits as they are written."""
        written = [Fraction(str(frequency)) for frequency in self.frequencies]
        return Fraction(gcd(*(f.numerator for f in written)), lcm(*(f.denominator for f in written)))

    @cached_property
    def multiples(self) -> tuple[int, ...]:
        """How often each is in a cycle."""
        return tuple(int(Fraction(str(frequency)) / self.fundamental) for frequency in self.frequencies)

    @property
    def cycle(self) -> float:
        """How long one cycle takes, s."""
        return float(1 / self.fundamental)

    @cached_property
    def _piece(self) -> Piece:
        """All of the motion in one."""
        omega = (2 * pi * frequency for frequency in self.frequencies)
        return Piece(0.0, (self.middle,), [*zip(self.amplitudes, omega, self.phases, strict=True)])

    def through(self, cycles: int) -> Sequence[Piece]:  # noqa: ARG002 - it is one
        """The pieces of so many cycles."""
        return [self._piece]

    @property
    def start(self) -> float:
        """The position when time is zero, rad or m."""
        return float(self.at(0.0).position)

    @cached_property
    def peak_rate(self) -> float:
        """The largest |rate|, rad/s or m/s."""
        return float(np.abs(self.at(self._still(2)).rate).max())

    @cached_property
    def extent(self) -> tuple[float, float]:
        """The least and the largest position of a cycle, rad or m."""
        positions = self.at(self._still(1)).position
        return float(positions.min()), float(positions.max())

    def _still(self, order: int) -> Samples:
        """The instants of a cycle, s, among which are all where the derivative of an order is zero.

        With z = exp(2 pi i t / cycle) it is the real part of a polynomial, which is that and its conjugate with 1 / z.
        """
        c = np.zeros(max(self.multiples) + 1, complex)
        for size, n, phase in zip(self.amplitudes, self.multiples, self.phases, strict=True):
            c[n] += size / 1j * np.exp(1j * phase) * (1j * n) ** order
        roots = np.roots([*c[:0:-1], 0.0, *c[1:].conj()])
        return np.asarray(np.angle(roots) / (2 * pi) * self.cycle)

    def after(self, cycles: ArrayLike) -> Samples:
        """The positions, rad or m, after numbers of cycles, whole or not, of any shape."""
        return self.at(np.asarray(cycles, np.float64) * self.cycle).position

    def at(self, time: ArrayLike) -> Driven:
        """What the drive asks for at instants of any shape, s."""
        return self._piece.at(time)
