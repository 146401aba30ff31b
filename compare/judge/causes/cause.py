"""A cause of a disagreement as data: what is wrong, in which channels, and by how much; `words` has its sentence."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple

from scenes.channels import Channel, Channels, Role

MANY = {"position": "positions", "velocity": "velocities", "acceleration": "accelerations", "force": "forces"}
POSES = MANY | {"position": "poses"}


class Kind(StrEnum):
    """Causes of a disagreement."""

    unknown = "unknown"
    sign = "opposite sign"
    unit = "factor"
    offset = "offset"
    frame = "another frame"
    swap = "channels swapped"
    copy = "another's channel"
    pair = "another pair of bodies at the pin"
    moment = "moment about another point"
    term = "a term of the acceleration"
    lag = "late"
    drive = "drive"
    mass = "mass"
    inertia = "moment of inertia"
    com = "centre of mass"
    length = "length"
    place = "place on the ground"
    guide = "guide"
    load = "load"
    spring = "spring"
    gravity = "gravity"
    friction = "friction"
    missing = "missing"
    nonfinite = "not finite"
    held = "rows held"
    constant = "constant"
    spike = "spoilt sample"
    rows = "rows out of order"
    noise = "noise"
    differences = "differences of samples"
    solver = "discretisation"
    start = "start transient"
    coarse = "interpolation"
    code = "wrong line"


class Part(NamedTuple):
    """Channels that a read-out treats alike."""

    name: str  # what they are called
    channels: tuple[str, ...]
    many: bool = False  # whether the name is a plural
    place: str = "all"  # the body, joint or point that all of them are of, `drive`, or `all`

    def cause(self, kind: Kind, text: str, *amounts: float, names: tuple[str, ...] = ()) -> "Cause":
        """What may be wrong with these channels."""
        return Cause(kind, self.place, text, amounts, names, self)


NO_PART = Part("", ())


@dataclass(frozen=True)
class Cause:
    """What is likely wrong, where, and by how much."""

    kind: Kind = Kind.unknown
    place: str = ""  # a body, joint, channel, "drive" or "all"; empty where unknown
    text: str = "the cause is unknown"  # a sentence with gaps, see `words`, for where it is and by how much
    amounts: tuple[float, ...] = ()  # SI, or shares
    names: tuple[str, ...] = ()  # of what else is in it, as the other of two that are swapped
    part: Part = NO_PART  # the channels
    rows: tuple[float, ...] = ()  # positions of the drive: the first and the last where it acts, or the first alone
    left: float = 0.0  # of the error, that it does not explain
    besides: tuple["Cause", ...] = ()  # what is wrong too: they explain the error together
    others: tuple["Cause", ...] = field(default=(), compare=False)  # each of which explains it as well


UNKNOWN = Cause()


def common(channels: Channels, names: Iterable[str]) -> str:
    """Return whose channels they are: one's, or `all`."""
    owners = {channels[name].owner for name in names}
    return owners.pop() if len(owners) == 1 else "all"


def general(channel: Channel) -> str:
    """What is the same for several quantities: `position`, `velocity`, `acceleration`, `force`; empty of a drive."""
    return "force" if channel.is_force else channel.group if channel.role is Role.kinematic else ""


def _moves(channel: Channel) -> bool:
    return channel.kind == "point" and channel.role is Role.kinematic


def _of_vector(channel: Channel) -> str:
    return general(channel) if channel.axis else ""


_NAMES: Sequence[tuple[bool, Callable[[Channel], str]]] = (  # whether it is a plural, and what a channel belongs to
    (False, lambda c: c.name),
    (False, lambda c: f"{c.owner}'s {general(c)}" if _of_vector(c) else ""),
    (False, lambda c: c.owner),
    (False, lambda c: f"{c.owner} along {c.axis}" if _moves(c) else ""),
    (False, lambda c: f"{c.owner}'s motion" if _moves(c) else ""),
    (False, lambda c: f"{c.owner}'s angle and its rates" if c.kind == "body" else ""),
    (False, lambda c: f"all {c.quantity}"),
    (True, lambda c: f"all {MANY[general(c)]} of points" if _of_vector(c) else ""),
    (True, lambda c: "all vectors" if _of_vector(c) else ""),
    (True, lambda c: f"all {POSES[general(c)]}" if general(c) else ""),
    (True, lambda c: "all rates" if general(c) in ("velocity", "acceleration") else ""),
    (True, lambda c: "all reactions" if c.role is Role.force and c.kind in ("pin", "guide") else ""),
    (True, lambda c: "all angles and their rates" if c.kind == "body" else ""),
    (False, lambda c: f"all along {c.axis}" if _of_vector(c) else ""),
    (False, lambda c: "" if c.is_force else "all of the motion"),
)


def parts(channels: Channels, names: Sequence[str]) -> list[Part]:
    """Return all parts of a motion that has these channels, the drive's among them, each with what it is called."""
    known: dict[frozenset[str], tuple[str, bool]] = {}
    for many, name_of in _NAMES:
        grouped: dict[str, list[str]] = {}
        for channel in names:
            if name := name_of(channels[channel]):
                grouped.setdefault(name, []).append(channel)
        for name, alike in grouped.items():
            known.setdefault(frozenset(alike), (name, many))
    known.setdefault(frozenset(names), ("all", False))
    known.setdefault(frozenset(names).difference(channels.names(Role.input)), ("all but the drive", False))
    return [
        Part(name, tuple(c for c in names if c in alike), many, common(channels, alike))
        for alike, (name, many) in known.items()
    ]
