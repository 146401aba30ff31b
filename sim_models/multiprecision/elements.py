"""The generalised force Q = J^T F of each type of element, J of the work of a unit force, F the force, all in balls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from math import ceil, floor, pi, tau
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from scenes import Failure, Status
from scenes.elements.constant_force_springs import ConstantForceSpring
from scenes.elements.element import Element
from scenes.elements.loads import (
    Force,
    ForceTable,
    GuideForce,
    Load,
    Moment,
    PressForce,
    TabledLoad,
    TableForce,
    TurningForce,
)
from scenes.elements.springs import Damper, PointPair, Spring, TorsionSpring

if TYPE_CHECKING:  # which kinds there are rules for is asked without python-flint too
    from flint import acb, arb, arb_mat

    from .constraints import LinkageEquations
    from .rows import EquationRows

GeneralisedForce: TypeAlias = "Callable[[arb_mat, arb_mat, arb], arb_mat]"  # of q, its rate, (3 bodies, 1); time, s
UnitForce: TypeAlias = "Callable[[arb_mat], arb_mat]"  # Q of 1 N or 1 N m, of q
Size: TypeAlias = "Callable[[arb_mat, arb_mat, arb], arb]"  # N or N m, of the same as Q

HALF_TURN = pi + 1e-9  # rad: half a turn is that, whichever way the scene's numbers were rounded


class Assembled(NamedTuple):
    """A linkage that forces act on."""

    linkage: LinkageEquations
    ends: Mapping[str, float]  # of the press forces' strokes, by place in the file, m
    start: arb_mat  # the pose at time zero

    def at_point(self, load: Load, force: acb) -> UnitForce:
        """A force at the point of a load, in the frame of the ground."""
        work = self.linkage.rows(1)
        self.linkage.add_point(work, 0, force, load.body, load.at)
        return by_work(work)

    def turning(self, load: Load, force: acb) -> UnitForce:
        """A force F in its body's frame, at the arm s: e^{iθ} F, and the moment s × F, which does not change."""
        from flint import acb, arb_mat

        linkage = self.linkage
        i, moment = 3 * linkage.index[load.body], (linkage.arms[load.body][load.at].conjugate() * force).imag

        def unit(q: arb_mat) -> arb_mat:
            Q, turned = arb_mat(q.nrows(), 1), force * acb(0, q[i + 2, 0]).exp()
            Q[i, 0], Q[i + 1, 0], Q[i + 2, 0] = turned.real, turned.imag, moment
            return Q

        return unit

    def size(self, load: TabledLoad, constant: float | None = None) -> Size:
        """The size of a load that is constant or by a table."""
        from flint import arb

        if (table := load.table) is None:
            value_given = arb(constant)
            return lambda _q, _velocity, _time: value_given
        value = straight_lines(table.arguments, table.values, periodic=table.periodic)
        if table.over == "time":
            return lambda _q, _velocity, time: value(time)
        argument = self.linkage.position if table.over == "drive" else self.linkage.displacement(load.body)
        return lambda q, _velocity, _time: value(argument.value(q)[0, 0])


def by_work(work: EquationRows) -> UnitForce:
    """What does a work for every N or N m of its size: its derivative."""
    return lambda q: work.jacobian(q).transpose()


def _scaled(unit: UnitForce, size: Size) -> GeneralisedForce:
    return lambda q, velocity, time: unit(q) * size(q, velocity, time)


def _one(_q: arb_mat, _velocity: arb_mat, _time: arb) -> arb:
    from flint import arb

    return arb(1)


def _force(load: Force, _: str, to: Assembled) -> GeneralisedForce:
    from flint import acb

    return _scaled(to.at_point(load, acb(*load.force)), _one)


def _turning_force(load: TurningForce, _: str, to: Assembled) -> GeneralisedForce:
    from flint import acb

    return _scaled(to.turning(load, acb(*load.force)), _one)


def _press(load: PressForce, place: str, to: Assembled) -> GeneralisedForce:
    """Where the balls prove that the slider closes, in the last part of its stroke; neither is proven on the switch."""
    from flint import acb, arb

    from .start import closing_sign

    displacement, end = to.linkage.displacement(load.body), to.ends[place]
    closing = closing_sign(to.linkage.scene, load)

    def acts(q: arb_mat, velocity: arb_mat, _time: arb) -> arb:
        rate, left = (displacement.jacobian(q) * velocity)[0, 0], closing * (end - displacement.value(q)[0, 0])
        return arb(int(closing * rate > 0 and left <= load.last))

    return _scaled(to.at_point(load, acb(*load.force)), acts)


def _guide_force(load: GuideForce, _: str, to: Assembled) -> GeneralisedForce:
    """On what moves along the guide, against what has it."""
    return _scaled(by_work(to.linkage.displacement(load.body, load.at)), to.size(load, load.force))


def _by_table(load: TableForce, _: str, to: Assembled) -> GeneralisedForce:
    from flint import acb

    along = acb(*load.along)
    along = along / abs(along)
    unit = to.turning(load, along) if load.frame == "body" else to.at_point(load, along)
    return _scaled(unit, to.size(load))


def _moment(load: Moment, _: str, to: Assembled) -> GeneralisedForce:
    from flint import arb

    work = to.linkage.rows(1)
    work.add_angle(0, to.linkage.index[load.body], arb(1))
    return _scaled(by_work(work), to.size(load, load.moment))


def _spring(spring: Spring, _: str, to: Assembled) -> GeneralisedForce:
    """The pull along d from its first point to its second: -(k (1 - l / |d|) + c d·d' / d^2) d on the second."""
    from flint import arb

    way = Way(to.linkage, spring)

    def force(q: arb_mat, velocity: arb_mat, _time: arb) -> arb_mat:
        d, J, pull = way.rows.value(q), way.rows.jacobian(q), arb(spring.stiffness)
        if spring.needs_direction:
            distance = way.distance(q, d)
            pull -= pull * spring.length / distance
            pull += arb(spring.damping or 0) * (d.transpose() * J * velocity)[0, 0] / (distance * distance)
        return J.transpose() * d * -pull

    return force


class Way:
    """The way d from the first of two points to the second."""

    def __init__(self, linkage: LinkageEquations, pair: PointPair) -> None:
        self.linkage, self.pair, self.rows = linkage, pair, linkage.rows(2)
        linkage.add_way(self.rows, 0, *pair.ends)

    def distance(self, q: arb_mat, d: arb_mat) -> arb:
        """The length of d, m, in a pose q; Failure where the balls do not prove that there is one."""
        from flint import acb

        distance = abs(acb(d[0, 0], d[1, 0]))  # a ball around zero squared by ** is not a number
        if not distance > 0:
            ends = " and ".join(map(".".join, self.pair.ends))
            place = self.linkage.scene.where(float(self.linkage.position.value(q)[0, 0]))
            reason = f"the {self.pair.noun}'s ends {ends} meet at {place}: it has no direction"
            raise Failure(Status.nonfinite, reason)
        return distance


def _torsion_spring(spring: TorsionSpring, _: str, to: Assembled) -> GeneralisedForce:
    """The moment -k (phi - angle) - c phi' on the second body, and its reaction on the first.

    The angles of q go on over whole turns, as phi does. It begins with as many as leave it in (-π, π], but for the
    drive's own angle.
    """
    from flint import arb

    linkage, row = to.linkage, to.linkage.rows(1)
    linkage.add_angle(row, 0, spring.second, spring.first)
    driven = row.C in (linkage.position.C, linkage.position.C * -1)
    turns = 0 if driven else ceil((float(row.value(to.start)[0, 0]) - HALF_TURN) / tau)
    free = spring.angle + 2 * arb.pi() * turns

    def moment(q: arb_mat, velocity: arb_mat, _time: arb) -> arb_mat:
        rate = (row.C * velocity)[0, 0]
        size = -spring.stiffness * (row.value(q)[0, 0] - free) - (spring.damping or 0) * rate
        return row.C.transpose() * size

    return moment


def _constant_force_spring(spring: ConstantForceSpring, _: str, to: Assembled) -> GeneralisedForce:
    """The pull f d / |d| on the first point, d being the way to the second, and its reaction there."""
    way = Way(to.linkage, spring)

    def force(q: arb_mat, _velocity: arb_mat, _time: arb) -> arb_mat:
        d = way.rows.value(q)
        return way.rows.jacobian(q).transpose() * d * (-spring.force / way.distance(q, d))

    return force


RULES: Mapping[type[Element], Callable[[Any, str, Assembled], GeneralisedForce]] = {
    Force: _force,
    TurningForce: _turning_force,
    PressForce: _press,
    GuideForce: _guide_force,
    ForceTable: _guide_force,
    TableForce: _by_table,
    Moment: _moment,
    Spring: _spring,
    Damper: _spring,
    TorsionSpring: _torsion_spring,
    ConstantForceSpring: _constant_force_spring,
}


def straight_lines(arguments: Sequence[float], values: Sequence[float], *, periodic: bool) -> Callable[[arb], arb]:
    """Return f(x) = f_0 + Σ Δ_i max(x - x_i, 0), Δ_i the change of slope at entry i: constant beyond, or periodic."""
    from flint import arb

    x, f = [*map(arb, arguments)], [*map(arb, values)]
    first, period = x[0], x[-1] - x[0]
    if periodic:  # a line more to either side, since a ball may reach over the seam
        x, f = [x[-2] - period, *x, x[1] + period], [f[-2], *f, f[1]]
    # A piecewise linear function as a sum of kinks instead of a search for the piece: a ball that holds a knot is in
    # two pieces at once, and the sum encloses the values of both.
    slopes = [arb(0), *((g - e) / (v - u) for (u, v), (e, g) in zip(pairwise(x), pairwise(f), strict=True)), arb(0)]
    kinks = [(kink, after - before) for kink, (before, after) in zip(x, pairwise(slopes), strict=True)]

    def value(argument: arb) -> arb:
        if periodic:
            argument -= period * floor(float((argument - first) / period))
        return f[0] + sum((change * (argument - kink).nonnegative_part() for kink, change in kinks), arb(0))

    return value
