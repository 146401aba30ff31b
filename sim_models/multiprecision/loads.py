"""The loads of a scene as generalised forces Q = J^T F: J of the work of a unit force, F the force, all in balls."""

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from math import ceil, floor, pi, tau
from typing import TypeAlias

from flint import acb, arb, arb_mat

from scenes import Failure, Status
from scenes.scene import GuideForce, Load, Moment, PressForce, Spring, TableForce, TorsionSpring

from .constraints import LinkageEquations
from .rows import EquationRows
from .start import closing_sign

GeneralisedForce: TypeAlias = Callable[[arb_mat, arb_mat, arb], arb_mat]  # of q, its rate, both (3 bodies, 1); time, s
UnitForce: TypeAlias = Callable[[arb_mat], arb_mat]  # Q of 1 N or 1 N m, of q
Size: TypeAlias = Callable[[arb_mat, arb_mat, arb], arb]  # N or N m, of the same

HALF_TURN = pi + 1e-9  # rad: half a turn is that, whichever way the scene's numbers were rounded


def generalised_force(linkage: LinkageEquations, ends: Mapping[PressForce, float], start: arb_mat) -> GeneralisedForce:
    """Return Q of all loads, springs and the weight; `ends` are those of the press forces' strokes, m.

    `start` is the pose at time zero. Q raises a Failure where the ends of a spring meet, so that it has no direction.
    """
    scene = linkage.scene
    weight = EquationRows(1, len(linkage.index))  # Σ m g·r, its work
    loads = [(_unit_force(linkage, load), _size(linkage, load, ends)) for load in scene.loads]
    springs = [_spring(linkage, spring) for spring in scene.springs]
    springs += [_torsion_spring(linkage, spring, start) for spring in scene.torsion_springs]
    if scene.gravity is not None:
        for i in linkage.index.values():
            weight.add_point(0, linkage.mass[3 * i] * acb(*scene.gravity), i, acb(0))

    def total(q: arb_mat, velocity: arb_mat, time: arb) -> arb_mat:
        Q = weight.jacobian(q).transpose()
        for unit, size in loads:
            Q = Q + unit(q) * size(q, velocity, time)
        for spring in springs:
            Q = Q + spring(q, velocity, time)
        return Q

    return total


def _pressing(linkage: LinkageEquations, load: PressForce, end: float) -> Size:
    """Return 1 where the balls prove that the slider closes, in the last part of its stroke, else 0."""
    displacement, closing = linkage.displacement(load.body), closing_sign(linkage.scene, load)

    def acts(q: arb_mat, velocity: arb_mat, _time: arb) -> arb:
        rate, left = (displacement.jacobian(q) * velocity)[0, 0], closing * (end - displacement.value(q)[0, 0])
        return arb(int(closing * rate > 0 and left <= load.last))  # neither is proven on the switch

    return acts


def _unit_force(linkage: LinkageEquations, load: Load) -> UnitForce:
    """Return what a load does for every N or N m of its size: the derivative of its work, a row of equations."""
    work = EquationRows(1, len(linkage.index))
    if isinstance(load, Moment):
        work.add_angle(0, linkage.index[load.body], arb(1))
    elif isinstance(load, GuideForce):  # what moves along the guide against what has it
        work = linkage.displacement(load.body, load.at)
    else:
        force = acb(*(load.along if isinstance(load, TableForce) else load.force))
        force = force / abs(force) if isinstance(load, TableForce) else force
        if not isinstance(load, PressForce) and load.frame == "body":
            return _turning(linkage, load, force)
        linkage.add_point(work, 0, force, load.body, load.at)
    return lambda q: work.jacobian(q).transpose()


def _turning(linkage: LinkageEquations, load: Load, force: acb) -> UnitForce:
    """Return a force F in its body's frame, at the arm s: e^{iθ} F, and the moment s × F, which does not change."""
    i, moment = 3 * linkage.index[load.body], (linkage.arms[load.body][load.at].conjugate() * force).imag

    def of(q: arb_mat) -> arb_mat:
        Q, turned = arb_mat(q.nrows(), 1), force * acb(0, q[i + 2, 0]).exp()
        Q[i, 0], Q[i + 1, 0], Q[i + 2, 0] = turned.real, turned.imag, moment
        return Q

    return of


def _size(linkage: LinkageEquations, load: Load, ends: Mapping[PressForce, float]) -> Size:
    if isinstance(load, PressForce):
        return _pressing(linkage, load, ends[load])
    if (table := load.table) is None:
        size = arb(load.moment if isinstance(load, Moment) else load.force if isinstance(load, GuideForce) else 1)
        return lambda _q, _velocity, _time: size
    value = straight_lines(table.arguments, table.values, periodic=table.periodic)
    if table.over == "time":
        return lambda _q, _velocity, time: value(time)
    argument = linkage.position if table.over == "drive" else linkage.displacement(load.body)
    return lambda q, _velocity, _time: value(argument.value(q)[0, 0])


def straight_lines(arguments: Sequence[float], values: Sequence[float], *, periodic: bool) -> Callable[[arb], arb]:
    """Return f(x) = f_0 + Σ Δ_i max(x - x_i, 0), Δ_i the change of slope at entry i: constant beyond, or periodic."""
    x, f = [*map(arb, arguments)], [*map(arb, values)]
    first, period = x[0], x[-1] - x[0]
    if periodic:  # a line more to either side, since a ball may reach over the seam
        x, f = [x[-2] - period, *x, x[1] + period], [f[-2], *f, f[1]]
    slopes = [arb(0), *((g - e) / (v - u) for (u, v), (e, g) in zip(pairwise(x), pairwise(f), strict=True)), arb(0)]
    kinks = [(at, after - before) for at, (before, after) in zip(x, pairwise(slopes), strict=True)]

    def value(argument: arb) -> arb:
        if periodic:
            argument -= period * floor(float((argument - first) / period))
        return f[0] + sum((change * (argument - at).nonnegative_part() for at, change in kinks), arb(0))

    return value


def _spring(linkage: LinkageEquations, spring: Spring) -> GeneralisedForce:
    """Return the pull along d from its first point to its second: -(k (1 - l / |d|) + c d·d' / d^2) d on the second."""
    rows = EquationRows(2, len(linkage.index))
    linkage.add_way(rows, 0, spring.first, spring.second)

    def force(q: arb_mat, velocity: arb_mat, _time: arb) -> arb_mat:
        d, J, pull = rows.value(q), rows.jacobian(q), arb(spring.stiffness)
        if spring.needs_direction:
            distance = abs(acb(d[0, 0], d[1, 0]))  # a ball around zero squared by ** is not a number
            if not distance > 0:
                first, second = ".".join(spring.first), ".".join(spring.second)
                place = linkage.scene.where(float(linkage.position.value(q)[0, 0]))
                reason = f"the spring's ends {first} and {second} meet at {place}: it has no direction"
                raise Failure(Status.nonfinite, reason)
            pull -= pull * spring.length / distance
            pull += arb(spring.damping or 0) * (d.transpose() * J * velocity)[0, 0] / (distance * distance)
        return J.transpose() * d * -pull

    return force


def _torsion_spring(linkage: LinkageEquations, spring: TorsionSpring, start: arb_mat) -> GeneralisedForce:
    """Return the moment -k (phi - angle) - c phi' on the second body, and its reaction on the first.

    The angles of q go on over whole turns, as phi does. It begins with as many as leave it in (-π, π], but for the
    drive's own angle.
    """
    row = EquationRows(1, len(linkage.index))
    linkage.add_angle(row, 0, spring.second, spring.first)
    driven = row.C in (linkage.position.C, linkage.position.C * -1)
    turns = 0 if driven else ceil((float(row.value(start)[0, 0]) - HALF_TURN) / tau)
    free = spring.angle + 2 * arb.pi() * turns

    def moment(q: arb_mat, velocity: arb_mat, _time: arb) -> arb_mat:
        rate = (row.C * velocity)[0, 0]
        size = -spring.stiffness * (row.value(q)[0, 0] - free) - (spring.damping or 0) * rate
        return row.C.transpose() * size

    return moment
