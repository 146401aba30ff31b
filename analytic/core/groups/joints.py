"""The joints of a larger group, a kind a class: its equations between two frames, and what it does to the bodies.

A frame is that of a body of the group, of a placed body, the ground or a placed point that the group hangs on, or one
that stands for a drive. An equation is a component of the way from a place in one frame to a place in another, or a sum
of angles of frames; `GroupEquations` takes all of a group at once.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeAlias

import scenes.joints
from scenes import Scene
from scenes.bodies import GROUND
from scenes.joints import Guide, Joint, Pin, SlidingDrive, TurningDrive

from ..geometry import as_complex
from ..numbers import Vector, samples

if TYPE_CHECKING:
    from ..kinetostatics import Balance

Arm: TypeAlias = Callable[[str, Vector], Vector]  # of a place in a body's frame, m, from the body's first point


class Part(IntEnum):
    """What an equation of a joint holds; a group has its equations in this order, and then in that of its joints."""

    x = 0
    y = 1
    across = 2  # offset from a guide
    turn = 3
    along = 4  # displacement along a guide


GAPS = (Part.x, Part.y, Part.across)  # lengths by which a joint is open


class Way(NamedTuple):
    """From a place in one frame to a place in another; where the first has a guide, along that and across it."""

    start: tuple[str, Vector]  # frame, and arm there, m
    end: tuple[str, Vector]
    along: Vector | None = None  # unit


@dataclass(frozen=True)
class GroupJoint(ABC):
    """A joint between `body`, and `on`."""

    declared: ClassVar[type[Joint]]  # what it is in a scene
    parts: ClassVar[tuple[Part, ...]]
    body: str

    @classmethod
    @abstractmethod
    def among(cls, scene: Scene, bodies: Sequence[str], placed: frozenset[str]) -> "Iterator[GroupJoint]":
        """Yield the joints of this kind that bodies have as a group; `placed` are bodies, the ground among them."""

    @property
    @abstractmethod
    def frames(self) -> tuple[str, ...]:
        """The frames that it is between: a body's name, a point's after a dot, that of a drive's body after a slash."""

    @property
    def label(self) -> str:
        """What messages call it where it stays open; nothing where it does not."""
        return ""

    def way(self, scene: Scene, local: Mapping[str, Mapping[str, Vector]], arm: Arm) -> Way | None:  # noqa: ARG002
        """The way that its equations hold, by the places of the bodies' points, if they hold one."""
        return None

    @property
    def turns(self) -> Mapping[str, float]:
        """How often it counts the angle of each frame in the sum that it holds at whole turns, if it holds one."""
        return {}

    @abstractmethod
    def act(self, balance: "Balance", bodies: Sequence[str], *multipliers: Any) -> None:
        """Pass on what it does, by the multipliers of its equations, to a balance of a group's bodies."""


@dataclass(frozen=True)
class PinJoint(GroupJoint):
    """A pin: at `point`, `body` hangs on the body `on` of the group, or on a placed point (None).

    Of the bodies of a group that name a point, all hang on the first.
    """

    declared = Pin
    parts = (Part.x, Part.y)
    on: str | None
    point: str

    @classmethod
    def among(cls, scene: Scene, bodies: Sequence[str], placed: frozenset[str]) -> Iterator[GroupJoint]:
        """Yield the pins, body after body."""
        # A pin of n bodies has n - 1 joints, all with the same partner: the placed point where there is one, else the
        # first body of the group that names the point. So no closed loop of joints at one point makes an equation
        # superfluous.
        first: dict[str, str | None] = {}
        for body in bodies:
            for point in scene.bodies[body].points:
                if point not in first and not placed.isdisjoint(scene.owners[point]):
                    first[point] = None
                if point in first:
                    yield cls(body, first[point], point)
                first.setdefault(point, body)

    @property
    def frames(self) -> tuple[str, ...]:
        """The bodies; or the body and the placed point."""
        return self.body, self.on or f".{self.point}"

    @property
    def label(self) -> str:
        """The point."""
        return self.point

    def way(self, _: Scene, local: Mapping[str, Mapping[str, Vector]], arm: Arm) -> Way:
        """From the point of what it hangs on to that of the body."""
        body, other = self.frames
        start = 0 if self.on is None else arm(other, local[other][self.point])
        return Way((other, start), (body, arm(body, local[body][self.point])))

    def act(self, balance: "Balance", _: Sequence[str], *multipliers: Any) -> None:
        """Hold the body by a force along x and one along y."""
        x, y = multipliers
        balance.hold(self.body, self.point, x + 1j * y)
        if self.on is not None:
            balance.hold(self.on, self.point, -(x + 1j * y))


@dataclass(frozen=True)
class GuideJoint(GroupJoint):
    """A guide: `body` slides on the body `on`, either of which may be placed."""

    declared = Guide
    parts = (Part.across, Part.turn)
    on: str

    @classmethod
    def among(cls, scene: Scene, bodies: Sequence[str], placed: frozenset[str]) -> Iterator[GroupJoint]:
        """Yield the guides in the order of the file."""
        return (cls(name, slide.on) for name, slide in scene.slides.items() if _joins((name, slide.on), bodies, placed))

    @property
    def frames(self) -> tuple[str, ...]:
        """The slider, and what has the guide."""
        return self.body, self.on

    @property
    def label(self) -> str:
        """Whose guide it is."""
        return f"the guide of {self.body}"

    def way(self, scene: Scene, _: Mapping[str, Mapping[str, Vector]], arm: Arm) -> Way:
        """From the guide's point to the slider's first."""
        slide = scene.slides[self.body]
        return Way((self.on, arm(self.on, as_complex(slide.through))), (self.body, 0), as_complex(slide.along))

    @property
    def turns(self) -> Mapping[str, float]:
        """The slider does not turn against the guide."""
        return {self.body: 1, self.on: -1}

    def act(self, balance: "Balance", bodies: Sequence[str], *multipliers: Any) -> None:
        """Hold the slider by a force across the guide, and a moment."""
        # The multiplier of an equation is the generalised force along what it measures: of the offset across the guide
        # a force in that direction, of the angle a moment.
        balance.reactions.guide[self.body] = force, moment = multipliers
        balance.pass_on(self.frames[:2], bodies, force * (1j * _direction(balance, self)), moment)


@dataclass(frozen=True)
class GroupDrive(GroupJoint):
    """A drive of `body` against the body `on`."""

    declared: ClassVar[type[scenes.joints.DriveJoint]]
    on: str

    @classmethod
    def among(cls, scene: Scene, bodies: Sequence[str], placed: frozenset[str]) -> Iterator[GroupJoint]:
        """Yield the drives between moving bodies."""
        drives = (joint.drive for joint in scene.joints if isinstance(joint, cls.declared))
        ends = ((drive.body, drive.on) for drive in drives)
        return (cls(*pair) for pair in ends if GROUND not in pair and _joins(pair, bodies, placed))

    @property
    def frames(self) -> tuple[str, ...]:
        """The bodies, and that which stands for the drive: its x, m, and its angle are the drive's position."""
        return self.body, self.on, f"/{self.body}"


@dataclass(frozen=True)
class TurningJoint(GroupDrive):
    """A drive that turns `body` against `on`."""

    parts = (Part.turn,)
    declared = TurningDrive

    @property
    def turns(self) -> Mapping[str, float]:
        """The body's angle from that of the other is the drive's position."""
        return dict(zip(self.frames, (1, -1, -1), strict=True))

    def act(self, balance: "Balance", bodies: Sequence[str], *multipliers: Any) -> None:
        """Turn both by a torque."""
        (balance.reactions.effort,) = multipliers
        balance.pass_on(self.frames[:2], bodies, samples(0j), balance.reactions.effort)


@dataclass(frozen=True)
class SlidingJoint(GroupDrive):
    """A drive that moves `body` along its guide on `on`."""

    parts = (Part.along,)
    declared = SlidingDrive

    def act(self, balance: "Balance", bodies: Sequence[str], *multipliers: Any) -> None:
        """Push both along the guide."""
        (balance.reactions.effort,) = multipliers
        balance.pass_on(self.frames[:2], bodies, balance.reactions.effort * _direction(balance, self), samples(0.0))


# A group has its joints in this order.
KINDS: tuple[type[GroupJoint], ...] = (PinJoint, GuideJoint, TurningJoint, SlidingJoint)


def _joins(pair: tuple[str, str], bodies: Sequence[str], placed: frozenset[str]) -> bool:
    return placed.union(bodies).issuperset(pair) and not {*bodies}.isdisjoint(pair)


def _direction(balance: "Balance", joint: GuideJoint | SlidingJoint) -> Any:
    """The direction of the guide of a joint's body in the plane."""
    return balance.k.u[joint.on] * as_complex(balance.scene.slides[joint.body].along)
