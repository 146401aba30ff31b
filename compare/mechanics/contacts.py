"""How joints with friction rub, as the judge has it: a rule for each type of friction."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from math import atan, sin
from typing import Any

import numpy as np

from scenes import Scene
from scenes.elements.friction import Friction, GuideFriction, PinFriction
from scenes.model.motion import Samples

from .motion_vectors import MotionVectors


class JudgedContact(ABC):
    """What one type of friction is by; `friction` is one of that type."""

    turns: bool  # whether its parts turn on each other, else they slide
    joint: str  # what sentences call the joint, with a gap for its place
    linear: str  # the number in which it is linear, and from which its coefficient cannot be told
    others: Mapping[str, str] = {}  # by what sentences call them, its other numbers

    @abstractmethod
    def rate(self, friction: Any, state: MotionVectors) -> Samples:
        """How fast the parts of the joint move on each other."""

    @abstractmethod
    def load(self, friction: Any, scene: Scene, forces: Mapping[str, Samples]) -> Samples:
        """What the friction goes by, N, from channels of forces."""

    @abstractmethod
    def coefficient(self, friction: Any) -> float:
        """Friction by its load, m or 1."""

    @abstractmethod
    def share(self, friction: Any, size: float) -> float:
        """By how much a newton more in every joint of a linkage of a size, m, is more of the load."""


class JudgedPinContact(JudgedContact):
    """A pin in its hole."""

    turns = True
    joint = "the pin {place}"
    linear = "radius"

    def rate(self, friction: PinFriction, state: MotionVectors) -> Samples:
        """The rate of the later body against the first, rad/s."""
        first, second = friction.joined(state.scene)
        return state.turning(second)[1] - state.turning(first)[1]

    def load(self, friction: PinFriction, scene: Scene, forces: Mapping[str, Samples]) -> Samples:
        """The force of the pin."""
        return np.asarray(np.hypot(*(forces[name] for name in scene.channels.pins[friction.joint(scene)])))

    def coefficient(self, friction: PinFriction) -> float:
        """The radius of the friction circle."""
        return friction.radius * sin(atan(friction.coefficient))

    def share(self, friction: PinFriction, size: float) -> float:  # noqa: ARG002
        """One newton of load for each in the joint."""
        return 1.0


class JudgedGuideContact(JudgedContact):
    """A slider in its guide, which touches at both ends of the contact."""

    turns = False
    joint = "{place}'s guide"
    linear = "coefficient"
    others = {"length of contact": "length"}  # noqa: RUF012

    def rate(self, friction: GuideFriction, state: MotionVectors) -> Samples:
        """The rate of the slider along its guide, m/s."""
        return state.sliding(state.scene.bodies[friction.slider])

    def load(self, friction: GuideFriction, scene: Scene, forces: Mapping[str, Samples]) -> Samples:
        """What both ends of the contact carry."""
        # The couple M is carried by a pair of forces M / length at both ends, of opposite signs; the normal force by
        # halves. The sum of both sizes is max(|N|, 2 |M| / length), which the model that is judged may well use
        # instead.
        normal, couple = (forces[name] for name in scene.channels.guides[friction.slider])
        return np.asarray(np.abs(normal / 2 - couple / friction.length) + np.abs(normal / 2 + couple / friction.length))

    def coefficient(self, friction: GuideFriction) -> float:
        """The coefficient of friction."""
        return friction.coefficient

    def share(self, friction: GuideFriction, size: float) -> float:
        """One newton of load by the normal force, and the newtons of the couple at both ends."""
        return 1 + 2 * size / friction.length


CONTACTS: Mapping[type[Friction], JudgedContact] = {
    PinFriction: JudgedPinContact(),
    GuideFriction: JudgedGuideContact(),
}
