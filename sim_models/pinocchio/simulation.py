"""One run: poses at the samples by one of two routes, and the channels in each of them."""

from collections.abc import Iterator, Mapping

import numpy as np

from scenes import Failure, Motion, ProcessorBudget, Request, Sampling, Scene, Status
from scenes.engine import equal_steps
from scenes.motion import Samples

from . import channels
from .poses import SECONDS, Pose
from .settings import Baumgarte, PinocchioSettings
from .start import begun
from .stepping import stepped

ROUNDING = float(np.finfo(float).eps) / 2


def build(scene: Scene, settings: PinocchioSettings, request: Request) -> "PinocchioSimulation":
    """Span the tree and assemble, see `engine.build`."""
    if isinstance(settings, Baumgarte):
        equal_steps(request)
    return PinocchioSimulation(scene, settings, request)


class PinocchioSimulation:
    """One prepared run, see `scenes.engine.Simulation`."""

    def __init__(self, scene: Scene, settings: PinocchioSettings, request: Request) -> None:
        self._scene, self._settings, self._request = scene, settings, request
        self._poses, self._start, self._ends = begun(scene)
        self._wanted = [channel for channel in request.wanted(scene) if channel != "time"]
        self._times, self._positions = request.times(scene), request.commanded(scene)
        self._rows: list[list[float]] = []
        self._largest: list[float] = []  # of the derivatives of the coordinates by the drive's way
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}

    def solve(self) -> None:
        """Find the poses, and the channels in them.

        Raises:
            Failure: the linkage locks, two branches meet, a step led to another branch or nowhere, a spring has no
                direction, or `timed_out`.
        """
        poses, turns = self._poses, self._request.turns if isinstance(self._request, Sampling) else 1
        poses.budget = ProcessorBudget(SECONDS * turns, "the way of the linkage")
        poses.counters = dict.fromkeys(poses.counters, 0)
        closures, forces = poses.closures, self._request.wants_forces(self._scene)
        self._rows, self._largest = [], [0.0]
        for pose, velocity, acceleration in self._motion():
            bodies = closures.tree.moved(pose.q, velocity, acceleration)
            found = channels.kinematics(closures, pose.q, bodies)
            if forces:
                found |= channels.forces(closures, pose, bodies, (velocity, acceleration), self._ends)
            self._rows.append([found[channel] for channel in self._wanted])
        self.counters = poses.counters

    def read(self) -> Motion:
        """Return the channels.

        Raises:
            Failure: `not_converged`, rounding alone may break the promise.
        """
        columns = zip(self._wanted, np.array(self._rows).T, strict=True)
        motion = Motion({"time": self._times} | {name: np.ascontiguousarray(column) for name, column in columns})
        self.residuals = {"rounding": ROUNDING * max(self._largest)}
        if not self.residuals["rounding"] <= self._settings.promise:
            where = self._scene.where(self._positions[int(np.argmax(self._largest[1:]))])
            reason = f"rounding alone may be {self.residuals['rounding']:.1e} of an acceleration at {where}"
            raise Failure(Status.not_converged, f"{reason}, too close to a lock")
        return motion

    def _motion(self) -> Iterator[tuple[Pose, Samples, Samples]]:
        """Yield pose, rates and accelerations at every sample."""
        poses, driven = self._poses, self._scene.drive.at(self._times)
        if isinstance(self._settings, Baumgarte):
            yield from stepped(poses, self._start, equal_steps(self._request), self._settings.steps)
            return
        travel = 1.0 if self._scene.driven_slide is None else float(np.ptp(self._scene.drive.extent))
        way = poses.through(self._start, self._scene.drive.start, self._positions.tolist())
        for pose, rate, acceleration in zip(way, driven.rate, driven.acceleration, strict=True):
            try:
                tangent, bend = poses.tangent(pose)
            except np.linalg.LinAlgError:
                raise Failure(Status.not_converged, "the linkage is singular at one of the samples") from None
            units = poses.closures.units
            self._largest.append(
                float(max(np.abs(tangent / units).max() * travel, np.abs(bend / units).max() * travel**2))
            )
            yield pose, tangent * rate, bend * rate**2 + tangent * acceleration
