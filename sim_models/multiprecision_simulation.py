"""One run at arbitrary precision: march over the samples, prove each, round the channels at the end."""

from collections.abc import Iterable, Mapping
from math import ceil, remainder, tau
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, ctx

from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.motion import Samples, force_channels

from .multiprecision_linkage import Linkage, angles
from .multiprecision_march import March

ENOUGH = 1e-20  # largest proven error of the motion, relative; far below what a double resolves


class State(NamedTuple):
    """Balls that hold the solution of one sample, each of shape (rows, 1)."""

    q: arb_mat  # m, rad: x, y, θ of every body
    velocity: arb_mat
    acceleration: arb_mat
    multipliers: arb_mat  # N, N m, in the order of the force channels


class MultiprecisionSimulation:
    """One prepared run, see `scenes.engine.Simulation`."""

    def __init__(self, scene: Scene, sampling: Sampling, digits: int) -> None:
        """Find the pose at the first sample.

        Raises:
            Failure: the linkage cannot be assembled as sketched, or locks on the way to the first sample.
        """
        self._scene, self._sampling, self._digits = scene, sampling, digits
        self._crank_angles = sampling.commanded(scene).tolist()
        start = self._crank_angles[0]
        sketched = start + remainder(scene.sketch.angle - start, tau)  # from there the short way round to the start
        with ctx.workdps(digits):  # puts back the precision it found
            self._linkage = Linkage(scene)
            march = March(self._linkage, digits)
            q = march.follow(self._linkage.sketched_pose(sketched), self._linkage.goal(sketched))
            self._start = march.follow(q, self._linkage.goal(start))
        self._states: list[State] = []
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}

    def solve(self) -> None:
        """March over the samples and enclose each.

        Raises:
            Failure: the linkage locks at some crank angle, or the digits are too few.
        """
        march = March(self._linkage, self._digits)
        self._states = []
        q = self._start
        with ctx.workdps(self._digits):
            for crank_angle in self._crank_angles:
                goal = self._linkage.goal(crank_angle)
                q = march.follow(q, goal)
                self._states.append(self._state(march.enclose(q, goal)))
            self.residuals = self._residuals()
        self.counters = march.counters
        if not self.residuals["constraints"] <= ENOUGH:
            reason = f"{self._digits} digits prove the motion only to {self.residuals['constraints']:.0e}"
            raise Failure(Status.not_converged, reason)

    def read(self) -> Motion:
        """Return every channel of the scene, rounded to double precision here and nowhere before."""
        scene, linkage, states = self._scene, self._linkage, self._states
        samples = {"time": self._sampling.times(scene)}
        with ctx.workdps(self._digits):
            samples["crank_angle"] = _table([linkage.crank_angle(state.q)] for state in states)[:, 0]
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
        for i, body in enumerate(scene.bodies.values()):
            if body.slide is None:
                samples[f"{body.name}.angle"] = angle[:, i]
                samples[f"{body.name}.omega"] = omega[:, i]
                samples[f"{body.name}.alpha"] = alpha[:, i]
        if scene.has_masses:
            samples |= zip(force_channels(scene), multipliers.T, strict=True)
        return Motion(samples)

    def _state(self, q: arb_mat) -> State:
        """Return what follows from the pose: J q' = f', J q'' = centripetal, J^T λ = M q'' - Q."""
        linkage, rows = self._linkage, self._linkage.constraints
        J = rows.jacobian(q)
        velocity = J.solve(linkage.drive_rate(self._scene.drive.speed))
        acceleration = J.solve(rows.centripetal(q, velocity))
        multipliers = J.transpose().solve(linkage.mass * acceleration - linkage.work.jacobian(q).transpose())
        return State(q, velocity, acceleration, multipliers)

    def _points(self, state: State) -> tuple[list[float], list[float], list[float]]:
        """Return x, y of the moving points and their first and second time derivatives, each of length 2 points."""
        points = self._linkage.points
        J = points.jacobian(state.q)
        acceleration = J * state.acceleration - points.centripetal(state.q, state.velocity)
        position, velocity = points.value(state.q), J * state.velocity
        return _floats(position.entries()), _floats(velocity.entries()), _floats(acceleration.entries())

    def _residuals(self) -> dict[str, float]:
        """Return the proven errors: of the angles and their rates in crank angle, and of the largest multiplier."""
        speed = abs(self._scene.drive.speed)
        motion = [
            [_radius(angles(derivative)) / speed**order for order, derivative in enumerate(state[:3])]
            for state in self._states
        ]
        residuals = {"constraints": float(np.max(motion))}
        if self._scene.has_masses:
            force = np.max([_radius(state.multipliers.entries()) for state in self._states])
            peak = np.max(np.abs(_table(state.multipliers.entries() for state in self._states)))
            residuals["newton-euler"] = float(force / peak if peak > 0 else force)
        return residuals


def _within_a_turn(angle: arb) -> arb:
    """Return an angle less the whole turns that leave it in (-π, π]."""
    return angle - 2 * arb.pi() * ceil(float(angle) / tau - 0.5)


def _radius(balls: Iterable[arb]) -> float:
    return float(np.max([float(ball.rad()) for ball in balls]))


def _floats(balls: Iterable[arb]) -> list[float]:
    return [float(ball) for ball in balls]


def _table(rows: Iterable[Iterable[arb]]) -> Samples:
    return np.array([_floats(row) for row in rows])
