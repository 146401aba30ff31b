"""Continuation of a pose along a moving right-hand side, and the proof that a pose is a solution.

The constraints f(q) of `rows` are linear in q but for y = S q, the angles and the displacements on moving bodies over
the linkage's size. So every criterion here is on y alone, which has no unit: a change of y by Δ, a turn by Δ rad or a
displacement by Δ sizes, or of one that is longer than the size by Δ of itself, is called a turn for short.
"""

from math import radians

import numpy as np
from flint import arb, arb_mat
from numpy.typing import NDArray

from scenes import Failure, ProcessorBudget, Status

from .constraints import LinkageEquations
from .misfit import misfit

LARGEST_TURN = radians(2)  # of any body in one step
# The predicted turn of the fastest body where a continuation gives up. Rounding of the scene's doubles can make or undo
# a singular configuration within their root, 1e-8.
SMALLEST_TURN = 1e-7
CONTRACTION = 0.25  # largest ratio of Newton corrections; Deuflhard, Newton Methods for Nonlinear Problems, ch. 5
ITERATIONS = 12  # contracting quadratically from 1/4, these reach thousands of digits
TRIALS = 9  # positions from a singular one to the goal, to find one where a joint stays open
HOMOTOPY = 0.5  # largest change of the Jacobian in one step, relative to itself


class Continuation:
    """Follows the pose of a linkage; counts the work."""

    def __init__(self, linkage: LinkageEquations, digits: int, budget: ProcessorBudget) -> None:
        self.linkage, self.budget = linkage, budget
        self.rows = linkage.constraints
        self.converged = 10.0 ** (-digits / 2)  # the next correction would be its square
        halo = 10.0 ** (-2 * digits / 3)
        self.halo = arb_mat(len(linkage.units), 1, [arb(0, unit * halo) for unit in linkage.units])
        self.counters = {"steps": 0, "rejected_steps": 0, "newton_iterations": 0}

    def follow(self, q: arb_mat, goal: arb_mat) -> arb_mat:
        """Return the pose with f(q) = goal that is connected to q: f moves to its goal along a straight line.

        From the sketch this is Davidenko's homotopy, which closes the linkage; from a closed pose it moves the drive.
        A Taylor predictor of second order is followed by Newton; a step is halved unless Newton contracts and the
        Jacobian stays regular from one pose to the next, which keeps the assembly branch. The next step may be twice
        as long.

        Raises:
            Failure: the Jacobian becomes singular on the way, or the budget does not last.
        """
        rows = self.rows
        share, longest = 0.0, LARGEST_TURN
        while share < 1:
            self.budget.check(f"it is at {self._place(q)}")
            left = goal - rows.value(q)
            J = rows.jacobian(q)
            rate = self._solve(J, left, q, goal)
            curvature = self._solve(J, rows.centripetal(q, rate), q, goal)
            turn = self._largest_turn(rate, q)
            share = longest / max(longest, turn)
            while (reached := self._step(q, J, rate, curvature, goal - left * arb(1 - share), share)) is None:
                share /= 2
                self.counters["rejected_steps"] += 1
                if not share * turn >= SMALLEST_TURN:
                    raise self._singular(q, goal)
            q, longest = reached, min(LARGEST_TURN, 2 * share * turn)
            self.counters["steps"] += 1
        return q

    def enclose(self, q: arb_mat, goal: arb_mat) -> arb_mat:
        """Return balls that hold one and only one solution of f(q) = goal: a step of the interval Newton method.

        The image q - J(X)^-1 (f(q) - goal) of a box X about q holds all solutions in X; where it lies in X there is
        one, and where all of J(X) is regular no other. Moore, Kearfott & Cloud (2009), Introduction to Interval
        Analysis, ch. 8.

        Raises:
            Failure: nothing is proven at this precision.
        """
        box = q + self.halo
        image = q - self.rows.jacobian(box).solve(self.rows.value(q) - goal, nonstop=True)  # NaN where singular
        if not box.contains(image):
            raise Failure(Status.not_converged, f"the digits are too few to prove the pose at {self._place(q)}")
        return image

    def _step(
        self, q: arb_mat, J: arb_mat, rate: arb_mat, curvature: arb_mat, goal: arb_mat, share: float
    ) -> arb_mat | None:
        """Return the pose a step further, or None where Newton does not contract or J changes too much."""
        h = arb(share)
        reached = self._newton(
            (q + rate * h + curvature * (h * h / 2)).mid(), goal, share * self._largest_turn(rate, q)
        )
        if reached is None:
            return None
        # J and its successor differ by ΔB S, and det(J + t ΔB S) = det(J) det(1 + t S J^-1 ΔB). Where a norm of
        # S J^-1 ΔB is less than one, no matrix on the line between the two is singular. The least of its norms in any
        # units of y is the spectral radius of the matrix of its magnitudes (Perron and Frobenius).
        change = self.rows.varying(reached) - self.rows.varying(q)
        relative = np.array((self.rows.S * J.solve(change, algorithm="approx")).tolist(), dtype=float)
        return reached if np.abs(np.linalg.eigvals(np.abs(relative))).max() <= HOMOTOPY else None

    def _newton(self, q: arb_mat, goal: arb_mat, turn: float) -> arb_mat | None:
        """Return the solution of f(q) = goal near q, or None; `turn` is the predicted step that q came by."""
        for _ in range(ITERATIONS):
            self.counters["newton_iterations"] += 1
            try:
                correction = self.rows.jacobian(q).solve(goal - self.rows.value(q), algorithm="approx")
            except ZeroDivisionError:
                return None
            q = (q + correction).mid()
            last, turn = turn, self._largest_turn(correction, q)
            if turn <= self.converged:
                return q
            if not turn <= CONTRACTION * last:
                return None
        return None

    def _solve(self, J: arb_mat, right: arb_mat, q: arb_mat, goal: arb_mat) -> arb_mat:
        try:
            return J.solve(right)
        except ZeroDivisionError:
            raise self._singular(q, goal) from None

    def _largest_turn(self, change: arb_mat, q: arb_mat) -> float:
        """Return the largest |Δy| of a change of pose q, that of a displacement longer than the size over itself."""
        moves, bodies = self._turns(change), len(self.linkage.index)
        if len(moves) > bodies:
            lengths = np.hypot(*self._turns(q)[bodies:].reshape(-1, 2).T)
            moves[bodies:] /= np.repeat(np.maximum(1.0, lengths), 2)
        return float(np.max(np.abs(moves)))  # NaN stays NaN

    def _turns(self, q: arb_mat) -> NDArray[np.float64]:
        return np.array([float(y) for y in (self.rows.S * q).entries()])

    def _place(self, q: arb_mat) -> str:
        return self.linkage.scene.where(float(self.linkage.position.value(q)[0, 0]))

    def _singular(self, q: arb_mat, goal: arb_mat) -> Failure:
        """Return why no pose follows q on the way to the goal, and which joint stays open from there on."""
        here, there = float(self.linkage.position.value(q)[0, 0]), float(goal[goal.nrows() - 1, 0])
        open_by = misfit(self.linkage, q, np.linspace(here, there, TRIALS)[1:])
        reason = f"the constraint Jacobian is singular at {self._place(q)}: the linkage locks or two branches meet"
        return Failure(Status.cannot_assemble, reason + open_by)
