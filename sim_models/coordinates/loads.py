"""What loads and springs do to the bodies: a rule for each type of element that these engines know."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from scenes import Failure, Scene, Status
from scenes.elements.constant_force_springs import ConstantForceSpring
from scenes.elements.element import Element, End
from scenes.elements.loads import Force, ForceTable, Load, PressForce
from scenes.elements.springs import PointPair, Spring

MIN_SPRING_LENGTH = 1e-12  # of the linkage's size; a shorter one's direction is round-off


class Wrench(NamedTuple):
    """A force on a body, N, at a place, m, and a moment, N m, at one time or at many."""

    body: str
    at: Any
    force: Any
    moment: Any = 0.0

    def about(self, place: Any) -> Any:
        """Return the moment of both about a place, N m."""
        return self.moment + ((self.at - place).conjugate() * self.force).imag


@dataclass(frozen=True)
class LoadedPose:
    """What forces depend on, at one time or at many."""

    scene: Scene
    ends: Mapping[str, float]  # of the press forces' strokes, by place in the file, m
    slid: Callable[[str], tuple[Any, Any]]  # how far, m, and fast, m/s, a slider on the ground is along its guide
    place: Callable[[End], Any]  # of a point, m
    shortest: float  # m: from this length on a spring has a direction

    def on_body(self, load: Load, force: Any) -> Iterator[Wrench]:
        """Yield a force at the point of a load."""
        yield Wrench(load.body, self.place((load.body, load.at)), force)

    def apart(self, pair: PointPair, way: Any) -> Any:
        """Return the length, m, of the way from the first of two points to the second; Failure where it is none."""
        length: Any = np.abs(way)
        if not np.min(length) > self.shortest:
            first, second = (".".join(end) for end in pair.ends)
            raise Failure(Status.nonfinite, f"the ends {first} and {second} of a {pair.noun} meet: it has no direction")
        return length


def applied(pose: LoadedPose) -> Iterator[Wrench]:
    """Yield what all loads and springs do."""
    for place, element in pose.scene.elements:
        yield from RULES[type(element)](element, place, pose)


def _force(load: Force, _: str, pose: LoadedPose) -> Iterator[Wrench]:
    return pose.on_body(load, complex(*load.force))


def _press(load: PressForce, place: str, pose: LoadedPose) -> Iterator[Wrench]:
    acts = load.acts(*pose.slid(load.body), pose.ends[place])
    return pose.on_body(load, acts * complex(*load.force))


def _force_table(load: ForceTable, _: str, pose: LoadedPose) -> Iterator[Wrench]:
    assert load.table is not None
    displacement, _velocity = pose.slid(load.body)
    return pose.on_body(load, complex(*pose.scene.slides[load.body].along) * load.table.at(displacement))


def _spring(spring: Spring, _: str, pose: LoadedPose) -> Iterator[Wrench]:
    first, second = (pose.place(end) for end in spring.ends)
    way = second - first
    relaxed = spring.length * way / pose.apart(spring, way) if spring.length else 0
    pull = spring.stiffness * (way - relaxed)
    yield Wrench(spring.first[0], first, pull)
    yield Wrench(spring.second[0], second, -pull)


def _constant_force_spring(spring: ConstantForceSpring, _: str, pose: LoadedPose) -> Iterator[Wrench]:
    first, second = (pose.place(end) for end in spring.ends)
    pull = spring.force * (second - first) / pose.apart(spring, second - first)
    yield Wrench(spring.first[0], first, pull)
    yield Wrench(spring.second[0], second, -pull)


RULES: Mapping[type[Element], Callable[[Any, str, LoadedPose], Iterator[Wrench]]] = {
    Force: _force,
    PressForce: _press,
    ForceTable: _force_table,
    Spring: _spring,
    ConstantForceSpring: _constant_force_spring,
}
