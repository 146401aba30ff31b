"""The loads of a scene as generalised forces Q = J^T F: J of what moves against the load, F the load, all in balls."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

from flint import arb, arb_mat

from scenes import Failure, Status
from scenes.loads import Force, ForceTable, PressForce, Spring

from .constraints import Linkage
from .rows import Rows, axis_vector


class _Effort(Protocol):
    """A load that depends on the pose or its rate."""

    def __call__(self, q: arb_mat, velocity: arb_mat) -> arb_mat:
        """Return the generalised force, shape (3 bodies, 1)."""


class Loads:
    """All loads and the weight; `ends` are where the press forces' strokes end, m."""

    def __init__(self, linkage: Linkage, ends: Mapping[PressForce, float]) -> None:
        scene = linkage.scene
        self._work = Rows(1, len(linkage.index))  # Σ F·p + Σ m g·r of all that is constant
        self._efforts: list[_Effort] = [_spring(linkage, spring) for spring in scene.springs]
        for load in scene.loads:
            if isinstance(load, Force):
                linkage.add_point(self._work, 0, (arb(load.force[0]), arb(load.force[1])), load.body, load.at)
            elif isinstance(load, PressForce):
                self._efforts.append(_press(linkage, load, ends[load]))
            else:
                self._efforts.append(_table(linkage, load))
        if scene.gravity is not None:
            for i in linkage.index.values():
                m = linkage.mass[3 * i, 3 * i]
                self._work.add_point(0, (m * scene.gravity[0], m * scene.gravity[1]), i, (arb(0), arb(0)))

    def generalised(self, q: arb_mat, velocity: arb_mat) -> arb_mat:
        """Return Q, shape (3 bodies, 1).

        Raises:
            Failure: the ends of a spring meet, so that it pulls in no direction.
        """
        Q = self._work.jacobian(q).transpose()
        for effort in self._efforts:
            Q = Q + effort(q, velocity)
        return Q


@dataclass(frozen=True)
class _Press:
    """A force that acts or not, as the doubles nearest to the slider's displacement and velocity decide."""

    load: PressForce
    work: Rows
    displacement: Rows
    end: float  # m

    def __call__(self, q: arb_mat, velocity: arb_mat) -> arb_mat:
        x, v = self.displacement.value(q)[0, 0], (self.displacement.jacobian(q) * velocity)[0, 0]
        return self.work.jacobian(q).transpose() * arb(int(self.load.acts(float(x), float(v), self.end)))


@dataclass(frozen=True)
class _Table:
    """A force along the guide, f(x) = f_0 + Σ Δ_i max(x - x_i, 0): Δ_i is by how much the slope changes at entry i."""

    work: Rows  # of a unit force
    displacement: Rows
    first: arb  # f_0, N
    kinks: list[tuple[arb, arb]]  # x_i, m, and Δ_i, N/m

    def __call__(self, q: arb_mat, velocity: arb_mat) -> arb_mat:  # noqa: ARG002 - it depends on the pose alone
        x = self.displacement.value(q)[0, 0]
        force = self.first + sum((change * (x - at).nonnegative_part() for at, change in self.kinks), arb(0))
        return self.work.jacobian(q).transpose() * force


@dataclass(frozen=True)
class _Spring:
    """A pull along the way d from the first point to the second: -k (1 - l / |d|) d on the second."""

    linkage: Linkage
    spring: Spring
    way: Rows  # d, two rows

    def __call__(self, q: arb_mat, velocity: arb_mat) -> arb_mat:  # noqa: ARG002 - it depends on the pose alone
        d = self.way.value(q)
        pull = arb(self.spring.stiffness)
        if self.spring.length > 0:
            distance = (d[0, 0] ** 2 + d[1, 0] ** 2).sqrt()
            if not distance > 0:
                raise self._meets(q)
            pull -= pull * self.spring.length / distance
        return self.way.jacobian(q).transpose() * d * -pull

    def _meets(self, q: arb_mat) -> Failure:
        first, second = (".".join(end) for end in (self.spring.first, self.spring.second))
        place = self.linkage.scene.where(float(self.linkage.position.value(q)[0, 0]))
        return Failure(Status.nonfinite, f"the spring's ends {first} and {second} meet at {place}: it has no direction")


def _press(linkage: Linkage, load: PressForce, end: float) -> _Press:
    work = Rows(1, len(linkage.index))
    linkage.add_point(work, 0, (arb(load.force[0]), arb(load.force[1])), load.body, load.at)
    return _Press(load, work, linkage.displacement(load.body), end)


def _table(linkage: Linkage, load: ForceTable) -> _Table:
    slide = linkage.scene.bodies[load.body].slide
    assert slide is not None
    work = Rows(1, len(linkage.index))
    linkage.add_point(work, 0, (arb(slide.along[0]), arb(slide.along[1])), load.body, load.at)
    x, f = [arb(at) for at in load.displacements], [arb(force) for force in load.forces]
    slopes = [arb(0), *((g - e) / (v - u) for (u, v), (e, g) in zip(pairwise(x), pairwise(f), strict=True)), arb(0)]
    kinks = [(at, after - before) for at, (before, after) in zip(x, pairwise(slopes), strict=True)]
    return _Table(work, linkage.displacement(load.body), f[0], kinks)


def _spring(linkage: Linkage, spring: Spring) -> _Spring:
    way = Rows(2, len(linkage.index))
    for axis in (0, 1):
        linkage.add_point(way, axis, axis_vector(axis), *spring.second)
        linkage.add_point(way, axis, axis_vector(axis, -1), *spring.first)
    return _Spring(linkage, spring, way)
