"""Channels that a read-out treats alike, and what they are called."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from scenes.model.motion import quantity

from ...results.frame import ANGLES as ANGLES

MOVING, TURNING = ("x", "y", "vx", "vy", "ax", "ay"), ("angle", "omega", "alpha")
VECTORS = {"x": "position", "y": "position", "vx": "velocity", "vy": "velocity", "ax": "acceleration"}
VECTORS |= {"ay": "acceleration", "fx": "force", "fy": "force"}
GENERAL = VECTORS | {"angle": "position", "omega": "velocity", "alpha": "acceleration"}
GENERAL |= dict.fromkeys(("guide_force", "guide_moment", "torque", "force"), "force")
FORCES = ("fx", "fy", "guide_force", "guide_moment", "torque", "force")
MANY = {"position": "positions", "velocity": "velocities", "acceleration": "accelerations", "force": "forces"}
POSES = MANY | {"position": "poses"}


class Part(NamedTuple):
    """Some channels."""

    name: str  # what they are called
    channels: tuple[str, ...]
    many: bool = False  # whether the name is a plural

    @property
    def place(self) -> str:
        """The body, joint or point that all of them are of, `drive`, or `all`."""
        return common(self.channels)


def stem(channel: str) -> str:
    """Return whose channel it is: a point, a joint, a body, or the drive."""
    return channel.rpartition(".")[0] or "drive"


def common(channels: Iterable[str]) -> str:
    """Return whose channels they are: one's, or `all`."""
    stems = {stem(channel) for channel in channels}
    return stems.pop() if len(stems) == 1 else "all"


def _of_stem(kind: str | None, channel: str) -> str:
    """Return `P4's force`, or nothing where a channel is of no such kind."""
    return f"{stem(channel)}'s {kind}" if kind else ""


_NAMES: tuple[
    tuple[bool, Callable[[str], str]], ...
] = (  # whether it is a plural, and what a channel belongs to, if any
    (False, lambda c: c),
    (False, lambda c: _of_stem(VECTORS.get(quantity(c)), c)),
    (False, stem),
    (False, lambda c: f"{stem(c)} along {c[-1]}" if quantity(c) in MOVING else ""),
    (False, lambda c: f"{stem(c)}'s motion" if quantity(c) in MOVING else ""),
    (False, lambda c: f"{stem(c)}'s angle and its rates" if quantity(c) in TURNING else ""),
    (False, lambda c: f"all {quantity(c)}"),
    (True, lambda c: f"all {MANY[VECTORS[quantity(c)]]} of points" if quantity(c) in VECTORS else ""),
    (True, lambda c: "all vectors" if quantity(c) in VECTORS else ""),
    (True, lambda c: f"all {POSES[GENERAL[quantity(c)]]}" if quantity(c) in GENERAL else ""),
    (True, lambda c: "all rates" if GENERAL.get(quantity(c)) in ("velocity", "acceleration") else ""),
    (True, lambda c: "all reactions" if quantity(c) in FORCES[:4] else ""),
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
