"""Motion: what a model returns. Named channels, their units and sign rules; nothing else.

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

Of the analytic core alone, since the other engines know no Assur groups, by the group's inner joint:

| channel | meaning |
|---|---|
| `P.transmission` | from 0 in a singular configuration to a right angle: of two bars, or a bar and a guide's normal |
| `P.to_lock` | by how much the nearest length, or guide's offset, would have to be off for the group to be singular |

The drive stays where it is, and all other lengths as they are; lengths are those of links between their two pins. Of a
dyad it is exact, of a larger group to 1e-5 of itself, near to a singular configuration and far from it alike. A guide
that crosses another would have to be turned: `to_lock` is the sine of their angle times the linkage's longest
arm, which is the largest distance of two points, or of a point from a guide, on one body or the ground.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from html import escape
from typing import TYPE_CHECKING

from ..drive import Samples as Samples  # which most who read a motion name
from ..errors import nearest
from ..scene import Scene
from .sparkline import sparkline

if TYPE_CHECKING:
    from pandas import DataFrame

UNITS: Mapping[str, str] = {
    **dict.fromkeys(("x", "y", "displacement", "to_lock"), "m"),
    **dict.fromkeys(("crank_angle", "angle", "transmission"), "rad"),
    **dict.fromkeys(("fx", "fy", "guide_force", "force"), "N"),
    **dict.fromkeys(("guide_moment", "torque"), "N*m"),
    **{"time": "s", "vx": "m/s", "vy": "m/s", "ax": "m/s^2", "ay": "m/s^2", "omega": "rad/s", "alpha": "rad/s^2"},
}


@cache
def quantity(channel: str) -> str:
    """What a channel measures, a key of `UNITS`: `P5.y` -> `y`, `time` -> `time`."""
    return channel.rpartition(".")[2]


def header(channel: str) -> str:
    """The CSV header of a channel: `P5.y [m]`."""
    return f"{channel} [{UNITS[quantity(channel)]}]"


def kinematic_channels(scene: Scene) -> tuple[str, ...]:
    """The names of a scene's channels that describe the motion, in the order of the files."""
    points = tuple(f"{point}.{q}" for point in scene.moving_points for q in ("x", "y", "vx", "vy", "ax", "ay"))
    turning = (f"{body}.{q}" for body in scene.turning for q in ("angle", "omega", "alpha"))
    return ("time", scene.drive_channel, *points, *turning)


def force_channels(scene: Scene) -> tuple[str, ...]:
    """The names of a scene's channels that describe the forces; none in a kinematic scene."""
    if not scene.has_masses:
        return ()
    pins = tuple(f"{pin.channel}.{q}" for pin in scene.pins for q in ("fx", "fy"))
    sliding = (body.name for body in scene.bodies.values() if body.slide is not None)
    effort = "drive.torque" if scene.driven_slide is None else "drive.force"
    return (*pins, *(f"{body}.{q}" for body in sliding for q in ("guide_force", "guide_moment")), effort)


def channels(scene: Scene) -> tuple[str, ...]:
    """The names of all channels of a scene, in the order of the files."""
    return kinematic_channels(scene) + force_channels(scene)


@dataclass(frozen=True)
class Motion:
    """One model's answer: channel name -> samples of shape (n,), SI; and why any channel is missing."""

    samples: Mapping[str, Samples]
    unsupported: Mapping[str, str] = field(default_factory=dict)  # channel -> reason

    def __getitem__(self, channel: str) -> Samples:
        """The samples of a channel, shape (n,), in the unit of `UNITS`; KeyError with the reason, or the nearest."""
        if channel in self.samples:
            return self.samples[channel]
        if channel in self.unsupported:
            raise KeyError(f"{channel}: unsupported, {self.unsupported[channel]}")
        raise KeyError(f"{channel}: no such channel{nearest(channel, self.samples)}")

    def __contains__(self, channel: str) -> bool:
        """Whether the channel was computed."""
        return channel in self.samples

    def to_frame(self) -> "DataFrame":
        """One row a sample and one column a channel, each under its name and unit as in the CSV files."""
        from pandas import DataFrame  # late, as no model needs it

        return DataFrame({header(channel): values for channel, values in self.samples.items()})

    def _repr_html_(self) -> str:
        """What a notebook shows: a row a channel, its least and largest value, and its curve."""
        count = len(next(iter(self.samples.values()), ()))
        rows = [f"<tr><th>{count} samples</th><th>least</th><th>largest</th><th></th></tr>"]
        for channel, values in self.samples.items():
            numbers = f"<td>{values.min():.6g}</td><td>{values.max():.6g}</td><td>{sparkline(values)}</td>"
            rows.append(f"<tr><th>{header(channel)}</th>{numbers}</tr>")
        for channel, reason in self.unsupported.items():
            rows.append(f"<tr><th>{channel}</th><td colspan=3>unsupported: {escape(reason)}</td></tr>")
        return f"<table>{''.join(rows)}</table>"
