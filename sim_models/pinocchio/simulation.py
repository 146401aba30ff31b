"""One run: poses at the samples by one of two routes, and the channels in each of them."""

from collections.abc import Iterator

import numpy as np

from scenes import Failure, Motion, Request, Scene, Status
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples

from ..coordinates.settings import PoseSettings
from ..coordinates.simulation import CoordinateSimulation
from ..coordinates.system import ClosedPose
from .system import PinocchioSystem

MAX_GAP = 0.1  # gap over the linkage's size, from where nothing pulls the loops together again
PULL = 5.0  # over the drive's rate of turning, 2 pi a cycle: stable with Heun's method from 16 steps a cycle on


class PinocchioSimulation(CoordinateSimulation[PinocchioSystem]):
    """One prepared run, see `scenes.model.engine.Simulation`."""

    def __init__(self, scene: Scene, settings: PoseSettings, request: Request) -> None:
        """Span the tree and assemble, see `engine.build`."""
        super().__init__(PinocchioSystem, scene, settings.steps, request)
        self._settings = settings
        self._poses: list[ClosedPose] = []

    def solve(self) -> None:
        """Find the poses, and the channels in them."""
        system = self._system
        self._follower.begin(self._turns)
        self._poses, rows = [], []
        for pose, *rates in self._motion():
            bodies = system.moved(pose.x, *rates)
            row = system.kinematics(bodies)
            if self._forces:
                row |= system.forces((pose.x, *rates), pose.J, bodies, self._ends)
            self._poses.append(pose)
            rows.append([row[channel] for channel in self._wanted])
        self._channels = dict(zip(self._wanted, np.array(rows).T, strict=True))
        self.counters = self._follower.counters

    def read(self) -> Motion:
        """Hand over the channels."""
        if not self._steps:
            self.residuals = self._follower.residuals(self._poses, self._driven.position, self._settings.promise)
        return super().read()

    def _motion(self) -> Iterator[tuple[ClosedPose, Samples, Samples]]:
        """Yield pose and the rates and accelerations of its coordinates at every sample."""
        if self._steps:
            yield from self._stepped()
            return
        driven = self._driven
        for pose, rate, acceleration in zip(self._through(), driven.rate, driven.acceleration, strict=True):
            tangent, bend = self._follower.tangent(pose)
            yield pose, tangent * rate, bend * rate**2 + tangent * acceleration

    def _stepped(self) -> Iterator[tuple[ClosedPose, Samples, Samples]]:
        """Yield the same from accelerations integrated in time, as codes do that close loops by them alone.

        With Baumgarte's terms J a = e s'' - J' v - 2 k (J v - e s') - k^2 (C - e s), by Heun's method; nothing else
        closes the loops.
        """
        follower, system, scene, count = self._follower, self._system, self._scene, self._steps
        h = scene.cycle / self._samples / self._each
        driven = np.transpose(inputs_of(scene, h * np.arange(count + 1)).driven())
        k = PULL * 2 * np.pi / scene.cycle

        def acceleration(pose: ClosedPose, v: Samples, instants: Samples, k: float) -> Samples:
            goal, rate, change = (follower.goal(value) for value in instants)
            drift = 2 * k * (pose.J @ v - rate) + k**2 * (system.gaps(pose.x) - goal)
            with np.errstate(over="ignore", invalid="ignore"):  # a run that leaves its branch may run away
                return np.asarray(np.linalg.solve(pose.J, change - system.bend(pose.x, v) - drift))

        pose, v = self._start, driven[0][1] * follower.tangent(self._start)[0]
        for step in range(count + 1):
            if step % self._each == 0:
                yield pose, v, acceleration(pose, v, driven[step], 0.0)
            if step == count:
                return
            follower.budget.check(f"{step} of {count} steps are done")
            follower.counters["steps"] += 1
            try:
                # Heun's method for the rates, a Taylor step for the coordinates: order 2 in both. Baumgarte's terms
                # pull gaps and their rates to zero like a critically damped oscillator of frequency k (Baumgarte 1972).
                a = acceleration(pose, v, driven[step], k)
                ahead = acceleration(follower.pose(pose.x + h * v), v + h * a, driven[step + 1], k)
            except np.linalg.LinAlgError:
                ahead = np.full_like(v, np.nan)
            pose, v = follower.pose(pose.x + h * v + h**2 / 2 * a), v + h / 2 * (a + ahead)
            closed = bool(np.abs(system.gaps(pose.x) - follower.goal(driven[step + 1][0])).max() <= MAX_GAP)
            if not (closed and pose.branch == self._start.branch):
                status = Status.wrong_branch if closed else Status.diverged
                raise Failure(status, f"a step left the branch at {self._scene.where(driven[step + 1][0])}")
