"""Friction of pins and guides in balls: the multipliers' own part in the equations that they solve.

The rates do not depend on the forces, so the sense s of each friction is known. With c the arm of a pin's friction
circle, or a guide's coefficient, and g what presses the joint's surfaces together, N, its moment or force is

    t = -c s g - v rate,    g = Σ |P λ|    over the resultant of a pin, or the two ends of a guide's contact      (1)

and λ = λ0 - Y t, Y being the multipliers that balance a unit of each: as many equations as there are frictions, for g.
"""

from collections.abc import Sequence
from typing import NamedTuple

from flint import arb, arb_mat

from scenes import Failure, Status
from scenes.elements.friction import AT_REST, Friction

from .constraints import LinkageEquations
from .contacts import CONTACTS
from .rows import angles, column, part, solved

MAX_GROWTH = 0.5  # largest change of any g in one step of the factor on all coefficients, of the largest g
MIN_STEP = 1e-12  # of that factor, so near to one where forces grow without bound, or where two solutions meet
MAX_ITERATIONS = 30  # of Newton's; each end of a contact that lifts off takes one more
CORRECTION_TOL = 1e-25  # of the largest g, a last correction; what it leaves is about its square
ANY_DIRECTION = arb(0, 1)


class JointResistance:
    """One joint's friction: its `work` for a unit of it, and the P of (1) for the two multipliers of its `rows`."""

    def __init__(self, linkage: LinkageEquations, friction: Friction) -> None:
        self.mu, self.viscous, self.smooth = arb(friction.coefficient), arb(friction.viscous or 0), friction.smooth
        joint, self.work, self.presses, self.radius = CONTACTS[type(friction)](friction, linkage)
        self.rows = 2 * joint, 2 * joint + 1

    def coefficient(self, factor: float) -> arb:
        """Return c with a factor on mu: r sin φ with tan φ = mu, or mu."""
        mu = self.mu * factor
        return mu if self.radius is None else self.radius * mu / (1 + mu * mu).sqrt()

    def sense(self, rate: arb, turning: arb, moving: arb) -> arb:
        """Return s; `turning` and `moving` are the largest rates of all bodies, and of all points."""
        if self.smooth is not None:
            return (rate / self.smooth).tanh()
        return rate.sgn() if abs(rate) > AT_REST * (moving if self.radius is None else turning) else arb(0)


def resisted(
    linkage: LinkageEquations,
    frictions: Sequence[JointResistance],
    q: arb_mat,
    velocity: arb_mat,
    frictionless: arb_mat,
) -> arb_mat:
    """Return the multipliers, from those without friction, then all t and their power; Failure as of `Pressed`."""
    # Virtual work: the Jacobian of a friction's work is both its generalised force per unit and, times the velocity,
    # its slip.
    works = [friction.work.jacobian(q) for friction in frictions]
    rates = [(work * velocity)[0, 0] for work in works]
    speeds = (linkage.points.jacobian(q) * velocity).entries()
    moving = max((x * x + y * y).nonnegative_part().sqrt() for x, y in zip(speeds[::2], speeds[1::2], strict=True))
    turning = max(map(abs, angles(velocity)))
    units = arb_mat([work.entries() for work in works]).transpose()
    Y = solved(linkage.transposed_groups, linkage.constraints.jacobian(q).transpose(), units)
    viscous = [friction.viscous * rate for friction, rate in zip(frictions, rates, strict=True)]
    given = frictionless + Y * column(viscous)
    senses = [
        (friction, friction.sense(rate, turning, moving)) for friction, rate in zip(frictions, rates, strict=True)
    ]
    parts = [(i, P, friction.rows) for i, friction in enumerate(frictions) for P in friction.presses]
    every = range(len(frictions))
    terms = [(i, P * part(given, rows, [0]), P * part(Y, rows, every)) for i, P, rows in parts]
    pressed = Pressed(linkage.scene.where(float(linkage.position.value(q)[0, 0])), senses, terms)
    dry = [c * g for c, g in zip(pressed.factors(1.0), pressed.enclosed(pressed.followed()), strict=True)]
    t = [-x - v for x, v in zip(dry, viscous, strict=True)]
    power = sum((x * rate for x, rate in zip(t, rates, strict=True)), arb(0))
    return column([*(given + Y * column(dry)).entries(), *t, power])


class Pressed(NamedTuple):
    """The equations (1) of one sample for g: g = Σ |a + B c s g| over its terms (friction, a, B).

    Failure: `jammed`, where g without friction does not go on to g with all of it; `not_converged`, not proven.
    """

    place: str  # of the drive
    senses: Sequence[tuple[JointResistance, arb]]
    terms: Sequence[tuple[int, arb_mat, arb_mat]]

    def factors(self, factor: float) -> list[arb]:
        """Return all c s, with a factor on all coefficients."""
        return [friction.coefficient(factor) * s for friction, s in self.senses]

    def followed(self) -> Sequence[arb]:
        """Return g about, followed over the factor from 0 to 1."""
        factor, step = 0.0, 1.0
        g = self._newton(0.0, [arb(0)] * len(self.senses)) or []
        while factor < 1:
            trial = min(factor + step, 1.0)
            found = self._newton(trial, g)
            if found and max(abs(x - y) for x, y in zip(found, g, strict=True)) <= MAX_GROWTH * max(g):
                factor, step, g = trial, 2 * step, found
            elif step > MIN_STEP:
                step /= 2
            else:
                reason = f"friction holds the linkage at {self.place}, from {factor:.6g} of its coefficients on"
                raise Failure(Status.jammed, reason)
        return g

    def enclosed(self, g: Sequence[arb]) -> Sequence[arb]:
        """Return balls that hold one solution: Newton's method for intervals takes their neighbourhood into itself."""
        try:
            open_by, slopes = self._equations(1.0, g)
            # Interval Newton: a box twice the size of a Newton correction about g. If the image of the box lies in it,
            # exactly one solution is there.
            radius = 2 * max(x.abs_upper() for x in slopes.solve(open_by).entries()) + CORRECTION_TOL * max(g)
            domain = [x + radius * arb(0, 1) for x in g]
            change = self._equations(1.0, domain)[1].solve(open_by).entries()
            found = [x - dx for x, dx in zip(g, change, strict=True)]
            if all(x.contains(y) for x, y in zip(domain, found, strict=True)):
                return found
        except ZeroDivisionError:
            pass  # it is not proven that the slopes are regular
        raise Failure(Status.not_converged, f"the digits do not prove the friction's forces at {self.place}")

    def _newton(self, factor: float, g: Sequence[arb]) -> Sequence[arb] | None:
        """Return g where Newton's method converges, on the side of where two solutions meet that it starts from."""
        for _ in range(MAX_ITERATIONS):
            open_by, slopes = self._equations(factor, g)
            try:
                change = slopes.mid().solve(open_by.mid()).entries()
            except ZeroDivisionError:
                return None
            g = [(x - dx).mid() for x, dx in zip(g, change, strict=True)]
            if max(map(abs, change)) <= CORRECTION_TOL * max(g):
                return g if slopes.mid().det() > 0 else None
        return None

    def _equations(self, factor: float, g: Sequence[arb]) -> tuple[arb_mat, arb_mat]:
        """Return g - Σ |a + B c s g| and its slopes; where the balls hold a kink, all of those there."""
        every, cs = range(len(g)), self.factors(factor)
        open_by, slopes = column(g), arb_mat([[int(i == j) for j in every] for i in every])
        acting = column([c * x for c, x in zip(cs, g, strict=True)])
        for i, a, B in self.terms:
            # |force| has no derivative at zero. A ball that holds zero gets the slopes of all directions, which the
            # proof then covers.
            force = a + B * acting
            size = (force.transpose() * force)[0, 0].nonnegative_part().sqrt()
            normal = [x / size if size > 0 else ANY_DIRECTION for x in force.entries()]
            open_by[i, 0] -= size
            for j, slope in zip(every, (arb_mat([normal]) * B).entries(), strict=True):
                slopes[i, j] -= slope * cs[j]
        return open_by, slopes
