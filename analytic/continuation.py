"""The branch of a group solved by Newton's method: poses over one turn, followed step by step from the sketch.

Every crank angle asked for starts from the nearest of these poses, so that its answer depends on no other angle.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import copysign, degrees, pi, radians
from typing import TypeAlias

import numpy as np

from scenes import Failure, Scene, Status
from scenes.motion import Samples

from .geometry import RigidBody, as_complex, sketched
from .newton_group import Complex, Group, System, assemble, rates, refine, system

STEP = radians(1.0)
SMALLEST = STEP / 2**20  # 1e-6 deg: a lock is found to that
SAME = 1e-6  # rad: two poses

Placed: TypeAlias = Callable[[Samples], tuple[Complex, Complex, Complex]]  # crank angle -> z, v, a of the placed pins


@dataclass(frozen=True)
class Track:
    """N poses by crank angle, within one turn, and how they change with the crank angle."""

    equations: System
    angle: Samples  # (N,), rad, increasing
    q: Samples  # (N, m)
    dq: Samples  # (N, m), by radian of the crank
    ddq: Samples  # (N, m), by radian squared
    branch: float  # the sign of det J: it changes where the branch meets another, in a lock

    def at(self, angle: Samples, z: Complex) -> tuple[Samples, Samples]:
        """Return the coordinates (n, m) and the Jacobian (n, m, m), NaN where the branch does not reach."""
        start = self.angle[0]
        middles = (self.angle[1:] + self.angle[:-1]) / 2
        nearest = np.searchsorted(middles, start + np.remainder(angle - start, 2 * pi))
        h = (np.remainder(angle - self.angle[nearest] + pi, 2 * pi) - pi)[:, None]
        guess = self.q[nearest] + h * (self.dq[nearest] + h / 2 * self.ddq[nearest])
        near = np.abs(h) <= 1.01 * STEP  # a whole step, and its roundings; further off there is no pose to start from
        q, found = refine(self.equations, np.where(near, guess, np.nan), z)
        J = self.equations.jacobian(q)
        found &= np.linalg.slogdet(J)[0] == self.branch
        return np.where(found[:, None], q, np.nan), np.where(found[:, None, None], J, np.nan)


def follow(scene: Scene, group: Group, bodies: Mapping[str, RigidBody], placed: Placed) -> Track:
    """Follow the sketch's branch round the whole turn, or to its locks on both sides.

    Raises:
        Failure: `cannot_assemble` at the sketch's angle; `unsupported` when a turn of the crank ends in another pose.
    """
    equations = system(scene, bodies, group)
    speed = scene.drive.speed
    angle = np.array([scene.sketch.angle])
    q = assemble(equations, _sketched(scene, group, bodies), placed(angle)[0])
    first = _pose(equations, speed, angle, q, placed)
    if np.isnan(first.at(angle, placed(angle)[0])[0]).any():
        why = f"{', '.join(group.bodies)} do not close near the sketch, at crank angle {degrees(angle[0]):.4f} deg"
        raise Failure(Status.cannot_assemble, why)
    forward = _march(first, speed, placed, STEP, 2 * pi)
    ahead = forward[-1].angle[0] - first.angle[0]
    if ahead < 2 * pi - SMALLEST:
        return _joined([*_march(first, speed, placed, -STEP, 2 * pi - ahead)[:0:-1], *forward])
    if np.abs(equations.attitude(forward[-1].q) - equations.attitude(first.q)).max() > SAME:
        why = f"after one turn of the crank {', '.join(group.bodies)} are in another pose than before"
        raise Failure(Status.unsupported, why)
    return _joined(forward)


def _march(first: Track, speed: float, placed: Placed, step: float, furthest: float) -> list[Track]:
    """Return the poses from the first onwards, one a step; where Newton's method loses the branch, by smaller steps."""
    poses = [first]
    h = step
    while abs(h) >= SMALLEST and (gone := abs(poses[-1].angle[0] - first.angle[0])) < furthest - SMALLEST:
        h = copysign(min(abs(h), furthest - gone), h)
        angle = poses[-1].angle + h
        q, _ = poses[-1].at(angle, placed(angle)[0])
        if np.isnan(q).any():
            h /= 2
        else:
            poses.append(_pose(first.equations, speed, angle, q, placed))
            h = copysign(min(2 * abs(h), STEP), h)
    return poses


def _pose(equations: System, speed: float, angle: Samples, q: Samples, placed: Placed) -> Track:
    """Return the track of one pose, q of shape (1, m)."""
    J = equations.jacobian(q)
    _, v, a = placed(angle)
    velocity, acceleration = rates(equations, q, J, v, a)
    return Track(equations, angle, q, velocity / speed, acceleration / speed**2, float(np.linalg.slogdet(J)[0][0]))


def _joined(poses: list[Track]) -> Track:
    columns = zip(*((pose.angle, pose.q, pose.dq, pose.ddq) for pose in poses), strict=True)
    angle, q, dq, ddq = map(np.concatenate, columns)
    return Track(poses[0].equations, angle, q, dq, ddq, poses[0].branch)


def _sketched(scene: Scene, group: Group, bodies: Mapping[str, RigidBody]) -> Samples:
    """Return the coordinates, shape (1, m), that lay each body on its sketched points with the least squares."""
    at = sketched(scene)
    q: list[float] = []
    for name in group.bodies:
        slide, local = scene.bodies[name].slide, bodies[name].local
        shown = [point for point in local if point in at]
        place, own = np.array([at[point] for point in shown]), np.array([local[point] for point in shown])
        turn = 0.0 if slide else float(np.angle(np.vdot(own - own.mean(), place - place.mean())))
        foot = complex(place.mean() + np.exp(1j * turn) * (local[scene.bodies[name].points[0]] - own.mean()))
        q += (
            [((foot - as_complex(slide.through)) * as_complex(slide.along).conjugate()).real]
            if slide
            else [foot.real, foot.imag, turn]
        )
    return np.array([q])
