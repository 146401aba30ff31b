"""How joints with friction rub, a rule for each type of friction: what they carry, and where friction acts."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scenes.bodies import GROUND
from scenes.elements.friction import Friction, GuideFriction, PinFriction

if TYPE_CHECKING:  # which kinds there are rules for is asked without Exudyn too
    from .system import ExudynSystem

Array = NDArray[np.float64]
TURN = 2  # of x, y and the angle of a body


class ExudynContact(ABC):
    """What one type of friction is by; `friction` is one of that type."""

    round: bool  # whether its load is the resultant of two parts; else the larger one

    @abstractmethod
    def lever(self, friction: Any) -> float:
        """What the coefficient times the load is a moment about, m; 1 of a force."""

    @abstractmethod
    def carried(self, friction: Any, system: "ExudynSystem", forces: Mapping[str, Array]) -> list[Array]:
        """Both parts of its load, N, from the channels of forces."""

    @abstractmethod
    def direct(self, friction: Any, system: "ExudynSystem", q: Array, B: Array) -> None:
        """Fill in what turns or slides on the coordinates q by a unit of it, both of shape (n, 3 bodies)."""


class ExudynPinContact(ExudynContact):
    """A pin in its hole."""

    round = True

    def lever(self, friction: PinFriction) -> float:
        """The radius of the pin."""
        return friction.radius

    def carried(self, friction: PinFriction, system: "ExudynSystem", forces: Mapping[str, Array]) -> list[Array]:
        """The force of the pin."""
        return [forces[name] for name in system.scene.channels.pins[friction.joint(system.scene)]]

    def direct(self, friction: PinFriction, system: "ExudynSystem", q: Array, B: Array) -> None:  # noqa: ARG002
        """Turn both bodies."""
        for body, sign in zip(friction.joined(system.scene), (-1, 1), strict=True):
            if body != GROUND:
                B[:, 3 * [*system.bodies].index(body) + TURN] = sign


class ExudynGuideContact(ExudynContact):
    """A slider in its guide, which touches at both ends of the contact."""

    round = False

    def lever(self, friction: GuideFriction) -> float:  # noqa: ARG002
        """One: friction in a guide is a force."""
        return 1.0

    def carried(self, friction: GuideFriction, system: "ExudynSystem", forces: Mapping[str, Array]) -> list[Array]:
        """N and 2 M / length."""
        force, moment = system.scene.channels.guides[friction.slider]
        return [forces[force], forces[moment] * (2 / friction.length)]

    def direct(self, friction: GuideFriction, system: "ExudynSystem", q: Array, B: Array) -> None:
        """Push both bodies along the guide, at the slider's first point."""
        on, slider = friction.joined(system.scene)
        (com, angle), (_, turn) = system.pose_of(slider, q), system.pose_of(on, q)
        # A column of B is what a unit of friction does in generalised forces: along the guide by x and y, and by the
        # turning angle the moment of that force about the body's centre of mass, (arm x force). With it the virtual
        # power of friction is the force times the rate of sliding.
        along = system.along(slider) * np.exp(1j * (turn + 0 * angle))
        first = com + system.lever(slider) * np.exp(1j * angle)
        for body, sign in ((on, -1), (slider, 1)):
            if body != GROUND:
                turns = ((first - system.pose_of(body, q)[0]).conjugate() * along).imag
                number = 3 * [*system.bodies].index(body)
                B[:, number : number + 3] = sign * np.stack([along.real, along.imag, turns], axis=1)


CONTACTS: Mapping[type[Friction], ExudynContact] = {
    PinFriction: ExudynPinContact(),
    GuideFriction: ExudynGuideContact(),
}
