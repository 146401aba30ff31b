"""What loads and springs do to the bodies: a rule for each type of element."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import tau
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes import Scene
from scenes.bodies import GROUND
from scenes.elements.constant_force_springs import ConstantForceSpring
from scenes.elements.element import Element
from scenes.elements.loads import (
    Force,
    ForceTable,
    GuideForce,
    Moment,
    PressForce,
    TabledLoad,
    TableForce,
    TurningForce,
)
from scenes.elements.springs import Damper, PointPair, Spring, TorsionSpring
from scenes.model.motion import Samples

from .decomposition import Linkage
from .dyads import Vectors, dot
from .geometry import as_complex
from .numbers import Number, chosen, samples
from .placing import Kinematics

# The drive's `position` and the `time`; by place in the file where a press force's stroke ends, m, and what the angle
# of a torsion spring is roughly, rad, over whole turns.
Given: TypeAlias = Mapping[str, Number]


class ActingForce(NamedTuple):
    """A force on a body, N, the point where it acts, m, and a moment with it, N m."""

    force: Vectors
    at: Vectors
    moment: Samples | float = 0.0


Acting: TypeAlias = Iterator[tuple[str, ActingForce]]  # by body


@dataclass(frozen=True)
class Loading:
    """What acts on the bodies from outside, and what that is evaluated from."""

    scene: Scene
    linkage: Linkage
    given: Given
    k: Kinematics

    @cached_property
    def outside(self) -> Mapping[str, list[ActingForce]]:
        """By body, what acts on it of all elements."""
        acting: dict[str, list[ActingForce]] = {}
        for place, element in self.scene.elements:
            for body, force in acts(element, place, self):
                acting.setdefault(body, []).append(force)
        return acting

    def guide(self, body: str) -> tuple[Vectors, Samples]:
        """The direction of a body's guide in the plane, and its displacement, m."""
        k, slide = self.k, self.scene.slides[body]
        along, through = samples(as_complex(slide.along)), as_complex(slide.through)
        if slide.on != GROUND:
            u, foot = k.u[slide.on], k.foot[slide.on]
            along, through = u * along, k.z[foot] + u * (through - self.linkage.bodies[slide.on].local[foot])
        return along, dot(along, k.z[self.scene.bodies[body].points[0]] - through)

    def acting(self, load: PressForce, place: str) -> Any:
        """Where a press force acts, which has a place in the file."""
        s, ds, _ = self.k.displaced(self.scene, self.scene.bodies[load.body].points[0])
        return load.acts(s, ds, self.given[place])

    def twisted(self, spring: TorsionSpring, place: str) -> Any:
        """The angle of a torsion spring, over whole turns."""
        # The pose gives the angle modulo a turn; the input, which is roughly right, picks the turn.
        phi = twist(spring, self.k)
        return phi + tau * np.floor((self.given[place] - phi) / tau + 0.5)

    def apart(self, pair: PointPair) -> Any:
        """The way from the first of two points to the second, m."""
        (_, start), (_, end) = pair.ends
        return self.k.z[end] - self.k.z[start]

    def along(self, d: Any, length: Number | None = None) -> Any:
        """The direction d / |d| of a way between two points, m.

        A length, m, where it is zero, leaves any direction to ends that meet: there is no pull along it.
        """
        apart = np.abs(d)
        return d / (apart if length is None else chosen(apart + length > 0, apart, 1.0))

    def size(self, load: TabledLoad, constant: Number = None) -> Number:
        """The number of a load, N or N m, or that of its table."""
        if load.table is None:
            return constant
        if load.table.over == "displacement":
            return load.table.at(self.guide(load.body)[1])
        return load.table.at(self.given["position" if load.table.over == "drive" else "time"])


def acts(element: Element, place: str, loading: Loading) -> Acting:
    """Yield what an element, which has a place in the file, does to each body."""
    return RULES[type(element)](element, place, loading)


def _force(load: Force, _: str, loading: Loading) -> Acting:
    yield load.body, ActingForce(samples(as_complex(load.force)), loading.k.z[load.at])


def _turning_force(load: TurningForce, _: str, loading: Loading) -> Acting:
    yield load.body, ActingForce(loading.k.u[load.body] * samples(as_complex(load.force)), loading.k.z[load.at])


def _press(load: PressForce, place: str, loading: Loading) -> Acting:
    yield load.body, ActingForce(np.where(loading.acting(load, place), as_complex(load.force), 0), loading.k.z[load.at])


def _guide_force(load: GuideForce, _: str, loading: Loading) -> Acting:
    force = loading.guide(load.body)[0] * loading.size(load, load.force)
    yield load.body, ActingForce(force, loading.k.z[load.at])
    yield loading.scene.slides[load.body].on, ActingForce(-force, loading.k.z[load.at])


def _by_table(load: TableForce, _: str, loading: Loading) -> Acting:
    force = as_complex(load.direction) * loading.size(load)
    yield (
        load.body,
        ActingForce(force if load.frame == "ground" else loading.k.u[load.body] * force, loading.k.z[load.at]),
    )


def _moment(load: Moment, _: str, loading: Loading) -> Acting:
    yield load.body, ActingForce(samples(0j), loading.k.z[load.at], loading.size(load, load.moment))


def _spring(spring: Spring, _: str, loading: Loading) -> Acting:
    d = loading.apart(spring)
    # Without damping, a spring of no free length pulls by k d and needs no direction where its ends meet.
    along = loading.along(d, spring.length if spring.damping is None else None)
    pull = spring.stiffness * (d - spring.length * along)
    if spring.damping is not None:
        v = loading.k.v
        pull = pull + spring.damping * dot(along, v[spring.second[1]] - v[spring.first[1]]) * along
    return pulled(spring, pull, loading)


def pulled(pair: PointPair, pull: Any, loading: Loading) -> Acting:
    """Yield a pull on the first end of a pair of points, and its reaction on the second."""
    for (body, point), force in zip(pair.ends, (pull, -pull), strict=True):
        yield body, ActingForce(force, loading.k.z[point])


def _torsion_spring(spring: TorsionSpring, place: str, loading: Loading) -> Acting:
    sign = spring.drives(loading.scene)
    phi = sign * loading.given["position"] if sign else loading.twisted(spring, place)
    moment = spring.moment(phi, loading.k.omega[spring.second] - loading.k.omega[spring.first])
    for body, share in ((spring.second, moment), (spring.first, -moment)):
        yield body, ActingForce(samples(0j), loading.k.z[spring.at], share)


def _constant_force_spring(spring: ConstantForceSpring, _: str, loading: Loading) -> Acting:
    return pulled(spring, spring.force * loading.along(loading.apart(spring)), loading)


RULES: Mapping[type[Element], Callable[[Any, str, Loading], Acting]] = {
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


def twist(spring: TorsionSpring, k: Kinematics) -> Any:
    """The angle of a torsion spring's second body less that of its first, from -pi to pi."""
    turned = k.u[spring.second] * k.u[spring.first].conjugate()
    return np.arctan2(turned.imag, turned.real)


def wound(scene: Scene) -> Mapping[str, TorsionSpring]:
    """Torsion springs, but the drive's own, by their places in the file."""
    springs = scene.of_type(TorsionSpring)
    return {place: spring for place, spring in springs.items() if not spring.drives(scene)}
