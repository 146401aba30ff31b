"""Poses of an Exudyn system: Newton's method on the constraints C(q) = 0 as Exudyn itself evaluates them.

All terms are its own: its solver computes every term of a step's residual and Jacobian.

A pose is a function of the drive's position s, whatever the time; continuation takes it from one position to others.
Its derivatives by s give velocities and accelerations of any motion, and with the forces the multipliers:

    C_q q' = -C_s,    C_q q'' = -(C_q q')_q q',    C_q^T lambda = f - M a.

Arrays of one state have the shapes given; those of many have one more axis in front.
"""

from collections.abc import Callable, Iterable
from functools import wraps
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenes import Failure, ProcessorBudget, Scene, Status
from scenes.model.constraints import joint_rows, misfit

from .drive import ExudynDrive
from .system import Array, ExudynSystem, exudyn

KNOTS = 18  # poses per cycle that are followed one by one; those between are then found from them all at once
MAX_ITERATIONS = 12  # from a predicted pose, with the Jacobian there
MAX_PATIENT_ITERATIONS = 60  # from a rough sketch, or nearly singular, where Newton's method gains one bit per step
TRIALS = 9  # for a pose beyond where the motion cannot be followed
CONVERGED_TOL = 1e-9  # the largest last correction, over the size
ROUND_OFF = 1e-15  # of the size: the error left after it, estimated from the rate of convergence
MAX_CORRECTION = 0.1  # of a predicted pose, over the length of the step to it
MAX_BISECTIONS = 30  # of a step, before it counts as impossible
SECONDS = 60.0  # of processor time, for the build and for every cycle of the solution
DIFFERENCE = 1e-5  # of a turn or of the size: of a symmetric difference, near the cube root of round-off


def _of_many(term: Callable[..., Array]) -> Callable[..., Array]:
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
        given = self.jacobian, q, system.units, joint_rows(scene.joints), system.size
        return misfit(scene, positions, lambda position, pose: self.residual(pose, position), *given)


class Configuration(NamedTuple):
    """A pose that meets the constraints, and how it changes with the drive's position; or many."""

    position: Array  # s, of the drive, shape (), rad or m
    q: Array  # shape (3 bodies,), m and rad
    tangent: Array  # q' = dq/ds, shape (3 bodies,)
    curvature: Array  # q'', shape (3 bodies,)
    inverse: Array  # of C_q, shape (3 bodies, constraints)
    branch: Array  # sign of det C_q, which changes only where two branches meet, shape ()

    def rows(self, chosen: NDArray[np.intp] | slice | int) -> "Configuration":
        """Some of many states."""
        return Configuration(*(field[chosen] for field in self))

    def velocities(self, rate: ArrayLike) -> Array:
        """The velocities for a rate of the drive, shape (3 bodies,)."""
        return np.asarray(self.tangent * np.asarray(rate)[..., np.newaxis])

    def accelerations(self, rate: ArrayLike, acceleration: ArrayLike) -> Array:
        """The accelerations for a rate and an acceleration of the drive, shape (3 bodies,)."""
        rate, acceleration = np.asarray(rate)[..., np.newaxis], np.asarray(acceleration)[..., np.newaxis]
        return np.asarray(self.curvature * rate**2 + self.tangent * acceleration)


class PoseSolver:
    """The poses of a scene's system with the drive held, in units of its own or in SI; it starts without loads."""

    def __init__(self, scene: Scene, *, si: bool = False) -> None:
        self.system = ExudynSystem(scene, ExudynDrive(scene.drive.law.start), si=si)
        self.equations = Equations(self.system)
        self.newton_iterations = self.curvatures = 0  # found so far
        self.budget = ProcessorBudget(SECONDS, "building the system")

    # Two passes over many positions. Knots, some 18 a cycle, are followed one by one, each predicted from the one
    # before. All others start from the quintic between their knots and are corrected at once, as rows of one array;
    # those that do not converge are followed singly. A correction that is larger than MAX_CORRECTION of the step, or
    # that ends on another branch, counts as no convergence.
    def through(self, state: Configuration, positions: Array, *, curved: bool = True) -> Configuration:
        """The states at many positions, passed one after the other from the state given; Failure as of `follow`.

        Without curvatures, those of most states are not a number, and have cost nothing.
        """
        knots = self._knots(np.append(state.position, positions))
        followed = [*accumulate(positions[knots].tolist(), self.follow, initial=state)]
        known = Configuration(*map(np.array, zip(*followed, strict=True)))
        rest = np.delete(np.arange(len(positions)), knots)
        if not len(rest):
            return known.rows(slice(1, None))
        last = np.searchsorted(knots, rest)  # of the states that are known before each
        before, after = known.rows(last), known.rows(last + 1)
        guess = _interpolated(before, after, positions[rest])
        reached, closes = self._at(guess, positions[rest], before, curved=curved)
        for row in np.flatnonzero(~closes):
            alone = self.follow(followed[last[row]], float(positions[rest[row]]))
            for field, value in zip(reached, alone, strict=True):
                field[row] = value
        order = np.argsort(np.append(knots, rest))
        return Configuration(*(np.concatenate([k[1:], r])[order] for k, r in zip(known, reached, strict=True)))

    def _knots(self, positions: Array) -> NDArray[np.intp]:
        """Which positions after the first to follow one by one: every so far along the way, and the last.

        Where the drive rests or turns back is one too, so that the others lie between two of them.
        """
        span = self.system.prescribed.span
        steps = np.diff(positions)
        # A knot ends each block of the way, and there is one wherever the drive's steps change their sign or are zero.
        blocks = np.abs(steps).cumsum() // (span / KNOTS)
        ends = np.diff(blocks, append=np.inf) + np.abs(np.diff(np.sign(steps), append=0)) + (steps == 0)
        return np.flatnonzero(ends)

    def follow(
        self, state: Configuration, position: float, bisections: int = MAX_BISECTIONS, goal: float | None = None
    ) -> Configuration:
        """The state at another position: predicted and corrected, in smaller steps if the correction is large."""
        if position == state.position:
            return state
        self.budget.check(f"a pose was sought past {self.system.scene.where(float(state.position))}")
        travel = position - state.position
        # Predictor of second order, q + s q' + s^2/2 q''; corrector: Newton's method; bisection of the step where it
        # fails.
        guess = state.q + travel * (state.tangent + travel / 2 * state.curvature)
        reached, closes = self._at(guess, np.asarray(position), state)
        if closes:
            return reached
        goal = position if goal is None else goal
        if bisections == 0:
            raise self._stuck(state, goal)
        middle = self.follow(state, (float(state.position) + position) / 2, bisections - 1, goal)
        return self.follow(middle, position, bisections - 1, goal)

    def _stuck(self, state: Configuration, goal: float) -> Failure:
        """Why no pose follows: none exists somewhere on the way to the goal, or two are too close together."""
        past = self.system.scene.where(float(state.position))
        way = np.linspace(float(state.position), goal, TRIALS)[1:].tolist()
        if any(self.nearest(state.q, position) is None for position in way):
            open_by = self.equations.misfit(state.q, way)
            reason = f"the bodies cannot follow the drive past {past}: the linkage locks there{open_by}"
            return Failure(Status.cannot_assemble, reason)
        reason = f"the assembly branch past {past} cannot be decided: two branches meet there"
        return Failure(Status.not_converged, reason)

    # Damped Gauss-Newton with a pseudoinverse step, so that it also works where constraints are redundant or the
    # Jacobian is singular. A step is at most half a linkage's size: from a rough sketch full steps overshoot into other
    # assemblies.
    def nearest(self, q: Array, position: float) -> Array | None:
        """A pose near q that meets the constraints, redundant ones too, by damped Gauss-Newton."""
        for _ in range(MAX_PATIENT_ITERATIONS):
            residual = self.equations.residual(q, position)
            step: Array = np.asarray(np.linalg.lstsq(self.equations.jacobian(q), -residual)[0], np.float64)
            length = float(self.length(step))
            if length < CONVERGED_TOL and np.abs(residual).max() < CONVERGED_TOL * self.system.size:
                return q + step
            q = q + step / max(1.0, 2 * length)
            self.newton_iterations += 1
        return None

    def state(self, q: Array, position: Array, *, curved: bool = True) -> Configuration:
        """The state in a pose that meets the constraints."""
        jacobian = self.equations.jacobian(q)
        inverse: Array = np.asarray(np.linalg.inv(jacobian), np.float64)
        tangent = -inverse @ self.equations.drive_rate
        curvature = self._curvature(q, tangent, inverse) if curved else np.full_like(q, np.nan)
        return Configuration(position, q, tangent, curvature, inverse, self.branch(jacobian))

    def closed(self, q: Array, position: Array) -> Configuration:
        """The states, without curvatures, near coordinates that an integration has left a little open."""
        near, closes = self._corrected(q, position, np.full(position.shape, MAX_CORRECTION))
        return self.state(np.where(closes[..., np.newaxis], near, q), position, curved=False)

    def multipliers(self, state: Configuration, rate: ArrayLike, acceleration: ArrayLike, time: ArrayLike) -> Array:
        """The Lagrange multipliers of a motion that has this state at an instant, s."""
        forces = self.equations.forces(state.q, state.velocities(rate), time)
        inertia = self.equations.masses * state.accelerations(rate, acceleration)
        return _times(np.swapaxes(state.inverse, -1, -2), forces - inertia)

    def branch(self, jacobian: Array) -> Array:
        """The sign of det C_q."""
        return np.asarray(np.linalg.slogdet(jacobian)[0])

    def length(self, step: Array) -> Array:
        """The largest change of a coordinate, over the linkage's size, or in rad."""
        return np.asarray(np.abs(step / self.system.units).max(axis=-1))

    def _curvature(self, q: Array, tangent: Array, inverse: Array) -> Array:
        """Return q'', with the change of C_q q' along q' by a symmetric difference."""
        # C_q q' is a function of q that Exudyn evaluates exactly; its derivative along q' is the only difference
        # quotient here. The step balances truncation, h^2, against round-off, eps/h.
        rates, h = self.equations.rates, (DIFFERENCE / self.length(tangent))[..., np.newaxis]
        change = (rates(q + h * tangent, tangent) - rates(q - h * tangent, tangent)) / (2 * h)
        self.curvatures += change.size // change.shape[-1]
        return -_times(inverse, change)

    def _at(
        self, guess: Array, position: Array, start: Configuration, *, curved: bool = True
    ) -> tuple[Configuration, NDArray[np.bool_]]:
        """Find the state near a guess, which was predicted from `start`; and whether there is one, on that branch."""
        try:
            q, closes = self._corrected(guess, position, MAX_CORRECTION * self.length(guess - start.q) + CONVERGED_TOL)
            reached = self.state(np.where(closes[..., np.newaxis], q, start.q), position, curved=curved)
        except np.linalg.LinAlgError:  # two branches meet at one of them
            return start, np.zeros(position.shape, dtype=bool)
        return reached, closes & (reached.branch == start.branch)

    def _corrected(self, guess: Array, position: Array, reach: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Find a pose by Newton's method with the Jacobian of the guess; and whether it is within reach of that."""
        # Simplified Newton: one inverse a pose, as the guess is near and a Jacobian by Exudyn costs more than some
        # iterations. It ends where the error left, estimated from the linear rate as length^2 / before, is round-off,
        # or where corrections no longer decrease.
        inverse: Array = np.asarray(np.linalg.inv(self.equations.jacobian(guess)), np.float64)
        q, closes, length = guess, np.zeros(position.shape, dtype=bool), reach
        for _ in range(MAX_ITERATIONS):
            step = _times(inverse, self.equations.residual(q, position))
            self.newton_iterations += position.size
            q, before, length = q - step, length, self.length(step)
            closes = closes | (length < CONVERGED_TOL) & ((length**2 < ROUND_OFF * before) | (length >= before))
            if (closes | (length > reach)).all():
                break
        return q, closes & (self.length(q - guess) <= reach)


def _times(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., np.newaxis])[..., 0])


def _interpolated(before: Configuration, after: Configuration, position: Array) -> Array:
    """Return poses between others by the quintic that meets those with both derivatives."""
    h = (after.position - before.position)[:, np.newaxis]
    x = (position - before.position)[:, np.newaxis] / h

    def part(x: Array, q: Array, dq: Array, ddq: Array) -> Array:
        return (1 - x) ** 3 * ((1 + 3 * x + 6 * x**2) * q + x * (1 + 3 * x) * dq + x**2 / 2 * ddq)

    begins = part(x, before.q, h * before.tangent, h**2 * before.curvature)
    return begins + part(1 - x, after.q, -h * after.tangent, h**2 * after.curvature)
