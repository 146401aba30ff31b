"""What a model is asked for, and the motion that it returns: samples by the names of `scenes.channels`."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ..channels import Role, named
from ..drive import ConstantSpeed
from ..drive import Samples as Samples  # which most who read a motion name
from ..errors import InputError, nearest
from ..scene import Scene
from .inputs import Inputs, inputs_of, passing
from .lookup import Later

if TYPE_CHECKING:
    from pandas import DataFrame


FEWEST = 8  # samples of a cycle: of fewer no course is seen
WIDTH, HEIGHT, MARGIN = 120, 24, 2  # px, of a sparkline


def header(channel: str) -> str:
    """The CSV header of a channel, `P5.y [m]`; a motion does not know its scene."""
    return f"{channel} [{named(channel).unit}]"


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

    @property
    def late(self) -> frozenset[str]:
        """The channels that are found when they are first looked up, since they take many times as long as others."""
        return self.samples.late if isinstance(self.samples, Later) else frozenset()

    @property
    def prompt(self) -> "Motion":
        """The motion without these."""
        return Motion({c: self[c] for c in self.samples if c not in self.late}, self.unsupported)

    def inputs(self, scene: Scene, rows: Any = ...) -> Inputs:
        """The inputs that it has, at some of its samples or all: its own instants and positions of the drives.

        Their rates and accelerations are by the laws at those instants.
        """
        return passing(scene, self[scene.channels.drive.position][rows], self["time"][rows])

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


@dataclass(frozen=True)
class _Channels:
    channels: frozenset[str] | None = field(default=None, kw_only=True)  # besides the time and the drive's; None: all

    def wanted(self, scene: Scene) -> tuple[str, ...]:
        """The names of the wanted channels, with time and drive, in the order of the files."""
        known = scene.channels.names()
        if self.channels is None:
            return known
        wanted = self.channels.union(scene.channels.names(Role.time, Role.input))
        return tuple(channel for channel in known if channel in wanted)

    def wants_forces(self, scene: Scene) -> bool:
        """Whether any force channel is wanted; if not, no model needs to find one."""
        forces = scene.channels.names(Role.force, Role.friction)
        return bool(forces) if self.channels is None else not self.channels.isdisjoint(forces)


@dataclass(frozen=True)
class Sampling(_Channels):
    """Samples at equal steps of the time, `samples` a cycle of the drive, over `turns` cycles, both ends included."""

    samples: int = 360
    turns: int = 1

    @property
    def count(self) -> int:
        """The number of samples, n."""
        return self.samples * self.turns + 1

    def _cycles(self) -> Samples:
        return np.arange(self.count, dtype=np.float64) / self.samples

    def times(self, scene: Scene) -> Samples:
        """The instants, shape (n,), s."""
        return self._cycles() * scene.cycle

    def commanded(self, scene: Scene) -> Samples:
        """The positions that the drive commands at those instants, shape (n,), rad or m."""
        return scene.drive.law.after(self._cycles())

    def inputs(self, scene: Scene) -> Inputs:
        """The inputs at those instants: positions by parts of a cycle, which are the same in every turn."""
        return passing(scene, self.commanded(scene), self.times(scene))


@dataclass(frozen=True)
class Positions(_Channels):
    """Samples at positions of a drive at constant speed, rad or m, in the order in which it passes them.

    Only models without a time step can answer; the others refuse it as unsupported.
    """

    positions: tuple[float, ...]

    @property
    def count(self) -> int:
        """The number of samples, n."""
        return len(self.positions)

    def times(self, scene: Scene) -> Samples:
        """The instants, shape (n,), s; InputError where the drive follows a motion law."""
        if not isinstance(scene.drive.law, ConstantSpeed):
            raise InputError("positions alone are of a drive at constant speed")
        return (self.commanded(scene) - scene.drive.law.start) / scene.drive.law.speed

    def commanded(self, scene: Scene) -> Samples:  # noqa: ARG002 - they are the request itself
        """The positions, shape (n,), rad or m."""
        return np.array(self.positions)

    def inputs(self, scene: Scene) -> Inputs:
        """The inputs at those positions; InputError where the drive follows a motion law."""
        return passing(scene, self.commanded(scene), self.times(scene))


@dataclass(frozen=True)
class Instants(_Channels):
    """Samples at instants that somebody else chose, in any steps: those of a result that was computed elsewhere."""

    instants: tuple[float, ...]  # s, increasing

    def wanted(self, scene: Scene) -> tuple[str, ...]:
        """The names of the wanted channels, as of any request; after them magnitudes, which no model is asked for."""
        known = super().wanted(scene)
        return (*known, *sorted((self.channels or frozenset()).difference(known)))

    @property
    def count(self) -> int:
        """The number of samples, n."""
        return len(self.instants)

    def times(self, scene: Scene) -> Samples:  # noqa: ARG002 - they are the request itself
        """The instants, shape (n,), s."""
        return np.array(self.instants)

    def commanded(self, scene: Scene) -> Samples:
        """The positions that the drive commands at those instants, shape (n,), rad or m."""
        return self.inputs(scene).driven().position

    def inputs(self, scene: Scene) -> Inputs:
        """The inputs by the laws of the drives at those instants."""
        return inputs_of(scene, self.times(scene))


@dataclass(frozen=True, eq=False)
class AtInputs(_Channels):
    """Samples at inputs from any source, whatever the laws of the scene have there.

    Only models without a time step can answer; the others refuse it as unsupported.
    """

    given: Inputs

    @property
    def count(self) -> int:
        """The number of samples, n."""
        return len(self.given.time)

    def times(self, scene: Scene) -> Samples:  # noqa: ARG002 - they are the request itself
        """The instants, shape (n,), s."""
        return self.given.time

    def commanded(self, scene: Scene) -> Samples:
        """The positions of the drive, shape (n,), rad or m."""
        return self.inputs(scene).driven().position

    def inputs(self, scene: Scene) -> Inputs:
        """The inputs; InputError where they are no such numbers, or of another shape."""
        return self.given.checked(scene)


Request: TypeAlias = Sampling | Positions | AtInputs  # of a model
Rows: TypeAlias = Request | Instants  # of anything that is compared


def sparkline(values: Samples) -> str:
    """Draw samples, evenly spaced, as an SVG curve in the colour of the text, between their least and largest."""
    shown = values[np.linspace(0, len(values) - 1, min(len(values), WIDTH)).round().astype(int)]
    size = np.ptp(values)
    y = (values.max() - shown) / size if 0 < size < np.inf else np.full(len(shown), 0.5)
    across = np.linspace(MARGIN, WIDTH - MARGIN, len(shown))
    corners = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(across, MARGIN + (HEIGHT - 2 * MARGIN) * y, strict=True))
    return (
        f'<svg width="{WIDTH}" height="{HEIGHT}" role="img" aria-label="curve">'
        f'<polyline points="{corners}" fill="none" stroke="currentColor"/></svg>'
    )
