"""Friction that a few steps do not settle: continued by one factor on all coefficients, row by row of the samples.

The continuation follows the solution of (1) of `friction` from that without friction, as long as the determinant of
its Jacobian keeps its sign; it ends where the forces grow without bound, or two solutions meet. There it is jammed.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from scenes.model.motion import Samples

from .friction import CLOSE, Loads

LEAST_STEP = 1e-14  # of the factor, where the continuation ends
NEWTON = 12  # steps from a solution nearby
SEARCH = 40  # from anywhere
STARTS = (1e-2, 1.0, 1e2, 1e4)  # times the loads without friction: where other solutions are looked for
APART = 1e-6  # of each other, relative: two solutions
FASTER = 0.5  # by which each step of Newton's method is shorter than the one before, near to a solution


@dataclass(frozen=True)
class Rows(Loads):
    """The frictions of a group at r samples, each array of shape (r,)."""

    def picked(self, rows: Any) -> "Rows":
        """Some of the samples."""
        own = ("sense", "viscous", "share")
        rubbing = [replace(one, **{name: getattr(one, name)[rows] for name in own}) for one in self.rubbing]
        return Rows(rubbing, [x[rows] for x in self.X0], [[s[rows] for s in row] for row in self.S])

    def stepped(self, w: Samples, factor: Any, steps: int, *, anywhere: bool = False) -> tuple[Samples, Any, Any]:
        """Newton's method from w, (r, K): where it ends, whether at a solution, and whether each step was much shorter.

        Unless it may be `anywhere`, the determinant of the Jacobian has the sign that it has without friction.
        """
        slopes = [one.slope(factor) for one in self.rubbing]
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
            near &= (length <= FASTER * before) | (length <= CLOSE)
            before = length
            if not ((length > CLOSE) & (near | anywhere)).any():  # what is not a number has ended too
                break
        return w, before <= CLOSE, near

    def continued(self) -> tuple[Samples, Any]:
        """The solution that the one without friction becomes, (r, K), and where it ends before the factor 1, (r,)."""
        w = -np.stack([one.viscous for one in self.rubbing], axis=-1)
        factor, step = np.zeros(len(w)), np.full(len(w), 0.25)
        while (going := np.flatnonzero((factor < 1) & (step > LEAST_STEP))).size:
            trial = np.minimum(1.0, factor[going] + step[going])
            found, good, near = self.picked(going).stepped(w[going], trial, NEWTON)
            fine = good & near
            w[going[fine]], factor[going[fine]] = found[fine], trial[fine]
            step[going] *= np.where(fine, 2.0, 0.5)
        return w, factor < 1

    def several(self, w: Samples) -> Any:
        """Whether there is a solution other than w, as far as one is found from some starts, shape (r,)."""
        slope = np.stack([one.slope() for one in self.rubbing], axis=-1)
        loads = np.max(np.abs(self.X0), axis=0)[:, None]
        gains = np.moveaxis(np.array(self.gains), -1, 0)
        unproven, another = np.abs(np.linalg.eigvals(gains)).max(axis=-1) >= 1, np.zeros(len(w), np.bool_)
        for some in (np.ones(len(self.rubbing)), *np.eye(len(self.rubbing))) if unproven.any() else ():
            for start in STARTS:
                from_there = -slope * loads * start * some
                found, good, _ = self.stepped(from_there, 1.0, SEARCH, anywhere=True)
                another |= good & (np.abs(found - w).max(axis=-1) > APART * np.abs(w).max(axis=-1))
        return another & unproven
