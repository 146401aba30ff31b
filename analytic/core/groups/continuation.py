"""The branch of a group solved by Newton's method: poses over the drive's way, followed from the sketch.

Long strides come first, then all poses between them at once; where these are not on one smooth branch, it is followed
step by step. Every position asked for starts from the nearest of the poses, so that its answer depends on no other one.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import copysign, inf, remainder, sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene, Status
from scenes.drive import Drive
from scenes.model.constraints import open_joint
from scenes.model.motion import Samples

from ..geometry import RigidBody
from .group_equations import FramePoses, Group, GroupEquations, Placed, coordinates, equations_of, sketched_coordinates
from .newton_group import SINGULAR_TOL, assemble, correction, length_of, own_jacobian, rates, refine

STEPS = 360  # over a turn, or over the way of a driven slider
STRIDE = 16  # steps: so far apart poses are at first
ONE_STEP = 1.01  # steps: a step, and its roundings
MIN_STEP = 2.0**-20  # of a step: a singular configuration is found to that
MAX_MISS = 0.1  # of a move: a pose that is further off than that from where it was expected may be another branch's
PARABOLA_TOL = 0.01  # of a move: how far off a parabola may be at the next pose, an eighth of it half way
SAFE = 0.7  # of the stride that the last one's parabola allows
MIN_OFF = 0.1  # of what a parabola may be off: how much less is not relied on for the next stride
SAME_POSE_TOL = 1e-6  # rad: two poses

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

    def guess(self, position: Samples) -> tuple[Samples, Samples]:
        """Where Newton's method begins at positions of the drive, shape (n, m), and how far off a pose may be, (n,), m.

        NaN where there is no pose near enough to begin from.
        """
        nearest = self.rows(self.nearest(position))
        h = self._within(position - nearest.position, -self.turn / 2)
        return nearest.ahead(np.where(np.abs(h) <= ONE_STEP * self.step, h, np.nan))

    def ahead(self, h: Samples) -> tuple[Samples, Samples]:
        """The same as `guess`, from each pose to the position that is h further, shape (N,)."""
        guess = self.q + h[:, None] * (self.dq + h[:, None] / 2 * self.ddq)
        return guess, MAX_MISS * length_of(guess - self.q, self.equations.size) + SINGULAR_TOL * self.equations.size

    def at(self, guess: Samples, allowed: Samples, placed: FramePoses) -> tuple[FramePoses, Samples]:
        """All frames near guesses, and their Jacobian, shape (n, m, 3 frames), NaN where there is no branch."""
        q, closed = refine(correction(self.equations, placed), guess, self.equations.size)
        closed &= length_of(q - guess, self.equations.size) <= allowed
        pose = self.equations.pose(q, placed)
        J = self.equations.jacobian(pose)
        closed &= np.linalg.slogdet(J[..., : q.shape[-1]])[0] == self.branch
        if not closed.all():
            pose = self.equations.pose(np.where(closed[:, None], q, np.nan), placed)
            J = np.where(closed[:, None, None], J, np.nan)
        return pose, J

    def moved(self, h: Samples, placed: PlacedAt) -> "Track":
        """Return the poses at the positions that are h further, shape (N,); NaN where the branch does not reach."""
        position = self.position + h
        hung = placed(position)
        pose, J = self.at(*self.ahead(h), hung.pose)
        q = coordinates(pose.z, pose.angle)[:, : 3 * self.equations.bodies]
        dq, ddq = rates(self.equations, pose, J, hung)
        return replace(self, position=position, q=q, dq=dq, ddq=ddq)

    def rows(self, which: slice | NDArray[np.intp] | NDArray[np.bool_]) -> "Track":
        """Some of the poses."""
        q, dq, ddq = (values[which] for values in (self.q, self.dq, self.ddq))
        return replace(self, position=self.position[which], q=q, dq=dq, ddq=ddq)

    def nearest(self, position: Samples) -> NDArray[np.intp]:
        """Return which poses are nearest to positions of the drive, shape (n,)."""
        middles = (self.position[1:] + self.position[:-1]) / 2
        return np.asarray(np.searchsorted(middles, self.position[0] + self._within(position - self.position[0], 0.0)))

    def off_parabola(self, before: "Track") -> Samples:
        """Return how far the parabola through each pose is off the one before, of how far it may be, shape (N,)."""
        # Above one, no position between may be found: a step can leap over a singular configuration, near which a
        # parabola holds for less than a step.
        h, size = (before.position - self.position)[:, None], self.equations.size
        move = length_of(self.q - before.q, size)
        off = length_of(self.q + h * (self.dq + h / 2 * self.ddq) - before.q, size)
        return np.asarray(off / (PARABOLA_TOL * move + SINGULAR_TOL * size))

    def _within(self, difference: Samples, least: float) -> Samples:
        """Return the difference less the whole turns that leave it at `least` or up to a turn above."""
        return difference if self.turn == inf else least + np.remainder(difference - least, self.turn)


def follow(scene: Scene, drive: Drive, group: Group, bodies: Mapping[str, RigidBody], placed: PlacedAt) -> Track:
    """Follow the sketch's branch round the turn, along a driven slider's way, or to where it ends on both sides.

    Failure is `cannot_assemble` at the sketch, or where a branch of more than a turn ends on the drive's way, and
    `unsupported` when a crank turns all the way and ends in another pose.
    """
    first = _begun(scene, drive, group, bodies, placed)
    start, step, turn = scene.sketch.drive, first.step, first.turn
    least, most = drive.law.extent
    if turn == inf:
        return _both(*(_march(first, placed, way) for way in (min(least - start, 0.0), max(most - start, 0.0))))
    forward = _march(first, placed, turn)
    # Cases, in this order: the crank turns all round and comes back to the first pose; its branch spans less than a
    # turn; it spans more, as a group that returns after two turns does, and only the part about the drive's way is
    # used; else a Failure, as no one angle has one pose.
    turns = forward.position[-1] - start >= turn - MIN_STEP * step
    if turns and comes_back(forward.q):
        return forward
    both = _both(_march(first, placed, -turn), forward)
    if np.ptp(both.position) <= turn:
        return both
    middle, half = start + remainder((least + most) / 2 - start, turn), (most - least) / 2
    if half <= turn / 2 - step:  # of a part of a turn, where one angle has one pose
        return both.rows(np.abs(both.position - middle) <= turn / 2)
    if turns or (both.position[0] <= middle - half and middle + half <= both.position[-1]):
        why = f"after one turn of the crank {', '.join(group.bodies)} are in another pose than before"
        raise Failure(Status.unsupported, why)
    low, high = map(float, both.position[[0, -1]])
    ways = f"turns only from {scene.position(low)} to {scene.position(high)}"
    why = f"the {drive.body} {ways}, with {', '.join(group.bodies)} in a singular configuration at both ends"
    raise Failure(Status.cannot_assemble, why, at=(high if middle + half > high else low, group.P))


def _begun(scene: Scene, drive: Drive, group: Group, bodies: Mapping[str, RigidBody], placed: PlacedAt) -> Track:
    """The pose at the sketch, q of shape (1, m), or Failure."""
    equations, start = equations_of(scene, bodies, group), scene.sketch.drive
    turn = drive.turn
    step = (turn if turn < inf else np.ptp(drive.law.extent)) / STEPS
    position, rough = np.array([start]), np.array([sketched_coordinates(scene, group, bodies)])
    hung = placed(position)
    q = assemble(correction(equations, hung.pose), rough, equations.size)
    pose = equations.pose(q, hung.pose)
    J = equations.jacobian(pose)
    branch = float(np.linalg.slogdet(J[..., : q.shape[-1]])[0][0])
    first = Track(equations, step, turn, position, q, *rates(equations, pose, J, hung), branch)
    if np.isnan(first.at(*first.ahead(np.zeros(1)), hung.pose)[1]).any():
        open_by = misfit(scene, group, equations, rough, hung.pose)
        why = f"{', '.join(group.bodies)} do not close near the sketch, at {scene.where(start)}{open_by}"
        raise Failure(Status.cannot_assemble, why, at=(start, group.P))
    return first


def _march(first: Track, placed: PlacedAt, way: float) -> Track:
    """Return the poses from the first onwards, at most a step apart."""
    # Coarse to fine: few long strides one after the other, then halves between them all at once. The short strides are
    # the fallback where a long one has leapt to another branch.
    strides = _strides(first, placed, way, STRIDE * first.step)
    return _filled(strides, placed) or _strides(first, placed, way, first.step)


def _strides(first: Track, placed: PlacedAt, way: float, longest: float) -> Track:
    """Return the poses from the first onwards, a stride apart, shorter ones where Newton's method loses the branch."""
    poses, smallest = [first], MIN_STEP * first.step
    h = first.step
    while h >= smallest and (gone := abs(poses[-1].position[0] - first.position[0])) < abs(way) - smallest:
        h = min(h, abs(way) - gone)
        # Predictor by the parabola, corrector by Newton's method. The error of a parabola is of third order: the stride
        # that keeps it within PARABOLA_TOL of the move follows from the last one's.
        reached = poses[-1].moved(np.array([copysign(h, way)]), placed)
        off = float(reached.off_parabola(poses[-1])[0])
        if not off <= 1:
            h /= 2
        else:
            poses.append(reached)
            h = min(h * SAFE / sqrt(max(off, MIN_OFF)), longest)  # a parabola is off by h^3 of a move by h
    return _joined(poses)


def _filled(track: Track, placed: PlacedAt) -> Track | None:
    """Return a track with poses half way between its own until they are at most a step apart, each near the last.

    None where the branch does not reach one of them, or they are near each other at no distance.
    """
    while True:
        before, after = track.rows(slice(-1)), track.rows(slice(1, None))
        apart = after.position - before.position
        wide = (np.abs(apart) > ONE_STEP * track.step) | ~(after.off_parabola(before) <= 1)
        if not wide.any():
            return track
        halved = np.flatnonzero(wide)
        if np.abs(apart[halved]).min() < MIN_STEP * track.step:
            return None
        between = before.rows(halved).moved(apart[halved] / 2, placed)
        if np.isnan(between.q).any():
            return None
        order = np.argsort(np.r_[: len(apart) + 1, halved + 0.5], kind="stable")
        track = _joined([track, between]).rows(order)


def misfit(scene: Scene, group: Group, equations: GroupEquations, q: Samples, placed: FramePoses) -> str:
    """Return which joint of a group stays open when all others close, near q, shape (1, m), by how much, or nothing."""
    joint, gap = open_joint(
        lambda q: equations.open(equations.pose(q[np.newaxis], placed))[0],
        lambda q: own_jacobian(equations, equations.pose(q[np.newaxis], placed))[0],
        *(q[0], np.tile([equations.size, equations.size, 1.0], equations.bodies), group.gaps, equations.size),
    )
    return f": with all else closed {joint} stays open by {scene.length(gap)}" if gap else ""


def comes_back(q: Samples) -> NDArray[np.bool_]:
    """Whether the last of N poses, shape (..., N, m), is the first one up to whole turns, shape (...)."""
    last, first = (np.exp(1j * q[..., row, 2::3]) for row in (-1, 0))
    return np.asarray(np.abs(last - first).max(axis=-1) <= SAME_POSE_TOL)


def _both(back: Track, forth: Track) -> Track:
    """Return the poses on both sides of the first, by increasing position."""
    return _joined([back.rows(slice(None, 0, -1)), forth])


def _joined(poses: Sequence[Track]) -> Track:
    columns = zip(*((pose.position, pose.q, pose.dq, pose.ddq) for pose in poses), strict=True)
    position, q, dq, ddq = map(np.concatenate, columns)
    return replace(poses[0], position=position, q=q, dq=dq, ddq=ddq)
