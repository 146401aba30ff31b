"""Where the drive is to be, in arbitrary-precision balls: a second implementation of `scenes.drive` and of a request.

Nothing but the scene's own numbers is shared with that: a slip in what all other models ask for shows as an error.
"""

from bisect import bisect_right
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import TypeAlias

from flint import arb, arb_mat

from scenes import Request, Sampling
from scenes.scene import ConstantSpeed, Drive, HarmonicLaw, MotionLaw, SegmentedLaw

from .laws import Command as Command
from .laws import SegmentsLaw, SinesLaw, ball


class SteadyLaw:
    """A constant speed, turn after turn or once to an end."""

    def __init__(self, drive: ConstantSpeed) -> None:
        self._start, self._speed = arb(drive.start), arb(drive.speed)
        turn = 2 * arb.pi() * (1 if drive.speed > 0 else -1)
        self._advance = turn if drive.end is None else arb(drive.end) - self._start

    def at(self, cycles: Fraction) -> Command:
        """Return the command after a number of cycles, whole or not."""
        return self.passing(self._start + ball(cycles) * self._advance)

    def passing(self, position: arb) -> Command:
        """Return the command as the drive passes a position, rad or m."""
        return Command((position - self._start) / self._speed, position, self._speed, arb(0))


class SplineLaw:
    """A cubic spline through a table."""

    def __init__(self, drive: MotionLaw) -> None:
        self._times = [Fraction(time) for time in drive.times]
        self._positions = [arb(position) for position in drive.positions]
        self._periodic = drive.periodic
        self._steps = [ball(late - early) for early, late in pairwise(self._times)]
        chords = [(z - y) / h for (y, z), h in zip(pairwise(self._positions), self._steps, strict=True)]
        self._bends = second_derivatives(self._steps, chords, periodic=drive.periodic)

    def at(self, cycles: Fraction) -> Command:
        """Return the command after a number of cycles, from the cubic over the step of h from y, M to z, N.

        With the shares a = 1 - b and b of the step before and behind the instant, the position is
        a y + b z + ((a^3 - a) M + (b^3 - b) N) h^2 / 6. Each period adds what the table gains.
        """
        periods, share = divmod(cycles, 1) if self._periodic else (0, cycles)
        time = share * self._times[-1]
        i = min(bisect_right(self._times, time), len(self._steps)) - 1
        h, (y, z), (M, N) = self._steps[i], self._positions[i : i + 2], self._bends[i : i + 2]
        b = ball(time - self._times[i]) / h
        a = 1 - b
        bend = ((a**3 - a) * M + (b**3 - b) * N) * h**2 / 6
        position = a * y + b * z + bend + periods * (self._positions[-1] - self._positions[0])
        rate = (z - y) / h + ((1 - 3 * a**2) * M + (3 * b**2 - 1) * N) * h / 6
        return Command(ball(cycles * self._times[-1]), position, rate, a * M + b * N)


Law: TypeAlias = SteadyLaw | SplineLaw | SegmentsLaw | SinesLaw


def law_of(drive: Drive) -> Law:
    """Return a scene's drive at the precision that the caller has set."""
    match drive:
        case ConstantSpeed():
            return SteadyLaw(drive)
        case MotionLaw():
            return SplineLaw(drive)
        case SegmentedLaw():
            return SegmentsLaw(drive)
        case HarmonicLaw():
            return SinesLaw(drive)


def commands(law: Law, request: Request) -> list[Command]:
    """Return the command at every sample of a request; positions alone are of a constant speed."""
    if isinstance(request, Sampling):
        return [law.at(Fraction(k, request.samples)) for k in range(request.samples * request.turns + 1)]
    assert isinstance(law, SteadyLaw)
    return [law.passing(arb(position)) for position in request.positions]


def second_derivatives(h: Sequence[arb], chords: Sequence[arb], *, periodic: bool) -> list[arb]:
    """Return the second derivatives M_0 ... M_n of a cubic spline at its knots.

    Where a knot is inside, the first derivative is continuous:

        h_{i-1} M_{i-1} + 2 (h_{i-1} + h_i) M_i + h_i M_{i+1} = 6 (c_i - c_{i-1})        (1)

    That leaves M_0 and M_n, in which all others are linear, for two conditions at the ends: in a periodic spline (1)
    holds across them too; the others are not-a-knot, with three or more of the steps h, s, between the knots.
    """
    none = [arb(0)] * len(h)
    ends = _across if periodic else _not_a_knot
    M, A, B = _inside(h, chords, 0, 0), _inside(h, none, 1, 0), _inside(h, none, 0, 1)
    (m, k), (a, c), (b, d) = ends(h, chords, M), ends(h, none, A), ends(h, none, B)
    first, last = arb_mat(2, 2, [a, b, c, d]).solve(arb_mat(2, 1, [-m, -k])).entries()
    return [x + first * y + last * z for x, y, z in zip(M, A, B, strict=True)]


def _inside(h: Sequence[arb], chords: Sequence[arb], first: int, last: int) -> list[arb]:
    """Return M of (1) with given values at the ends, by elimination: M_i = p_i - q_i M_{i+1}."""
    p, q = [arb(first)], [arb(0)]
    for (g, k), (c, d) in zip(pairwise(h), pairwise(chords), strict=True):
        pivot = 2 * (g + k) - g * q[-1]
        p.append((6 * (d - c) - g * p[-1]) / pivot)
        q.append(k / pivot)
    M = [arb(last)]
    for i in reversed(range(len(p))):
        M.append(p[i] - q[i] * M[-1])
    return M[::-1]


def _across(h: Sequence[arb], chords: Sequence[arb], M: Sequence[arb]) -> tuple[arb, arb]:
    """Return the jump of M at the ends of a periodic spline, and by how much (1) is open there; both have to vanish."""
    bend = h[-1] * (M[-2] + 2 * M[-1]) + h[0] * (2 * M[0] + M[1])
    return M[-1] - M[0], bend - 6 * (chords[0] - chords[-1])


def _not_a_knot(h: Sequence[arb], _chords: Sequence[arb], M: Sequence[arb]) -> tuple[arb, arb]:
    """Return the jumps of the third derivative at the second knot and the last but one, which are none."""
    third = [(late - early) / step for (early, late), step in zip(pairwise(M), h, strict=True)]
    return third[1] - third[0], third[-1] - third[-2]
