"""The constraints of a linkage as arrays, by CasADi's functions, see `coordinates.system.System`."""

from functools import cached_property
from typing import Any

import casadi
import numpy as np
from casadi import MX, Function

from scenes import Scene
from scenes.model.motion import Samples

from ..coordinates.system import CONVERGED_TOL, MAX_FIRST_CORRECTION, ClosedPose, System
from .linkage import SymbolicLinkage

SOLVER = "qr"  # CasADi's own, by Householder reflections; it raises RuntimeError where a pivot is zero
CORRECTIONS = 3  # from a prediction good to a tenth of a step, Newton's method leaves 1e-8 after two


class Compiled:
    """A function of vectors whose calls go through memory that stays: a fifth of the time of CasADi's own."""

    def __init__(self, function: Function) -> None:
        arguments = function.mx_in()
        dense = Function("dense", arguments, [casadi.densify(output) for output in function.call(arguments)])
        buffer: Any
        buffer, self._evaluate = dense.buffer()
        self._failed = buffer.ret
        self._inputs = [np.zeros(dense.nnz_in(number)) for number in range(dense.n_in())]
        self._outputs = [np.zeros(dense.nnz_out(number)) for number in range(dense.n_out())]
        memory: Any = memoryview
        for number, vector in enumerate(self._inputs):
            buffer.set_arg(number, memory(vector))
        for number, vector in enumerate(self._outputs):
            buffer.set_res(number, memory(vector))

    def __call__(self, *vectors: Samples | float) -> list[Samples]:
        """Evaluate the outputs, matrices column by column; a linear system that is singular is a RuntimeError."""
        for buffer, vector in zip(self._inputs, vectors, strict=True):
            buffer[:] = vector
        self._evaluate()
        if self._failed():
            raise RuntimeError("a pivot is zero")
        return [vector.copy() for vector in self._outputs]


class CasadiSystem(System):
    """The constraints of one linkage."""

    def __init__(self, scene: Scene) -> None:
        """Differentiate the constraints."""
        super().__init__(scene)
        self.linkage = SymbolicLinkage(self)
        self._gaps, self._jacobian, self._bend = map(Compiled, self.linkage.functions)

    @cached_property
    def _compiled(self) -> Compiled:
        """The pose and Jacobian where a step ends, its first correction, the last, and the way predicted."""
        gaps, jacobian, bend = self.linkage.functions
        x, g = MX.sym("x", len(self.units)), MX.sym("g", len(self.row_units))
        J = jacobian(x)
        rate = casadi.solve(J, g - gaps(x), SOLVER)
        # Taylor predictor of second order along the line from C(x) to g; C'' along the rate is the bend. A fixed number
        # of full Newton corrections, since compiled code has no exit in between; the first and the last decide whether
        # they converged.
        way = rate - casadi.solve(J, bend(x, rate), SOLVER) / 2
        reached, corrections = x + way, []
        for _ in range(CORRECTIONS):
            correction = casadi.solve(jacobian(reached), g - gaps(reached), SOLVER)
            reached += correction
            corrections.append(casadi.norm_inf(correction))
        quality = casadi.vertcat(corrections[0], corrections[-1], casadi.norm_inf(way))
        return Compiled(Function("step", [x, g], [reached, jacobian(reached), quality]))

    def step(self, pose: ClosedPose, goal: Samples) -> tuple[ClosedPose | None, int]:
        """Go from a pose to C(x) = goal by one compiled function."""
        try:
            x, J, (first, last, way) = self._compiled(pose.x, goal)
        except RuntimeError:
            return None, 0
        good = first <= MAX_FIRST_CORRECTION * way + CONVERGED_TOL and last <= CONVERGED_TOL
        return ClosedPose(x, J.reshape(-1, len(self.units), order="F")) if good else None, CORRECTIONS

    def gaps(self, x: Samples) -> Samples:
        """C(x), shape (m,)."""
        return self._gaps(x)[0]

    def jacobian(self, x: Samples) -> Samples:
        """C_x, shape (m, n)."""
        return self._jacobian(x)[0].reshape(-1, len(self.units), order="F")

    def bend(self, x: Samples, v: Samples) -> Samples:
        """(C_x v)_x v, shape (m,)."""
        return self._bend(x, v)[0]
