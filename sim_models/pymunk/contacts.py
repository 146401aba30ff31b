"""How joints with friction rub, a rule for each type of friction: what presses, how they move, and what resists."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from numpy.typing import NDArray

from scenes import Scene
from scenes.elements.friction import Friction, GuideFriction, PinFriction
from scenes.model.motion import Samples

if TYPE_CHECKING:  # which kinds there are rules for is asked without pymunk too
    from .constraints import LinkageConstraints
    from .planes import PoseArray


class Largest(NamedTuple):
    """Of the linkage, shape (n,)."""

    turning: Samples  # rate of all bodies, rad/s
    moving: Samples  # speed of all points, m/s


class PymunkContact(ABC):
    """What one type of friction is by; `friction` is one of that type."""

    sides: bool  # whether its load is the larger of two parts; else their resultant

    @abstractmethod
    def carried(self, friction: Any, scene: Scene) -> Sequence[str]:
        """The two channels that have what the joint carries."""

    @abstractmethod
    def levers(self, friction: Any) -> tuple[float, float]:
        """What both parts of the load are times those channels."""

    @abstractmethod
    def radius(self, friction: Any) -> float:
        """What resists at a radius, m; 1 of a force."""

    @abstractmethod
    def largest(self, rates: Largest) -> Samples:
        """The largest of all rates of its kind."""

    @abstractmethod
    def direct(self, friction: Any, linkage: "LinkageConstraints", slid: NDArray[Any], d: "PoseArray") -> None:
        """Fill in what a unit of it does on all bodies and the ground, shape (n, bodies + 1, 3); `slid` by slider."""

    @abstractmethod
    def groove(self, friction: Any, linkage: "LinkageConstraints", reach: float) -> Sequence[complex]:
        """The line across a guide, by two places at a reach, m, and the point on it; none of a pin."""


class PymunkPin(PymunkContact):
    """A pin in its hole."""

    sides = False

    def carried(self, friction: PinFriction, scene: Scene) -> Sequence[str]:
        """Both components of the force."""
        return scene.channels.pins[friction.joint(scene)]

    def levers(self, friction: PinFriction) -> tuple[float, float]:  # noqa: ARG002
        """The components of the force count as they are."""
        return 1, 1

    def radius(self, friction: PinFriction) -> float:
        """The radius of the pin."""
        return friction.radius

    def largest(self, rates: Largest) -> Samples:
        """The largest rate of all bodies."""
        return rates.turning

    def direct(self, friction: PinFriction, linkage: "LinkageConstraints", slid: NDArray[Any], d: "PoseArray") -> None:  # noqa: ARG002
        """Turn both bodies."""
        first, second = friction.joined(linkage.scene)
        d[:, linkage.index[second], 2], d[:, linkage.index[first], 2] = 1, -1

    def groove(self, friction: PinFriction, linkage: "LinkageConstraints", reach: float) -> Sequence[complex]:  # noqa: ARG002
        """A pin has no guide."""
        return ()


class PymunkGuide(PymunkContact):
    """A slider in its guide, which touches at both ends of the contact."""

    sides = True

    def carried(self, friction: GuideFriction, scene: Scene) -> Sequence[str]:
        """The normal force and the moment."""
        return scene.channels.guides[friction.slider]

    def levers(self, friction: GuideFriction) -> tuple[float, float]:
        """N and 2 M / length."""
        return 1, 2 / friction.length

    def radius(self, friction: GuideFriction) -> float:  # noqa: ARG002
        """One: friction in a guide is a force."""
        return 1.0

    def largest(self, rates: Largest) -> Samples:
        """The largest speed of all points."""
        return rates.moving

    def direct(
        self, friction: GuideFriction, linkage: "LinkageConstraints", slid: NDArray[Any], d: "PoseArray"
    ) -> None:
        """Push both bodies along the guide."""
        d[:] = slid[:, [*linkage.slides].index(friction.slider)]

    def groove(self, friction: GuideFriction, linkage: "LinkageConstraints", reach: float) -> Sequence[complex]:
        """Across the guide through the slider's first point."""
        middle, across = linkage.through(friction.slider), 2j * reach * complex(*linkage.slides[friction.slider].along)
        return middle - across, middle + across, linkage.first_arm(friction.slider)


CONTACTS: Mapping[type[Friction], PymunkContact] = {PinFriction: PymunkPin(), GuideFriction: PymunkGuide()}
