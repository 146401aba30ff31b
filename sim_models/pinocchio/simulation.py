"""One run: poses at the samples by one of two routes, and the channels in each of them."""

from collections.abc import Iterator, Mapping
from functools import lru_cache

import numpy as np

from scenes import Motion, Request, Sampling, Scene
from scenes.engine import equal_steps
from scenes.motion import Samples

from ..coordinates.poses import ClosedPose
from ..coordinates.start import SCENES, Start, begun
from . import channels
from .closures import Closures
from .settings import Baumgarte, PinocchioSettings
from .stepping import stepped
from .tree import Tree


def build(scene: Scene, settings: PinocchioSettings, request: Request) -> "PinocchioSimulation":
    """Span the tree and assemble, see `engine.build`."""
    if isinstance(settings, Baumgarte):
        equal_steps(request)
    return PinocchioSimulation(scene, settings, request)


@lru_cache(SCENES)
def _begun(scene: Scene) -> tuple[Closures, Start]:
    closures = Closures(Tree(scene))
    return closures, begun(closures)


class PinocchioSimulation:
    """One prepared run, see `scenes.engine.Simulation`."""

    def __init__(self, scene: Scene, settings: PinocchioSettings, request: Request) -> None:
        self._scene, self._settings, self._request = scene, settings, request
        self._closures, (self._follower, self._start, self._ends) = _begun(scene)
        self._wanted = [channel for channel in request.wanted(scene) if channel != "time"]
        self._times, self._positions = request.times(scene), request.commanded(scene)
        self._poses: list[ClosedPose] = []
        self._rows: list[list[float]] = []
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}

    def solve(self) -> None:
        """Find the poses, and the channels in them.

        Raises:
            Failure: the linkage locks, two branches meet, a step led to another branch or nowhere, a spring has no
                direction, or `timed_out`.
        """
        follower, closures, units = self._follower, self._closures, self._closures.units
        follower.begin(self._request.turns if isinstance(self._request, Sampling) else 1)
        forces = self._request.wants_forces(self._scene)
        self._poses, self._rows = [], []
        for pose, *rates in self._motion():
            velocity, acceleration = (units * rate for rate in rates)
            bodies = closures.tree.moved(units * pose.x, velocity, acceleration)
            row = channels.kinematics(closures, units * pose.x, bodies)
            if forces:
                row |= channels.forces(closures, pose, bodies, (velocity, acceleration), self._ends)
            self._poses.append(pose)
            self._rows.append([row[channel] for channel in self._wanted])
        self.counters = follower.counters

    def read(self) -> Motion:
        """Return the channels.

        Raises:
            Failure: `not_converged`, rounding alone may break the promise.
        """
        columns = zip(self._wanted, np.array(self._rows).T, strict=True)
        motion = Motion({"time": self._times} | {name: np.ascontiguousarray(column) for name, column in columns})
        if not isinstance(self._settings, Baumgarte):
            self.residuals = self._follower.residuals(self._poses, self._positions, self._settings.promise)
        return motion

    def _motion(self) -> Iterator[tuple[ClosedPose, Samples, Samples]]:
        """Yield pose and the rates and accelerations of its coordinates at every sample."""
        follower, driven = self._follower, self._scene.drive.at(self._times)
        if isinstance(self._settings, Baumgarte):
            yield from stepped(follower, self._start, equal_steps(self._request), self._settings.steps)
            return
        way = follower.through(self._start, self._scene.drive.start, self._positions.tolist())
        for pose, rate, acceleration in zip(way, driven.rate, driven.acceleration, strict=True):
            tangent, bend = follower.tangent(pose)
            yield pose, tangent * rate, bend * rate**2 + tangent * acceleration
