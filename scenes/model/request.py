"""What is asked of a model: at which instants, and for which channels."""

from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from ..drive import ConstantSpeed
from ..errors import InputError
from ..scene import Scene
from .motion import Samples, channels, force_channels

FEWEST = 8  # samples of a cycle: of fewer no course is seen


@dataclass(frozen=True)
class _Channels:
    """Which channels are wanted."""

    channels: frozenset[str] | None = field(default=None, kw_only=True)  # besides the time and the drive's; None: all

    def wanted(self, scene: Scene) -> tuple[str, ...]:
        """The names of the wanted channels, with time and drive, in the order of the files."""
        known = channels(scene)
        wanted = {"time", scene.drive_channel, *(known if self.channels is None else self.channels)}
        return tuple(channel for channel in known if channel in wanted)

    def wants_forces(self, scene: Scene) -> bool:
        """Whether any force channel is wanted; if not, no model needs to find one."""
        forces = force_channels(scene)
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
        return self._cycles() * scene.drive.cycle

    def commanded(self, scene: Scene) -> Samples:
        """The positions that the drive commands at those instants, shape (n,), rad or m."""
        return scene.drive.after(self._cycles())


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
        if not isinstance(scene.drive, ConstantSpeed):
            raise InputError("positions alone are of a drive at constant speed")
        return (self.commanded(scene) - scene.drive.start) / scene.drive.speed

    def commanded(self, scene: Scene) -> Samples:  # noqa: ARG002 - they are the request itself
        """The positions, shape (n,), rad or m."""
        return np.array(self.positions)


@dataclass(frozen=True)
class Instants(_Channels):
    """Samples at instants that somebody else chose, in any steps: those of a result that was computed elsewhere."""

    instants: tuple[float, ...]  # s, increasing

    @property
    def count(self) -> int:
        """The number of samples, n."""
        return len(self.instants)

    def times(self, scene: Scene) -> Samples:  # noqa: ARG002 - they are the request itself
        """The instants, shape (n,), s."""
        return np.array(self.instants)

    def commanded(self, scene: Scene) -> Samples:
        """The positions that the drive commands at those instants, shape (n,), rad or m."""
        return scene.drive.at(self.times(scene)).position


Request: TypeAlias = Sampling | Positions  # of a model
Rows: TypeAlias = Request | Instants  # of anything that is compared
