"""Channels of a scene, as a table: the columns of a motion, what each is of, its unit and its sign.

| channel | meaning |
|---|---|
| `time`, `crank_angle` | the sample's instant; the angle of the crank's x axis that the engine really has, continuous |
| `drive.displacement` | instead, where a slider is driven: of its first point along `along` from `through` |
| `P.x .y .vx .vy .ax .ay` | a moving point, ground frame |
| `body.angle .omega .alpha` | a turning body's x axis, counter-clockwise positive; the angle counts modulo one turn |
| `P.fx .fy` | the force that the pin's body named first in the file exerts on the later one; ground comes before all |
| `P/body.fx .fy` | the same for a third body at one point: the force of the first body on it |
| `body.guide_force` | from its guide on the slider, along `along` turned +90 degrees, in the frame of the guide |
| `body.guide_moment` | from its guide on the slider, about the slider's first point, counter-clockwise positive |
| `drive.torque` | what the drive does on the crank |
| `drive.force` | what the drive does on the driven slider's first point, along `along` |
| `P.friction_moment`, `P/body.friction_moment` | of friction on the later body of the pin |
| `body.friction_force` | of friction on the slider, along `along` |
| `friction.power` | of all friction: at most zero |

Of the analytic core alone, since the other engines know no Assur groups, by the group's inner joint:

| channel | meaning |
|---|---|
| `P.transmission` | from 0 in a singular configuration to a right angle: of two bars, or a bar and a guide's normal |
| `P.to_lock` | the least change of one length, or of a guide's offset, that makes the group singular |

Enclosures bound channels between the samples too, and these magnitudes:

| magnitude | meaning |
|---|---|
| `P.speed`, `P.acceleration`, `P.force` | how large the velocity, the acceleration, the force at a pin is |
| `P/body.force` | the same for a third body at one point; and of a pin called `drive` where the drive has a force |
| `transmission` | the least transmission angle of all dyads |

Samples of an angle, and files of them, count modulo one turn; bounds and limits go on over whole turns, from more than
-180 to 180 degrees at the drive's start.

The drive stays where it is, and all other lengths as they are; lengths are those of links between their two pins. Of a
dyad it is exact, of a larger group to 1e-5 of itself, near to a singular configuration and far from it alike. A guide
that crosses another would have to be turned: `to_lock` is the sine of their angle times the linkage's longest
arm, which is the largest distance of two points, or of a point from a guide, on one body or the ground.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import permutations
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

from .elements.friction import PinFriction

if TYPE_CHECKING:
    from .scene import Scene

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
    own = "what the analytic core alone knows: how far an Assur group is from a singular configuration"


ASKED = (Role.time, Role.input, Role.kinematic, Role.force, Role.friction)  # of any model
TIME = "time"
TRANSMISSION = "transmission"  # the least angle of all dyads
TO_LOCK = "to_lock"
POWER = "friction.power"


class Quantity(NamedTuple):
    """What a channel measures; those of one name have one unit."""

    name: str
    unit: str
    group: str = ""  # in which errors are judged; none of the time
    order: int | None = None  # of the derivative that a channel of the motion is: 0 of a place, 1, 2
    axis: str = ""  # x or y of a vector's component
    modulo_turn: bool = False


_POINT = tuple(
    Quantity(f"{letter}{axis}", unit, group, order, axis)
    for order, (letter, unit, group) in enumerate(
        (("", "m", "position"), ("v", "m/s", "velocity"), ("a", "m/s^2", "acceleration"))
    )
    for axis in "xy"
)
_BODY = (
    Quantity("angle", "rad", "position", 0, modulo_turn=True),
    Quantity("omega", "rad/s", "velocity", 1),
    Quantity("alpha", "rad/s^2", "acceleration", 2),
)
_PIN = Quantity("fx", "N", "reaction", axis="x"), Quantity("fy", "N", "reaction", axis="y")
_GUIDE = Quantity("guide_force", "N", "reaction"), Quantity("guide_moment", "N*m", "reaction")
_TIME = Quantity(TIME, "s")
_TURNED = Quantity("crank_angle", "rad", "drive", 0), Quantity("torque", "N*m", "torque")
_SLID = Quantity("displacement", "m", "drive", 0), Quantity("force", "N", "force")
_RUBBING_PIN, _RUBBING_GUIDE = (
    Quantity("friction_moment", "N*m", "reaction"),
    Quantity("friction_force", "N", "reaction"),
)
_POWER = Quantity("power", "W", "reaction")
_GROUP = Quantity(TRANSMISSION, "rad", "position"), Quantity(TO_LOCK, "m", "position")
_RATES = Quantity("speed", "m/s", "velocity", 1), Quantity("acceleration", "m/s^2", "acceleration", 2)
_LENGTH_OF_FORCE = Quantity("force", "N", "reaction")
QUANTITIES = (_TIME, *_POINT, *_BODY, *_PIN, *_GUIDE, *_TURNED, *_SLID, _RUBBING_PIN, _RUBBING_GUIDE, _POWER)
QUANTITIES += (*_GROUP, *_RATES)
# Of the units that a file may name; the others are SI in files too.
DIMENSIONS = {"m": "length", "rad": "angle", "N": "force", "N*m": "moment", "m/s": "sliding_rate"}


@dataclass(frozen=True, slots=True)
class Channel:
    """One column of a motion, or a magnitude: its name, and what that stands for."""

    name: str  # `P5.vy`
    role: Role
    kind: Kind  # of its subject: points, bodies, pins and guides may have the same names
    subject: str  # the point, the body, the pin's `Pin.channel`, the slider, the driven body, the group's inner joint
    measured: Quantity
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
    def is_force(self) -> bool:
        """Whether it is a force, a moment or a power of a joint or a drive."""
        return self.role in (Role.force, Role.friction)

    @property
    def owner(self) -> str:
        """What messages call its subject."""
        return self.kind if self.kind in ("drive", "friction") else self.subject

    @property
    def header(self) -> str:
        """The heading of its column in files: `P5.y [m]`."""
        return f"{self.name} [{self.unit}]"


class DriveChannels(NamedTuple):
    """The names of a drive's channels."""

    position: str
    effort: str  # of a scene without masses too, where no motion has it


class PointChannels(NamedTuple):
    """The names of a point's channels, along x and along y."""

    place: tuple[str, str]
    velocity: tuple[str, str]
    acceleration: tuple[str, str]


class BodyChannels(NamedTuple):
    """The names of a turning body's channels."""

    angle: str
    omega: str
    alpha: str


class GuideChannels(NamedTuple):
    """The names of a guide's channels."""

    force: str
    moment: str


class Channels:
    """A scene's channels by name, in the order of the files; besides them, magnitudes and what the core alone knows."""

    def __init__(self, scene: "Scene") -> None:
        self.drive = DriveChannels(*map(_of_drive, _TURNED if scene.drive.slide is None else _SLID))
        rows = *_asked(scene), *_magnitudes(scene, self.drive.effort)
        self._rows = {row.name: row for row in rows}
        self._first = {name: body.points[0] for name, body in scene.bodies.items()}
        self._names: dict[tuple[Role, ...], Names] = {}

    def names(self, *roles: Role) -> Names:
        """The names of all channels of these roles; of all that any model may be asked for where none is given."""
        if (names := self._names.get(roles)) is None:
            wanted = roles or ASKED
            names = self._names[roles] = tuple(name for name, row in self._rows.items() if row.role in wanted)
        return names

    def __getitem__(self, name: str) -> Channel:
        """The channel, or magnitude, of that name; KeyError of none."""
        return self._rows[name] if name in self._rows else self._own[name]

    def __contains__(self, name: str) -> bool:
        """Whether there is a channel, or a magnitude, of that name."""
        return name in self._rows or name in self._own

    def find(self, kind: Kind, subject: str, quantity: str) -> Channel | None:
        """The channel of a subject by what it measures; None where there is none."""
        return self._found.get((kind, subject, quantity))

    @cached_property
    def points(self) -> Mapping[str, PointChannels]:
        """By moving point the names of its channels."""
        vectors = self._by_subject("point", Role.kinematic)
        return {p: PointChannels((x, y), (vx, vy), (ax, ay)) for p, (x, y, vx, vy, ax, ay) in vectors.items()}

    @cached_property
    def bodies(self) -> Mapping[str, BodyChannels]:
        """By turning body the names of its channels."""
        return {body: BodyChannels(*names) for body, names in self._by_subject("body", Role.kinematic).items()}

    @cached_property
    def pins(self) -> Mapping[str, tuple[str, str]]:
        """By `Pin.channel` the names of the force along x and along y."""
        return {pin: (x, y) for pin, (x, y) in self._by_subject("pin", Role.force).items()}

    @cached_property
    def guides(self) -> Mapping[str, GuideChannels]:
        """By slider the names of its guide's channels."""
        return {slider: GuideChannels(*names) for slider, names in self._by_subject("guide", Role.force).items()}

    @cached_property
    def magnitudes(self) -> Mapping[str, tuple[str, str]]:
        """By magnitude the names of the two channels that it is the length of."""
        rows = (self._rows[name] for name in self.names(Role.magnitude))
        return {row.name: (x, y) for row in rows for x, y in (row.components,)}

    def _by_subject(self, kind: Kind, role: Role) -> dict[str, list[str]]:
        names: dict[str, list[str]] = {}
        for row in self._rows.values():
            if row.kind == kind and row.role is role:
                names.setdefault(row.subject, []).append(row.name)
        return names

    @cached_property
    def _found(self) -> Mapping[tuple[str, str, str], Channel]:
        return {(row.kind, row.subject, row.quantity): row for row in self._rows.values()}

    @cached_property
    def _own(self) -> Mapping[str, Channel]:
        """What the core may know of any group: it has the name of a point, of a body, or of two."""
        joints = {f"{one}/{other}": self._first[one] for one, other in permutations(self._first, 2)}
        joints |= self._first | {point: point for point in self.points}
        rows = {TRANSMISSION: Channel(TRANSMISSION, Role.own, "group", "", _GROUP[0])}
        for joint, point in joints.items():
            for quantity in _GROUP:
                name = own_channel(joint, quantity.name)
                rows[name] = Channel(name, Role.own, "group", joint, quantity, (), point)
        return rows


def own_channel(joint: str, quantity: str) -> str:
    """The name of a channel that the analytic core alone has, of the group with that inner joint."""
    return f"{joint}.{quantity}"


def _of_drive(quantity: Quantity) -> str:
    return quantity.name if quantity.name == "crank_angle" else f"drive.{quantity.name}"


def _vector(role: Role, kind: Kind, subject: str, quantities: tuple[Quantity, ...], point: str) -> Iterator[Channel]:
    """Yield both components of a vector."""
    names = tuple(f"{subject}.{quantity.name}" for quantity in quantities)
    for name, quantity in zip(names, quantities, strict=True):
        yield Channel(name, role, kind, subject, quantity, names, point)


def _asked(scene: "Scene") -> Iterator[Channel]:
    """Yield the channels that any model may be asked for, in the order of the files."""
    driven, (position, effort) = scene.drive.body, _TURNED if scene.drive.slide is None else _SLID
    first = {name: body.points[0] for name, body in scene.bodies.items()}
    yield Channel(TIME, Role.time, "time", "", _TIME)
    yield Channel(_of_drive(position), Role.input, "drive", driven, position, (), first[driven])
    for point in scene.moving_points:
        for order in range(3):
            yield from _vector(Role.kinematic, "point", point, _POINT[2 * order : 2 * order + 2], point)
    for body in scene.turning:
        for quantity in _BODY:
            yield Channel(f"{body}.{quantity.name}", Role.kinematic, "body", body, quantity, (), first[body])
    if not scene.has_masses:
        return
    for pin in scene.pins:
        yield from _vector(Role.force, "pin", pin.channel, _PIN, pin.point)
    for body in scene.slides:
        for quantity in _GUIDE:
            yield Channel(f"{body}.{quantity.name}", Role.force, "guide", body, quantity, (), first[body])
    yield Channel(_of_drive(effort), Role.force, "drive", driven, effort, (), first[driven])
    for friction in scene.friction:
        joint = friction.joint(scene)
        if isinstance(friction, PinFriction):
            point = friction.pin(scene).point
            yield Channel(friction.channel(scene), Role.friction, "pin", joint, _RUBBING_PIN, (), point)
        else:
            yield Channel(friction.channel(scene), Role.friction, "guide", joint, _RUBBING_GUIDE, (), first[joint])
    if scene.friction:
        yield Channel(POWER, Role.friction, "friction", "", _POWER)


def _magnitudes(scene: "Scene", effort: str) -> Iterator[Channel]:
    """Yield the lengths of vectors; of a pin whose force would be called as the drive's is with the later body."""
    for quantity, letter in zip(_RATES, "va", strict=True):
        for point in scene.moving_points:
            both = f"{point}.{letter}x", f"{point}.{letter}y"
            yield Channel(f"{point}.{quantity.name}", Role.magnitude, "point", point, quantity, both, point)
    for pin in scene.pins if scene.has_masses else ():
        name, both = f"{pin.channel}.force", (f"{pin.channel}.fx", f"{pin.channel}.fy")
        name = f"{pin.point}/{pin.second}.force" if name == effort else name
        yield Channel(name, Role.magnitude, "pin", pin.channel, _LENGTH_OF_FORCE, both, pin.point)
