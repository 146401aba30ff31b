"""One run: poses at the samples, and the channels there by one compiled function."""

import casadi
import numpy as np
from casadi import MX, SX, Function

from scenes import Failure, Motion, Request, Scene, Status

from ..coordinates.loads import MIN_SPRING_LENGTH
from ..coordinates.settings import PoseSettings
from ..coordinates.simulation import CoordinateSimulation
from ..coordinates.system import ClosedPose
from .linkage import channels
from .system import SOLVER, CasadiSystem, Compiled


class CasadiSimulation(CoordinateSimulation[CasadiSystem]):
    """One prepared run, see `scenes.model.engine.Simulation`."""

    def __init__(self, scene: Scene, settings: PoseSettings, request: Request) -> None:
        """Differentiate and assemble, see `engine.build`."""
        super().__init__(CasadiSystem, scene, settings.steps, request)
        self._settings = settings
        self._sampled = self._compiled()
        self._poses: list[ClosedPose] = []
        self._shortest = np.empty(0)  # spring at every sample, over the linkage's size

    def solve(self) -> None:
        """Find the poses, and the channels in them."""
        self._follower.begin(self._turns)
        self._poses = self._integrated() if self._steps else [*self._through()]
        x = np.transpose([pose.x for pose in self._poses])
        try:
            table = self._sampled(x, self._driven.rate[None], self._driven.acceleration[None])
        except RuntimeError:
            raise Failure(Status.not_converged, "the linkage is singular at one of the samples") from None
        *rows, self._shortest = np.array(table, dtype=np.float64)
        self._channels = dict(zip(self._wanted, rows, strict=True))
        self.counters = self._follower.counters

    def read(self) -> Motion:
        """Hand over the channels."""
        motion = super().read()
        if self._forces and not self._shortest.min() > MIN_SPRING_LENGTH:
            where = self._scene.where(self._driven.position[self._shortest.argmin()])
            raise Failure(Status.nonfinite, f"the ends of a spring meet at {where}: it has no direction", motion)
        self.residuals = self._follower.residuals(self._poses, self._driven.position, self._settings.promise)
        return motion

    def _integrated(self) -> list[ClosedPose]:
        """Return the poses at the samples, by Runge and Kutta's method of dx/ds = C_x^-1 e; nothing is corrected."""
        follower, unit, count = self._follower, self._system.drive_unit, self._steps
        # Integration by the drive's position instead of the time: dx/ds = C_x^-1 e does not depend on the law. Gaps are
        # not corrected and grow with the method's error, of order 4 in the step.
        positions = self._system.drive.law.after(np.arange(count + 1) / (self._each * self._samples))
        step, poses, pose = self._step(), [self._start], self._start
        for number, (position, width) in enumerate(zip(positions[:-1], np.diff(positions) / unit, strict=True), 1):
            follower.budget.check(f"{number} of {count} steps are done")
            try:
                pose = follower.pose(step(pose.x, width)[0])
            except RuntimeError:
                reason = f"a step past {self._scene.where(position)} came to a singular pose"
                raise Failure(Status.diverged, reason) from None
            if pose.branch != self._start.branch:  # a sign of NaN is another one too
                where = self._scene.where(positions[number])
                raise Failure(Status.wrong_branch, f"a step led to another way to assemble the bodies at {where}")
            if number % self._each == 0:
                poses.append(pose)
        follower.counters["steps"] = count
        return poses

    def _step(self) -> Compiled:
        """Return the function of a pose and a step of the drive, over its unit, that gives the next pose."""
        (_, jacobian, _), count = self._system.linkage.functions, len(self._start.x)
        x, h, nothing = MX.sym("x", count), MX.sym("h"), MX.sym("p", 0)
        rate = Function("rate", [x, nothing], [casadi.solve(jacobian(x), np.eye(count)[:, -1], SOLVER)])
        return Compiled(Function("step", [x, h], [casadi.simpleRK(rate, 1, 4)(x, nothing, h)]))

    def _compiled(self) -> Function:
        """Return the channels and the shortest spring as a function of x and the drive's rate and acceleration."""
        linkage, count = self._system.linkage, len(self._start.x)
        _, jacobian, bend = linkage.functions
        x, rate, acceleration = MX.sym("x", count), MX.sym("rate"), MX.sym("acceleration")
        # Three linear systems with one Jacobian: velocity, acceleration, and with its transpose the multipliers.
        J, unit = jacobian(x), np.eye(count)[:, -1] / self._system.drive_unit
        v = casadi.solve(J, unit * rate, SOLVER)
        a = multipliers = MX.zeros(count)
        if self._forces or any(self._scene.channels[name].order == 2 for name in self._wanted):
            a = casadi.solve(J, unit * acceleration - bend(x, v), SOLVER)
        if self._forces:
            known = [linkage.x, linkage.v, linkage.a, linkage.stroke_ends]
            needed = Function("needed", known, [linkage.required])
            multipliers = casadi.solve(J.T, needed(x, v, a, [*self._ends.values()]), SOLVER)
        held = SX.sym("l", count)
        rows = casadi.vertcat(*map(channels(linkage, held).__getitem__, self._wanted), linkage.shortest_spring)
        sampled = Function("channels", [linkage.x, linkage.v, linkage.a, held], [rows])
        return Function("sample", [x, rate, acceleration], [sampled(x, v, a, multipliers)])
