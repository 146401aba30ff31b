"""The friction of a group's joints, from the joints' forces, which it changes itself.

Of each joint X is its load as a plane vector: a pin's force; of a guide its normal force and, across it, twice its
moment over the contact's length. X is linear in the frictions w of the group, moments or forces against the sense s:

    X_i = X0_i + sum_j S_ij w_j,    w_i = -s_i c_i |X_i| - viscous,    |X| = max(|N|, 2 |M| / length) in guides  (1)

with c the radius of the friction circle, or the coefficient. Newton's method solves (1). The map from the |X_j| to the
|X_i| contracts where the matrix |S_ij| c_j has a spectral radius below one: then there is one solution (Banach).
Elsewhere, row by row of the samples, the solution is continued by one factor on all coefficients, from that without
friction, as long as the determinant of its Jacobian keeps its sign; it ends where the forces grow without bound, or two
solutions meet. There it is jammed.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any

import numpy as np

from scenes.elements.friction import Friction
from scenes.model.motion import Samples

from .contacts import CONTACTS, RubbingContact
from .dyads import dot
from .numbers import chosen

GUESSES = 2  # from no friction: what is left is the square of the map's contraction, often some thousandths
STEPS = 3  # of Newton's method, after which that is round-off
STEP_TOL = 1e-8  # of the last step, relative: what is left is smaller by the step before
MIN_STEP = 1e-14  # of the factor, where the continuation ends
NEWTON_STEPS = 12  # steps from a solution nearby
SEARCH_STEPS = 40  # from anywhere
STARTS = (1e-2, 1.0, 1e2, 1e4)  # times the loads without friction: where other solutions are looked for
SAME_SOLUTION_TOL = 1e-6  # of each other, relative: two solutions
MAX_STEP_RATIO = 0.5  # by which each step of Newton's method is shorter than the one before, near to a solution


@dataclass(frozen=True)
class Rubbing:
    """One friction of a group at some samples."""

    friction: Friction
    sense: Any
    viscous: Any  # what resists whatever the load, N m or N
    share: Any = 1.0  # of the coefficient

    def slope(self, factor: Any = 1.0) -> Any:
        """The friction by the load, with a factor on the coefficient: s c of (1)."""
        return self.sense * self.contact.factor(self.friction, factor * self.share * self.friction.coefficient)

    @property
    def contact(self) -> RubbingContact:
        """The rule of its joint."""
        return CONTACTS[type(self.friction)]

    def size(self, X: Any) -> Any:
        """The load |X|."""
        return self.contact.size(X)

    def gradient(self, X: Any, size: Any) -> Any:
        """The direction in which the load grows, a unit vector; any where there is no load."""
        return self.contact.gradient(X, size)


@dataclass(frozen=True)
class Loads:
    """The frictions of a group, and what the loads of its joints are by them: X0 and S of (1)."""

    rubbing: Sequence[Rubbing]
    X0: Sequence[Any]
    S: Sequence[Sequence[Any]]

    def open(self, w: Sequence[Any], slopes: Sequence[Any]) -> tuple[list[Any], Iterator[list[Any]]]:
        """How far w is from solving (1), and the rows of the Jacobian."""
        # Joints of one force share the sum of its changes in a recorded line.
        X = [x + reduce(add, map(np.multiply, row, w)) for x, row in zip(self.X0, self.S, strict=True)]
        sizes = [joint.size(load) for joint, load in zip(self.rubbing, X, strict=True)]
        parts = [*zip(self.rubbing, slopes, X, sizes, strict=True)]
        F = [x + joint.viscous + slope * size for x, (joint, slope, _, size) in zip(w, parts, strict=True)]
        gradients = (slope * joint.gradient(load, size) for joint, slope, load, size in parts)
        J = (
            [dot(gradient, s) + (1.0 if i == j else 0.0) for j, s in enumerate(self.S[i])]
            for i, gradient in enumerate(gradients)
        )
        return F, J

    @property
    def gains(self) -> list[list[Any]]:
        """By how much the loads change at most by each other: |S_ij| c_j."""
        slopes = [np.abs(joint.slope()) for joint in self.rubbing]
        return [
            [joint.size(s) * slope for s, slope in zip(row, slopes, strict=True)]
            for joint, row in zip(self.rubbing, self.S, strict=True)
        ]

    @property
    def contraction(self) -> Any:
        """A bound on that of the map from loads to loads, no less than the spectral radius."""
        return reduce(np.maximum, (reduce(add, row) for row in self.gains))

    def about(self, number: Any) -> Any:
        """A number of which a method's steps are made: how near they come is asked of where they end."""
        return number

    def solved(self) -> tuple[list[Any], Any]:
        """Return w of (1) by a few steps, and a number that is below one where they are near to its one solution."""
        slopes = [joint.slope() for joint in self.rubbing]
        # A fixed number of steps, so that the method is a straight line that can be recorded: fixed-point steps from no
        # friction, which are safe in a contraction, then Newton's. Whether that was enough is asked at the end, by the
        # last step.
        w: list[Any] = [0.0 * x.real for x in self.X0]
        for _ in range(GUESSES):
            F, _ = self.open(w, slopes)
            w = [self.about(x - dx) for x, dx in zip(w, F, strict=True)]
        J: list[list[Any]] = []
        for step in range(STEPS):
            F, rows = self.open(w, slopes)
            # At last as before: it differs by that step's square.
            J = [[self.about(x) for x in row] for row in rows] if step < STEPS - 1 else J
            dw = eliminated(J, F)
            w = [self.about(x - dx) for x, dx in zip(w, dw, strict=True)]
        bound = self.contraction
        for x, dx in zip(w, dw, strict=True):
            bound = chosen(np.abs(dx) <= STEP_TOL * np.abs(x), bound, np.inf)
        return w, bound

    def picked(self, rows: Any) -> "Loads":
        """The loads at the r samples marked, each as an array of shape (r,)."""

        def some(values: Any) -> Any:
            return np.broadcast_to(values, rows.shape)[rows]

        rubbing = [
            Rubbing(joint.friction, *map(some, (joint.sense, joint.viscous, joint.share))) for joint in self.rubbing
        ]
        return Loads(rubbing, [*map(some, self.X0)], [[*map(some, row)] for row in self.S])

    def stepped(self, w: Samples, factor: Any, steps: int, *, anywhere: bool = False) -> tuple[Samples, Any, Any]:
        """Newton's method from w, (r, K): where it ends, whether at a solution, and whether each step was much shorter.

        Unless it may be `anywhere`, the determinant of the Jacobian has the sign that it has without friction.
        """
        # Newton's method is near a solution where each step is at most half the last. A positive determinant (without
        # friction it is one) means that no fold was passed.
        slopes = [joint.slope(factor) for joint in self.rubbing]
        near, before = np.ones(len(w), np.bool_), np.full(len(w), np.inf)
        for _ in range(steps):
            F, J = self.open([*w.T], slopes)
            A = np.moveaxis(np.array([*J]), -1, 0)
            sign = np.linalg.slogdet(np.where(np.isfinite(A), A, 0.0))[0]
            regular = sign != 0 if anywhere else sign > 0
            dw = np.full(w.shape, np.nan)
            dw[regular] = np.linalg.solve(A[regular], np.stack(F, axis=-1)[regular][..., None])[..., 0]
            w = w - dw
            length = np.abs(dw).max(axis=-1) / np.abs(w).max(axis=-1, initial=1e-300)
            near &= (length <= MAX_STEP_RATIO * before) | (length <= STEP_TOL)
            before = length
            if not ((length > STEP_TOL) & (near | anywhere)).any():  # what is not a number has ended too
                break
        return w, before <= STEP_TOL, near

    def continued(self) -> tuple[Samples, Any]:
        """The solution that the one without friction becomes, (r, K), and where it ends before the factor 1, (r,)."""
        w = -np.stack([joint.viscous for joint in self.rubbing], axis=-1)
        factor, step = np.zeros(len(w)), np.full(len(w), 0.25)
        # Numerical continuation row by row: the step of the factor doubles on success and is halved on failure. Below
        # MIN_STEP the branch has ended.
        while (left := (factor < 1) & (step > MIN_STEP)).any():
            going = np.flatnonzero(left)
            trial = np.minimum(1.0, factor[going] + step[going])
            found, good, near = self.picked(left).stepped(w[going], trial, NEWTON_STEPS)
            fine = good & near
            w[going[fine]], factor[going[fine]] = found[fine], trial[fine]
            step[going] *= np.where(fine, 2.0, 0.5)
        return w, factor < 1

    def several(self, w: Samples) -> Any:
        """Whether there is a solution other than w, as far as one is found from some starts, shape (r,)."""
        slope = np.stack([joint.slope() for joint in self.rubbing], axis=-1)
        loads = np.max(np.abs(self.X0), axis=0)[:, None]
        gains = np.moveaxis(np.array(self.gains), -1, 0)
        unproven, another = np.abs(np.linalg.eigvals(gains)).max(axis=-1) >= 1, np.zeros(len(w), np.bool_)
        # A search, no proof: other solutions are found if Newton's method leads to them from frictions of several
        # sizes, of all joints or of one. Rows whose contraction is below one need no search.
        for some in (np.ones(len(self.rubbing)), *np.eye(len(self.rubbing))) if unproven.any() else ():
            for start in STARTS:
                from_there = -slope * loads * start * some
                found, good, _ = self.stepped(from_there, 1.0, SEARCH_STEPS, anywhere=True)
                another |= good & (np.abs(found - w).max(axis=-1) > SAME_SOLUTION_TOL * np.abs(w).max(axis=-1))
        return another & unproven


def eliminated(A: Sequence[Sequence[Any]], b: Sequence[Any]) -> list[Any]:
    """Return x of A x = b by elimination without exchanges: next to the identity, A is dominated by its diagonal."""
    rows, n = [[*row, right] for row, right in zip(A, b, strict=True)], len(b)
    for k in range(n):
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [x - factor * above for x, above in zip(rows[i], rows[k], strict=True)]
    x: list[Any] = []
    for i in reversed(range(n)):
        known = reduce(add, map(np.multiply, rows[i][i + 1 : n], reversed(x)), 0.0)
        x.append((rows[i][n] - known) / rows[i][i])
    return x[::-1]
