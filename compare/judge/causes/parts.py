"""Channels that a read-out treats alike, and what they are called."""

from collections.abc import Iterable, Sequence
from typing import TypeAlias

from scenes.motion import quantity

Part: TypeAlias = tuple[str, tuple[str, ...]]  # what channels are called, and their names

ANGLES = ("angle", "crank_angle")  # modulo one turn
MOVING, TURNING = ("x", "y", "vx", "vy", "ax", "ay"), ("angle", "omega", "alpha")
VECTORS = {"x": "position", "y": "position", "vx": "velocity", "vy": "velocity", "ax": "acceleration"}
VECTORS |= {"ay": "acceleration", "fx": "force", "fy": "force"}
GENERAL = VECTORS | {"angle": "position", "omega": "velocity", "alpha": "acceleration"}
GENERAL |= dict.fromkeys(("guide_force", "guide_moment", "torque", "force"), "force")
NEAR_ONE = 0.01  # a factor that is no farther from one is shown in per cent
FORCES = ("fx", "fy", "guide_force", "guide_moment", "torque", "force")
PLURAL = {"position": "poses", "velocity": "velocities", "acceleration": "accelerations", "force": "forces"}


def stem(channel: str) -> str:
    """Return whose channel it is: a point, a joint, a body, or the drive."""
    return channel.rpartition(".")[0] or "drive"


def common(channels: Iterable[str]) -> str:
    """Return whose channels they are: one's, or `all`."""
    stems = {stem(channel) for channel in channels}
    return stems.pop() if len(stems) == 1 else "all"


def in_words(by: float, what: str = "it") -> tuple[str, str]:
    """Return a factor in numbers that are not one, and as what is wrong: `0.002 % too large`, `3 times what it ...`."""
    if abs(by - 1) >= NEAR_ONE:
        return f"{by:.4g}", f"{by:.4g} times what {what} should be"
    return f"{100 * (by - 1):+.3g} %", f"{100 * abs(by - 1):.3g} % too {'large' if by > 1 else 'small'}"


def place_of(part: Part) -> str:
    """Return the body, joint or point that all channels of a part are of, `drive`, or `all`."""
    return common(part[1])


def _vector(channel: str) -> str:
    kind = VECTORS.get(quantity(channel), "")
    return kind and f"{stem(channel)}'s {kind}"


_NAMES = (
    ("{}", lambda channel: channel),
    ("{}", _vector),
    ("{}", stem),
    ("{}", lambda channel: f"{stem(channel)} along {channel[-1]}" if quantity(channel) in MOVING else ""),
    ("{}'s angle and its rates", lambda channel: stem(channel) if quantity(channel) in TURNING else ""),
    ("all {}", quantity),
    ("all {}s of points", lambda channel: VECTORS.get(quantity(channel), "").replace("velocity", "velocitie")),
    ("all vectors", lambda channel: "s" if quantity(channel) in VECTORS else ""),
    ("all {}", lambda channel: PLURAL.get(GENERAL.get(quantity(channel), ""), "")),
    ("all {}", lambda channel: "rates" if GENERAL.get(quantity(channel)) in ("velocity", "acceleration") else ""),
    ("all {}", lambda channel: "reactions" if quantity(channel) in FORCES[:4] else ""),
    ("all angles and their rates{:.0}", lambda channel: "s" if quantity(channel) in TURNING else ""),
    ("all along {}", lambda channel: quantity(channel)[-1] if quantity(channel) in VECTORS else ""),
    ("all of the {}", lambda channel: "" if quantity(channel) in FORCES else "motion"),
)


def parts(names: Sequence[str], drive: str) -> list[Part]:
    """Return all parts of a motion that has these channels, one of them the drive's, each with what it is called."""
    found: dict[frozenset[str], str] = {}
    for name, of in _NAMES:
        grouped: dict[str, list[str]] = {}
        for channel in names:
            if key := of(channel):
                grouped.setdefault(key, []).append(channel)
        for key, channels in grouped.items():
            found.setdefault(frozenset(channels), name.format(key))
    found.setdefault(frozenset(names), "all")
    found.setdefault(frozenset(names) - {drive}, "all but the drive")
    return [(name, tuple(c for c in names if c in channels)) for channels, name in found.items()]
