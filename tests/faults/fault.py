"""A fault: a motion, or the scene that an engine solves, made wrong on purpose; and the clean run that it spoils."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar
from zlib import crc32

import numpy as np

from compare.engines.runner import Run
from compare.mechanics.motion_vectors import MotionVectors
from compare.mechanics.reference import Reference
from compare.mechanics.scales import apart, sizes
from scenes import Motion, Sampling, Scene, Settings
from scenes.channels import named
from scenes.model.motion import Samples

Item = TypeVar("Item")

OF_POINTS = (("", "place"), ("v", "velocity"), ("a", "acceleration"))
OF_BODIES = ("angle", "omega", "alpha")


@dataclass(frozen=True)
class Fault:
    """One way in which an answer is wrong: by its motion, or by the scene that was solved in place of the right one."""

    family: str
    kind: str
    magnitude: float
    cause: str  # the `Kind` that triage should name
    place: str  # the body, joint or point where it is, `drive` or `all`
    spoil: Callable[[], Motion] | None = None
    scene: Scene | None = None
    settings: Settings | None = None  # other ones than the run is judged by


@dataclass(frozen=True)
class Clean:
    """An engine's run with nothing wrong in it, and what of it can be spoilt."""

    reference: Reference
    sampling: Sampling
    run: Run

    @property
    def scene(self) -> Scene:
        """The scene solved."""
        return self.reference.scene

    @cached_property
    def motion(self) -> Motion:
        """The motion, every channel."""
        assert self.run.motion is not None
        return self.run.motion

    @cached_property
    def true(self) -> Motion:
        """What it should be."""
        return self.reference.at(self.sampling.inputs(self.scene))

    @property
    def promise(self) -> float:
        """The largest relative error that the settings promise."""
        assert self.run.settings is not None
        return self.run.settings.promise

    @property
    def drive(self) -> str:
        """The channel of the drive's position."""
        return self.scene.channels.drive.position

    @cached_property
    def state(self) -> MotionVectors:
        """The motion as vectors."""
        return MotionVectors(self.scene, self.motion)

    @property
    def channels(self) -> list[str]:
        """All channels that are judged, but the drive's."""
        return [
            name for name in self.motion.samples if name in self.reference.scale and name not in ("time", self.drive)
        ]

    def of(self, *quantities: str) -> list[str]:
        """Return the channels of some quantities."""
        return [name for name in self.channels if named(name).name in quantities]

    def grouped(self, *groups: str) -> Iterator[tuple[str, list[str]]]:
        """Yield those of some groups that have channels, with them."""
        for group in groups:
            if names := [name for name in self.channels if named(name).group == group]:
                yield group, names

    def stems(self, *quantities: str) -> list[str]:
        """Return the points, bodies or joints that have channels of some quantities, with something in them."""
        return [
            self.scene.channels[name].owner
            for name in self.of(*quantities)
            if np.abs(self.motion[name]).max() > 100 * self.promise * self.reference.scale[name]
        ]

    def size(self, channel: str) -> Samples:
        """Return what errors of a channel are divided by, shape (n,)."""
        return sizes(self.true, self.scene.channels[channel], self.reference.scale[channel])

    def some(self, items: Iterable[Item], kind: str, count: int = 1) -> Sequence[Item]:
        """Return a few of the items, always the same for a kind of fault, a scene and an engine."""
        found = [*dict.fromkeys(items)]
        draw = np.random.default_rng(crc32(f"{kind}/{self.scene.name}/{self.run.engine}".encode()))
        return [found[number] for number in sorted(draw.permutation(len(found))[:count])]


def above(fault: Fault, clean: Clean, motion: Motion) -> bool:
    """Return whether a fault moves a channel by more than its limit, straight from the motions.

    What an incomplete motion is off by cannot be measured: it is always above.
    """
    if fault.family == "data" or motion["time"].shape != clean.true["time"].shape:
        return True
    settings, scale = clean.run.settings, clean.reference.scale
    assert settings is not None
    if not np.array_equal(motion["time"], clean.motion["time"]):
        return True
    travel = 1.0 if clean.scene.drive.slide is None else float(np.ptp(clean.scene.drive.law.extent))
    off = np.abs(motion[clean.drive] - clean.sampling.commanded(clean.scene)).max() / travel
    if not off <= settings.drive_promise * max(1.0, float(np.ptp(clean.true[clean.drive])) / travel):
        return True
    for channel in clean.channels:
        pairs = [(motion[name], clean.true[name], clean.motion[name]) for name in _vector(channel)]
        error, own = (
            np.sqrt(sum(apart(clean.scene.channels[channel], one[k], one[1]) ** 2 for one in pairs)) for k in (0, 2)
        )
        size = np.full(own.shape, scale[channel])
        if named(channel).name not in ("x", "y", "angle"):
            size = np.maximum(size, np.sqrt(sum(one[1] ** 2 for one in pairs)))
        if not (error / size)[own <= settings.promise * size].max(initial=0.0) <= settings.promise:
            return True
    return False


def _vector(channel: str) -> tuple[str, ...]:
    """Return the channels of the vector that a channel belongs to."""
    return (f"{channel[:-1]}x", f"{channel[:-1]}y") if channel[-1] in "xy" else (channel,)
