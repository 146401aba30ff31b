"""What loads and springs do to the bodies at an instant: a rule for each type of element.

A pose is the places z of the bodies' origins and the turns exp(i theta) of their frames, by number of the body: complex
numbers, or arrays of them of shape (n,). Single numbers are plain Python's, which are much faster than numpy's.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

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

if TYPE_CHECKING:  # which kinds there are rules for is asked without pymunk too
    from .constraints import LinkageConstraints
    from .planes import PlaneVector

Planes: TypeAlias = Any  # one number or array for each body and the ground
# A body or the ground, the force, N, and the moment about its origin, N m.
BodyForce: TypeAlias = tuple[str, "PlaneVector", Any]


class Instant(NamedTuple):
    """What forces depend on, at one instant or at n: numbers or arrays of shape (n,), of bodies by their number."""

    time: Any  # s
    position: Any  # of the drive, rad or m
    z: Planes
    turn: Planes
    angle: Planes  # rad, over whole turns
    velocity: Planes  # of the origins
    omega: Planes


class Situation(NamedTuple):
    """An instant of a linkage."""

    linkage: "LinkageConstraints"
    at: Instant
    acts: Mapping[str, Any]  # by place in the file, whether press forces act
    turns: Mapping[str, float]  # by place in the file, what torsion springs' angles have beyond the pose's, rad

    def arm(self, body: str, point: str) -> "PlaneVector":
        """The way from a body's origin to a point of it, m."""
        return self.linkage.arm(body, point) * self.turn(body)

    def turn(self, body: str) -> Any:
        """How a body is turned."""
        return self.at.turn[self.linkage.index[body]]

    def on_body(self, load: Load, force: "PlaneVector") -> BodyForce:
        """A force at the point of a load."""
        return load.body, force, moment_of(self.arm(load.body, load.at), force)

    def sized(self, load: TabledLoad, constant: float | None = None) -> Any:
        """The size of a load, N or N m, that is constant or by a table."""
        if load.table is None:
            return constant
        if load.table.over == "displacement":
            return load.table.at(self.linkage.displacement(load.body, self.at.z, self.at.turn))
        return load.table.at(self.at.position if load.table.over == "drive" else self.at.time)


def moment_of(r: "PlaneVector", force: "PlaneVector") -> Any:
    """The moment of a force at the end of an arm, N m."""
    return (r.conjugate() * force).imag


def _force(load: Force, _: str, now: Situation) -> Iterator[BodyForce]:
    yield now.on_body(load, complex(*load.force))


def _turning_force(load: TurningForce, _: str, now: Situation) -> Iterator[BodyForce]:
    yield now.on_body(load, complex(*load.force) * now.turn(load.body))


def _press(load: PressForce, place: str, now: Situation) -> Iterator[BodyForce]:
    yield now.on_body(load, now.acts[place] * complex(*load.force))


def _guide_force(load: GuideForce, _: str, now: Situation) -> Iterator[BodyForce]:
    slide, z, index = now.linkage.slides[load.body], now.at.z, now.linkage.index
    r = now.arm(load.body, load.at)
    force = now.sized(load, load.force) * complex(*slide.along) * now.turn(slide.on)
    yield slide.on, -force, moment_of(z[index[load.body]] + r - z[index[slide.on]], -force)
    yield load.body, force, moment_of(r, force)


def _by_table(load: TableForce, _: str, now: Situation) -> Iterator[BodyForce]:
    force = now.sized(load) * complex(*load.direction)
    yield now.on_body(load, force * now.turn(load.body) if load.frame == "body" else force)


def _moment(load: Moment, _: str, now: Situation) -> Iterator[BodyForce]:
    yield load.body, 0j, now.sized(load, load.moment)


def _spring(spring: Spring, _: str, now: Situation) -> Iterator[BodyForce]:
    """Yield the pulls; without a length, but with a free one, they have no direction and are not finite."""
    instant, index, (first, second) = now.at, now.linkage.index, spring.ends
    r, s = now.arm(*first), now.arm(*second)
    i, j = index[first[0]], index[second[0]]
    d = instant.z[j] + s - instant.z[i] - r
    relaxed = spring.length * d / np.abs(d) if spring.length else 0
    pull = spring.stiffness * (d - relaxed)
    if spring.damping is not None:
        apart = instant.velocity[j] + 1j * instant.omega[j] * s - instant.velocity[i] - 1j * instant.omega[i] * r
        pull = pull + spring.damping * (d.conjugate() * apart).real * d / np.abs(d) ** 2
    yield from pulled(spring, pull, r, s)


def pulled(pair: PointPair, pull: "PlaneVector", r: "PlaneVector", s: "PlaneVector") -> Iterator[BodyForce]:
    """Yield a pull on the first of two points, with arms r and s, and its reaction on the second."""
    yield pair.first[0], pull, moment_of(r, pull)
    yield pair.second[0], -pull, moment_of(s, -pull)


def _torsion_spring(spring: TorsionSpring, place: str, now: Situation) -> Iterator[BodyForce]:
    instant, first, second = now.at, now.linkage.index[spring.first], now.linkage.index[spring.second]
    phi = instant.angle[second] - instant.angle[first] + now.turns[place]
    moment = spring.moment(phi, instant.omega[second] - instant.omega[first])
    yield spring.first, 0j, -moment
    yield spring.second, 0j, moment


def _constant_force_spring(spring: ConstantForceSpring, _: str, now: Situation) -> Iterator[BodyForce]:
    instant, index, (first, second) = now.at, now.linkage.index, spring.ends
    r, s = now.arm(*first), now.arm(*second)
    d = instant.z[index[second[0]]] + s - instant.z[index[first[0]]] - r
    yield from pulled(spring, spring.force * d / np.abs(d), r, s)


RULES: Mapping[type[Element], Callable[[Any, str, Situation], Iterator[BodyForce]]] = {
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
