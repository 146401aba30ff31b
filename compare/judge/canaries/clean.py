"""A clean run: what is copied, and spoilt on purpose."""

from dataclasses import dataclass
from functools import cached_property

from scenes import Motion, Sampling, Scene

from ...engines.reference import Reference
from ...engines.runner import Run


@dataclass(frozen=True)
class CleanRun:
    """An engine's run with nothing wrong in it."""

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
        return self.reference.at(self.sampling.commanded(self.scene), self.sampling.times(self.scene))

    @property
    def promise(self) -> float:
        """The largest relative error that the settings promise."""
        assert self.run.settings is not None
        return self.run.settings.promise

    @property
    def drive(self) -> str:
        """The channel of the drive's position."""
        return self.scene.drive_channel
