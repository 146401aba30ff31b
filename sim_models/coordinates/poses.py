"""Poses of a linkage: that at the drive's start, closed from the sketch, and those along the way of the drive.

For the start every body is laid on the sketch, the gaps are closed, and the drive is moved. A step that was too long is
halved. The sign of det C_x changes only where two branches meet, so a step that changes it is too long as well.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, lru_cache, partial
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from scenes import Failure, ProcessorBudget, Scene, Status
from scenes.model.constraints import joint_rows, misfit
from scenes.model.motion import Samples
from scenes.scene import GROUND

from .bodies import MovingBody
from .system import ClosedPose, System, solved

SINGULAR_TOL = 1e-10  # of the largest singular value: what repeats a constraint leaves, where gaps are nearly closed
MAX_HALVINGS = 20  # of one step; rounding of the scene's numbers can make or undo a lock within 1e-7 of a turn
MAX_PARTS = 200  # of one step; two branches that run side by side may need any number
MAX_STEP = np.radians(10.0)  # step of the drive, and as a part of its travel
TRIALS = 9  # positions ahead, to find one where a joint stays open
MAX_GAP = 1e-9  # of bodies that fit together, over the size
SECONDS = 120.0  # of processor time, for the build and for each cycle
ROUNDING = float(np.finfo(float).eps) / 2
CLOSING = 12  # steps in which the sketch's gaps are closed
POSITION_TOL = 1e-9  # of the drive's position, rad or of its travel; a stroke's displacement stands still at its end
MAX_SCENES = 4  # whose equations are kept by an engine: a scene run with several settings is prepared once


class PathFollower:
    """The poses of one linkage."""

    def __init__(self, system: System) -> None:
        self.system, self.scene = system, system.scene
        self.begin(1)

    def begin(self, turns: int) -> None:
        """Start the clock and the counters of the build, or of a run of so many turns."""
        self.budget = ProcessorBudget(SECONDS * turns, "the way of the linkage")
        self.counters = {"steps": 0, "newton_iterations": 0}

    def pose(self, x: Samples) -> ClosedPose:
        """Return the pose at coordinates."""
        return ClosedPose(x, self.system.jacobian(x))

    def through(self, pose: ClosedPose, here: float, positions: Iterable[float]) -> Iterator[ClosedPose]:
        """Yield the poses at positions of the drive, from that at `here`, one after the other."""
        for position in positions:
            parts = max(1, int(np.ceil(abs(position - here) / self.largest_step)))
            for part in np.linspace(here, position, parts + 1)[1:].tolist():
                pose = self.follow(pose, self.goal(part), partial(self._locked, position))
            here = position
            yield pose

    def goal(self, position: float) -> Samples:
        """Return C(x) at a position of the drive, shape (m,)."""
        goal = np.zeros(len(self.system.row_units))
        goal[-1] = position / self.system.drive_unit
        return goal

    @property
    def largest_step(self) -> float:
        """The largest step of the drive, rad or m."""
        drive = self.system.drive
        return float(MAX_STEP if drive.slide is None else MAX_STEP / (2 * np.pi) * drive.span)

    def tangent(self, pose: ClosedPose) -> tuple[Samples, Samples]:
        """Return dx/ds and d2x/ds2, s the drive's position, rad or m."""
        try:
            rate = solved(pose.J, self.goal(1.0))
            return rate, -solved(pose.J, self.system.bend(pose.x, rate))
        except np.linalg.LinAlgError:
            raise Failure(Status.not_converged, "the linkage is singular at one of the samples") from None

    def residuals(self, poses: Sequence[ClosedPose], positions: Samples, promise: float) -> dict[str, float]:
        """Return the largest gap, and how much rounding may be in accelerations, of those that the drive has."""
        travel = self.system.drive.unit
        gaps, parts = np.zeros(len(poses)), np.zeros(len(poses))
        for row, (pose, position) in enumerate(zip(poses, positions.tolist(), strict=True)):
            # Near a lock dx/ds is large: the relative round-off of that solution is eps times the largest coordinate
            # rate, over the drive's own scale. A promise below that cannot be kept.
            rate, bend = self.tangent(pose)
            parts[row] = max(np.abs(rate).max() * travel, np.abs(bend).max() * travel**2)
            gaps[row] = np.abs(self.system.gaps(pose.x) - self.goal(position)).max()
        rounding = ROUNDING * float(parts.max())  # of a linear system's largest part, which is large near a lock
        if not rounding <= promise:
            where = self.scene.where(float(positions[parts.argmax()]))
            reason = f"rounding alone may be {rounding:.1e} of an acceleration at {where}, too close to a lock"
            raise Failure(Status.not_converged, reason)
        return {"constraints": float(gaps.max()), "rounding": rounding}

    def follow(self, pose: ClosedPose, goal: Samples, failure: Callable[[ClosedPose], Failure]) -> ClosedPose:
        """Return the pose where C(x) is the goal, by as many steps of halved length as it takes.

        Where none leads on, it raises the failure of the last pose.
        """
        # A stack of goals: one that is not reached, or only on another branch, is halved towards the present pose, and
        # the half is tried first. The branch is checked by the sign of the determinant at the ends of each step: two
        # changes of sign within one step would be missed.
        ahead = [goal]
        for _ in range(MAX_PARTS):
            self.budget.check(f"{self.counters['steps']} steps are done")
            reached, iterations = self.system.step(pose, ahead[-1])
            self.counters["steps"] += 1
            self.counters["newton_iterations"] += iterations
            if reached is not None and reached.branch == pose.branch:
                pose = reached
                ahead.pop()
                if not ahead:
                    return pose
            elif len(ahead) > MAX_HALVINGS:
                break
            else:
                ahead.append((self.system.gaps(pose.x) + ahead[-1]) / 2)
        raise failure(pose)

    def _locked(self, goal: float, pose: ClosedPose) -> Failure:
        """Return why no pose follows on the way of the drive to a goal."""
        here = float(self.system.gaps(pose.x)[-1]) * self.system.drive_unit
        past = self.scene.where(here)
        for position in np.linspace(here, goal, TRIALS)[1:].tolist():
            if not self.assembles(pose, position):
                return Failure(Status.cannot_assemble, f"the linkage locks past {past}{self.misfit(pose, position)}")
        reason = f"two ways to assemble the linkage meet past {past}, and nothing decides between them"
        return Failure(Status.not_converged, reason)

    def assembles(self, pose: ClosedPose, position: float) -> bool:
        """Return whether there is a pose nearby, by least squares."""
        goal = self.goal(position)
        # Levenberg-Marquardt, since the Jacobian may be singular there.
        closest = least_squares(lambda x: self.system.gaps(x) - goal, pose.x, self.system.jacobian, method="lm")
        return bool(np.abs(closest.fun).max() <= MAX_GAP)

    def repeated(self, pose: ClosedPose, position: float) -> int:
        """Return how many constraints repeat others where the bodies fit together, zero where they do not."""
        count = len(pose.x) - int(np.linalg.matrix_rank(pose.J, tol=SINGULAR_TOL * np.linalg.norm(pose.J, 2)))
        return count if count and self.assembles(pose, position) else 0

    def misfit(self, pose: ClosedPose, position: float) -> str:
        """Return which joint stays open near a pose when all others close, for a message; or nothing."""
        system, joints = self.system, joint_rows(self.system.joints)
        given = (
            (lambda position, x: system.gaps(x) - self.goal(position)),
            system.jacobian,
            pose.x,
            np.ones(len(pose.x)),
            joints,
        )
        return misfit(self.scene, [position], *given, 1.0, unit=system.size) if joints else ""


@lru_cache(MAX_SCENES)
def begun(
    kind: Callable[[Scene], System], scene: Scene, whole_way: bool
) -> tuple[Any, PathFollower, ClosedPose, Mapping[str, float]]:
    """Return what all runs of a scene begin with; Failure where constraints repeat others, or no pose is on the branch.

    Those are its constraints, of that kind; its poses, and that at the drive's start; and by the place of each press
    force in the file the displacement where its stroke ends, m. Where asked, the whole way of the drive is followed
    too.
    """
    system = kind(scene)
    poses, drawn = PathFollower(system), system.drive.in_range(scene.sketch.drive)
    # Homotopy from the sketch: its gaps are brought to zero in CLOSING equal parts.
    x = system.placed(on_sketch(system, drawn))
    pose, gaps = poses.pose(x), system.gaps(x)
    apart = partial(_apart, poses, drawn)
    for share in np.linspace(0, 1, CLOSING + 1)[1:]:
        pose = poses.follow(pose, gaps + share * (poses.goal(drawn) - gaps), apart)
    if poses.repeated(pose, drawn):
        raise apart(pose)
    law = system.drive.law
    pose = next(poses.through(pose, drawn, [law.start]))
    for end in law.extent if whole_way else ():
        _ = [*poses.through(pose, law.start, [end])]
    end_of = cache(partial(_end, poses, pose))
    return system, poses, pose, {place: end_of(load.body, load.closing) for place, load in scene.presses.items()}


def on_sketch(system: System, position: float) -> dict[str, MovingBody]:
    """Return every body where it fits the sketch best by least squares, with the drive at a position, rad or m."""
    scene, frames = system.scene, {GROUND: MovingBody()}
    in_body, seen = dict[str, Samples](), dict[str, Samples]()
    for name, body in system.bodies.items():
        shown = [point for point in body.points if point in scene.drawn]
        in_body[name] = np.array([body.points[point] for point in shown], complex)
        seen[name] = np.array([scene.drawn[point] for point in shown], complex)
    for name in system.bodies:
        group, angle = scene.aligned[name], 0.0
        if system.drive.body in group and system.drive.slide is None:
            angle = position
        elif GROUND not in group:
            # Orthogonal Procrustes problem in the plane: the best common angle is arg sum conj(s) z, with the points s
            # of each body about their mean.
            fits = (np.vdot(in_body[n] - in_body[n].mean(), seen[n]) for n in sorted(group) if len(in_body[n]))
            angle = float(np.angle(sum(fits)))
        # A body without a sketched point has guides alone, which are met from anywhere.
        origin = complex((seen[name] - np.exp(1j * angle) * in_body[name]).mean()) if len(in_body[name]) else 0j
        frames[name] = MovingBody(origin, angle, np.exp(1j * angle))
    return frames


def _apart(poses: PathFollower, position: float, pose: ClosedPose) -> Failure:
    """Return why the sketch's gaps cannot be closed."""
    where, count = poses.scene.where(position), poses.repeated(pose, position)
    if count:
        reason = f"{count} constraints repeat others at {where}: the reactions are not determined"
        return Failure(Status.unsupported, reason)
    reason = f"the bodies do not fit together where the sketch shows them, {where}{poses.misfit(pose, position)}"
    return Failure(Status.cannot_assemble, reason)


def _end(poses: PathFollower, start: ClosedPose, body: str, closing: int) -> float:
    """Return a stroke's furthest displacement as it closes, m: at the best of many positions, or between two."""
    begin, step = poses.system.drive.law.start, poses.largest_step / 4

    def closed(pose: ClosedPose) -> float:
        return closing * float(poses.system.slid(poses.system.moved(pose.x), body)[0].real)

    # Sampled with a quarter of the largest step over the whole range; the best sample's neighbours bracket the dead
    # point.
    known = {begin: start}
    for end in poses.system.drive.law.extent:
        positions = np.linspace(begin, end, int(np.ceil(abs(end - begin) / step)) + 1)[1:].tolist()
        known |= zip(positions, poses.through(start, begin, positions), strict=True)
    best = max(known, key=lambda position: closed(known[position]))
    near, pose = [pair for pair in pairwise(sorted(known)) if best in pair], known[best]
    low, high = near[0][0], near[-1][1]
    refined = minimize_scalar(
        lambda position: -closed(next(poses.through(pose, best, [position]))),
        bounds=(low, high),
        method="bounded",
        options={"xatol": POSITION_TOL * (high - low)},
    )
    return closing * max(closed(pose), -float(refined.fun))
