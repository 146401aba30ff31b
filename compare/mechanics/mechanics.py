"""One linkage, prepared to be judged: what follows from its scene alone, worked out once and handed on."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import NamedTuple

import numpy as np

from scenes import Failure, Scene
from scenes.fields import At, put, walk
from scenes.model.motion import UNITS, channels, force_channels, friction_channels, quantity
from scenes.scene import PressForce

from ..engines import registry
from .axis import DriveAxis, axis
from .bodies import inertia
from .constraints import Constraints
from .motion_vectors import press_forces

GROUPS: Mapping[str, str] = (
    dict.fromkeys(("x", "y", "angle"), "position")
    | dict.fromkeys(("vx", "vy", "omega"), "velocity")
    | dict.fromkeys(("ax", "ay", "alpha"), "acceleration")
    | dict.fromkeys(("fx", "fy", "guide_force", "guide_moment"), "reaction")
    | dict.fromkeys(("friction_moment", "friction_force", "power"), "reaction")
    | {"torque": "torque", "force": "force", "crank_angle": "drive", "displacement": "drive"}
)  # by quantity; every channel but the time is judged in one

SHOWN_GROUPS = ("position", "velocity", "acceleration", "reaction", "torque", "force")  # the drive is an input

ULPS = 4  # of every number, up or down at random
DRAWS = 4  # scenes; their worst is within a factor of three of the worst of many more, see the tests
SEED = 20261121
LEFT_OUT = {("drive", name) for name in ("start", "end", "times", "positions")} | {
    ("loads", name) for name in ("last", "displacements", "positions", "times")
}


@dataclass(frozen=True)
class Mechanics:
    """The judge's own model of a linkage, each part made when it is first asked for."""

    scene: Scene

    @cached_property
    def axis(self) -> DriveAxis:
        """What curves run over, and where tables say that something happened."""
        return axis(self.scene)

    @cached_property
    def presses(self) -> tuple[PressForce, ...]:
        """The loads that depend on the direction of motion."""
        return press_forces(self.scene)

    @cached_property
    def inertia(self) -> Mapping[str, float]:
        """By body its moment of inertia about the centre of mass, kg m^2."""
        return {name: inertia(body) for name, body in self.scene.bodies.items()}

    @property
    def way(self) -> float:
        """What the drive's position is measured by: 1 rad, or the travel of a slider that is driven, m."""
        least, largest = self.scene.drive.extent
        return 1.0 if self.scene.driven_slide is None else largest - least

    @property
    def rate(self) -> float:
        """The drive's peak rate over its `way`, 1/s."""
        return self.scene.drive.peak_rate / self.way

    @cached_property
    def forces(self) -> tuple[str, ...]:
        """The channels of its forces, one a constraint; none without masses."""
        return force_channels(self.scene)

    @cached_property
    def friction(self) -> tuple[str, ...]:
        """The channels of its friction."""
        return friction_channels(self.scene)

    @cached_property
    def units(self) -> Mapping[str, str]:
        """By channel its unit, in the order of the files."""
        return {channel: UNITS[quantity(channel)] for channel in channels(self.scene)}

    @cached_property
    def groups(self) -> Mapping[str, str]:
        """By channel the group in which it is judged; all but the time."""
        return {channel: GROUPS[quantity(channel)] for channel in self.units if channel != "time"}

    @cached_property
    def constraints(self) -> Constraints:
        """Its joints and its drive as equations."""
        return Constraints(self.scene)

    @property
    def size(self) -> float:
        """Its largest length, m."""
        return self.constraints.size

    @cached_property
    def newtons(self) -> Mapping[str, float]:
        """By force channel what one newton is there: 1 N, or its moment at an arm of the largest length, N m."""
        one = {"N": 1.0, "N*m": self.size}
        return {channel: one[self.units[channel]] for channel in self.forces}

    @cached_property
    def along_guides(self) -> Mapping[str, tuple[str, ...]]:
        """By body that slides its moving points, and those of the body that it slides on."""
        bodies, moving = self.scene.bodies, {*self.scene.moving_points}
        return {
            name: tuple(p for each in (name, slide.on) if each in bodies for p in bodies[each].points if p in moving)
            for name, slide in self.scene.slides.items()
        }

    @cached_property
    def neighbours(self) -> tuple[registry.Solve, ...]:
        """Solvers of the scene with its lengths and places a few last places off; none where one cannot be solved."""
        draw, off = np.random.default_rng(SEED), ULPS * np.finfo(float).eps
        lengths = [one for one in inputs(self.scene) if one.dimension == "length"]

        def jittered(value: float) -> float:
            return value * (1 + off * float(draw.choice((-1.0, 1.0))))

        try:
            others = [put(self.scene, {one.at: one.each(jittered) for one in lengths}) for _ in range(DRAWS)]
            return tuple(registry.reference(other, frozenset(self.units)) for other in others)
        except Failure:
            return ()


class Input(NamedTuple):
    """A number of a scene, SI, or several that belong together: a vector, or the forces of a table."""

    at: At
    value: float | tuple[float, ...]
    dimension: str  # `length` of lengths and places

    def each(self, other: Callable[[float], float]) -> float | tuple[float, ...]:
        """The value with another number in the place of each."""
        return tuple(map(other, self.value)) if isinstance(self.value, tuple) else other(self.value)


def inputs(scene: Scene) -> Iterator[Input]:
    """Yield the inputs of a scene but for those that say where the drive is, and where a load changes."""
    for at, together in groupby(walk(scene), lambda n: n.at[:-1] if isinstance(n.at[-1], int) else n.at):
        first, *others = together
        if at[0] != "sketch" and (at[0], at[-1]) not in LEFT_OUT:
            value = (first.value, *(other.value for other in others)) if isinstance(first.at[-1], int) else first.value
            yield Input(at, value, first.quantity.dimension)
