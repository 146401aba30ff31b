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
from functools import cached_property
from itertools import permutations
from typing import TYPE_CHECKING, NamedTuple

from . import quantities
from .elements.friction import PinFriction
from .quantities import POWER, TIME, TO_LOCK, TRANSMISSION, Channel, ChannelQuantity, Kind, Names, Role, named, vector

if TYPE_CHECKING:
    from .scene import Scene

__all__ = ["POWER", "TIME", "TO_LOCK", "TRANSMISSION", "Channel", "Channels", "Role", "named", "own_channel"]


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
        self.drive = DriveChannels(*map(_of_drive, quantities.TURNED if scene.drive.slide is None else quantities.SLID))
        rows = *_asked(scene), *_besides(scene, self.drive.effort)
        self._rows = {row.name: row for row in rows}
        self._first = {name: body.points[0] for name, body in scene.bodies.items()}
        self._names: dict[tuple[Role, ...], Names] = {}

    def names(self, *roles: Role) -> Names:
        """The names of all channels of these roles; of all that any model may be asked for where none is given."""
        if (names := self._names.get(roles)) is None:
            wanted = roles or quantities.ASKED
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

    def below(self, name: str) -> str | None:
        """The channel whose derivative by the time one is; None where that is no channel."""
        row = self[name]
        return self._by_order.get((row.kind, row.subject, row.axis, (row.order or 0) - 1))

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

    @cached_property
    def forces_of_pins(self) -> Mapping[str, str]:
        """By `Pin.channel` the name of how large its force is."""
        rows = (self._rows[name] for name in self.magnitudes)
        return {row.subject: row.name for row in rows if row.kind == "pin"}

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
    def _by_order(self) -> Mapping[tuple[str, str, str, int | None], str]:
        rows = (self[name] for name in self.names(Role.kinematic))
        return {(row.kind, row.subject, row.axis, row.order): row.name for row in rows}

    @cached_property
    def _own(self) -> Mapping[str, Channel]:
        """What the core may know of any group: it has the name of a point, of a body, or of two."""
        joints = {f"{one}/{other}": self._first[one] for one, other in permutations(self._first, 2)}
        joints |= self._first | {point: point for point in self.points}
        rows = {TRANSMISSION: Channel(TRANSMISSION, Role.own, "group", "", quantities.GROUP[0])}
        for joint, point in joints.items():
            for quantity in quantities.GROUP:
                name = own_channel(joint, quantity.name)
                rows[name] = Channel(name, Role.own, "group", joint, quantity, (), point)
        return rows


def own_channel(joint: str, quantity: str) -> str:
    """The name of a channel that the analytic core alone has, of the group with that inner joint."""
    return f"{joint}.{quantity}"


def _of_drive(quantity: ChannelQuantity) -> str:
    return quantity.name if quantity.name == "crank_angle" else f"drive.{quantity.name}"


def _asked(scene: "Scene") -> Iterator[Channel]:
    """Yield the channels that any model may be asked for, in the order of the files."""
    driven, (position, _) = scene.drive.body, quantities.TURNED if scene.drive.slide is None else quantities.SLID
    first = {name: body.points[0] for name, body in scene.bodies.items()}
    yield Channel(TIME, Role.time, "time", "", quantities.INSTANT)
    yield Channel(_of_drive(position), Role.input, "drive", driven, position, (), first[driven])
    for point in scene.moving_points:
        for order in range(3):
            yield from vector(Role.kinematic, "point", point, quantities.POINT[2 * order : 2 * order + 2], point)
    for body in scene.turning:
        for quantity in quantities.BODY:
            yield Channel(f"{body}.{quantity.name}", Role.kinematic, "body", body, quantity, (), first[body])
    if not scene.has_masses:
        return
    for joint in scene.joints:
        yield from joint.channels(scene)
    for friction in scene.friction:
        rubbing = friction.joint(scene)
        if isinstance(friction, PinFriction):
            point = friction.pin(scene).point
            yield Channel(friction.channel(scene), Role.friction, "pin", rubbing, quantities.RUBBING_PIN, (), point)
        else:
            yield Channel(
                friction.channel(scene), Role.friction, "guide", rubbing, quantities.RUBBING_GUIDE, (), first[rubbing]
            )
    if scene.friction:
        yield Channel(POWER, Role.friction, "friction", "", quantities.LOST)


def _besides(scene: "Scene", effort: str) -> Iterator[Channel]:
    """Yield the axes of guides' forces, and the lengths of vectors.

    The force of a pin whose name would be that of the drive's force has the later body in its name too.
    """
    for slider in scene.slides if scene.has_masses else ():
        yield from vector(Role.given, "guide", slider, quantities.GUIDE_AXES, scene.bodies[slider].points[0])
    for quantity, letter in zip(quantities.RATES, "va", strict=True):
        for point in scene.moving_points:
            both = f"{point}.{letter}x", f"{point}.{letter}y"
            yield Channel(f"{point}.{quantity.name}", Role.magnitude, "point", point, quantity, both, point)
    for pin in scene.pins if scene.has_masses else ():
        name, both = f"{pin.channel}.force", (f"{pin.channel}.fx", f"{pin.channel}.fy")
        name = f"{pin.point}/{pin.second}.force" if name == effort else name
        yield Channel(name, Role.magnitude, "pin", pin.channel, quantities.LENGTH_OF_FORCE, both, pin.point)
