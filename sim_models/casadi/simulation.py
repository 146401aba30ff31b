"""One run: poses at the samples, and the channels there by one compiled function."""

from collections.abc import Mapping

import casadi
import numpy as np
from casadi import MX, SX, Function

from scenes import Failure, Motion, ProcessorBudget, Request, Sampling, Scene, Status
from scenes.engine import equal_steps
from scenes.motion import Samples, quantity

from .channels import channels
from .linkage import table
from .poses import SECONDS, SOLVER, STEPS
from .settings import CasadiSettings, RungeKutta
from .start import begun

SHORTEST_SPRING = 1e-12  # of the linkage's size; a shorter one's direction is round-off
ROUNDING = float(np.finfo(float).eps) / 2


def build(scene: Scene, settings: CasadiSettings, request: Request) -> "CasadiSimulation":
    """Differentiate and assemble, see `engine.build`."""
    if isinstance(settings, RungeKutta):
        equal_steps(request)
    return CasadiSimulation(scene, settings, request)


class CasadiSimulation:
    """One prepared run, see `scenes.engine.Simulation`."""

    def __init__(self, scene: Scene, settings: CasadiSettings, request: Request) -> None:
        self._scene, self._settings, self._request = scene, settings, request
        self._poses, self._start, self._ends = begun(scene)
        self._linkage = self._poses.linkage
        self._wanted = [channel for channel in request.wanted(scene) if channel != "time"]
        self._times, self._positions = request.times(scene), request.commanded(scene)
        self._driven = scene.drive.at(self._times)
        self._sampled = self._compiled()
        self._x, self._rows = np.empty((0, 0)), np.empty((0, 0))
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}

    def solve(self) -> None:
        """Find the poses, and the channels in them.

        Raises:
            Failure: the linkage locks, or two branches meet; a step led to another branch or nowhere; `timed_out`.
        """
        poses, turns = self._poses, self._request.turns if isinstance(self._request, Sampling) else 1
        poses.budget = ProcessorBudget(SECONDS * turns, "the way of the linkage")
        poses.counters = dict.fromkeys(poses.counters, 0)
        if isinstance(self._settings, RungeKutta):
            self._x = self._integrated(self._settings.steps)
        else:
            self._x = poses.through(self._start, self._scene.drive.start, self._positions)
        self._rows = self._at(self._x)
        self.counters = poses.counters

    def read(self) -> Motion:
        """Return the channels.

        Raises:
            Failure: `nonfinite`, a spring has no direction, with the motion; `not_converged`, rounding alone may
                break the promise.
        """
        goals = self._poses.goals(self._positions)
        rows = (np.ascontiguousarray(row) for row in self._rows)
        motion = Motion({"time": self._times} | dict(zip(self._wanted, rows, strict=False)))
        shortest = self._rows[-1]
        if self._request.wants_forces(self._scene) and not shortest.min() > SHORTEST_SPRING:
            where = self._scene.where(self._positions[shortest.argmin()])
            raise Failure(Status.nonfinite, f"the ends of a spring meet at {where}: it has no direction", motion)
        rounding, where = self._rounding()
        self.residuals = {"constraints": float(np.abs(table(self._linkage.gaps, self._x) - goals).max())}
        self.residuals |= {"rounding": rounding}
        if not rounding <= self._settings.promise:
            reason = f"rounding alone may be {rounding:.1e} of an acceleration at {where}, too close to a lock"
            raise Failure(Status.not_converged, reason)
        return motion

    def _at(self, x: Samples) -> Samples:
        """Return the channels in poses, and the shortest spring, shape (channels + 1, n)."""
        try:
            return table(self._sampled, x, self._driven.rate[None], self._driven.acceleration[None])
        except RuntimeError:
            raise Failure(Status.not_converged, "the linkage is singular at one of the samples") from None

    def _rounding(self) -> tuple[float, str]:
        """Return how much rounding may be in accelerations, of those that the drive has, and where most of it is.

        A linear system's solution is good to round-off of its largest part, and near a lock that is far larger.
        """
        travel = 1.0 if self._scene.driven_slide is None else float(np.ptp(self._scene.drive.extent))
        rate, bend = self._poses.tangent(self._x)
        parts = np.maximum(np.abs(rate) * travel, np.abs(bend) * travel**2).max(axis=0)
        return float(ROUNDING * parts.max()), self._scene.where(self._positions[parts.argmax()])

    def _integrated(self, steps: int) -> Samples:
        """Return the poses by Runge and Kutta's method, shape (3 bodies, n)."""
        sampling, poses = equal_steps(self._request), self._poses
        each = -(-steps // sampling.samples)  # from a sample to the next
        count = each * sampling.samples * sampling.turns
        positions = self._scene.drive.after(np.arange(count + 1) / (each * sampling.samples))
        widths = np.append(np.diff(positions), np.zeros(-count % STEPS)) / self._linkage.drive_unit
        found, x = [self._start[:, None]], self._start
        for first in range(0, count, STEPS):
            poses.budget.check(f"{first} of {count} steps are done")
            try:
                found.append(table(poses.runge_kutta, x, widths[None, first : first + STEPS]))
            except RuntimeError:
                where = self._scene.where(positions[first])
                raise Failure(Status.diverged, f"a step past {where} came to a singular pose") from None
            x = found[-1][:, -1]
        poses.counters["steps"] = count
        path = np.hstack(found)[:, : count + 1]
        other = poses.branch(path) != poses.branch(self._start[:, None])  # a sign of NaN is another one too
        if other.any():
            where = self._scene.where(positions[other.argmax()])
            raise Failure(Status.wrong_branch, f"a step led to another way to assemble the bodies at {where}")
        return path[:, ::each]

    def _compiled(self) -> Function:
        """Return the function that gives the channels from x and the drive's rate and acceleration."""
        linkage, count = self._linkage, self._poses.rows
        x, rate, acceleration = MX.sym("x", count), MX.sym("rate"), MX.sym("acceleration")
        J, unit = linkage.jacobian(x), self._poses.drive_row / linkage.drive_unit
        v = casadi.solve(J, unit * rate, SOLVER)
        a = multipliers = MX.zeros(count)
        forces = self._request.wants_forces(self._scene)
        if forces or any(quantity(channel) in ("ax", "ay", "alpha") for channel in self._wanted):
            a = casadi.solve(J, unit * acceleration - linkage.bend(x, v), SOLVER)
        if forces:
            multipliers = casadi.solve(J.T, linkage.needed(x, v, a, self._ends), SOLVER)
        held, known = SX.sym("l", count), [linkage.x, linkage.v, linkage.a]
        all_channels = channels(linkage, held)
        rows = casadi.vertcat(*map(all_channels.__getitem__, self._wanted), linkage.shortest_spring)
        return Function(
            "sample", [x, rate, acceleration], [Function("channels", [*known, held], [rows])(x, v, a, multipliers)]
        )
