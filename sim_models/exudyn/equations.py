"""The equations of an Exudyn system, C(q) = 0 and M a + C_q^T lambda = f, term by term as Exudyn itself evaluates them.

Its solver computes every term of a step's residual and Jacobian.
"""

from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, TypeAlias

import numpy as np

from scenes.model.constraints import joint_rows, misfit

from .system import Array, ExudynSystem, exudyn

EquationTerm: TypeAlias = Callable[..., Array]


def _of_many(term: EquationTerm) -> EquationTerm:
    """Let a term of one pose take many too: all of its arguments, and then its result, with a leading axis."""

    @wraps(term)
    def terms(self: "Equations", q: Array, *more: Any) -> Array:
        if q.ndim == 1:
            return term(self, q, *more)
        return np.array([term(self, *each) for each in zip(q, *more, strict=True)])

    return terms


class Equations:
    """The terms of one system at coordinates q and velocities v, shape (3 bodies,), or many of them."""

    def __init__(self, system: ExudynSystem) -> None:
        self._system, self._mbs, self._state = system, system.mbs, system.state
        self._solver: Any = exudyn.MainSolverImplicitSecondOrder()
        self._solver.InitializeSolver(system.mbs, system.settings)
        self._n = 3 * len(system.bodies)  # coordinates, and as many constraints
        self._zeros = np.zeros((2 * self._n, 2 * self._n))
        self._solver.ComputeMassMatrix(system.mbs)
        self.masses: Array = np.diag(self._solver.GetSystemMassMatrix())  # constant, and diagonal: nodes are at the com
        still = np.zeros(self._n)
        self.drive_rate = self.rates(still, still)  # C_t for a drive with a rate of one, the same in any pose

    @_of_many
    def residual(self, q: Array, position: float) -> Array:
        """Return C(q) with the drive at a position, shape (constraints,), m and rad."""
        self._state.SetODE2Coordinates(q)
        self._system.driven_by.held = position
        self._solver.ComputeAlgebraicEquations(self._mbs)
        return np.asarray(self._solver.GetSystemResidual()[self._n :])

    @_of_many
    def jacobian(self, q: Array) -> Array:
        """Return C_q, shape (constraints, 3 bodies)."""
        self._state.SetODE2Coordinates(q)
        self._solver.SetSystemJacobian(self._zeros)
        self._solver.ComputeJacobianAE(self._mbs)
        return np.asarray(self._solver.GetSystemJacobian()[self._n :, : self._n])

    @_of_many
    def rates(self, q: Array, v: Array) -> Array:
        """Return C_q v + C_t for a drive that is held with a rate of one, shape (constraints,)."""
        self._state.SetODE2Coordinates(q)
        self._state.SetODE2Coordinates_t(v)
        self._solver.ComputeAlgebraicEquations(self._mbs, velocityLevel=True)
        return np.asarray(self._solver.GetSystemResidual()[self._n :])

    @_of_many
    def forces(self, q: Array, v: Array, time: float) -> Array:
        """Return f at an instant, s: in the system's unit of force, and that times m, shape (3 bodies,)."""
        self._state.SetODE2Coordinates(q)
        self._state.SetODE2Coordinates_t(v)
        self._state.SetTime(time)
        self._solver.ComputeODE2RHS(self._mbs)
        return np.asarray(self._solver.GetSystemResidual()[: self._n])

    def misfit(self, q: Array, positions: Iterable[float]) -> str:
        """Name the joint that stays open when all others close, near q at the first position where one does."""
        scene, system = self._system.scene, self._system
        given = self.jacobian, q, system.units, joint_rows(scene.pins, scene.slides), system.size
        return misfit(scene, positions, lambda position, at: self.residual(at, position), *given)
