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

from .geometry import RigidBody
from .group_equations import Group, GroupEquations, Placed, Pose, coordinates, equations_of, sketched_coordinates
from .misfit import of_group
from .newton_group import ROUGHLY, assemble, rates, refine

STEPS = 360  # over a turn, or over the way of a driven slider
STRIDE = 16  # steps: so far apart poses are at first
NEAR = 1.01  # steps: a step, and its roundings
SMALLEST = 2.0**-20  # of a step: a singular configuration is found to that
ASTRAY = 0.1  # of a move: a pose that is further off than that from where it was expected may be another branch's
SMOOTH = 0.01  # of a move: how far off a parabola may be at the next pose, an eighth of it half way
SAFE = 0.7  # of the stride that the last one's parabola allows
FLAT = 0.1  # of what a parabola may be off: how much less is not relied on for the next stride
SAME = 1e-6  # rad: two poses
FEW = 0.25  # of machines that are followed together: more of them shorten the strides of all,
SHORT = 2.0**-6  # of a step, to no less

PlacedAt: TypeAlias = Callable[[Samples], Placed]  # position of the drive -> what the group hangs on, at rate one


@dataclass(frozen=True)
class Track:
    """N poses by the drive's position, within one turn of a crank, and how they change with the position.

    Of M machines at the same positions, q, dq and ddq begin with the axes (M, 1), while they are followed with (M,).
    """

    equations: GroupEquations
    step: float  # rad or m, between poses
    turn: float  # the period of positions, 2 pi; infinite for a driven slider
    position: Samples  # (N,), increasing
    q: Samples  # (N, m)
    dq: Samples  # (N, m), by unit of position
    ddq: Samples  # (N, m)
    branch: Samples  # the sign of det J, (1,): it changes where the branch meets another

    @property
    def machines(self) -> tuple[int, ...]:
        """Return the axes that q, dq and ddq begin with."""
        return self.q.shape[:-2]

    @property
    def known(self) -> NDArray[np.bool_]:
        """Return which poses were reached, of each machine."""
        return np.asarray(~np.isnan(self.q[..., 0]))

    def at(self, position: Samples, placed: Pose) -> tuple[Pose, Samples]:
        """Return all frames and their Jacobian, shape (..., m, 3 frames), NaN where there is no branch."""
        nearest = self.beginnings(position)
        h = self._within(position - nearest.position, -self.turn / 2)
        near = np.abs(h) <= NEAR * self.step  # further off there is no pose to start from
        return nearest.beside(np.where(near, h, np.nan), placed)

    def beside(self, h: Samples, placed: Pose) -> tuple[Pose, Samples]:
        """Return what `at` does, from each pose to the position that is h further, shape (N,)."""
        guess = self.q + h[..., None] * (self.dq + h[..., None] / 2 * self.ddq)
        q, found = refine(self.equations, guess, placed)
        move, off = self.equations.length(guess - self.q), self.equations.length(q - guess)
        found &= off <= ASTRAY * move + ROUGHLY * self.equations.size
        pose = self.equations.pose(q, placed)
        J = self.equations.jacobian(pose)
        found &= np.linalg.slogdet(J[..., : q.shape[-1]])[0] == self.branch
        if not found.all():
            pose = self.equations.pose(np.where(found[..., None], q, np.nan), placed)
            J = np.where(found[..., None, None], J, np.nan)
        return pose, J

    def moved(self, h: Samples, placed: PlacedAt) -> "Track":
        """Return the poses at the positions that are h further, shape (N,); NaN where the branch does not reach."""
        position = self.position + h
        hung = placed(position)
        pose, J = self.beside(h, hung.pose)
        q = coordinates(pose.z, pose.angle)[..., : 3 * self.equations.bodies]
        dq, ddq = rates(self.equations, pose, J, hung)
        return replace(self, position=position, q=q, dq=dq, ddq=ddq)

    @property
    def comes_back(self) -> NDArray[np.bool_]:
        """Return whether the last pose is the first one again, of each machine."""
        last, first = (np.exp(1j * self.q[..., row, 2::3]) for row in (-1, 0))
        return np.asarray(np.abs(last - first).max(axis=-1) <= SAME)

    def given_up(self, astray: NDArray[np.bool_], h: Samples | float) -> NDArray[np.bool_]:
        """Return whether the machines astray, shape (M, ...), are so few that no other need take shorter strides."""
        if not self.machines:
            return ~astray
        count = astray.sum(axis=0)
        few = (count <= FEW * self.known.any(axis=-1).sum()) & (h <= NEAR * self.step)
        return np.asarray((count == 0) | few | (h <= SHORT * self.step))

    def without(self, poses: NDArray[Any]) -> "Track":
        """Return the others but for these poses, of each machine, which then are unknown."""
        return replace(self, q=np.where(poses[..., None], np.nan, self.q)) if poses.any() else self

    def rows(self, which: slice | NDArray[Any]) -> "Track":
        """Return some of the poses."""
        q, dq, ddq = (values[..., which, :] for values in (self.q, self.dq, self.ddq))
        return replace(self, position=self.position[which], q=q, dq=dq, ddq=ddq)

    def beginnings(self, position: Samples) -> "Track":
        """Return the nearest pose to each position of the drive, shape (n,) or (M, n)."""
        nearest = self.nearest(position)
        if not self.machines:
            return self.rows(nearest)
        each = np.arange(len(self.q))[:, None], 0, nearest
        return replace(self, position=self.position[nearest], q=self.q[each], dq=self.dq[each], ddq=self.ddq[each])

    def nearest(self, position: Samples) -> NDArray[np.intp]:
        """Return which poses are nearest to positions of the drive, shape (n,)."""
        middles = (self.position[1:] + self.position[:-1]) / 2
        return np.asarray(np.searchsorted(middles, self.position[0] + self._within(position - self.position[0], 0.0)))

    def off_parabola(self, before: "Track") -> Samples:
        """Return how far the parabola through each pose is off the one before, of how far it may be, shape (N,).

        Above one, no position between may be found: a step can leap over a singular configuration, near which a
        parabola holds for less than a step.
        """
        h, move = (before.position - self.position)[..., None], self.equations.length(self.q - before.q)
        off = self.equations.length(self.q + h * (self.dq + h / 2 * self.ddq) - before.q)
        share: Samples = off / (SMOOTH * move + ROUGHLY * self.equations.size)
        return share

    def _within(self, difference: Samples, least: float) -> Samples:
        """Return the difference less the whole turns that leave it at `least` or up to a turn above."""
        return difference if self.turn == inf else least + np.remainder(difference - least, self.turn)


def follow(scene: Scene, group: Group, bodies: Mapping[str, RigidBody], placed: PlacedAt) -> Track:
    """Follow the sketch's branch round the turn, along a driven slider's way, or to where it ends on both sides.

    Several machines are followed together, each as far as it goes with the others.

    Raises:
        Failure: `cannot_assemble` at the sketch; `unsupported` when a crank turns all the way and ends in another pose.
    """
    first = _begun(scene, group, bodies, placed)
    start, step, turn = scene.sketch.drive, first.step, first.turn
    least, most = _extent(scene)
    if first.machines:
        return _together(first, (min(least, start), max(most, start)), placed)
    if not first.known.all():
        at_sketch = sketched_coordinates(scene, group, bodies), placed(first.position).pose
        open_by = of_group(scene, group, first.equations, *at_sketch)
        why = f"{', '.join(group.bodies)} do not close near the sketch, at {scene.where(start)}{open_by}"
        raise Failure(Status.cannot_assemble, why)
    if scene.driven_slide is not None:
        return _both(*(_march(first, placed, way) for way in (min(least - start, 0.0), max(most - start, 0.0))))
    forward = _march(first, placed, turn)
    ahead = forward.position[-1] - start
    if ahead < turn - SMALLEST * step:
        return _both(_march(first, placed, ahead - turn), forward)
    if forward.comes_back:
        return forward
    if most - least > turn - step:
        why = f"after one turn of the crank {', '.join(group.bodies)} are in another pose than before"
        raise Failure(Status.unsupported, why)
    middle = start + remainder((least + most) / 2 - start, turn)  # of a part of a turn, where one angle has one pose
    both = _both(_march(first, placed, -turn), forward)
    return both.rows(np.abs(both.position - middle) <= turn / 2)


def _together(first: Track, extent: tuple[float, float], placed: PlacedAt) -> Track:
    """Follow the branches of machines at the same positions, from poses of shape (M, 1, m), with the same checks.

    Unknown are the poses of a machine from where it needs shorter strides than most others, and all of one that ends in
    another pose after a turn.
    """

    def of_each(position: Samples) -> Placed:
        return placed(np.broadcast_to(position, (len(first.q), *position.shape)))

    def march(way: float) -> Track:
        track = _march(first, of_each, way)
        ends = abs(track.position[-1] - first.position[0]) < abs(way) - SMALLEST * first.step
        unknown = np.append(~track.known[:, 1:], np.full((len(first.q), 1), ends), axis=1)
        return track.without(unknown)  # what is next to an unknown pose too: the way there is not checked

    if first.turn == inf:
        track = _both(*(march(end - first.position[0]) for end in extent))
    else:
        track = march(first.turn)
        ahead = track.position[-1] - first.position[0]
        if ahead < first.turn - SMALLEST * first.step:
            track = _both(march(ahead - first.turn), track)
        else:
            track = track.without((track.known[:, -1] & ~track.comes_back)[:, None])
    return replace(track, q=track.q[:, None], dq=track.dq[:, None], ddq=track.ddq[:, None])


def _begun(scene: Scene, group: Group, bodies: Mapping[str, RigidBody], placed: PlacedAt) -> Track:
    """Return the pose at the sketch, q of shape (1, m), or (M, 1, m) of machines that differ; NaN for none."""
    equations, position = equations_of(scene, bodies, group), np.array([scene.sketch.drive])
    turn = 2 * pi if scene.driven_slide is None else inf
    least, most = _extent(scene)
    step = (2 * pi if scene.driven_slide is None else most - least) / STEPS
    q = sketched_coordinates(scene, group, bodies)
    shape = np.broadcast_shapes(placed(position).v.shape[:-1], q.shape[:-1], equations.machines)
    hung = placed(np.broadcast_to(position, shape))
    q = assemble(equations, np.broadcast_to(q, (*shape, q.shape[-1])), hung.pose)
    pose = equations.pose(q, hung.pose)
    J = equations.jacobian(pose)
    branch = np.linalg.slogdet(J[..., : q.shape[-1]])[0]
    first = Track(equations, step, turn, position, q, *rates(equations, pose, J, hung), branch)
    pose, J = first.beside(np.zeros(1), hung.pose)
    return replace(first, q=np.where(np.isnan(J[..., :1, 0]), np.nan, q))


def _extent(scene: Scene) -> tuple[float, float]:
    """Return the least and the largest position of the drive, of all machines."""
    least, most = scene.drive.extent
    return float(np.min(least)), float(np.max(most))


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
        off = reached.off_parabola(poses[-1])
        astray = ~(off <= 1) & poses[-1].known
        if not poses[-1].given_up(astray, h).all():
            h /= 2
        elif not (reached := reached.without(astray)).known.any():
            break
        else:
            poses.append(reached)
            worst = float(off[off <= 1].max(initial=FLAT))
            h = min(h * SAFE / sqrt(worst), longest)  # a parabola is off by h^3 of a move by h
    return _joined(poses)


def _filled(track: Track, placed: PlacedAt) -> Track | None:
    """Return a track with poses half way between its own until they are at most a step apart, each near the last.

    None where the branch does not reach one of them, or they are near each other at no distance.
    """
    while True:
        before, after = track.rows(slice(-1)), track.rows(slice(1, None))
        apart = after.position - before.position
        astray = ~(after.off_parabola(before) <= 1) & before.known & after.known
        wide = (np.abs(apart) > NEAR * track.step) | ~track.given_up(astray, np.abs(apart))
        track = track.without(np.any(astray & ~wide, axis=-1, keepdims=True))
        if not wide.any():
            return track
        halved = np.flatnonzero(wide)
        if np.abs(apart[halved]).min() < SMALLEST * track.step:
            return None
        between = before.rows(halved).moved(apart[halved] / 2, placed)
        lost = ~between.known & before.rows(halved).known
        if not track.given_up(lost, 0.0).all():
            return None
        order = np.argsort(np.r_[: len(apart) + 1, halved + 0.5], kind="stable")
        track = _joined([track, between]).without(np.any(lost, axis=-1, keepdims=True)).rows(order)


def _both(back: Track, forth: Track) -> Track:
    """Return the poses on both sides of the first, by increasing position."""
    return _joined([back.rows(slice(None, 0, -1)), forth])


def _joined(poses: Sequence[Track]) -> Track:
    columns = zip(*((pose.position, pose.q, pose.dq, pose.ddq) for pose in poses), strict=True)
    position, q, dq, ddq = (
        np.concatenate(column, axis=axis) for column, axis in zip(columns, (0, -2, -2, -2), strict=True)
    )
    return replace(poses[0], position=position, q=q, dq=dq, ddq=ddq)
