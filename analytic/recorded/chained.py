"""Dyads of two bars in a row as one system of equations, for an arithmetic of bounds.

Where dyad hangs on dyad and each is bounded by bounds of the one before, bounds grow by a factor from one to the next,
as the pin's x and y are taken to be off independently of each other. Here all inner pins P of RRR dyads are the
unknowns of one system,

    |P - A|^2 = r1^2,    |P - B|^2 = r2^2    of each dyad with the outer pins A and B,                              (1)

whose Jacobian has to do with all of them at once: what one equation is open by moves the last pin by as much as in
truth. Rates follow by the implicit function theorem, from linear equations with the same Jacobian, and the forces R at
the inner pins from those of virtual work,

    R . g1 = -Q1,    R . g2 = Q2    of each dyad (`core.dyads.inner_force`),                                        (2)

where Q1 and Q2 hold the forces at the pins of what hangs on its bars. Dyads of other kinds stay in closed form, of what
they hang on. It fails, with bounds that are not known, where (1) is singular or its box too wide.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from scenes import Scene
from scenes.drive import Samples

from ..core.decomposition import InnerPin, Linkage, Pinned, members
from ..core.dyads import Vectors, cross, dot
from ..core.groups.group_equations import Group
from ..core.kinematics import Pass
from ..core.numbers import Number, samples
from ..core.placing import Kinematics, Spin
from .balances import BoundedBalance
from .expressions import Closing, Expression, Recorder, forward, jacobian
from .traced import Traced, traced


def two_bars(linkage: Linkage) -> list[InnerPin]:
    """The dyads of two bars, in solving order."""
    pins = (group for group in linkage.groups if isinstance(group, InnerPin))
    return [dyad for dyad in pins if all(isinstance(leg, Pinned) for leg in dyad.legs)]


def depth(linkage: Linkage) -> int:
    """How many groups hang on each other, one on the other, at most."""
    carrier = {point: body for body, points in linkage.carries.items() for point in points}
    deep: dict[str | None, int] = {}
    below: list[str | None]
    for group in linkage.groups:
        if isinstance(group, Group):
            below = [carrier.get(name.removeprefix("."), name) for name in group.hangs_on]
        else:
            below = [carrier.get(leg.A) if isinstance(leg, Pinned) else leg.on for leg in group.legs]
        deep |= dict.fromkeys(members(group), 1 + max((deep.get(body, 0) for body in below), default=0))
    return max(deep.values(), default=0)


class ChainedPass(Pass):
    """Places everything as expressions, with inner pins of dyads of two bars where they are known to be."""

    def __init__(
        self, scene: Scene, linkage: Linkage, driven: Any, pins: Sequence[Sequence[Expression]], make: Recorder
    ) -> None:
        """Take positions, and with more of them rates and accelerations, x and y of pin after pin."""
        super().__init__(scene, linkage, driven, rates=len(pins) > 1)
        values: Any = [
            [Traced(make, *xy) for xy in zip(coordinates[::2], coordinates[1::2], strict=True)] for coordinates in pins
        ]
        self.pins = dict(zip((dyad.P for dyad in two_bars(linkage)), zip(*values, strict=True), strict=True))
        self.open: list[Expression] = []  # the left sides of (1) less the right ones

    def arms(
        self,
        dyad: InnerPin,
        d: Vectors,  # noqa: ARG002 - as of `Pass.arms`
        distance: Samples,  # noqa: ARG002
        r1: Number,
        r2: Number,
    ) -> tuple[Vectors, Vectors, Samples]:
        """Return the arms to a known pin, which is on the dyad's branch where p x q has its sign."""
        k, (first, second) = self.k, [leg for leg in dyad.legs if isinstance(leg, Pinned)]
        place = k.z[dyad.P] = self.pins[dyad.P][0]
        p, q = place - k.z[first.A], place - k.z[second.A]
        area = cross(p, q)
        self.open += [(dot(arm, arm) - r * r).x for arm, r in ((p, r1), (q, r2))]
        k.reach[f"{dyad.P} (on its branch)"] = area * dyad.branch
        return p, q, area

    def spins(self, P: str, bar_1: tuple[Pinned, Vectors], bar_2: tuple[Pinned, Vectors]) -> tuple[Spin, Spin]:
        """Return how two bars turn, given how their inner pin moves."""
        k = self.k
        _, k.v[P], k.a[P] = self.pins[P]

        def spin(leg: Pinned, arm: Vectors) -> Spin:
            square, v, a = dot(arm, arm), samples(k.v[P] - self.foot_v(leg, arm)), k.a[P]
            omega = cross(arm, v) / square
            return omega, cross(arm, samples(a - self.foot_a(leg, arm, omega))) / square

        return spin(*bar_1), spin(*bar_2)


def chained(
    make: Recorder, scene: Scene, linkage: Linkage, driven: Any, by_time: Mapping[Expression, Expression]
) -> Kinematics:
    """Place everything, with all dyads of two bars as one system."""
    names = [f"{dyad.P}.{xy}" for dyad in two_bars(linkage) for xy in "xy"]

    def placed(*pins: Sequence[Expression]) -> ChainedPass:
        way = ChainedPass(scene, linkage, driven, pins, make)
        way.solve()
        return way

    def constraints(q: Sequence[Expression]) -> tuple[list[Expression], list[Expression]]:
        rows = placed(q).open
        return rows, jacobian(make, rows, q)

    # The closed forms give the start in the middles of boxes; their bounds would grow, their values do not.
    roughly: Any = Pass(scene, linkage, driven, rates=False).solve().k.z
    start = [part for dyad in two_bars(linkage) for part in (roughly[dyad.P].x, roughly[dyad.P].y)]
    sought = [make.input(f"{name} sought", sampled=True) for name in names]
    closing = Closing(sought, *constraints(sought), start=start)
    closed = make.closed(closing, [*closing.begun, *closing.outer])
    q = [make.component(closed, i) for i in range(len(names))]
    closing.at_zero = constraints(q)
    dq = forward(make, q, by_time)
    return placed(q, dq, forward(make, dq, by_time)).k


@dataclass(frozen=True)
class ChainedBalance(BoundedBalance):
    """Balances everything as expressions, with known forces at the inner pins of dyads of two bars."""

    pulls: Mapping[str, Any] = field(default_factory=dict)
    open: list[Any] = field(default_factory=list)  # the left sides of (2) less the right ones

    def pull(self, dyad: InnerPin, Q1: Samples, Q2: Samples) -> Vectors:
        """Return the force at an inner pin."""
        if dyad.P not in self.pulls:
            return super().pull(dyad, Q1, Q2)
        g1, g2, _ = self.k.closure[dyad.P]
        R: Vectors = self.pulls[dyad.P]
        self.open.extend((dot(R, g1) + Q1, dot(R, g2) - Q2))
        return R


def balanced(make: Recorder, scene: Scene, linkage: Linkage, given: Any, k: Kinematics) -> BoundedBalance:
    """The balance of all, with the forces at the inner pins of dyads of two bars from one system.

    Friction is found group by group, from the forces of those that are balanced before.
    """
    pins, zero = [dyad.P for dyad in two_bars(linkage)], make.constant(0.0)

    def solved(R: Sequence[Expression]) -> ChainedBalance:
        forces = (Traced(make, *xy) for xy in zip(R[::2], R[1::2], strict=True))
        balance = ChainedBalance(scene, linkage, given, k, pulls=dict(zip(pins, forces, strict=True)))
        balance.solve()
        return balance

    sought = [make.input(f"{P}.force.{xy} sought", sampled=True) for P in pins for xy in "xy"]
    # The rows are affine in the forces sought: their derivatives are the matrix, their values at zero the right side.
    # Solving once and passing once more through the balance gives all reactions.
    A = jacobian(make, [traced(make, row).x for row in solved(sought).open], sought)
    b = [make("negative", traced(make, row).x) for row in solved([zero] * len(sought)).open]
    system = make.system(A, b)
    return solved([make.component(system, i) for i in range(len(sought))])
