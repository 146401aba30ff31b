"""Springs that twist, and their dampers, at a pin between two bodies, either of which may be the ground.

The angle that twists is that of the second body less that of the first. It goes on over whole turns; at time zero it
lies within half a turn of zero, but for the drive's own angle, which is as prescribed.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, Strict

from ..bodies import GROUND
from ..errors import InputError
from ..fields import Angle, FileTable, Known, TorsionDamping, TorsionStiffness
from .attack import problems_of_attack

if TYPE_CHECKING:
    from ..scene import Scene


@dataclass(frozen=True)
class TorsionSpring:
    """The moment on its second body is -stiffness (phi - angle) - damping dphi/dt, its reaction on the first."""

    at: str  # the pin
    first: str  # body
    second: str
    stiffness: TorsionStiffness  # N m/rad
    angle: Angle  # rad: of the second body less that of the first, where there is no moment
    damping: TorsionDamping | None = None  # N m s/rad
    kind = "torsion springs"

    def moment(self, phi: Any, rate: Any) -> Any:
        """The moment on the second body, N m, at angles phi, rad, and their rates, rad/s, of any shape."""
        moment = -self.stiffness * (phi - self.angle)
        return moment if self.damping is None else moment - self.damping * rate

    def drives(self, scene: "Scene") -> int:
        """1 where the angle is the drive's own, -1 where it is that turned round, else 0."""
        pair = (scene.drive_on, scene.drive.body)
        if scene.driven_slide is not None or {self.first, self.second} != {*pair}:
            return 0
        return 1 if (self.first, self.second) == pair else -1

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield what does not fit together with the rest of the scene."""
        for body in (self.first, self.second):
            yield from problems_of_attack(scene, f"{place}.between", f"{place}.at", body, self.at, GROUND)
        if self.first == self.second:
            yield f"{place}.between: expected two bodies, found both '{self.first}'"


class TorsionSpringTable(FileTable):
    """A spring that twists, a damper, or both, at a pin."""

    at: Known = Field(description="The pin about which it twists.")
    between: Annotated[tuple[Known, Known], Strict(False)] = Field(description='Two bodies, or "ground" and a body.')
    stiffness: TorsionStiffness | None = Field(None, description="Moment by angle; none of a damper alone.")
    angle: Angle | None = Field(None, description="Without moment: the angle of the second body less the first's.")
    damping: TorsionDamping | None = Field(None, description="Moment by rate of the angle.")

    def element(self, place: str) -> TorsionSpring:
        """The spring, its numbers as they are; InputError where the keys do not go together."""
        if not self.stiffness and self.damping is None:
            found = "missing" if self.stiffness is None else "zero"
            raise InputError(f"{place}.stiffness: {found}; expected more than zero, or a 'damping'")
        if self.stiffness and self.angle is None:
            raise InputError(f"{place}.angle: missing; a spring needs its angle without moment, which may be 0")
        return TorsionSpring(self.at, *self.between, self.stiffness or 0.0, self.angle or 0.0, self.damping)
