"""Springs and dampers between two bodies, either of which may be the ground: of points, and that twist at a pin.

The angle that twists is that of the second body less that of the first. It goes on over whole turns; at time zero it
lies within half a turn of zero, but for the drive's own angle, which is as prescribed.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field, Strict

from ..errors import InputError
from ..fields import Angle, BodyPoint, Damping, FileTable, Known, RestLength, Stiffness, TwistDamping, TwistStiffness

if TYPE_CHECKING:
    from ..scene import Scene


@dataclass(frozen=True)
class Spring:
    """It pulls with stiffness (distance - length) + damping d(distance)/dt along the line of its ends."""

    first: tuple[str, str]  # body, point
    second: tuple[str, str]
    stiffness: Stiffness  # N/m
    length: RestLength  # m, without force
    damping: Damping | None = None  # N s/m

    @property
    def kind(self) -> str:
        """What it is, as an engine names what it knows."""
        return "springs" if self.damping is None else "dampers"

    @property
    def needs_direction(self) -> bool:
        """Whether it has no force where its ends meet: of a spring without length that is zero."""
        return bool(np.any(self.length)) or self.damping is not None


@dataclass(frozen=True)
class TorsionSpring:
    """The moment on its second body is -stiffness (phi - angle) - damping dphi/dt, its reaction on the first."""

    at: str  # the pin
    first: str  # body
    second: str
    stiffness: TwistStiffness  # N m/rad
    angle: Angle  # rad, without moment
    damping: TwistDamping | None = None  # N m s/rad
    kind = "torsion springs"

    def moment(self, phi: Any, rate: Any) -> Any:
        """The moment on the second body, N m, at angles phi, rad, and their rates, rad/s, of any shape."""
        moment = -self.stiffness * (phi - self.angle)
        return moment if self.damping is None else moment - self.damping * rate

    def drives(self, scene: "Scene") -> int:
        """1 where the angle is the drive's own, -1 where it is that turned round, else 0."""
        pair = (scene.drive.on, scene.drive.body)
        if scene.drive.slide is not None or {self.first, self.second} != {*pair}:
            return 0
        return 1 if (self.first, self.second) == pair else -1


class SpringTable(FileTable):
    """A linear spring, a damper, or both, between two points."""

    between: Annotated[tuple[BodyPoint, BodyPoint], Strict(False)] = Field(
        description='Each as "body.point", or "ground.S".'
    )
    stiffness: Stiffness | None = Field(None, description="Force by length; none of a damper alone.")
    length: RestLength | None = Field(None, description="Its length without force; 0 for one that always pulls.")
    damping: Damping | None = Field(None, description="Force by rate of the length, as N s/m.")

    def element(self, place: str) -> Spring:
        """The spring, its numbers as they are; InputError where the keys do not go together."""
        _check_keys(self, place, "length", "force")
        first, second = ((body, point) for body, _, point in (text.partition(".") for text in self.between))
        return Spring(first, second, self.stiffness or 0.0, self.length or 0.0, self.damping)


class TorsionSpringTable(FileTable):
    """A spring that twists, a damper, or both, at a pin."""

    at: Known = Field(description="The pin about which it twists.")
    between: Annotated[tuple[Known, Known], Strict(False)] = Field(description='Two bodies, or "ground" and a body.')
    stiffness: TwistStiffness | None = Field(None, description="Moment by angle; none of a damper alone.")
    angle: Angle | None = Field(None, description="Without moment: the angle of the second body less the first's.")
    damping: TwistDamping | None = Field(None, description="Moment by rate of the angle.")

    def element(self, place: str) -> TorsionSpring:
        """The spring, its numbers as they are; InputError where the keys do not go together."""
        _check_keys(self, place, "angle", "moment")
        return TorsionSpring(self.at, *self.between, self.stiffness or 0.0, self.angle or 0.0, self.damping)


def _check_keys(table: SpringTable | TorsionSpringTable, place: str, rest: str, effort: str) -> None:
    if not table.stiffness and table.damping is None:
        found = "missing" if table.stiffness is None else "zero"
        raise InputError(f"{place}.stiffness: {found}; expected more than zero, or a 'damping'")
    if table.stiffness and getattr(table, rest) is None:
        raise InputError(f"{place}.{rest}: missing; a spring needs its {rest} without {effort}, which may be 0")
