"""Joints and drives: what holds two bodies to each other, a kind a class, for which every model has a rule by its type.

Each is some equations between the coordinates of its two bodies. Models have these in the order of `Scene.joints`,
which is that of the force channels: a channel is the multiplier of one equation.
"""

from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from . import quantities
from .bodies import Slide
from .drive import Drive
from .quantities import Channel, ChannelQuantity, Role, vector

if TYPE_CHECKING:
    from .scene import Scene


class Joint:
    """What every kind has; a kind with a table of its own in scene files is an element too."""

    equations: ClassVar[int]
    gaps: ClassVar[int] = 0  # how many of them, the first ones, are lengths by which the joint is open

    @property
    @abstractmethod
    def between(self) -> tuple[str, str]:
        """The two bodies, or the ground: the force channels are what the first does on the second."""

    @property
    @abstractmethod
    def label(self) -> str:
        """What messages call it."""

    @abstractmethod
    def channels(self, scene: "Scene") -> Iterator[Channel]:
        """Yield its force channels, one an equation."""


@dataclass(frozen=True)
class Pin(Joint):
    """A pin between two bodies at a point they both name; `first` comes first in the file, the ground before all."""

    equations = gaps = 2

    point: str
    first: str
    second: str
    channel: str  # its channels are `<channel>.fx`, `<channel>.fy`: the force of `first` on `second`

    @property
    def between(self) -> tuple[str, str]:
        """The two bodies."""
        return self.first, self.second

    @property
    def label(self) -> str:
        """What messages call it."""
        return self.channel

    def channels(self, _: "Scene") -> Iterator[Channel]:
        """Yield the force along x and along y."""
        return vector(Role.force, "pin", self.channel, quantities.PIN, self.point)


@dataclass(frozen=True)
class Guide(Joint):
    """A straight guide, and the body that slides on it."""

    equations, gaps = 2, 1

    slider: str
    slide: Slide

    @property
    def between(self) -> tuple[str, str]:
        """What has the guide, and the slider."""
        return self.slide.on, self.slider

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"the guide of {self.slider}"

    def channels(self, scene: "Scene") -> Iterator[Channel]:
        """Yield the force across the guide and the moment."""
        for quantity in quantities.GUIDE:
            name, first = f"{self.slider}.{quantity.name}", scene.bodies[self.slider].points[0]
            yield Channel(name, Role.force, "guide", self.slider, quantity, (), first)


@dataclass(frozen=True)
class DriveJoint(Joint):
    """A drive between two bodies."""

    equations = 1
    effort: ClassVar[ChannelQuantity]

    drive: Drive

    @property
    def between(self) -> tuple[str, str]:
        """What the body is driven against, and the body."""
        return self.drive.on, self.drive.body

    @property
    def label(self) -> str:
        """What messages call it."""
        return f"the drive of {self.drive.body}"

    def channels(self, scene: "Scene") -> Iterator[Channel]:
        """Yield the effort."""
        body, name = self.drive.body, self.drive.effort_channel
        yield Channel(name, Role.force, "drive", body, self.effort, (), scene.bodies[body].points[0])


class TurningDrive(DriveJoint):
    """A drive that holds the angle of one body from another: a crank's, an elbow's."""

    effort = quantities.TURNED[1]


class SlidingDrive(DriveJoint):
    """A drive that holds how far a body is along its guide: a slider's, a cylinder's."""

    effort = quantities.SLID[1]
