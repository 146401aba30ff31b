"""How joints with friction rub, a rule for each type of friction: what they carry, how they move, what resists there.

What a joint carries is a plane vector X, by whose size its friction goes: a pin's force; of a guide its normal force N
and, across it, twice its moment M over the contact's length.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import reduce
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from scenes.bodies import GROUND
from scenes.elements.friction import Friction, GuideFriction, PinFriction

from .dyads import dot
from .elements import ActingForce
from .numbers import chosen, samples

if TYPE_CHECKING:
    from .rubbing_joints import FrictionBalance

TINY = 1e-300  # N, which changes no load but none
Unit: TypeAlias = Mapping[str, ActingForce]  # what one unit of a friction does, by body


class RubbingContact(ABC):
    """What one type of friction is by; `friction` is one of that type."""

    @abstractmethod
    def factor(self, friction: Any, mu: Any) -> Any:
        """Friction over the load's size |X| at a coefficient: the radius of the friction circle, m, or that itself."""

    @abstractmethod
    def size(self, X: Any) -> Any:
        """The size |X| of a load."""

    @abstractmethod
    def gradient(self, X: Any, size: Any) -> Any:
        """The direction in which the size grows, a unit vector; any where there is no load."""

    @abstractmethod
    def first_known(self, friction: Any, balance: "FrictionBalance", group_of: Mapping[str, int]) -> int:
        """The number of the group with which the joint's force is known, given that of each body."""

    @abstractmethod
    def motion(self, friction: Any, balance: "FrictionBalance") -> tuple[Any, Any]:
        """How fast the joint's parts move on each other, and the largest such rate in the linkage."""

    @abstractmethod
    def unit(self, friction: Any, balance: "FrictionBalance") -> Unit:
        """What a unit of friction does on the later body that rubs, and its reaction on the other."""

    @abstractmethod
    def load(self, friction: Any, balance: "FrictionBalance") -> Any:
        """The load X."""


class RubbingPin(RubbingContact):
    """A pin in its hole."""

    def factor(self, friction: PinFriction, mu: Any) -> Any:
        """The radius of the friction circle."""
        # r sin(arctan mu): the resultant of the pin's pressure and friction is tangent to the circle of this radius.
        return friction.radius * mu / np.sqrt(1 + mu * mu)

    def size(self, X: Any) -> Any:
        """The size of the force."""
        return np.abs(X)

    def gradient(self, X: Any, size: Any) -> Any:
        """The direction of the force."""
        return X / (size + TINY)

    def first_known(self, friction: PinFriction, balance: "FrictionBalance", group_of: Mapping[str, int]) -> int:
        """The group of the pin's later body; where that body carries the pin, of the first body that hangs on it."""
        pin = friction.pin(balance.scene)
        # The pin's force on its later body is known as soon as that body's group is balanced. If that body carries the
        # pin, its force follows from the bodies that hang on it, the last of which is balanced with the lowest number.
        carrier = next((body for body, points in balance.linkage.carries.items() if pin.point in points), GROUND)
        others = [body for body in balance.scene.owners[pin.point] if body != pin.second]
        return min(group_of[body] for body in others) if pin.second == carrier else group_of[pin.second]

    def motion(self, friction: PinFriction, balance: "FrictionBalance") -> tuple[Any, Any]:
        """The rate of the later body against the first, rad/s."""
        omega, (first, second) = balance.k.omega, friction.joined(balance.scene)
        return omega[second] - omega[first], balance.fastest[0]

    def unit(self, friction: PinFriction, balance: "FrictionBalance") -> Unit:
        """A moment of 1 N m."""
        (first, second), no_force, place = friction.joined(balance.scene), samples(0j), balance.k.z[friction.at]
        return {
            second: ActingForce(no_force, place, samples(1.0)),
            first: ActingForce(no_force, place, samples(-1.0)),
        }

    def load(self, friction: PinFriction, balance: "FrictionBalance") -> Any:
        """The force of the pin on its later body."""
        pins, (_, second) = balance.reactions.pin, friction.joined(balance.scene)
        others = (pins[friction.at, body] for body in balance.scene.owners[friction.at] if (friction.at, body) in pins)
        return pins[friction.at, second] if (friction.at, second) in pins else -reduce(np.add, others)


class RubbingGuide(RubbingContact):
    """A slider in its guide, which touches at both ends of the contact."""

    def factor(self, friction: GuideFriction, mu: Any) -> Any:  # noqa: ARG002
        """The coefficient."""
        return mu

    def size(self, X: Any) -> Any:
        """The larger of the two parts, as the ends carry N / 2 -+ M / length."""
        return np.maximum(np.abs(X.real), np.abs(X.imag))

    def gradient(self, X: Any, size: Any) -> Any:  # noqa: ARG002
        """The direction of the larger part."""
        # max(|x|, |y|) has no gradient where |x| = |y|: there the slider's end changes that carries all. Newton's
        # method takes either side's.
        along, across = (chosen(part < 0, -1.0, 1.0) for part in (X.real, X.imag))
        return chosen(np.abs(X.real) < np.abs(X.imag), 1j * across, along)

    def first_known(self, friction: GuideFriction, balance: "FrictionBalance", group_of: Mapping[str, int]) -> int:
        """The group of the later of slider and carrier."""
        return max(group_of[body] for body in friction.joined(balance.scene))

    def motion(self, friction: GuideFriction, balance: "FrictionBalance") -> tuple[Any, Any]:
        """The rate of the slider's first point along the guide, m/s."""
        k, first, (on, _) = balance.k, balance.scene.bodies[friction.slider].points[0], friction.joined(balance.scene)
        # The velocity of the carrier's own point that is just under the slider's: what is left is sliding.
        carried = 0.0 if on == GROUND else k.v[k.foot[on]] + 1j * k.omega[on] * (k.z[first] - k.z[k.foot[on]])
        return dot(balance.guide(friction.slider)[0], k.v[first] - carried), balance.fastest[1]

    def unit(self, friction: GuideFriction, balance: "FrictionBalance") -> Unit:
        """A force of 1 N along the guide."""
        (along, _), (on, slider) = balance.guide(friction.slider), friction.joined(balance.scene)
        first = balance.k.z[balance.scene.bodies[slider].points[0]]
        return {slider: ActingForce(along, first), on: ActingForce(-along, first)}

    def load(self, friction: GuideFriction, balance: "FrictionBalance") -> Any:
        """N and 2 M / length."""
        N, M = balance.reactions.guide[friction.slider]
        return N + 1j * (M * (2 / friction.length))


CONTACTS: Mapping[type[Friction], RubbingContact] = {PinFriction: RubbingPin(), GuideFriction: RubbingGuide()}
