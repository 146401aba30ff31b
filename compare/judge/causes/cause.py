"""A cause of a disagreement as data: what is wrong, in which channels, and by how much; `words` has its sentence."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple

from scenes.model.motion import quantity

from ...mechanics.mechanics import GROUPS
from ...results.frame import ANGLES as ANGLES

MOVING, TURNING = ("x", "y", "vx", "vy", "ax", "ay"), ("angle", "omega", "alpha")
REACTIONS = ("fx", "fy", "guide_force", "guide_moment")
FORCES = (*REACTIONS, "torque", "force", "friction_moment", "friction_force", "power")
GENERAL = {of: "force" if of in FORCES else group for of, group in GROUPS.items() if group != "drive"}
VECTORS = {of: general for of, general in GENERAL.items() if of[-1] in "xy"}
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

    @property
    def place(self) -> str:
        """The body, joint or point that all of them are of, `drive`, or `all`."""
        return common(self.channels)

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


def stem(channel: str) -> str:
    """Return whose channel it is: a point, a joint, a body, or the drive."""
    return channel.rpartition(".")[0] or "drive"


def common(channels: Iterable[str]) -> str:
    """Return whose channels they are: one's, or `all`."""
    stems = {stem(channel) for channel in channels}
    return stems.pop() if len(stems) == 1 else "all"


_NAMES: Sequence[tuple[bool, Callable[[str], str]]] = (  # whether it is a plural, and what a channel belongs to, if any
    (False, lambda c: c),
    (False, lambda c: f"{stem(c)}'s {VECTORS[quantity(c)]}" if quantity(c) in VECTORS else ""),
    (False, stem),
    (False, lambda c: f"{stem(c)} along {c[-1]}" if quantity(c) in MOVING else ""),
    (False, lambda c: f"{stem(c)}'s motion" if quantity(c) in MOVING else ""),
    (False, lambda c: f"{stem(c)}'s angle and its rates" if quantity(c) in TURNING else ""),
    (False, lambda c: f"all {quantity(c)}"),
    (True, lambda c: f"all {MANY[VECTORS[quantity(c)]]} of points" if quantity(c) in VECTORS else ""),
    (True, lambda c: "all vectors" if quantity(c) in VECTORS else ""),
    (True, lambda c: f"all {POSES[GENERAL[quantity(c)]]}" if quantity(c) in GENERAL else ""),
    (True, lambda c: "all rates" if GENERAL.get(quantity(c)) in ("velocity", "acceleration") else ""),
    (True, lambda c: "all reactions" if quantity(c) in REACTIONS else ""),
    (True, lambda c: "all angles and their rates" if quantity(c) in TURNING else ""),
    (False, lambda c: f"all along {quantity(c)[-1]}" if quantity(c) in VECTORS else ""),
    (False, lambda c: "" if quantity(c) in FORCES else "all of the motion"),
)


def parts(names: Sequence[str], drive: str) -> list[Part]:
    """Return all parts of a motion that has these channels, one of them the drive's, each with what it is called."""
    known: dict[frozenset[str], tuple[str, bool]] = {}
    for many, name_of in _NAMES:
        grouped: dict[str, list[str]] = {}
        for channel in names:
            if name := name_of(channel):
                grouped.setdefault(name, []).append(channel)
        for name, channels in grouped.items():
            known.setdefault(frozenset(channels), (name, many))
    known.setdefault(frozenset(names), ("all", False))
    known.setdefault(frozenset(names) - {drive}, ("all but the drive", False))
    return [Part(name, tuple(c for c in names if c in own), many) for own, (name, many) in known.items()]
