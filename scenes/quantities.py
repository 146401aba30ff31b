"""What a channel is: its role, what it is of, and its quantity with unit, group of errors and order."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Literal, NamedTuple, TypeAlias

TIME = "time"
TRANSMISSION = "transmission"  # the least angle of all dyads
TO_LOCK = "to_lock"
POWER = "friction.power"


class ChannelQuantity(NamedTuple):
    """What a channel measures; those of one name have one unit."""

    name: str
    unit: str
    group: str = ""  # in which errors are judged; none of the time
    order: int | None = None  # of the derivative that a channel of the motion is: 0 of a place, 1, 2
    axis: str = ""  # x or y of a vector's component
    modulo_turn: bool = False


POINT = tuple(
    ChannelQuantity(f"{letter}{axis}", unit, group, order, axis)
    for order, (letter, unit, group) in enumerate(
        (("", "m", "position"), ("v", "m/s", "velocity"), ("a", "m/s^2", "acceleration"))
    )
    for axis in "xy"
)
BODY = (
    ChannelQuantity("angle", "rad", "position", 0, modulo_turn=True),
    ChannelQuantity("omega", "rad/s", "velocity", 1),
    ChannelQuantity("alpha", "rad/s^2", "acceleration", 2),
)
PIN = ChannelQuantity("fx", "N", "reaction", axis="x"), ChannelQuantity("fy", "N", "reaction", axis="y")
GUIDE_AXES = (
    ChannelQuantity("guide_fx", "N", "reaction", axis="x"),
    ChannelQuantity("guide_fy", "N", "reaction", axis="y"),
)
GUIDE = ChannelQuantity("guide_force", "N", "reaction"), ChannelQuantity("guide_moment", "N*m", "reaction")
INSTANT = ChannelQuantity(TIME, "s")
TURNED = ChannelQuantity("crank_angle", "rad", "drive", 0), ChannelQuantity("torque", "N*m", "torque")
SLID = ChannelQuantity("displacement", "m", "drive", 0), ChannelQuantity("force", "N", "force")
RUBBING_PIN, RUBBING_GUIDE = (
    ChannelQuantity("friction_moment", "N*m", "reaction"),
    ChannelQuantity("friction_force", "N", "reaction"),
)
LOST = ChannelQuantity("power", "W", "reaction")
GROUP = ChannelQuantity(TRANSMISSION, "rad", "position"), ChannelQuantity(TO_LOCK, "m", "position")
RATES = ChannelQuantity("speed", "m/s", "velocity", 1), ChannelQuantity("acceleration", "m/s^2", "acceleration", 2)
LENGTH_OF_FORCE = ChannelQuantity("force", "N", "reaction")
QUANTITIES = (INSTANT, *POINT, *BODY, *PIN, *GUIDE, *TURNED, *SLID, RUBBING_PIN, RUBBING_GUIDE, LOST)
QUANTITIES += (*GROUP, *RATES)
_BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}
# Of the units that a file may name; the others are SI in files too.
DIMENSIONS = {"m": "length", "rad": "angle", "N": "force", "N*m": "moment", "m/s": "sliding_rate"}


def named(column: str) -> ChannelQuantity:
    """What a column measures, `P5.y`, by the end of its name: of a table or a report whose scene is not known."""
    return _BY_NAME[column.rpartition(".")[2]]


Kind: TypeAlias = Literal["time", "drive", "point", "body", "pin", "guide", "friction", "group"]
Names: TypeAlias = tuple[str, ...]


class Role(Enum):
    """What a channel is to a model."""

    time = "the instant"
    input = "where a drive has its body"
    kinematic = "motion of a point or a body"
    force = "force or moment of a joint or a drive: the multiplier of one constraint, in the order of the constraints"
    friction = "friction of a joint, or its power"
    magnitude = "length of a vector, of which limits and other programs may speak"
    given = "component along an axis of a guide's force, which other programs may give"
    own = "what the analytic core alone knows: how far an Assur group is from a singular configuration"


ASKED = (Role.time, Role.input, Role.kinematic, Role.force, Role.friction)  # of any model


@dataclass(frozen=True, slots=True)
class Channel:
    """One column of a motion, or a magnitude: its name, and what that stands for."""

    name: str  # `P5.vy`
    role: Role
    kind: Kind  # of its subject: points, bodies, pins and guides may have the same names
    subject: str  # the point, the body, the pin's `Pin.channel`, the slider, the driven body, the group's inner joint
    measured: ChannelQuantity
    components: Names = ()  # of the vector whose component, or whose length, it is: its x and its y
    point: str = ""  # where it is: the point, the pin's, or the first of its body

    @property
    def quantity(self) -> str:
        """The name of what it measures."""
        return self.measured.name

    @property
    def unit(self) -> str:
        """Its SI unit."""
        return self.measured.unit

    @property
    def group(self) -> str:
        """The group in which its errors are judged."""
        return self.measured.group

    @property
    def order(self) -> int | None:
        """The order of the derivative with respect to time; None where it is no place and no rate."""
        return self.measured.order

    @property
    def axis(self) -> str:
        """The axis along which a vector's component is, x or y; empty of all else."""
        return self.measured.axis

    @property
    def modulo_turn(self) -> bool:
        """Whether samples count modulo one turn."""
        return self.measured.modulo_turn

    @property
    def is_angle(self) -> bool:
        """Whether it is a direction, of a body or of the drive: a whole turn more is the same pose."""
        return self.measured.order == 0 and self.measured.unit == "rad"

    @property
    def is_force(self) -> bool:
        """Whether it is a force, a moment or a power of a joint or a drive, or the size of one."""
        return self.group in ("reaction", "torque", "force")

    @property
    def owner(self) -> str:
        """What messages call its subject."""
        of_the_input = self.role in (Role.time, Role.input) or self.kind == "drive"
        return "drive" if of_the_input else self.kind if self.kind == "friction" else self.subject

    @property
    def header(self) -> str:
        """The heading of its column in files: `P5.y [m]`."""
        return f"{self.name} [{self.unit}]"


def vector(
    role: Role, kind: Kind, subject: str, quantities: tuple[ChannelQuantity, ...], point: str
) -> Iterator[Channel]:
    """Yield both components of a vector."""
    names = tuple(f"{subject}.{quantity.name}" for quantity in quantities)
    for name, quantity in zip(names, quantities, strict=True):
        yield Channel(name, role, kind, subject, quantity, names, point)
