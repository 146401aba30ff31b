"""The loads of a scene as generalised forces Q = J^T F: J of the work of a unit force, F the force, all in balls."""

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import TypeAlias

from flint import arb, arb_mat

from scenes import Failure, Status
from scenes.scene import Force, ForceTable, PressForce, Spring

from .constraints import LinkageEquations
from .rows import EquationRows, PlaneVector
from .start import closing_sign

GeneralisedForce: TypeAlias = Callable[[arb_mat, arb_mat], arb_mat]  # of q and its rate, each of shape (3 bodies, 1)


def generalised_force(linkage: LinkageEquations, ends: Mapping[PressForce, float]) -> GeneralisedForce:
    """Return Q of all loads and the weight; `ends` are those of the press forces' strokes, m.

    Q raises a Failure where the ends of a spring meet, so that it has no direction.
    """
    scene = linkage.scene
    work = EquationRows(1, len(linkage.index))  # Σ F·p + Σ m g·r of all that is constant
    others = [_spring(linkage, spring) for spring in scene.springs]
    for load in scene.loads:
        if isinstance(load, Force):
            linkage.add_point(work, 0, (arb(load.force[0]), arb(load.force[1])), load.body, load.at)
        elif isinstance(load, PressForce):
            others.append(_press(linkage, load, ends[load]))
        elif isinstance(load, ForceTable):
            others.append(_table(linkage, load))
    if scene.gravity is not None:
        for i in linkage.index.values():
            m = linkage.mass[3 * i]
            work.add_point(0, (m * scene.gravity[0], m * scene.gravity[1]), i, (arb(0), arb(0)))

    def total(q: arb_mat, velocity: arb_mat) -> arb_mat:
        Q = work.jacobian(q).transpose()
        for force in others:
            Q = Q + force(q, velocity)
        return Q

    return total


def _press(linkage: LinkageEquations, load: PressForce, end: float) -> GeneralisedForce:
    """Return a force that acts where the balls prove both: its power is negative, and its stroke is in the last part.

    On the switch itself nothing is proven, and the force does not act.
    """
    work = _work(linkage, load, (arb(load.force[0]), arb(load.force[1])))
    displacement, closing = linkage.displacement(load.body), closing_sign(linkage.scene, load)

    def force(q: arb_mat, velocity: arb_mat) -> arb_mat:
        J, left = work.jacobian(q), closing * (end - displacement.value(q)[0, 0])
        acts = (J * velocity)[0, 0] < 0 and left <= load.last
        return J.transpose() * arb(int(acts))

    return force


def _table(linkage: LinkageEquations, load: ForceTable) -> GeneralisedForce:
    """Return a force along the guide, f(x) = f_0 + Σ Δ_i max(x - x_i, 0), Δ_i the change of slope at entry i."""
    along = linkage.scene.slides[load.body].along
    work = _work(linkage, load, (arb(along[0]), arb(along[1])))
    displacement = linkage.displacement(load.body)
    x, f = [arb(at) for at in load.displacements], [arb(force) for force in load.forces]
    slopes = [arb(0), *((g - e) / (v - u) for (u, v), (e, g) in zip(pairwise(x), pairwise(f), strict=True)), arb(0)]
    kinks = [(at, after - before) for at, (before, after) in zip(x, pairwise(slopes), strict=True)]

    def force(q: arb_mat, _velocity: arb_mat) -> arb_mat:
        s = displacement.value(q)[0, 0]
        size = f[0] + sum((change * (s - at).nonnegative_part() for at, change in kinks), arb(0))
        return work.jacobian(q).transpose() * size

    return force


def _spring(linkage: LinkageEquations, spring: Spring) -> GeneralisedForce:
    """Return the pull of a spring along d from its first point to its second: -k (1 - l / |d|) d on the second."""
    rows = EquationRows(2, len(linkage.index))
    linkage.add_way(rows, 0, spring.first, spring.second)

    def force(q: arb_mat, _velocity: arb_mat) -> arb_mat:
        d, pull = rows.value(q), arb(spring.stiffness)
        if spring.length > 0:
            distance = (d[0, 0] ** 2 + d[1, 0] ** 2).sqrt()
            if not distance > 0:
                first, second = ".".join(spring.first), ".".join(spring.second)
                place = linkage.scene.where(float(linkage.position.value(q)[0, 0]))
                reason = f"the spring's ends {first} and {second} meet at {place}: it has no direction"
                raise Failure(Status.nonfinite, reason)
            pull -= pull * spring.length / distance
        return rows.jacobian(q).transpose() * d * -pull

    return force


def _work(linkage: LinkageEquations, load: PressForce | ForceTable, force: PlaneVector) -> EquationRows:
    """Return one row: F·p of a load's point."""
    work = EquationRows(1, len(linkage.index))
    linkage.add_point(work, 0, force, load.body, load.at)
    return work
