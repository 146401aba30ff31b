"""One run at arbitrary precision: march over the samples, prove each, round the channels at the end."""

from collections.abc import Iterable, Mapping
from math import ceil, remainder, tau
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, ctx

from scenes import Failure, Motion, Request, Scene, Status
from scenes.loads import PressForce
from scenes.motion import Samples, force_channels

from .constraints import Linkage
from .loads import Loads
from .march import March
from .rows import angles
from .stroke import end_of_stroke

ENOUGH = 1e-20  # largest proven error of the motion and of the forces, relative; far below what a double resolves


class State(NamedTuple):
    """Balls that hold the solution of one sample, each of shape (rows, 1)."""

    q: arb_mat  # m, rad: x, y, θ of every body
    velocity: arb_mat
    acceleration: arb_mat
    multipliers: arb_mat  # N, N m, in the order of the force channels


class MultiprecisionSimulation:
    """One prepared run, see `scenes.engine.Simulation`."""

    def __init__(self, scene: Scene, request: Request, digits: int) -> None:
        """Find the pose at the start, and where the strokes of press forces end.

        Raises:
            Failure: the linkage cannot be assembled as sketched, or locks on the way to the start, or within the
                cycle where a press force asks for its end.
        """
        self._scene, self._request, self._digits = scene, request, digits
        start, sketched = scene.drive.start, scene.sketch.drive
        if scene.driven_slide is None:
            sketched = start + remainder(sketched - start, tau)  # from there the short way round to the start
        with ctx.workdps(digits):  # puts back the precision it found
            self._linkage = Linkage(scene)
            march = March(self._linkage, digits)
            q = march.follow(self._linkage.sketched_pose(sketched), self._linkage.drive(sketched))
            self._start = march.follow(q, self._linkage.drive(start))
            meeting = [load for load in scene.loads if isinstance(load, PressForce)]
            ends = {load: end_of_stroke(self._linkage, march, self._start, load) for load in meeting}
            self._loads = Loads(self._linkage, ends)
        self._states: list[State] = []
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}

    def solve(self) -> None:
        """March over the samples and enclose each.

        Raises:
            Failure: the linkage locks at some position of the drive, or the digits are too few.
        """
        scene = self._scene
        _, rates, accelerations = scene.drive.at(self._request.times(scene))
        driven = zip(self._request.commanded(scene).tolist(), rates.tolist(), accelerations.tolist(), strict=True)
        march = March(self._linkage, self._digits)
        self._states = []
        q = self._start
        with ctx.workdps(self._digits):
            for position, rate, acceleration in driven:
                goal = self._linkage.drive(position)
                q = march.follow(q, goal)
                self._states.append(self._state(march.enclose(q, goal), rate, acceleration))
            self.residuals = self._residuals()
        self.counters = march.counters
        for proven, what in (("constraints", "motion"), ("newton-euler", "forces")):
            if proven in self.residuals and not self.residuals[proven] <= ENOUGH:
                reason = f"{self._digits} digits prove the {what} only to {self.residuals[proven]:.0e}"
                raise Failure(Status.not_converged, reason)

    def read(self) -> Motion:
        """Return the channels asked for, rounded to double precision here and nowhere before."""
        scene, linkage, states = self._scene, self._linkage, self._states
        samples = {"time": self._request.times(scene)}
        with ctx.workdps(self._digits):
            samples[scene.drive_channel] = _table(linkage.position.value(state.q).entries() for state in states)[:, 0]
            x, v, a = (np.array(rows) for rows in zip(*(self._points(state) for state in states), strict=True))
            angle = _table(map(_within_a_turn, angles(state.q)) for state in states)
            omega = _table(angles(state.velocity) for state in states)
            alpha = _table(angles(state.acceleration) for state in states)
            multipliers = _table(state.multipliers.entries() for state in states)
        for k, point in enumerate(scene.moving_points):
            for axis, column in (("x", 2 * k), ("y", 2 * k + 1)):
                samples[f"{point}.{axis}"] = x[:, column]
                samples[f"{point}.v{axis}"] = v[:, column]
                samples[f"{point}.a{axis}"] = a[:, column]
        for body in scene.turning:
            column = linkage.index[body]
            samples[f"{body}.angle"] = angle[:, column]
            samples[f"{body}.omega"] = omega[:, column]
            samples[f"{body}.alpha"] = alpha[:, column]
        if scene.has_masses:
            samples |= zip(force_channels(scene), multipliers.T, strict=True)
        return Motion({channel: samples[channel] for channel in self._request.wanted(scene)})

    def _state(self, q: arb_mat, rate: float, acceleration: float) -> State:
        """Return what follows from the pose, e being the drive's row.

        J q' = e rate, J q'' = e acceleration + centripetal, J^T λ = M q'' - Q.
        """
        linkage, rows = self._linkage, self._linkage.constraints
        J = rows.jacobian(q)
        velocity = J.solve(linkage.drive(rate))
        total = J.solve(linkage.drive(acceleration) + rows.centripetal(q, velocity))
        multipliers = J.transpose().solve(linkage.mass * total - self._loads.generalised(q, velocity))
        return State(q, velocity, total, multipliers)

    def _points(self, state: State) -> tuple[list[float], list[float], list[float]]:
        """Return x, y of the moving points and their first and second time derivatives, each of length 2 points."""
        points = self._linkage.points
        J = points.jacobian(state.q)
        acceleration = J * state.acceleration - points.centripetal(state.q, state.velocity)
        position, velocity = points.value(state.q), J * state.velocity
        return _floats(position.entries()), _floats(velocity.entries()), _floats(acceleration.entries())

    def _residuals(self) -> dict[str, float]:
        """Return the proven errors: of the motion, in the linkage's size, rad and the drive's pace; of the forces.

        A drive's pace is its rate, in rad/s, or in lengths of a driven slider's way a second. The error of the forces
        is that of any relative to the largest, or to what the heaviest body's inertia could take, where all are zero.
        """
        drive = self._scene.drive
        pace = drive.peak_rate / (1.0 if self._scene.driven_slide is None else float(np.ptp(drive.extent)))
        units = np.array(self._linkage.units)
        motion = [
            np.max(_radii(derivative) / units) / pace**order
            for state in self._states
            for order, derivative in enumerate(state[:3])
        ]
        residuals = {"constraints": float(np.max(motion))}
        if self._scene.has_masses:
            force = np.max([_radii(state.multipliers) for state in self._states])
            peak = np.max(np.abs(_table(state.multipliers.entries() for state in self._states)))
            heaviest = max(float(self._linkage.mass[k, k]) for k in range(0, len(units), 3))
            scale = max(peak, heaviest * self._linkage.size * pace**2)
            residuals["newton-euler"] = float(force / scale if scale > 0 else force)
        return residuals


def _within_a_turn(angle: arb) -> arb:
    """Return an angle less the whole turns that leave it in (-π, π]."""
    return angle - 2 * arb.pi() * ceil(float(angle) / tau - 0.5)


def _radii(balls: arb_mat) -> Samples:
    return np.array([float(ball.rad()) for ball in balls.entries()])


def _floats(balls: Iterable[arb]) -> list[float]:
    return [float(ball) for ball in balls]


def _table(rows: Iterable[Iterable[arb]]) -> Samples:
    return np.array([_floats(row) for row in rows])
