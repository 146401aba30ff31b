"""Friction in pins and guides, by the force that the joint itself carries.

A pin of radius r turns in its hole against r sin(arctan(mu)) |R|: the line of the joint's force R touches the friction
circle (Shigley, Uicker and Pennock, Theory of Machines and Mechanisms, chapter 13). A guide's normal force N and its
moment M about the slider's first point are carried at the two ends of the contact, each with N / 2 -+ M / length, and
resist by mu (|N1| + |N2|) = mu max(|N|, 2 |M| / length), along the guide through that point.
"""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field

from ..bodies import Body
from ..errors import InputError, nearest
from ..fields import Coefficient, Damping, Known, Length, SlidingRate, TurningDamping, TurningRate
from .element import Element, ElementTable, End

if TYPE_CHECKING:
    from ..scene import Pin, Scene

AT_REST = 1e-9  # of the largest rate of all bodies, or speed of all points, at that instant: slower than that, at rest


@dataclass(frozen=True, kw_only=True)
class Friction(Element):
    """What both kinds have; by default Coulomb's, kinetic, without smoothing."""

    kind = "friction"
    by_joints = True

    coefficient: Coefficient
    smooth: float | None = None  # a rate, of tanh(rate / smooth) in place of the sign
    viscous: float | None = None  # what resists besides, by the rate

    @property
    def ends(self) -> tuple[End, ...]:
        """None of its own: it acts where its joint is."""
        return ()

    @abstractmethod
    def channel(self, scene: "Scene") -> str:
        """The channel of its moment on the pin's later body, or of its force on the slider along the guide."""

    @abstractmethod
    def joint(self, scene: "Scene") -> str:
        """What the channels of the joint are named by."""

    @abstractmethod
    def joined(self, scene: "Scene") -> tuple[str, str]:
        """The two bodies that rub: the one whose friction the channel is comes last."""

    def bodies(self, scene: "Scene") -> frozenset[str]:
        """The two bodies that rub."""
        return frozenset(self.joined(scene))

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield a sentence for each name of a joint that is none, and where the joint has friction already."""
        before = scene.friction[: int(place.rpartition(".")[2])]
        if any(self.channel(scene) == other.channel(scene) for other in before):
            yield f"{place}: the joint has friction already; expected one table a joint"

    def sense(self, rate: Any, largest: Any) -> Any:
        """The sign of a rate of a joint's parts on each other, 0 at rest; `largest` is that of the linkage."""
        if self.smooth is not None:
            return np.tanh(rate / self.smooth)
        return np.where(np.abs(rate) <= AT_REST * largest, 0.0, np.where(rate < 0, -1.0, 1.0))


@dataclass(frozen=True, kw_only=True)
class PinFriction(Friction):
    """A moment at a pin against the turning of its two bodies on each other."""

    smooth: TurningRate | None = None  # rad/s
    at: str  # the pin
    body: str | None = None  # the later of its two bodies, where three meet
    radius: Length  # m
    viscous: TurningDamping | None = None  # N m s/rad

    @property
    def arm(self) -> Any:
        """The radius of the friction circle, m."""
        # sin(arctan mu), of the friction circle, by a square root alone.
        return self.radius * self.coefficient / np.sqrt(1 + self.coefficient**2)

    def pin(self, scene: "Scene") -> "Pin":
        """The pin; of several at the point the first, unless the body is another one's."""
        return next(pin for pin in scene.pins if pin.point == self.at and self.body in (None, pin.second))

    def joint(self, scene: "Scene") -> str:
        """What the channels of the pin are named by."""
        return self.pin(scene).channel

    def channel(self, scene: "Scene") -> str:
        """The channel of the moment on the pin's later body."""
        return f"{self.joint(scene)}.friction_moment"

    def joined(self, scene: "Scene") -> tuple[str, str]:
        """The two bodies of the pin, in the order of the file."""
        pin = self.pin(scene)
        return pin.first, pin.second

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield a sentence for each name of a joint that is none, and where the joint has friction already."""
        later = [pin.second for pin in scene.pins if pin.point == self.at]
        if not later:
            yield f"{place}.at: no pin '{self.at}'{nearest(self.at, [pin.point for pin in scene.pins])}"
        if self.body is not None and self.body not in later:
            yield f"{place}.body: expected a later body at {self.at}{nearest(self.body, later)}"
        yield from super().problems(scene, place)


@dataclass(frozen=True, kw_only=True)
class GuideFriction(Friction):
    """A force along a guide against the sliding of its slider."""

    smooth: SlidingRate | None = None  # m/s
    slider: str
    length: Length  # m, of the contact, with its middle at the slider's first point
    viscous: Damping | None = None  # N s/m

    def joint(self, _: "Scene") -> str:
        """What the channels of the guide are named by."""
        return self.slider

    def channel(self, _: "Scene") -> str:
        """The channel of the force on the slider along its guide."""
        return f"{self.slider}.friction_force"

    def joined(self, scene: "Scene") -> tuple[str, str]:
        """What has the guide, and the slider."""
        return scene.slides[self.slider].on, self.slider

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield a sentence for each name of a joint that is none, and where the joint has friction already."""
        if self.slider not in scene.slides:
            yield f"{place}.slider: no body '{self.slider}' that slides{nearest(self.slider, scene.slides)}"
        yield from super().problems(scene, place)


NEEDED = {  # what the sizes of joints are for
    "radius": "the radius of the pin: its friction is at most coefficient * radius * force",
    "length": "the length of the guide's contact: its ends carry the slider's moment, which gives friction too",
}


class FrictionTable(ElementTable):
    """Friction at a pin, or in a guide.

    A pin resists by r mu / sqrt(1 + mu^2) |R|, so that the line of its force R touches the friction circle; other
    programs often take mu r |R|, which is 0.5 % more at mu = 0.1, 2 % at 0.2, 4.4 % at 0.3. A guide resists by
    mu max(|N|, 2 |M| / length), of its normal force N and its moment M about the slider's first point.
    """

    key = "friction"
    about = "Friction of pins and guides; none where absent."
    rank = 2
    kinds = (PinFriction, GuideFriction)

    at: Known | None = Field(None, description="The pin.")
    body: Known | None = Field(None, description="Of three bodies at one pin: the later one of the two that rub.")
    radius: Length | None = Field(None, description="Of the pin.")
    slider: Known | None = Field(None, description="Instead of a pin: the body that slides.")
    length: Length | None = Field(None, description="Of the guide's contact, with its middle at the first point.")
    coefficient: Coefficient = Field(description="Of Coulomb's friction.")
    viscous: Damping | None = Field(None, description="At a pin moment by rad/s; in a guide force by length a second.")
    smooth: TurningRate | None = Field(None, description="The rate, rad/s or length a second, of tanh(rate / smooth).")

    def element(self, place: str, _: Mapping[str, Body]) -> Friction:
        """The friction, its numbers as they are; InputError where the keys do not go together."""
        if (self.at is None) == (self.slider is None):
            raise InputError(f"{place}: expected either 'at', a pin, or 'slider'")
        size, others = ("radius", ["length"]) if self.slider is None else ("length", ["radius", "body"])
        for key in others:
            if getattr(self, key) is not None:
                raise InputError(f"{place}.{key}: expected '{'at' if key != 'length' else 'slider'}' with it")
        if getattr(self, size) is None:
            raise InputError(f"{place}.{size}: missing; {NEEDED[size]}")
        given = self.model_dump(exclude_none=True)
        return PinFriction(**given) if self.slider is None else GuideFriction(**given)
