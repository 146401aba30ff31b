"""Poses of an Exudyn system: Newton's method on the constraints C(q, t) = 0 as Exudyn itself evaluates them.

Its solver gives the residual C and the Jacobian C_q; the steps taken with them are made here. From the sketch, the pose
is found at the sketch's crank angle and then followed to wherever it is wanted.
"""

from cmath import phase
from math import pi, remainder, tau
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Status

from .exudyn_system import System, engine, sketched

Array: TypeAlias = NDArray[np.float64]

ASSEMBLY_ITERATIONS = 50  # the sketch may be rough
ITERATIONS = 8  # from a predicted pose
CONVERGED = 1e-9  # a last correction, over the size; Newton is quadratic, so round-off is all that it leaves
STRAY = 0.1  # largest correction of a predicted pose, over the length of the step to it
BISECTIONS = 30  # of a step, before it counts as impossible


class State(NamedTuple):
    """A pose that meets the constraints, and its velocity."""

    time: float  # s, of Exudyn's clock
    q: Array  # shape (3 bodies,), m and rad
    v: Array  # shape (3 bodies,), m/s and rad/s
    branch: float  # sign of det C_q, which changes only where two branches meet


class Poses:
    """The poses of one system, on the sketch's branch."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.newton_iterations = 0  # so far
        self._solver: Any = engine().MainSolverImplicitSecondOrder()
        self._solver.InitializeSolver(system.mbs, system.settings)
        self._n = 3 * len(system.bodies)  # coordinates, and as many constraints
        self._zeros = np.zeros((2 * self._n, 2 * self._n))
        # Corrections are measured with lengths over the linkage's size and angles in rad.
        self.scale = np.tile([system.size, system.size, 1.0], len(system.bodies))

    def start(self) -> State:
        """Return the state at time zero of Exudyn's clock, assembled from the sketch.

        Raises:
            Failure: the constraints leave a freedom or repeat each other; no pose is found near the sketch; or none
                from there to the start.
        """
        speed, first = self.system.scene.drive.speed, self.system.crank_angle(0.0)
        back = remainder(first - self.system.scene.sketch.angle, tau)  # the shorter way round
        rough, time = self._rough(first - back), -back / speed
        assembled = self._assemble(rough, time)
        self._check_freedoms(assembled)
        sketch = self._state(assembled, time)
        self._check_branch(rough, sketch)
        return self.follow(sketch, 0.0)

    def follow(self, state: State, time: float, bisections: int = BISECTIONS) -> State:
        """Return the state at another time: predicted along the velocity, corrected, in smaller steps where it strays.

        Raises:
            Failure: no pose continues the motion on this branch.
        """
        path = (time - state.time) * state.v
        reached = self._correct(state.q + path, time, STRAY * self._length(path) + CONVERGED)
        if reached is not None and reached.branch == state.branch:
            return reached
        if bisections == 0:
            raise Failure(
                Status.cannot_assemble,
                f"the bodies cannot follow the drive past crank angle {self.system.degrees(state.time)}:"
                " the linkage locks there, or two ways of assembling it meet",
            )
        middle = self.follow(state, (state.time + time) / 2, bisections - 1)
        return self.follow(middle, time, bisections - 1)

    def accelerations(self, state: State) -> tuple[Array, Array]:
        """Return accelerations and Lagrange multipliers of a state, each of shape (3 bodies,).

        They are what Exudyn's generalised-alpha solver computes to begin with: M a + C_q^T lambda = f together with
        C_q a = -d(C_q)/dt v. It takes no C_tt, which is zero for a drive of constant speed.
        """
        initial, values = engine().ConfigurationType.Initial, self.system.state
        values.SetODE2Coordinates(state.q, initial)
        values.SetODE2Coordinates_t(state.v, initial)
        self.system.settings.timeIntegration.startTime = state.time
        self._solver.InitializeSolverInitialConditions(self.system.mbs, self.system.settings)
        return values.GetODE2Coordinates_tt(), values.GetAECoordinates()

    def _rough(self, crank_angle: float) -> Array:
        """Return every body laid on the sketch as well as a rigid body can be, shape (3 bodies,)."""
        scene, places = self.system.scene, sketched(self.system.scene)
        pose = []
        for name, body in self.system.bodies.items():
            known = [point for point in body.points if point in places]
            if not known:
                raise Failure(Status.unsupported, f"nothing moves {name}: it shares no point with another body")
            own = np.array([body.points[point] for point in known])
            drawn = np.array([places[point] for point in known])
            # argmin over the angle of sum |drawn - mean - e^{i angle} (own - mean)|^2
            angle = phase(np.vdot(own - own.mean(), drawn - drawn.mean()))
            if scene.bodies[name].slide is not None:
                angle = 0.0
            if name == scene.drive.body:
                angle = crank_angle
            com = drawn.mean() - np.exp(1j * angle) * own.mean()
            pose += [com.real, com.imag, angle]
        return np.array(pose)

    def _assemble(self, rough: Array, time: float) -> Array:
        """Return a pose that meets the constraints, by damped Gauss-Newton, which redundant ones do not stop."""
        q = rough
        for _ in range(ASSEMBLY_ITERATIONS):
            residual = self._residual(q, time)
            step = np.linalg.lstsq(self._jacobian(q), -residual, rcond=None)[0]
            length = self._length(step)
            if length < CONVERGED and np.abs(residual).max() < CONVERGED * self.system.size:
                return q + step
            q = q + step / max(1.0, 2 * length)
            self.newton_iterations += 1
        raise Failure(
            Status.cannot_assemble,
            f"the bodies do not fit together at crank angle {self.system.degrees(time)}, where the sketch shows them",
        )

    def _check_freedoms(self, q: Array) -> None:
        """Refuse a system that Exudyn finds to be movable with the drive held, or held twice."""
        mbs = self.system.mbs
        mbs.systemData.SetODE2Coordinates(q, engine().ConfigurationType.Initial)
        counts = mbs.ComputeSystemDegreeOfFreedom()
        free, redundant = int(counts["degreeOfFreedom"]), int(counts["redundantConstraints"])
        if free or redundant:
            raise Failure(
                Status.unsupported,
                f"with the drive held, Exudyn counts {free} degrees of freedom and {redundant} redundant constraints;"
                " it needs 0 and 0 to tell every reaction",
            )

    def _check_branch(self, rough: Array, state: State) -> None:
        """Refuse a pose that Newton's method found on another branch than the sketch's."""
        turned = np.abs(state.q - rough)[2::3].max()
        if turned > pi / 2 or self._branch(self._jacobian(rough)) != state.branch:
            raise Failure(
                Status.wrong_branch,
                f"the sketch at crank angle {self.system.degrees(state.time)} is too rough to tell"
                " which of two ways of assembling the bodies it shows",
            )

    def _correct(self, guess: Array, time: float, reach: float) -> State | None:
        """Return the state that Newton's method finds within reach of a guess."""
        q = guess
        try:
            for _ in range(ITERATIONS):
                step = np.linalg.solve(self._jacobian(q), -self._residual(q, time))
                self.newton_iterations += 1
                q = q + step
                if self._length(q - guess) > reach:
                    break
                if self._length(step) < CONVERGED:
                    return self._state(q, time)
        except np.linalg.LinAlgError:  # two branches meet here
            pass
        return None

    def _state(self, q: Array, time: float) -> State:
        """Solve the constraints at velocity level, C_q v + C_t = 0."""
        jacobian = self._jacobian(q)
        self.system.state.SetODE2Coordinates_t(np.zeros(self._n))
        self.system.state.SetTime(time)
        self._solver.ComputeAlgebraicEquations(self.system.mbs, velocityLevel=True)
        rate = self._solver.GetSystemResidual()[self._n :]
        return State(time, q, np.linalg.solve(jacobian, -rate), self._branch(jacobian))

    def _residual(self, q: Array, time: float) -> Array:
        """Return C(q, t), shape (constraints,), m and rad."""
        self.system.state.SetODE2Coordinates(q)
        self.system.state.SetTime(time)
        self._solver.ComputeAlgebraicEquations(self.system.mbs)
        residual: Array = self._solver.GetSystemResidual()[self._n :]
        return residual

    def _jacobian(self, q: Array) -> Array:
        """Return C_q, shape (constraints, 3 bodies)."""
        self.system.state.SetODE2Coordinates(q)
        self._solver.SetSystemJacobian(self._zeros)
        self._solver.ComputeJacobianAE(self.system.mbs)
        jacobian: Array = self._solver.GetSystemJacobian()[self._n :, : self._n]
        return jacobian

    def _branch(self, jacobian: Array) -> float:
        return float(np.linalg.slogdet(jacobian)[0])

    def _length(self, step: NDArray[np.floating[Any]]) -> float:
        return float(np.abs(step / self.scale).max())
