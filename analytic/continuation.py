"""The branch of a group solved by Newton's method: poses over the drive's way, followed from the sketch.

Long strides come first, then all poses between them at once; where these are not on one smooth branch, it is followed
step by step. Every position asked for starts from the nearest of the poses, so that its answer depends on no other one.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import copysign, inf, pi, remainder, sqrt
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene, Status
from scenes.motion import Samples

from .geometry import RigidBody, sketched, sketched_attitude
from .group_equations import Group, GroupEquations, Placed, Pose, coordinates, equations_of
from .misfit import of_group
from .newton_group import ROUGHLY, assemble, own_jacobian, rates, refine

STEPS = 360  # over a turn, or over the way of a driven slider
STRIDE = 16  # steps: so far apart poses are at first
NEAR = 1.01  # steps: a step, and its roundings
SMALLEST = 2.0**-20  # of a step: a singular configuration is found to that
ASTRAY = 0.1  # of a move: a pose that is further off than that from where it was expected may be another branch's
SMOOTH = 0.01  # of a move: how far off a parabola may be at the next pose, an eighth of it half way
SAFE = 0.7  # of the stride that the last one's parabola allows
FLAT = 0.1  # of what a parabola may be off: how much less is not relied on for the next stride
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
        nearest = self.rows(self.nearest(position))
        h = self._within(position - nearest.position, -self.turn / 2)
        near = np.abs(h) <= NEAR * self.step  # further off there is no pose to start from
        return nearest.beside(np.where(near, h, np.nan), placed)

    def beside(self, h: Samples, placed: Pose) -> tuple[Pose, Samples]:
        """Return what `at` does, from each pose to the position that is h further, shape (N,)."""
        guess = self.q + h[:, None] * (self.dq + h[:, None] / 2 * self.ddq)
        q, found = refine(self.equations, guess, placed)
        move, off = self.equations.length(guess - self.q), self.equations.length(q - guess)
        found &= off <= ASTRAY * move + ROUGHLY * self.equations.size
        pose = self.equations.pose(q, placed)
        J = own_jacobian(self.equations, pose)
        found &= np.linalg.slogdet(J)[0] == self.branch
        if not found.all():
            pose = self.equations.pose(np.where(found[:, None], q, np.nan), placed)
            J = np.where(found[:, None, None], J, np.nan)
        return pose, J

    def moved(self, h: Samples, placed: PlacedAt) -> "Track | None":
        """Return the poses at the positions that are h further, shape (N,); None where the branch does not reach."""
        position = self.position + h
        hung = placed(position)
        pose, J = self.beside(h, hung.pose)
        if np.isnan(J).any():
            return None
        q = coordinates(pose.z, pose.angle)[:, : 3 * self.equations.bodies]
        dq, ddq = rates(self.equations, pose, hung)
        return replace(self, position=position, q=q, dq=dq, ddq=ddq)

    def rows(self, which: slice | NDArray[Any]) -> "Track":
        """Return some of the poses."""
        return replace(self, position=self.position[which], q=self.q[which], dq=self.dq[which], ddq=self.ddq[which])

    def nearest(self, position: Samples) -> NDArray[np.intp]:
        """Return which poses are nearest to positions of the drive, shape (n,)."""
        middles = (self.position[1:] + self.position[:-1]) / 2
        return np.asarray(np.searchsorted(middles, self.position[0] + self._within(position - self.position[0], 0.0)))

    def off_parabola(self, before: "Track") -> Samples:
        """Return how far the parabola through each pose is off the one before, of how far it may be, shape (N,).

        Above one, no position between may be found: a step can leap over a singular configuration, near which a
        parabola holds for less than a step.
        """
        h, move = (before.position - self.position)[:, None], self.equations.length(self.q - before.q)
        off = self.equations.length(self.q + h * (self.dq + h / 2 * self.ddq) - before.q)
        share: Samples = off / (SMOOTH * move + ROUGHLY * self.equations.size)
        return share

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
        return _both(*(_march(first, placed, way) for way in (min(least - start, 0.0), max(most - start, 0.0))))
    forward = _march(first, placed, turn)
    ahead = forward.position[-1] - start
    if ahead < turn - SMALLEST * step:
        return _both(_march(first, placed, ahead - turn), forward)
    if np.abs(np.exp(1j * forward.q[-1, 2::3]) - np.exp(1j * first.q[0, 2::3])).max() <= SAME:
        return forward
    if most - least > turn - step:
        why = f"after one turn of the crank {', '.join(group.bodies)} are in another pose than before"
        raise Failure(Status.unsupported, why)
    middle = start + remainder((least + most) / 2 - start, turn)  # of a part of a turn, where one angle has one pose
    both = _both(_march(first, placed, -turn), forward)
    return both.rows(np.abs(both.position - middle) <= turn / 2)


def _march(first: Track, placed: PlacedAt, way: float) -> Track:
    """Return the poses from the first onwards, at most a step apart."""
    strides = _strides(first, placed, way, STRIDE * first.step)
    return _filled(strides, placed) or _strides(first, placed, way, first.step)


def _strides(first: Track, placed: PlacedAt, way: float, longest: float) -> Track:
    """Return the poses from the first onwards, a stride apart, shorter ones where Newton's method loses the branch."""
    poses, smallest = [first], SMALLEST * first.step
    h = first.step
    while h >= smallest and (gone := abs(poses[-1].position[0] - first.position[0])) < abs(way) - smallest:
        h = min(h, abs(way) - gone)
        reached = poses[-1].moved(np.array([copysign(h, way)]), placed)
        off = inf if reached is None else float(reached.off_parabola(poses[-1])[0])
        if reached is not None and off <= 1:
            poses.append(reached)
            h = min(h * SAFE / sqrt(max(off, FLAT)), longest)  # a parabola is off by h^3 of a move by h
        else:
            h /= 2
    return _joined(poses)


def _filled(track: Track, placed: PlacedAt) -> Track | None:
    """Return a track with poses half way between its own until they are at most a step apart, each near the last.

    None where the branch does not reach one of them, or they are near each other at no distance.
    """
    while True:
        before, after = track.rows(slice(-1)), track.rows(slice(1, None))
        apart = after.position - before.position
        wide = np.flatnonzero((np.abs(apart) > NEAR * track.step) | ~(after.off_parabola(before) <= 1))
        if not len(wide):
            return track
        if np.abs(apart[wide]).min() < SMALLEST * track.step:
            return None
        between = before.rows(wide).moved(apart[wide] / 2, placed)
        if between is None:
            return None
        track = _joined([track, between]).rows(np.argsort(np.r_[: len(track.q), wide + 0.5], kind="stable"))


def _both(back: Track, forth: Track) -> Track:
    """Return the poses on both sides of the first, by increasing position."""
    return _joined([back.rows(slice(None, 0, -1)), forth])


def _pose(
    equations: GroupEquations, step: float, turn: float, position: Samples, q: Samples, placed: PlacedAt
) -> Track:
    """Return the track of one pose, q of shape (1, m)."""
    hung = placed(position)
    pose = equations.pose(q, hung.pose)
    branch = float(np.linalg.slogdet(own_jacobian(equations, pose))[0][0])
    return Track(equations, step, turn, position, q, *rates(equations, pose, hung), branch)


def _joined(poses: Sequence[Track]) -> Track:
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
