"""The forces of loads and springs on the bodies, a function a kind."""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from scenes import Failure, Scene, Status
from scenes.model.motion import Samples
from scenes.scene import Force, Load, PressForce, Spring

from .bodies import End

SHORTEST_SPRING = 1e-12  # of the linkage's size; a shorter one's direction is round-off


class Wrench(NamedTuple):
    """A force on a body, N, at a place, m, and a moment, N m, at one time or at many."""

    body: str
    at: Any
    force: Any
    moment: Any = 0.0

    def about(self, place: Any) -> Any:
        """Return the moment of both about a place, N m."""
        return self.moment + ((self.at - place).conjugate() * self.force).imag


def applied(
    scene: Scene,
    ends: Samples,
    slid: Callable[[str], tuple[Any, Any]],
    place: Callable[[End], Any],
    shortest: float,
) -> Iterator[Wrench]:
    """Yield what loads and springs do, at one time or at many.

    By the ends of the press forces' strokes, m, a load; how far, m, and fast, m/s, a slider on the ground is along its
    guide; the place of a point, m; and the length, m, from which a spring has a direction.
    """
    for load, end in zip(scene.loads, ends.tolist(), strict=True):
        yield Wrench(load.body, place((load.body, load.at)), _force(scene, load, end, slid))
    for spring in scene.springs:
        first, second = place(spring.first), place(spring.second)
        pull = _pull(spring, second - first, shortest)
        yield Wrench(spring.first[0], first, pull)
        yield Wrench(spring.second[0], second, -pull)


def _force(scene: Scene, load: Load, end: float, slid: Callable[[str], tuple[Any, Any]]) -> Any:
    if isinstance(load, Force):
        return complex(*load.force)
    displacement, velocity = slid(load.body)
    if isinstance(load, PressForce):
        return load.acts(displacement, velocity, end) * complex(*load.force)
    assert load.table is not None  # along the guide, against the displacement: of the others it knows none
    return complex(*scene.slides[load.body].along) * load.table.at(displacement)


def _pull(spring: Spring, way: Any, shortest: float) -> Any:
    """Return the force on a spring's first end, by the way to its second."""
    if not spring.length:
        return spring.stiffness * way
    length = np.abs(way)
    if not np.min(length) > shortest:
        first, second = ".".join(spring.first), ".".join(spring.second)
        raise Failure(Status.nonfinite, f"the ends {first} and {second} of a spring meet: it has no direction")
    return spring.stiffness * (way - spring.length * way / length)
