"""Poses of the tree: steps along the way of the drive, predicted by two derivatives and corrected by Newton's method.

The Jacobian of a prediction serves all its corrections, which therefore shrink by a constant factor: where that is not
small, the step was too long.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from scenes import Failure, ProcessorBudget, Status
from scenes.motion import Samples
from scenes.open_joint import open_joint

from .closures import Closures

CONTRACTION = 0.25  # largest ratio of a correction to the one before
FITTING = 0.1  # of a step: the largest first correction
ITERATIONS = 20
CONVERGED = 1e-9  # the last correction, from where only rounding may stop the next ones from shrinking
ROUND_OFF = 1e-15
HALVINGS = 20  # of one step; rounding of the scene's numbers can make or undo a lock within 1e-7 of a turn
PARTS = 200  # of one step; two branches that run side by side may need any number
LARGEST = np.radians(10.0)  # step of the drive, and as a part of its travel
TRIALS = 9  # positions ahead, to find one where a joint stays open
OPEN = 1e-9  # gap of bodies that do not fit together, over the size
SECONDS = 120.0  # of processor time, for the build and for each cycle


class Pose(NamedTuple):
    """Joint coordinates where C(q) = g, and the Jacobian there, with columns by comparable units."""

    q: Samples
    J: Samples

    @property
    def branch(self) -> float:
        """The sign of det J, which changes only where two branches meet."""
        return float(np.linalg.slogdet(self.J)[0])


class Stuck(Exception):  # noqa: N818 - a way that ends is no error
    """No step leads on from this pose."""

    def __init__(self, pose: Pose) -> None:
        super().__init__()
        self.pose = pose


class Poses:
    """The poses of one linkage."""

    def __init__(self, closures: Closures) -> None:
        self.closures, self.scene = closures, closures.tree.scene
        self.drive_row = np.eye(len(closures.row_units))[-1]
        self.budget = ProcessorBudget(SECONDS, "the way of the linkage")
        self.counters = {"steps": 0, "newton_iterations": 0}

    def pose(self, q: Samples) -> Pose:
        """Return the pose at joint coordinates."""
        return Pose(q, self.closures.jacobian(q) * self.closures.units)

    def through(self, pose: Pose, here: float, positions: Iterable[float]) -> Iterator[Pose]:
        """Yield the poses at positions of the drive, from that at `here`, one after the other.

        Raises:
            Failure: `cannot_assemble`, the linkage locks on the way; `not_converged`, two branches meet there.
        """
        for position in positions:
            parts = max(1, int(np.ceil(abs(position - here) / self.largest_step)))
            for part in np.linspace(here, position, parts + 1)[1:]:
                try:
                    pose = self.follow(pose, self.goal(float(part)))
                except Stuck as stuck:
                    raise self._locked(stuck.pose, position) from None
            here = position
            yield pose

    def goal(self, position: float) -> Samples:
        """Return what C(q) is at a position of the drive."""
        return np.asarray(self.drive_row * position / self.closures.drive_unit)

    @property
    def largest_step(self) -> float:
        """The largest step of the drive, rad or m."""
        turn = self.scene.driven_slide is None
        return float(LARGEST if turn else LARGEST / (2 * np.pi) * np.ptp(self.scene.drive.extent))

    def tangent(self, pose: Pose) -> tuple[Samples, Samples]:
        """Return dq/ds and d2q/ds2, s the drive's position, rad or m."""
        units = self.closures.units
        rate = units * np.linalg.solve(pose.J, self.goal(1.0))
        return rate, -units * np.linalg.solve(pose.J, self.closures.bend(pose.q, rate))

    def follow(self, pose: Pose, goal: Samples) -> Pose:
        """Return the pose where C(q) is the goal, by as many steps of halved length as it takes.

        Raises:
            Stuck: no pose follows.
            Failure: `timed_out`.
        """
        ahead = [goal]
        for _ in range(PARTS):
            self.budget.check(f"{self.counters['steps']} steps are done")
            reached = self._step(pose, ahead[-1])
            if reached is not None:
                pose = reached
                ahead.pop()
                if not ahead:
                    return pose
            elif len(ahead) > HALVINGS:
                break
            else:
                ahead.append((self.closures.gaps(pose.q) + ahead[-1]) / 2)
        raise Stuck(pose)

    def _step(self, pose: Pose, goal: Samples) -> Pose | None:
        """Return the pose at a goal, or None where the step is too long."""
        closures, units = self.closures, self.closures.units
        self.counters["steps"] += 1
        try:
            rate = np.linalg.solve(pose.J, goal - closures.gaps(pose.q))
            way = rate - np.linalg.solve(pose.J, closures.bend(pose.q, units * rate)) / 2
            q = pose.q + units * way
            predicted, largest = self.pose(q), FITTING * np.abs(way).max() + CONVERGED
            for _ in range(ITERATIONS):
                correction = np.linalg.solve(predicted.J, goal - closures.gaps(q))
                length = np.abs(correction).max()
                self.counters["newton_iterations"] += 1
                if not (length <= largest or length <= CONVERGED):
                    return None
                q = q + units * correction
                if length <= ROUND_OFF or (length <= CONVERGED and length > largest):
                    break
                largest = CONTRACTION * length
            reached = self.pose(q)
            return reached if length <= CONVERGED and reached.branch == pose.branch else None
        except np.linalg.LinAlgError:
            return None

    # --- why not ------------------------------------------------------------------------------------------------------

    def _locked(self, pose: Pose, goal: float) -> Failure:
        """Return why no pose follows on the way of the drive to a goal."""
        here = float(self.closures.gaps(pose.q)[-1]) * self.closures.drive_unit
        past = self.scene.where(here)
        for position in np.linspace(here, goal, TRIALS)[1:].tolist():
            if not self.assembles(pose, position):
                reason = f"the loops cannot be closed past {past}: the linkage locks{self.misfit(pose, position)}"
                return Failure(Status.cannot_assemble, reason)
        return Failure(Status.not_converged, f"past {past} two branches meet, and nothing decides between them")

    def assembles(self, pose: Pose, position: float) -> bool:
        """Return whether there is a pose nearby, by least squares."""
        units, goal = self.closures.units, self.goal(position)
        found = least_squares(
            lambda x: self.closures.gaps(units * x) - goal,
            pose.q / units,
            lambda x: self.pose(units * x).J,
            method="lm",
        )
        return bool(np.abs(found.fun).max() <= OPEN)

    def misfit(self, pose: Pose, position: float) -> str:
        """Return which of the joints that close loops stays open when all others close, for a message; or nothing."""
        units, goal, first = self.closures.units, self.goal(position), 2 * len(self.closures.pins)
        joints = {f"the guide of {name}": [first + 2 * row] for row, name in enumerate(self.closures.sliders)}
        joints |= {name: [2 * row, 2 * row + 1] for row, name in enumerate(self.closures.pins)}
        if not joints:
            return ""
        joint, gap = open_joint(
            lambda x: self.closures.gaps(units * x) - goal,
            lambda x: self.pose(units * x).J,
            pose.q / units,
            np.ones(len(units)),
            joints,
            1.0,
        )
        apart = self.scene.length(gap * self.closures.size)
        return f"; with all else closed {joint} stays open by {apart} at {self.scene.where(position)}" if gap else ""
