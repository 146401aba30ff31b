"""One linkage, prepared to be judged: what follows from its scene alone, worked out once and handed on."""

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from scenes import Failure, Scene
from scenes.fields import Number, put, walk
from scenes.model.motion import UNITS, channels, force_channels, friction_channels, quantity

from ..engines import registry
from .axis import axis
from .constraints import Constraints

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


class Mechanics:
    """The judge's own model of a linkage; parts that take time are made when they are first asked for."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.axis, self.presses = scene, axis(scene), [*scene.presses.values()]
        self.forces = force_channels(scene)  # one a constraint; none without masses
        self.friction = friction_channels(scene)
        self.units = {c: UNITS[quantity(c)] for c in channels(scene)}  # by channel, in the order of the files
        self.groups = {c: GROUPS[quantity(c)] for c in self.units if c != "time"}  # in which each channel is judged
        bodies, moving = scene.bodies, {*scene.moving_points}
        self.along_guides = {  # by body that slides its moving points, and those of the body that it slides on
            name: tuple(p for each in (name, slide.on) if each in bodies for p in bodies[each].points if p in moving)
            for name, slide in scene.slides.items()
        }

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
    def neighbours(self) -> tuple[registry.Solve, ...]:
        """Solvers of the scene with its lengths and places a few last places off; none where one cannot be solved."""
        lengths = {one.at: one.value for one in inputs(self.scene) if one.quantity.dimension == "length"}
        signs = np.random.default_rng(SEED).choice((-1.0, 1.0), (DRAWS, len(lengths)))
        jittered = np.array([*lengths.values()]) * (1 + ULPS * np.finfo(float).eps * signs)
        try:
            others = (put(self.scene, dict(zip(lengths, values, strict=True))) for values in jittered)
            return tuple(registry.reference(other, frozenset(self.units)) for other in others)
        except Failure:
            return ()


def inputs(scene: Scene) -> Iterator[Number]:
    """Yield the numbers of a scene but for those that say where the drive is, and where a load changes."""
    for number in walk(scene):
        name = next(key for key in reversed(number.at) if not isinstance(key, int))
        if number.at[0] != "sketch" and (number.at[0], name) not in LEFT_OUT:
            yield number
