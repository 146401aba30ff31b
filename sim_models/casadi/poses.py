"""Poses of a linkage: step by step, many steps in one call of a compiled recurrence.

A step goes from a pose to the one where C(x) = g, along the straight line between C and g: predicted by the first two
derivatives and corrected by Newton's method, or by Runge and Kutta's without a correction.
"""

from functools import cached_property
from typing import Any

import casadi
import numpy as np
from casadi import MX, Function
from numpy.typing import NDArray
from scipy.optimize import least_squares

from scenes import Failure, ProcessorBudget, Status
from scenes.motion import Samples
from scenes.open_joint import open_joint

from .linkage import Linkage, table

STEPS = 36  # in one call
SOLVER = "qr"  # CasADi's own, by Householder reflections; it raises RuntimeError where a pivot is zero
CORRECTIONS = 3  # from a prediction good to a tenth of a step, Newton's method leaves 1e-8 after two
FITTING = 0.1  # of a step: the largest first correction
CONVERGED = 1e-9  # the last correction: it squares what is left
HALVINGS = 20  # of one step; rounding of the scene's numbers can make or undo a lock within 1e-7 of a turn
PARTS = 200  # of one step; two branches that run side by side may need any number
LARGEST = np.radians(10.0)  # step of the drive, and as a part of its travel
TRIALS = 9  # positions ahead, to find one where a joint stays open
OPEN = 1e-9  # gap of bodies that do not fit together, over the size
SECONDS = 60.0  # of processor time, for the build and for each cycle


class Stuck(Exception):  # noqa: N818 - a way that ends is no error
    """No step leads on from this pose, of shape (3 bodies,)."""

    def __init__(self, x: Samples) -> None:
        super().__init__()
        self.x = x


class Poses:
    """The poses of one linkage. Of arrays the last axis is that of the samples, as CasADi has its columns."""

    def __init__(self, linkage: Linkage) -> None:
        self.linkage, self.scene = linkage, linkage.scene
        self.rows = linkage.constraints.shape[0]
        self.drive_row = np.eye(self.rows)[:, -1]
        self.budget = ProcessorBudget(SECONDS, "the way of the linkage")
        self.counters = {"steps": 0, "halved_steps": 0}

    # --- along the drive ----------------------------------------------------------------------------------------------

    def through(self, x: Samples, here: float, positions: Samples) -> Samples:
        """Return the poses at positions of the drive, shape (3 bodies, n), from that at `here`, one after the other.

        Raises:
            Failure: `cannot_assemble`, the linkage locks on the way; `not_converged`, two branches meet there.
        """
        path = np.append(here, positions)
        parts = np.ceil(np.abs(np.diff(path)) / self.largest_step).clip(1).astype(int)
        known = np.append(0, np.cumsum(parts))
        fine = np.interp(np.arange(known[-1] + 1), known, path)
        try:
            return self.follow(x, self.goals(fine[1:]))[:, known[1:] - 1]
        except Stuck as stuck:
            raise self._locked(stuck.x, float(path[-1])) from None

    def goals(self, positions: Samples) -> Samples:
        """Return what C(x) is at positions of the drive, shape (rows, n)."""
        return np.asarray(self.drive_row[:, None] * positions / self.linkage.drive_unit)

    @property
    def largest_step(self) -> float:
        """The largest step of the drive, rad or m."""
        least, most = self.scene.drive.extent
        return float(LARGEST if self.scene.driven_slide is None else LARGEST / (2 * np.pi) * (most - least))

    def tangent(self, x: Samples) -> tuple[Samples, Samples]:
        """Return dx/ds and d2x/ds2 in poses of shape (3 bodies, n), s the drive's position, rad or m."""
        unit = np.repeat(self.drive_row[:, None], x.shape[1], axis=1) / self.linkage.drive_unit
        first = table(self.solve, x, unit)
        return first, table(self.solve, x, -table(self.linkage.bend, x, first))

    def branch(self, x: Samples) -> NDArray[np.float64]:
        """Return the sign of det C_x of poses, shape (3 bodies, n), which changes only where two branches meet."""
        J = table(self.linkage.jacobian, x).reshape(self.rows, -1, len(x))
        sign: NDArray[np.float64] = np.linalg.slogdet(J.transpose(1, 0, 2)).sign
        return sign

    # --- along any right-hand side ------------------------------------------------------------------------------------

    def follow(self, x: Samples, goals: Samples) -> Samples:
        """Return the poses where C(x) = g for each column g, shape (rows, n), from pose x, shape (3 bodies,).

        Raises:
            Stuck: no pose follows.
            Failure: `timed_out`.
        """
        found, done = np.empty((len(x), goals.shape[1])), 0
        branch = self.branch(x[:, None])
        while done < goals.shape[1]:
            self.budget.check(f"{done} of {goals.shape[1]} steps are done")
            block = goals[:, done : done + STEPS]
            poses, good = self._together(x, block, branch)
            found[:, done : done + good] = poses[:, :good]
            done += good
            x = found[:, done - 1] if good else x
            if good < block.shape[1]:
                x = found[:, done] = self._halved(x, goals[:, done], branch)
                done += 1
        self.counters["steps"] += done
        return found

    def _together(self, x: Samples, goals: Samples, branch: Samples) -> tuple[Samples, int]:
        """Return up to `STEPS` poses, and how many of the first are good."""
        padded = np.pad(goals, ((0, 0), (0, STEPS - goals.shape[1])), mode="edge")
        try:
            poses, quality = (np.array(of) for of in self._steps(x, padded))
        except RuntimeError:  # one of them is singular
            return padded, 0
        with np.errstate(invalid="ignore"):
            first, last, way = quality
            good = (first <= FITTING * way + CONVERGED) & (last <= CONVERGED) & (self.branch(poses) == branch)
        good = good[: goals.shape[1]]
        return poses, len(good) if good.all() else int(good.argmin())

    def _halved(self, x: Samples, goal: Samples, branch: Samples) -> Samples:
        """Return the pose at a goal, by as many shorter steps as it takes."""
        ahead = [goal]
        for _ in range(PARTS):
            poses, good = self._together(x, ahead[-1][:, None], branch)
            if good:
                x = poses[:, 0]
                ahead.pop()
                if not ahead:
                    return x
            elif len(ahead) > HALVINGS:
                break
            else:
                ahead.append((table(self.linkage.gaps, x)[:, 0] + ahead[-1]) / 2)
                self.counters["halved_steps"] += 1
        raise Stuck(x)

    # --- recurrences --------------------------------------------------------------------------------------------------

    @cached_property
    def solve(self) -> Function:
        """C_x^-1 b, from x and b."""
        x, b = MX.sym("x", self.rows), MX.sym("b", self.rows)
        return Function("solve", [x, b], [self._solved(x, b)])

    @cached_property
    def _steps(self) -> Function:
        """Pose after pose; of each the first correction, the last one and the way from the pose before."""
        x, g = MX.sym("x", self.rows), MX.sym("g", self.rows)
        J = self.linkage.jacobian(x)
        tangent = casadi.solve(J, g - self.linkage.gaps(x), SOLVER)
        way = tangent - casadi.solve(J, self.linkage.bend(x, tangent), SOLVER) / 2
        reached, corrections = x + way, []
        for _ in range(CORRECTIONS):
            correction = self._solved(reached, g - self.linkage.gaps(reached))
            reached += correction
            corrections.append(casadi.norm_inf(correction))
        quality = casadi.vertcat(corrections[0], corrections[-1], casadi.norm_inf(way))
        return Function("step", [x, g], [reached, quality]).mapaccum(STEPS)

    @cached_property
    def runge_kutta(self) -> Function:
        """Pose after pose, from a pose and steps of the drive, over its unit; shape (3 bodies, STEPS)."""
        x, h = MX.sym("x", self.rows), MX.sym("h")
        k = [self._solved(x, self.drive_row)]
        for part in (1 / 2, 1 / 2, 1):
            k.append(self._solved(x + part * h * k[-1], self.drive_row))
        return Function("step", [x, h], [x + h / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3])]).mapaccum(STEPS)

    def _solved(self, x: Any, b: Any) -> Any:
        return casadi.solve(self.linkage.jacobian(x), b, SOLVER)

    # --- why not ------------------------------------------------------------------------------------------------------

    def _locked(self, x: Samples, goal: float) -> Failure:
        """Return why no pose follows x on the way of the drive to a goal."""
        here = float(table(self.linkage.gaps, x)[-1, 0]) * self.linkage.drive_unit
        for position in np.linspace(here, goal, TRIALS)[1:].tolist():
            if not self.assembles(x, position):
                reason = f"the linkage locks past {self.scene.where(here)}{self.misfit(x, position)}"
                return Failure(Status.cannot_assemble, reason)
        reason = f"two ways to assemble the linkage meet past {self.scene.where(here)}, and neither is the one to take"
        return Failure(Status.not_converged, reason)

    def assembles(self, x: Samples, position: float) -> bool:
        """Return whether there is a pose near x, by least squares."""
        found = least_squares(lambda x: self._open(x, position), x, self._jacobian, method="lm")
        return bool(np.abs(found.fun).max() <= OPEN)

    def misfit(self, x: Samples, position: float) -> str:
        """Return which joint stays open near a pose when all others close, for a message; or nothing."""
        joints = {f"the guide of {name}": rows[:1] for name, rows in self.linkage.rows_of_slides.items()}
        joints |= {pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(self.scene.pins)}
        joint, gap = open_joint(lambda x: self._open(x, position), self._jacobian, x, np.ones(len(x)), joints, 1.0)
        apart = self.scene.length(gap * self.linkage.size)
        where = self.scene.where(position)
        return f"; with all else closed {joint} stays open by {apart} at {where}" if gap else ""

    def _open(self, x: Samples, position: float) -> Samples:
        return np.asarray((table(self.linkage.gaps, x) - self.goals(np.array([position])))[:, 0])

    def _jacobian(self, x: Samples) -> Samples:
        return table(self.linkage.jacobian, x)
