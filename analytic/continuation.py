"""The branch of a group solved by Newton's method: poses over the drive's way, followed step by step from the sketch.

Every position asked for starts from the nearest of these poses, so that its answer depends on no other position.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import copysign, inf, pi, remainder
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene, Status
from scenes.motion import Samples

from .geometry import RigidBody, sketched, sketched_attitude
from .group_equations import Group, GroupEquations, Placed, Pose, coordinates, equations_of
from .misfit import of_group
from .newton_group import ROUGHLY, assemble, own_jacobian, rates, refine

STEPS = 360  # over a turn, or over the way of a driven slider
SMALLEST = 2.0**-20  # of a step: a singular configuration is found to that
ASTRAY = 0.1  # of a move: a pose that is further off than that from where it was expected may be another branch's
SMOOTH = 0.01  # of a move: how far off a parabola may be at the next pose, an eighth of it half way
SAME = 1e-6  # rad: two poses

PlacedAt: TypeAlias = Callable[[Samples], Placed]  # position of the drive -> what the group hangs on, at rate one


@dataclass(frozen=True)
class Track:
    """N poses by the drive's position, within one turn of a crank, and how they change with the position."""

    equations: GroupEquations
    step: float  # rad or m, between poses
    turn: float  # the period of positions, 2 pi; infinite for a driven slider
    position: Samples  # (N,), increasing
    q: Samples  # (N, m)
    dq: Samples  # (N, m), by unit of position
    ddq: Samples  # (N, m)
    branch: float  # the sign of det J: it changes where the branch meets another

    def at(self, position: Samples, placed: Pose) -> tuple[Pose, Samples]:
        """Return all frames and the Jacobian (n, m, m), NaN where the branch does not reach."""
        nearest = self.nearest(position)
        h = self._within(position - self.position[nearest], -self.turn / 2)[:, None]
        guess = self.q[nearest] + h * (self.dq[nearest] + h / 2 * self.ddq[nearest])
        near = np.abs(h) <= 1.01 * self.step  # a step, and its roundings; further off there is no pose to start from
        q, found = refine(self.equations, np.where(near, guess, np.nan), placed)
        move, off = self.equations.length(guess - self.q[nearest]), self.equations.length(q - guess)
        found &= off <= ASTRAY * move + ROUGHLY * self.equations.size
        pose = self.equations.pose(q, placed)
        J = own_jacobian(self.equations, pose)
        found &= np.linalg.slogdet(J)[0] == self.branch
        if not found.all():
            pose = self.equations.pose(np.where(found[:, None], q, np.nan), placed)
            J = np.where(found[:, None, None], J, np.nan)
        return pose, J

    def nearest(self, position: Samples) -> NDArray[np.intp]:
        """Return which poses are nearest to positions of the drive, shape (n,)."""
        middles = (self.position[1:] + self.position[:-1]) / 2
        return np.asarray(np.searchsorted(middles, self.position[0] + self._within(position - self.position[0], 0.0)))

    def leads_back(self, before: "Track") -> bool:
        """Return whether the parabola through this pose is near the one before: else no position between may be found.

        A step can leap over a singular configuration, near which a parabola holds for less than a step.
        """
        h, move = before.position - self.position, self.equations.length(self.q - before.q)
        off = self.equations.length(self.q + h * (self.dq + h / 2 * self.ddq) - before.q)
        return bool((off <= SMOOTH * move + ROUGHLY * self.equations.size).all())

    def _within(self, difference: Samples, least: float) -> Samples:
        """Return the difference less the whole turns that leave it at `least` or up to a turn above."""
        return difference if self.turn == inf else least + np.remainder(difference - least, self.turn)


def follow(scene: Scene, group: Group, bodies: Mapping[str, RigidBody], placed: PlacedAt) -> Track:
    """Follow the sketch's branch round the turn, along a driven slider's way, or to where it ends on both sides.

    Raises:
        Failure: `cannot_assemble` at the sketch; `unsupported` when a crank turns all the way and ends in another pose.
    """
    equations = equations_of(scene, bodies, group)
    start = scene.sketch.drive
    least, most = scene.drive.extent
    turn = 2 * pi if scene.driven_slide is None else inf
    step = 2 * pi / STEPS if scene.driven_slide is None else (most - least) / STEPS
    position = np.array([start])
    q = assemble(equations, _sketched(scene, group, bodies), placed(position).pose)
    first = _pose(equations, step, turn, position, q, placed)
    if np.isnan(first.at(position, placed(position).pose)[1]).any():
        open_by = of_group(scene, group, equations, _sketched(scene, group, bodies), placed(position).pose)
        why = f"{', '.join(group.bodies)} do not close near the sketch, at {scene.where(start)}{open_by}"
        raise Failure(Status.cannot_assemble, why)
    if scene.driven_slide is not None:
        back, forth = (_march(first, placed, way) for way in (min(least - start, 0.0), max(most - start, 0.0)))
        return _joined([*back[:0:-1], *forth])
    forward = _march(first, placed, turn)
    ahead = forward[-1].position[0] - start
    if ahead < turn - SMALLEST * step:
        return _joined([*_march(first, placed, ahead - turn)[:0:-1], *forward])
    if np.abs(np.exp(1j * forward[-1].q[:, 2::3]) - np.exp(1j * first.q[:, 2::3])).max() <= SAME:
        return _joined(forward)
    if most - least > turn - step:
        why = f"after one turn of the crank {', '.join(group.bodies)} are in another pose than before"
        raise Failure(Status.unsupported, why)
    middle = start + remainder((least + most) / 2 - start, turn)  # of a part of a turn, where one angle has one pose
    poses = [*_march(first, placed, -turn)[:0:-1], *forward]
    return _joined([pose for pose in poses if abs(pose.position[0] - middle) <= turn / 2])


def _march(first: Track, placed: PlacedAt, way: float) -> list[Track]:
    """Return the poses from the first onwards, one a step; where Newton's method loses the branch, by smaller steps."""
    poses, smallest = [first], SMALLEST * first.step
    h = first.step
    while h >= smallest and (gone := abs(poses[-1].position[0] - first.position[0])) < abs(way) - smallest:
        h = min(h, abs(way) - gone)
        position = poses[-1].position + copysign(h, way)
        pose, J = poses[-1].at(position, placed(position).pose)
        if np.isnan(J).any():
            h /= 2
        else:
            q = coordinates(pose.z, pose.angle)[:, : 3 * first.equations.bodies]
            reached = _pose(first.equations, first.step, first.turn, position, q, placed)
            if reached.leads_back(poses[-1]):
                poses.append(reached)
                h = min(2 * h, first.step)
            else:
                h /= 2
    return poses


def _pose(
    equations: GroupEquations, step: float, turn: float, position: Samples, q: Samples, placed: PlacedAt
) -> Track:
    """Return the track of one pose, q of shape (1, m)."""
    hung = placed(position)
    pose = equations.pose(q, hung.pose)
    branch = float(np.linalg.slogdet(own_jacobian(equations, pose))[0][0])
    return Track(equations, step, turn, position, q, *rates(equations, pose, hung), branch)


def _joined(poses: list[Track]) -> Track:
    columns = zip(*((pose.position, pose.q, pose.dq, pose.ddq) for pose in poses), strict=True)
    position, q, dq, ddq = map(np.concatenate, columns)
    return replace(poses[0], position=position, q=q, dq=dq, ddq=ddq)


def _sketched(scene: Scene, group: Group, bodies: Mapping[str, RigidBody]) -> Samples:
    """Return the coordinates, shape (1, m), that lay each body on its sketched points with the least squares."""
    at = sketched(scene)
    q: list[float] = []
    for name in group.bodies:
        local = bodies[name].local
        shown = [point for point in local if point in at]
        u = sketched_attitude(scene, name, bodies)
        feet = [at[point] + u * (bodies[name].first - local[point]) for point in shown]
        foot = complex(np.mean(feet or list(at.values())))  # of a body on a guide nothing need be shown
        q += [foot.real, foot.imag, float(np.angle(u))]
    return np.array([q])
