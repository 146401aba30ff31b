"""Where the drive is to be, in arbitrary-precision balls: a second implementation of `scenes.drive` and of a request.

Nothing but the scene's own numbers is shared with that: a slip in what all other models ask for shows as an error. Of a
law by formula an acceleration is integrated there; here are printed formulas of the way, for a time that is a power
series: rates and accelerations are further coefficients.
"""

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import accumulate, pairwise
from math import gcd, lcm
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from flint import arb, arb_mat, arb_series, fmpq

from scenes import AtInputs, Request, Sampling
from scenes.laws import SAME_INSTANT_TOL
from scenes.scene import ConstantSpeed, DriveLaw, HarmonicLaw, MotionLaw, SegmentedLaw

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


Law: TypeAlias = Callable[[Fraction], Command]  # of a number of cycles, whole or not


def law_of(written: DriveLaw) -> Law:
    """Return the law of a drive, as its scene has it, at the precision that the caller has set."""
    match written:
        case ConstantSpeed():
            return _steady(written)
        case MotionLaw():
            return _spline(written)
        case SegmentedLaw():
            return _segments(written)
        case HarmonicLaw():
            return _sines(written)


def commands(written: DriveLaw, law: Law, request: Request) -> list[Command]:
    """Return the command at every sample of a request; positions alone are of a constant speed.

    Inputs are taken as they are, each double exact: nothing is computed of them.
    """
    if isinstance(request, Sampling):
        return [law(Fraction(k, request.samples)) for k in range(request.samples * request.turns + 1)]
    if isinstance(request, AtInputs):
        rows = np.transpose([request.given.time, *request.given.rows()]).tolist()
        return [Command(*map(arb, row)) for row in rows]
    assert isinstance(written, ConstantSpeed)
    return [_passing(written, arb(position)) for position in request.positions]


def _passing(written: ConstantSpeed, position: arb) -> Command:
    """Return the command as a drive of constant speed passes a position, rad or m."""
    return Command((position - written.start) / written.speed, position, arb(written.speed), arb(0))


def _steady(written: ConstantSpeed) -> Law:
    """Turn after turn, or once to an end."""
    turn = 2 * arb.pi() * (1 if written.speed > 0 else -1)
    advance = turn if written.end is None else arb(written.end) - written.start
    return lambda cycles: _passing(written, written.start + ball(cycles) * advance)


def _spline(written: MotionLaw) -> Law:
    """A cubic spline through a table.

    Over the step of h from y, M to z, N, with the shares a = 1 - b and b of the step before and behind the instant, the
    position is a y + b z + ((a^3 - a) M + (b^3 - b) N) h^2 / 6. Each period adds what the table gains.
    """
    times, positions = [*map(Fraction, written.times)], [*map(arb, written.positions)]
    steps = [ball(late - early) for early, late in pairwise(times)]
    chords = [(z - y) / h for (y, z), h in zip(pairwise(positions), steps, strict=True)]
    bends = second_derivatives(steps, chords, periodic=written.periodic)

    def at(cycles: Fraction) -> Command:
        periods, share = divmod(cycles, 1) if written.periodic else (0, cycles)
        time = share * times[-1]
        i = min(bisect_right(times, time), len(steps)) - 1
        # Exact rational times pick the piece, balls evaluate it: on a knot no rounding decides which of two pieces
        # holds.
        h, (y, z), (M, N) = steps[i], positions[i : i + 2], bends[i : i + 2]
        b = ball(time - times[i]) / h
        a = 1 - b
        A, B = a * a, b * b  # a ball around zero squared by ** is not a number
        bend = ((A * a - a) * M + (B * b - b) * N) * h * h / 6
        position = a * y + b * z + bend + periods * (positions[-1] - positions[0])
        rate = (z - y) / h + ((1 - 3 * A) * M + (3 * B - 1) * N) * h / 6
        return Command(ball(cycles * times[-1]), position, rate, a * M + b * N)

    return at


def _segments(written: SegmentedLaw) -> Law:
    """Segments in a row; on a boundary, or so near to one, the later segment's."""
    ends = [*accumulate(map(Fraction, written.durations), initial=Fraction(0))]
    positions = [
        *accumulate(written.ends, lambda here, end: here if end is None else arb(end), initial=arb(written.start))
    ]
    hair = Fraction(SAME_INSTANT_TOL) * ends[-1]

    def at(cycles: Fraction) -> Command:
        periods = (cycles + Fraction(SAME_INSTANT_TOL)) // 1 if written.periodic else 0
        time = (cycles - periods) * ends[-1]
        last = bisect_right(ends, time + hair) - 1
        i = min(last, len(written.laws) - 1)
        law, duration, (here, there) = written.laws[i], ends[i + 1] - ends[i], positions[i : i + 2]
        time = ends[last] if abs(time - ends[last]) <= hair else time
        start = here + periods * (positions[-1] - positions[0])
        way = _way(law, (time - ends[i]) / duration, ball(1 / duration)) if law else _series(arb(0), arb(0))
        return _command(cycles * ends[-1], start + (there - here) * way)

    return at


def _way(law: str, x: Fraction, pace: arb) -> arb_series:
    if 2 * x > 1:
        return 1 - _way(law, 1 - x, -pace)
    formula = next(formula for end, formula in FIRST_HALVES[law].items() if x <= end)
    return arb_series(formula(_series(ball(x), pace), arb.pi()))


def _sines(written: HarmonicLaw) -> Law:
    """A sum of sines, of frequencies as they are written."""
    frequencies = [Fraction(str(frequency)) for frequency in written.frequencies]
    period = Fraction(lcm(*(f.denominator for f in frequencies)), gcd(*(f.numerator for f in frequencies)))
    sines = [*zip(map(arb, written.amplitudes), frequencies, map(arb, written.phases), strict=True)]

    def at(cycles: Fraction) -> Command:
        time, position = cycles * period, _series(arb(written.middle), arb(0))
        for size, f, phase in sines:
            position += size * (2 * arb.pi() * _series(ball(f * time % 1), ball(f)) + phase).sin()
        return _command(time, position)

    return at


def _series(value: arb, rate: arb) -> arb_series:
    return arb_series([value, rate], prec=3)


def _command(time: Fraction, position: arb_series) -> Command:
    return Command(ball(time), position[0], position[1], 2 * position[2])


def ball(exact: Fraction) -> arb:
    """Return a number as a ball."""
    return arb(fmpq(exact.numerator, exact.denominator))


# The tridiagonal equations (1) are solved three times: with the given chords and zero ends, and with each end value
# one. Both conditions at the ends are then two linear equations for M_0 and M_n, whatever kind they are. Elimination
# needs no pivoting, as (1) is diagonally dominant.
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
