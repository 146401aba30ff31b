"""One linkage, prepared to be judged: what follows from its scene alone, worked out once and handed on."""

from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np

from scenes import Failure, Scene
from scenes.channels import Role
from scenes.fields import Number, put

from ..engines import registry
from .axis import axis
from .constraints import Constraints

SHOWN_GROUPS = ("position", "velocity", "acceleration", "reaction", "torque", "force")  # the drive is an input

EPS = float(np.finfo(float).eps)
ULPS = 4  # of every number, up or down at random
DRAWS = 4  # scenes; their worst is within a factor of three of the worst of many more, see the tests
SEED = 20261121
LEFT_OUT = {("drives", name) for name in ("start", "end", "times", "positions")} | {
    ("loads", name) for name in ("last", "displacements", "positions", "times")
}


class Mechanics:
    """The judge's own model of a linkage; parts that take time are made when they are first asked for."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.axis, self.presses = scene, axis(scene), [*scene.presses.values()]
        self.forces = scene.channels.names(Role.force)  # one a constraint; none without masses
        self.friction = scene.channels.names(Role.friction)
        known = {name: scene.channels[name] for name in scene.channels.names()}
        self.units = {name: channel.unit for name, channel in known.items()}  # by channel, in the order of the files
        self.groups = {name: channel.group for name, channel in known.items() if channel.group}  # of all but the time
        bodies, moving = scene.bodies, {*scene.moving_points}
        self.along_guides = {  # by body that slides its moving points, and those of the body that it slides on
            name: tuple(p for each in (name, slide.on) if each in bodies for p in bodies[each].points if p in moving)
            for name, slide in scene.slides.items()
        }

    @property
    def way(self) -> float:
        """What the drive's position is measured by: 1 rad, or the travel of a slider that is driven, m."""
        return max(drive.unit for drive in self.scene.drives)

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
        unit_of = {"N": 1.0, "N*m": self.size}
        return {channel: unit_of[self.units[channel]] for channel in self.forces}

    @cached_property
    def perturbed(self) -> tuple["Mechanics", ...]:
        """The scene with all its numbers a few last places off, up or down at random, `DRAWS` times.

        A drive's frequencies stay, which decide how long a cycle is: instants a few last places off do the same.
        """
        numbers = {number.at: number.value for number in rounded(self.scene)}
        # Random signs for all numbers at once: a few draws show the sensitivity of a result to round-off of its inputs
        # at the price of a few solutions, where one draw a number would take hundreds. Draws may cancel in one channel
        # by chance, so the worst of several counts.
        signs = np.random.default_rng(SEED).choice((-1.0, 1.0), (DRAWS, len(numbers)))
        jittered = np.array([*numbers.values()]) * (1 + ULPS * EPS * signs)
        return tuple(Mechanics(put(self.scene, dict(zip(numbers, values, strict=True)))) for values in jittered)

    @cached_property
    def neighbours(self) -> tuple[registry.Solve, ...]:
        """Solvers of the perturbed scenes; none where one cannot be solved."""
        try:
            return tuple(registry.reference(other.scene, frozenset(self.units)) for other in self.perturbed)
        except Failure:
            return ()


def inputs(scene: Scene) -> Iterator[Number]:
    """Yield the numbers of a scene but for those that say where the drive is, and where a load changes."""
    for number in scene.ranked_numbers:
        name = next(key for key in reversed(number.at) if not isinstance(key, int))
        if number.at[0] != "sketch" and (number.at[0], name) not in LEFT_OUT:
            yield number


def rounded(scene: Scene) -> Iterator[Number]:
    """Yield the numbers of a scene that every model rounds its own way, those of the drive's law among them."""
    for number in scene.ranked_numbers:
        group, name = number.at[0], next(key for key in reversed(number.at) if not isinstance(key, int))
        if group == "drives":
            if name not in ("times", "frequencies", "end"):
                yield number
        elif group not in ("sketch", "limits", "tolerances") and (group, name) not in LEFT_OUT:
            yield number
