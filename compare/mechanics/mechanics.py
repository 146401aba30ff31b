"""One linkage, prepared to be judged: what follows from its scene alone, worked out once and handed on."""

from collections.abc import Mapping
from functools import cached_property

from scenes import Scene
from scenes.model.motion import UNITS, channels, force_channels, quantity

from ..engines import registry
from .axis import axis
from .constraints import Constraints
from .motion_vectors import press_forces
from .perturbation import neighbours

GROUPS: Mapping[str, str] = (
    dict.fromkeys(("x", "y", "angle"), "position")
    | dict.fromkeys(("vx", "vy", "omega"), "velocity")
    | dict.fromkeys(("ax", "ay", "alpha"), "acceleration")
    | dict.fromkeys(("fx", "fy", "guide_force", "guide_moment"), "reaction")
    | {"torque": "torque", "force": "force", "crank_angle": "drive", "displacement": "drive"}
)  # by quantity; every channel but the time is judged in one

SHOWN_GROUPS = ("position", "velocity", "acceleration", "reaction", "torque", "force")  # the drive is an input


class Mechanics:
    """The judge's own model of a linkage; what takes time or room is made when it is first asked for."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.axis = axis(scene)  # what curves run over, and where tables say that something happened
        self.presses = press_forces(scene)
        least, largest = scene.drive.extent
        self.way = 1.0 if scene.driven_slide is None else largest - least  # rad or m: what the drive is measured by
        self.rate = scene.drive.peak_rate / self.way  # 1/s

    @cached_property
    def forces(self) -> tuple[str, ...]:
        """The channels of its forces, one a constraint; none without masses."""
        return force_channels(self.scene)

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
        on = {name: body.slide.on for name, body in bodies.items() if body.slide is not None}
        return {
            name: tuple(p for each in (name, guide) if each in bodies for p in bodies[each].points if p in moving)
            for name, guide in on.items()
        }

    @cached_property
    def neighbours(self) -> tuple[registry.Solve, ...]:
        """Solvers of the scene with its numbers a few last places off; none where one cannot be solved."""
        return neighbours(self.scene)
