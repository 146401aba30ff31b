"""One run: what all engines of minimal equations do with a start and a request."""

from collections.abc import Callable, Iterator, Mapping
from typing import Generic, TypeVar

import numpy as np

from scenes import Motion, Request, Sampling, Scene
from scenes.channels import Role
from scenes.model.engine import equal_steps
from scenes.model.motion import Samples

from .poses import begun
from .system import ClosedPose, System

S = TypeVar("S", bound=System)


class CoordinateSimulation(Generic[S]):
    """One prepared run, see `scenes.model.engine.Simulation`; `solve` is each engine's own."""

    whole_way = False  # whether the drive's is followed beforehand, since steps do not find out where the linkage locks

    def __init__(self, kind: Callable[[Scene], S], scene: Scene, steps: int | None, request: Request) -> None:
        """Begin with the start of a kind of system, for a run of at least so many steps a cycle, or of none."""
        self._scene = scene
        self._system: S
        self._system, self._follower, self._start, self._ends = begun(kind, scene, self.whole_way)
        self._samples = 1 if steps is None else equal_steps(request).samples  # a cycle
        self._turns = request.turns if isinstance(request, Sampling) else 1
        self._each = -(-(steps or 0) // self._samples)  # steps from a sample to the next
        self._steps = self._each * self._samples * self._turns
        inputs = request.inputs(scene)
        self._times, self._driven = inputs.time, inputs.rows()
        self._wanted = [name for name in request.wanted(scene) if scene.channels[name].role is not Role.time]
        self._forces = request.wants_forces(scene)
        self._channels: Mapping[str, Samples] = {}
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}

    def read(self) -> Motion:
        """Hand over the channels."""
        wanted = {name: np.ascontiguousarray(self._channels[name]) for name in self._wanted}
        return Motion({"time": self._times} | wanted)

    def _through(self) -> Iterator[ClosedPose]:
        """Yield the poses at the samples by Newton's method."""
        start = self._follower.system.drive.law.start
        return self._follower.through(self._start, start, self._driven.position.tolist())
