"""Springs and dampers between two bodies, either of which may be the ground: of points, and that twist at a pin.

The angle that twists is that of the second body less that of the first. It goes on over whole turns; at time zero it
lies within half a turn of zero, but for the drive's own angle, which is as prescribed.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field, Strict

from ..bodies import Body
from ..errors import InputError
from ..fields import Angle, BodyPoint, Damping, Known, RestLength, Stiffness, TwistDamping, TwistStiffness
from .element import Element, ElementTable, End

if TYPE_CHECKING:
    from ..scene import Scene

NEITHER = "has neither stiffness nor damping"
Between = Annotated[tuple[BodyPoint, BodyPoint], Strict(False)]
BETWEEN = 'Each as "body.point", or "ground.S".'


@dataclass(frozen=True)
class PointPair(Element):
    """What acts along the line between two points of different bodies."""

    noun = "spring"

    first: End  # body, point
    second: End

    @property
    def ends(self) -> tuple[End, End]:
        """Both ends."""
        return self.first, self.second

    @property
    def needs_direction(self) -> bool:
        """Whether it has no force where its ends meet."""
        return True

    @property
    def label(self) -> str:
        """Its name among all that acts."""
        return f"the {self.noun} between {' and '.join('.'.join(end) for end in self.ends)}"

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield what of its names does not fit the scene, and that its ends are one point."""
        yield from super().problems(scene, place)
        if self.first[1] == self.second[1]:
            yield f"{place}.between: {self.first[1]} is the same point of both bodies"


class Undamped:
    """What has no damping, unless a subclass has."""

    damping: float | None = None


@dataclass(frozen=True)
class Spring(PointPair, Undamped):
    """It pulls with stiffness (distance - length) along the line of its ends."""

    kind = "springs"
    plain = True

    stiffness: Stiffness  # N/m
    length: RestLength  # m, without force

    @property
    def needs_direction(self) -> bool:
        """Whether it has no force where its ends meet: of a spring without length that is zero."""
        return bool(np.any(self.length)) or self.damping is not None

    @property
    def least_above_zero(self) -> Mapping[str, str]:
        """The stiffness, where there is no damping."""
        return {"stiffness": NEITHER} if self.damping is None else {}

    def strength(self, size: float, rate: float) -> float:
        """That of a change by all of the linkage."""
        return self.stiffness * size + (self.damping or 0.0) * size * rate


@dataclass(frozen=True)
class Damper(Spring):
    """A spring that pulls with damping d(distance)/dt besides."""

    kind = "dampers"
    plain = False

    damping: Damping = field()  # N s/m


@dataclass(frozen=True)
class TorsionSpring(Element):
    """The moment on its second body is -stiffness (phi - angle) - damping dphi/dt, its reaction on the first."""

    kind = "torsion springs"
    point_key = "at"
    noun = "torsion spring"

    at: str  # the pin
    first: str  # body
    second: str
    stiffness: TwistStiffness  # N m/rad
    angle: Angle  # rad, without moment
    damping: TwistDamping | None = None  # N m s/rad

    @property
    def ends(self) -> tuple[End, End]:
        """The pin's point on both bodies."""
        return (self.first, self.at), (self.second, self.at)

    @property
    def label(self) -> str:
        """Its name among all that acts."""
        return f"the torsion spring at {self.at}"

    @property
    def least_above_zero(self) -> Mapping[str, str]:
        """The stiffness, where there is no damping."""
        return {"stiffness": NEITHER} if self.damping is None else {}

    def strength(self, size: float, rate: float) -> float:
        """That of a turn by one radian from where it is at rest, on an arm as long as the linkage."""
        return (self.stiffness * (1 + abs(self.angle)) + (self.damping or 0.0) * rate) / size

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


def ends_of(between: tuple[str, str]) -> tuple[End, End]:
    """Both ends, each from its text, as `body.point`."""
    first, second = ((body, point) for body, _, point in (text.partition(".") for text in between))
    return first, second


class SpringTable(ElementTable):
    """A linear spring, a damper, or both, between two points."""

    key = "springs"
    about = "Linear springs and dampers between two points."
    rank = 0
    kinds = (Spring, Damper)
    zeros = ("length",)

    between: Between = Field(description=BETWEEN)
    stiffness: Stiffness | None = Field(None, description="Force by length; none of a damper alone.")
    length: RestLength | None = Field(None, description="Its length without force; 0 for one that always pulls.")
    damping: Damping | None = Field(None, description="Force by rate of the length, as N s/m.")

    def element(self, place: str, _: Mapping[str, Body]) -> Spring:
        """The spring, its numbers as they are; InputError where the keys do not go together."""
        _check_keys(self, place, "length", "force")
        given = *ends_of(self.between), self.stiffness or 0.0, self.length or 0.0
        return Spring(*given) if self.damping is None else Damper(*given, self.damping)


class TorsionSpringTable(ElementTable):
    """A spring that twists, a damper, or both, at a pin."""

    key = "torsion_springs"
    about = "Springs and dampers that twist, at a pin."
    rank = 1
    kinds = (TorsionSpring,)
    zeros = ("angle",)

    at: Known = Field(description="The pin about which it twists.")
    between: Annotated[tuple[Known, Known], Strict(False)] = Field(description='Two bodies, or "ground" and a body.')
    stiffness: TwistStiffness | None = Field(None, description="Moment by angle; none of a damper alone.")
    angle: Angle | None = Field(None, description="Without moment: the angle of the second body less the first's.")
    damping: TwistDamping | None = Field(None, description="Moment by rate of the angle.")

    def element(self, place: str, _: Mapping[str, Body]) -> TorsionSpring:
        """The spring, its numbers as they are; InputError where the keys do not go together."""
        _check_keys(self, place, "angle", "moment")
        return TorsionSpring(self.at, *self.between, self.stiffness or 0.0, self.angle or 0.0, self.damping)


def _check_keys(table: SpringTable | TorsionSpringTable, place: str, rest: str, effort: str) -> None:
    if not table.stiffness and table.damping is None:
        found = "missing" if table.stiffness is None else "zero"
        raise InputError(f"{place}.stiffness: {found}; expected more than zero, or a 'damping'")
    if table.stiffness and getattr(table, rest) is None:
        raise InputError(f"{place}.{rest}: missing; a spring needs its {rest} without {effort}, which may be 0")
