"""Continuation of a pose along a moving right-hand side, and the proof that a pose is a solution.

The constraints f(q) of `rows` are linear in q but for y = S q, the angles and the displacements on moving bodies over
the linkage's size. So every criterion here is on y alone, which has no unit: a change of y by Δ, a turn by Δ rad or a
displacement by Δ sizes, or of one that is longer than the size by Δ of itself, is called a turn for short.
"""

from math import radians
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat

from scenes import Failure, ProcessorBudget, Status
from scenes.model.constraints import joint_rows, misfit
from scenes.model.motion import Samples

from .constraints import LinkageEquations
from .rows import solved

MAX_TURN = radians(6)  # of any body in one step: a crank's 72 positions a turn are one step each
# The predicted turn of the fastest body where a continuation gives up. Rounding of the scene's doubles can make or undo
# a singular configuration within their root, 1e-8.
MIN_TURN = 1e-7
MAX_CONTRACTION = 0.25  # largest ratio of Newton corrections; Deuflhard, Newton Methods for Nonlinear Problems, ch. 5
MAX_ITERATIONS = 12  # contracting from 1/4, at last by the digits of doubles: these reach a hundred
ON_THE_WAY = MIN_TURN**2  # error of a pose from which the next is predicted
CORRECTION_TOL = 1e-8  # of a correction in doubles, as much as `MIN_TURN` takes of their digits
TRIALS = 9  # positions from a singular one to the goal, to find one where a joint stays open
MAX_HOMOTOPY = 0.5  # largest change of the Jacobian in one step, relative to itself
AIM = 0.4  # what that is to be in the next step
MIN_FACTOR, MAX_FACTOR = 0.5, 2.0  # of one step and the next


class PoseRates(NamedTuple):
    """A pose, and its derivatives by the share of a way."""

    q: arb_mat
    B: Samples
    inverse: Samples  # of J
    rate: Samples
    curvature: Samples
    turn: float  # the largest rate of y


class Continuation:
    """Follows the pose of a linkage; counts the work."""

    def __init__(self, linkage: LinkageEquations, digits: int, budget: ProcessorBudget) -> None:
        self.linkage, self.budget = linkage, budget
        self.rows = linkage.constraints
        self._C, self._S = (np.array(part.tolist(), dtype=float) for part in (self.rows.C, self.rows.S))
        self._units = np.array(linkage.units)
        self.converged = 10.0 ** (-2 * digits / 3)
        self.halo = arb_mat([[arb(0, unit * self.converged)] for unit in linkage.units])
        self.counters = {"steps": 0, "rejected_steps": 0, "newton_iterations": 0}

    def follow(self, q: arb_mat, goal: arb_mat) -> arb_mat:
        """Return the pose with f(q) = goal that is connected to q: f moves to its goal along a straight line.

        From the sketch this is Davidenko's homotopy, which closes the linkage; from a closed pose it moves the drive.
        A Taylor predictor of second order is followed by Newton; a step is shortened until Newton contracts and the
        Jacobian stays regular from one pose to the next, which keeps the assembly branch. The next step is as long as
        the change of the Jacobian allows.
        """
        share, longest = 0.0, MAX_TURN
        while share < 1:
            self.budget.check(f"it is at {self._place(q)}")
            left = goal - self.rows.value(q)
            motion = self._motion(q, left, goal)
            # Step control by turns: the share of the way for which the fastest body turns by `longest`. A rejected step
            # shortens the share; an accepted one sets the next length by how much the Jacobian changed relative to AIM.
            share = longest / max(longest, motion.turn)
            while True:
                reached, factor = self._step(motion, goal - left * arb(1 - share), share)
                if reached is not None:
                    break
                share *= factor
                self.counters["rejected_steps"] += 1
                if not share * motion.turn >= MIN_TURN:
                    raise self._singular(q, goal)
            q, longest = reached, min(MAX_TURN, factor * share * motion.turn)
            self.counters["steps"] += 1
        return q

    def enclose(self, q: arb_mat, goal: arb_mat) -> arb_mat:
        """Return balls that hold one and only one solution of f(q) = goal: a step of the interval Newton method.

        The image q - J(X)^-1 (f(q) - goal) of a box X about q holds all solutions in X; where it lies in X there is
        one, and where all of J(X) is regular no other. Moore, Kearfott & Cloud (2009), Introduction to Interval
        Analysis, ch. 8.
        """
        box = q + self.halo
        J, left = self.rows.jacobian(box), self.rows.value(q) - goal
        image = q - solved(self.linkage.groups, J, left, nonstop=True)  # NaN where singular
        if not box.contains(image):
            raise Failure(Status.not_converged, f"the digits are too few to prove the pose at {self._place(q)}")
        return image

    def _motion(self, q: arb_mat, left: arb_mat, goal: arb_mat) -> PoseRates:
        """Return how a pose moves as f does by `left`."""
        B = self._varying(q)
        try:
            inverse = np.linalg.inv(self._C + B @ self._S)
        except np.linalg.LinAlgError:
            raise self._singular(q, goal) from None
        rate = inverse @ _floats(left)
        curvature = inverse @ _floats(self.rows.centripetal(q, _balls(rate)))
        return PoseRates(q, B, inverse, rate, curvature, self._largest_turn(rate, q))

    def _step(self, motion: PoseRates, goal: arb_mat, share: float) -> tuple[arb_mat | None, float]:
        """Return the pose a step further and how much longer the next one may be.

        There is none where Newton does not contract or J changes too much, and the next try is as much shorter.
        """
        predicted = (motion.q + _balls(share * motion.rate + share**2 / 2 * motion.curvature)).mid()
        enough = self.converged if share == 1 else ON_THE_WAY
        reached = self._newton(predicted, goal, share * motion.turn, enough)
        if reached is None:
            return None, MIN_FACTOR
        change = self._relative(motion.inverse, self._varying(reached) - motion.B)
        factor = max(MIN_FACTOR, min(AIM / change, MAX_FACTOR)) if change > 0 else MAX_FACTOR
        return (reached if change <= MAX_HOMOTOPY else None), factor

    def _relative(self, inverse: Samples, change: Samples) -> float:
        """Return how much J changes relative to itself where B changes by ΔB, given J^-1.

        det(J + t ΔB S) = det(J) det(1 + t S J^-1 ΔB). Where a norm of S J^-1 ΔB is less than one, no matrix on the line
        between the two is singular. The least of its norms in any units of y is the spectral radius of the matrix of
        its magnitudes (Perron and Frobenius).
        """
        return float(np.abs(np.linalg.eigvals(np.abs(self._S @ (inverse @ change)))).max())

    def _newton(self, q: arb_mat, goal: arb_mat, turn: float, enough: float) -> arb_mat | None:
        """Return the solution of f(q) = goal near q, or None; `turn` is the predicted step that q came by."""
        for _ in range(MAX_ITERATIONS):
            self.counters["newton_iterations"] += 1
            # Residuals with all digits, corrections by a Jacobian in doubles: each iteration gains the digits of a
            # double, at a fraction of the cost of a 50-digit factorisation. The correction's own error has to be below
            # what is asked for too, for coordinates that move without any turn.
            left = _floats(goal - self.rows.value(q))  # by all digits, all that follows by those of doubles
            try:
                correction = np.linalg.solve(self._C + self._varying(q) @ self._S, left)
            except np.linalg.LinAlgError:
                return None
            q = (q + _balls(correction)).mid()
            last, turn = turn, self._largest_turn(correction, q)
            closes = turn <= enough or turn * turn <= enough * last  # the next turn
            if closes and CORRECTION_TOL * np.abs(correction / self._units).max() <= enough:
                return q
            if not (closes or turn <= MAX_CONTRACTION * max(last, MIN_TURN)):  # what moves without turning has none
                return None
        return None

    def _varying(self, q: arb_mat) -> Samples:
        """Return B in double precision."""
        B = np.zeros((len(self._C), len(self._S)))
        for place, slope in self.rows.varying(q).items():
            B[place] = float(slope)
        return B

    def _largest_turn(self, change: Samples, q: arb_mat) -> float:
        """Return the largest |Δy| of a change of pose q, that of a displacement longer than the size over itself."""
        moves, bodies = self._S @ change, len(self.linkage.index)
        if len(moves) > bodies:
            lengths = np.hypot(*(self._S @ _floats(q))[bodies:].reshape(-1, 2).T)
            moves[bodies:] /= np.repeat(np.maximum(1.0, lengths), 2)
        return float(np.max(np.abs(moves)))  # NaN stays NaN

    def _place(self, q: arb_mat) -> str:
        return self.linkage.scene.where(float(self.linkage.position.value(q)[0, 0]))

    def _singular(self, q: arb_mat, goal: arb_mat) -> Failure:
        """Return why no pose follows q on the way to the goal, and which joint stays open from there on."""
        linkage, rows, scene = self.linkage, self.rows, self.linkage.scene
        here, there = float(linkage.position.value(q)[0, 0]), float(goal[goal.nrows() - 1, 0])
        open_by = misfit(  # in doubles
            scene,
            np.linspace(here, there, TRIALS)[1:],
            lambda position, q: _floats(rows.value(_balls(q)) - linkage.drive(position)),
            lambda q: np.array(rows.jacobian(_balls(q)).tolist(), dtype=float),
            *(_floats(q), self._units, joint_rows(scene.joints), linkage.size),
        )
        reason = f"the constraint Jacobian is singular at {self._place(q)}: the linkage locks or two branches meet"
        return Failure(Status.cannot_assemble, reason + open_by)


def _floats(balls: arb_mat) -> Samples:
    return np.array([float(ball) for ball in balls.entries()])


def _balls(values: Samples) -> arb_mat:
    return arb_mat([[value] for value in values.tolist()])
