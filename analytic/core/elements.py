"""What loads and springs do to the bodies, kind by kind."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import tau
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes import Scene
from scenes.elements.loads import TabledLoad
from scenes.model.motion import Samples
from scenes.scene import GROUND, Force, GuideForce, Load, Moment, PressForce, Spring, TableForce
from scenes.scene import TorsionSpring as Twist

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

    def twisted(self, spring: Twist, place: str) -> Any:
        """The angle of a torsion spring, over whole turns."""
        phi = twist(spring, self.k)
        return phi + tau * np.floor((self.given[place] - phi) / tau + 0.5)

    def along(self, spring: Spring, d: Any) -> Any:
        """The direction d / |d| of a spring, given the way d from its first end to its second one, m."""
        apart = np.abs(d)  # without a free length and a damping there is no pull where ends meet
        return d / (chosen(apart + spring.length > 0, apart, 1.0) if spring.damping is None else apart)

    def size(self, load: TabledLoad, constant: Number = None) -> Number:
        """The number of a load, N or N m, or that of its table."""
        if load.table is None:
            return constant
        if load.table.over == "displacement":
            return load.table.at(self.guide(load.body)[1])
        return load.table.at(self.given["position" if load.table.over == "drive" else "time"])


def acts(element: Load | Spring | Twist, place: str, at: Loading) -> Acting:
    """Yield what an element, which has a place in the file, does to each body."""
    z, u = at.k.z, at.k.u
    match element:
        case Force() | TableForce() as load:
            vector = as_complex(load.force if isinstance(load, Force) else load.direction)
            force = samples(vector) if isinstance(load, Force) else vector * at.size(load)
            yield load.body, ActingForce(force if load.frame == "ground" else u[load.body] * force, z[load.at])
        case PressForce() as load:
            yield load.body, ActingForce(np.where(at.acting(load, place), as_complex(load.force), 0), z[load.at])
        case GuideForce() as load:
            force = at.guide(load.body)[0] * at.size(load, load.force)
            yield load.body, ActingForce(force, z[load.at])
            yield at.scene.slides[load.body].on, ActingForce(-force, z[load.at])
        case Moment() as load:
            yield load.body, ActingForce(samples(0j), z[load.at], at.size(load, load.moment))
        case Spring() as spring:
            yield from _spring(spring, at)
        case Twist() as spring:
            sign = spring.drives(at.scene)
            phi = sign * at.given["position"] if sign else at.twisted(spring, place)
            moment = spring.moment(phi, at.k.omega[spring.second] - at.k.omega[spring.first])
            for body, share in ((spring.second, moment), (spring.first, -moment)):
                yield body, ActingForce(samples(0j), z[spring.at], share)


def _spring(spring: Spring, at: Loading) -> Acting:
    z, v, damping = at.k.z, at.k.v, spring.damping
    (first, start), (second, end) = spring.first, spring.second
    d: Any = z[end] - z[start]
    along = at.along(spring, d)
    pull = spring.stiffness * (d - spring.length * along)
    if damping is not None:
        pull = pull + damping * dot(along, v[end] - v[start]) * along
    yield first, ActingForce(pull, z[start])
    yield second, ActingForce(-pull, z[end])


def twist(spring: Twist, k: Kinematics) -> Any:
    """The angle of a torsion spring's second body less that of its first, from -pi to pi."""
    turned = k.u[spring.second] * k.u[spring.first].conjugate()
    return np.arctan2(turned.imag, turned.real)


def wound(scene: Scene) -> Mapping[str, Twist]:
    """Torsion springs, but the drive's own, by their places in the file."""
    return {place: spring for place, spring in scene.elements if isinstance(spring, Twist) and not spring.drives(scene)}
