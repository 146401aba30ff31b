"""Exudyn: the linkage as a planar multibody system with Lagrange multipliers, integrated in time or solved at instants.

Time stepping integrates the index-3 equations (generalised-alpha) or the index-2 ones (trapezoidal) from before the
first sample, so that the start transient is gone by then. The pointwise route takes a pose and velocity that meet the
constraints at every sample, and lets Exudyn's solve for initial accelerations find accelerations and reactions there.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import count
from math import ceil, pi
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Motion, Sampling, Scene, Settings, Status

from . import exudyn_channels as channels
from .exudyn_poses import Poses
from .exudyn_system import System, engine

Array: TypeAlias = NDArray[np.float64]

DRIVE_LIMIT = 1e-9  # rad; the crank is held at position level, so more than round-off is a failed run
BRANCH_LIMIT = 0.05  # of the linkage's size; a body that far from its assembled place is on another branch
HALVING_LIMIT = 0.1  # of the peak acceleration; above it two runs are too far apart to extrapolate


@dataclass(frozen=True)
class TimeStepping(Settings):
    """Integrate in time with a constant step."""

    steps: int  # a turn, at least: rounded up to a multiple of the samples
    solver: str = "GeneralizedAlpha"  # or TrapezoidalIndex2
    richardson: bool = True  # also take twice the steps, and extrapolate: cancels the error's h^2, leaves h^3
    spectral_radius: float = 0.5  # of generalised-alpha at high frequency; damps the start transient by this a step
    pre_roll: int = 24  # steps before the first sample, at least one
    tolerance: float = 1e-10  # of Newton's method, relative and absolute; Exudyn's 1e-8 shows in the reactions


@dataclass(frozen=True)
class Pointwise(Settings):
    """Solve position, velocity, acceleration and reactions at every sample, without integrating."""


ExudynSettings: TypeAlias = TimeStepping | Pointwise

DEFAULT: ExudynSettings = TimeStepping("generalised-alpha 720+1440", steps=720)

LADDER: tuple[ExudynSettings, ...] = (
    TimeStepping("generalised-alpha 72", steps=72, richardson=False),
    TimeStepping("generalised-alpha 360", steps=360, richardson=False),
    TimeStepping("trapezoidal 360", steps=360, richardson=False, solver="TrapezoidalIndex2"),
    TimeStepping("trapezoidal 72+144", steps=72, solver="TrapezoidalIndex2"),
    TimeStepping("generalised-alpha 72+144", steps=72),
    TimeStepping("generalised-alpha 360+720", steps=360),
    Pointwise("pointwise"),
)

LONG_LADDER: tuple[ExudynSettings, ...] = (
    TimeStepping("generalised-alpha 2880", steps=2880, richardson=False),
    TimeStepping("trapezoidal 2880", steps=2880, richardson=False, solver="TrapezoidalIndex2"),
    TimeStepping("generalised-alpha 1440+2880", steps=1440),
)


def version() -> str:
    """Return the version of Exudyn."""
    return f"exudyn {engine().__version__}"


def build(scene: Scene, settings: ExudynSettings, sampling: Sampling) -> "SteppedRun | PointwiseRun":
    """Prepare a run.

    Raises:
        Failure: the scene cannot be modelled, or the bodies cannot be put together somewhere in the turn.
    """
    try:
        if isinstance(settings, Pointwise):
            return PointwiseRun(scene, sampling)
        return SteppedRun(scene, settings, sampling)
    except engine().ExudynError as error:
        raise _failure(error, "building the system") from None


def _failure(error: Exception, doing: str) -> Failure:
    """Return what Exudyn raised as a failure, its many lines cut to one clause."""
    status = Status.diverged if isinstance(error, engine().SolverError) else Status.crashed
    clause = str(error).strip().splitlines()[0].partition(" [Python file")[0]
    return Failure(status, f"Exudyn gave up {doing}: {clause}")


class _Run:
    """What both routes share: the system at its start, and the checks of what comes out."""

    def __init__(self, scene: Scene, sampling: Sampling, lead: float) -> None:
        self.scene = scene
        self.system = System(scene, lead)
        self.poses = Poses(self.system)
        self.start = self.poses.start()
        self.times = lead + sampling.times(scene)  # of Exudyn's clock
        self.sampling = sampling
        self.counters: dict[str, int] = {}
        self.residuals: dict[str, float] = {}

    def _buffer(self) -> Array:
        """Return room for samples of position, velocity, acceleration and, where forces are asked for, multipliers."""
        return np.empty((4 if self.scene.has_masses else 3, self.sampling.count, 3 * len(self.scene.bodies)))

    def _motion(self, samples: Array) -> Motion:
        """Check samples of shape (3 or 4, n, 3 bodies) and return their channels."""
        finite = np.isfinite(samples).all(axis=(0, 2))
        if not finite.all():
            where = self.system.degrees(self.times[np.argmin(finite)])
            raise Failure(Status.nonfinite, f"values are not finite from crank angle {where} on")
        q, v, a, *multipliers = samples
        kinematics = channels.kinematics(self.system, q, v, a)
        slip = np.abs(kinematics["crank_angle"] - self.sampling.commanded(self.scene)).max()
        self.residuals["drive"] = float(slip / (2 * pi))
        if slip > DRIVE_LIMIT:
            raise Failure(Status.diverged, f"the crank left the angle that the drive asks for by {slip:.2g} rad")
        forces = channels.forces(self.system, multipliers[0]) if multipliers else {}
        return Motion({"time": self.sampling.times(self.scene)} | kinematics | forces)


class PointwiseRun(_Run):
    """States that meet the constraints, with Exudyn's initial accelerations and multipliers there."""

    def __init__(self, scene: Scene, sampling: Sampling) -> None:
        super().__init__(scene, sampling, lead=0.0)
        self._samples = self._buffer()

    def solve(self) -> None:
        """Follow the pose from sample to sample.

        Raises:
            Failure: the pose cannot follow the drive, or Exudyn finds no accelerations.
        """
        state, before = self.start, self.poses.newton_iterations
        for number, time in enumerate(self.times):
            state = self.poses.follow(state, time)
            try:
                acceleration, multipliers = self.poses.accelerations(state)
            except engine().ExudynError as error:
                raise _failure(error, f"the accelerations at crank angle {self.system.degrees(time)}") from None
            self._samples[:3, number] = state.q, state.v, acceleration
            self._samples[3:, number] = multipliers
        self.counters = {
            "newton_iterations": self.poses.newton_iterations - before,
            "acceleration_solves": len(self.times),
        }

    def read(self) -> Motion:
        """Return the channels.

        Raises:
            Failure: the result is not finite.
        """
        return self._motion(self._samples)


class SteppedRun(_Run):
    """One integration in time, or two whose results are extrapolated."""

    def __init__(self, scene: Scene, settings: TimeStepping, sampling: Sampling) -> None:
        self.options = settings
        self.period = 2 * pi / abs(scene.drive.speed)
        self.stride = ceil(settings.steps / sampling.samples)  # steps from sample to sample
        step = self.period / (self.stride * sampling.samples)
        super().__init__(scene, sampling, lead=settings.pre_roll * step)
        self._runs = [self._buffer() for _ in range(2 if settings.richardson else 1)]
        self._turn = self._assembled_turn()
        self._prepare()

    def _assembled_turn(self) -> Array:
        """Return the poses at one turn's samples, which prove it possible and tell the branch: (samples, 3 bodies)."""
        state, turn = self.start, []
        for time in self.times[: self.sampling.samples]:
            state = self.poses.follow(state, time)
            turn.append(state.q)
        return np.array(turn)

    def _prepare(self) -> None:
        """Set the integrator, and its initial values."""
        initial = engine().ConfigurationType.Initial
        self.system.state.SetODE2Coordinates(self.start.q, initial)
        self.system.state.SetODE2Coordinates_t(self.start.v, initial)
        integration = self.system.settings.timeIntegration
        integration.solverType = getattr(engine().DynamicSolverType, self.options.solver)
        integration.generalizedAlpha.spectralRadius = self.options.spectral_radius
        integration.adaptiveStep = False  # it adds up time, and ends on a tiny step with absurd forces
        integration.newton.relativeTolerance = self.options.tolerance
        integration.newton.absoluteTolerance = self.options.tolerance
        integration.newton.modifiedNewtonJacUpdatePerStep = True  # the fastest at the same accuracy

    def solve(self) -> None:
        """Integrate.

        Raises:
            Failure: a step found no solution, or the run ended early.
        """
        self.counters = dict.fromkeys(("steps", "newton_iterations", "jacobians"), 0)
        for level, samples in enumerate(self._runs):
            self._integrate(samples, refinement=2**level)

    def _integrate(self, samples: Array, refinement: int) -> None:
        before, stride = refinement * self.options.pre_roll, refinement * self.stride
        integration = self.system.settings.timeIntegration
        integration.numberOfSteps = before + stride * (self.sampling.count - 1)
        integration.endTime = self.times[-1]
        samples.fill(np.nan)
        mbs = self.system.mbs
        mbs.SetPostStepUserFunction(self._recorder(samples, before, stride))
        try:
            mbs.SolveDynamic(self.system.settings)
        except engine().SolverError:
            where = self.system.degrees(mbs.sys["dynamicSolver"].it.currentTime)
            raise Failure(
                Status.diverged, f"Newton's method found no solution for the step at crank angle {where}"
            ) from None
        except engine().ExudynError as error:
            raise _failure(error, "integrating") from None
        finally:
            mbs.SetPostStepUserFunction(0)  # else the system and this run keep each other alive
        self._check_end(mbs.sys["dynamicSolver"])

    def _recorder(self, samples: Array, before: int, stride: int) -> Callable[[Any, float], bool]:
        """Return what Exudyn calls at the start and after every step: it keeps the state of those that are samples."""
        state = self.system.state
        getters = [state.GetODE2Coordinates, state.GetODE2Coordinates_t, state.GetODE2Coordinates_tt]
        if self.scene.has_masses:
            getters.append(state.GetAECoordinates)
        steps = count(-before)

        def record(_mbs: Any, _time: float) -> bool:
            sample, between = divmod(next(steps), stride)
            if between == 0 and sample >= 0:
                for row, get in zip(samples, getters, strict=True):
                    row[sample] = get()
            return True

        return record

    def _check_end(self, solver: Any) -> None:
        """Count the work, and refuse a run that ended early, which Exudyn may call a success."""
        self.counters["steps"] += solver.it.currentStepIndex - 1  # it counts the start
        self.counters["newton_iterations"] += solver.it.newtonStepsCount
        self.counters["jacobians"] += solver.it.newtonJacobiCount
        where = f"at crank angle {self.system.degrees(solver.it.currentTime)}"
        if solver.output.simulationTimeout:
            raise Failure(Status.timed_out, f"Exudyn's own time limit ended the run {where}")
        if solver.output.simulationStoppedByUserFunction or solver.it.currentTime < self.times[-1] * (1 - 1e-9):
            raise Failure(Status.diverged, f"the run ended early, {where}")

    def read(self) -> Motion:
        """Return the channels.

        Raises:
            Failure: the result is not finite, left the drive or the branch, or changes too much with the step.
        """
        samples = self._runs[-1]
        if self.options.richardson:
            coarse, fine = self._runs
            samples = (4 * fine - coarse) / 3  # both methods are of order 2
        motion = self._motion(samples)
        self._check_branch(samples[0])
        if self.options.richardson:
            self._check_halving(coarse[2], fine[2])
        return motion

    def _check_branch(self, q: Array) -> None:
        """Compare every pose with the assembled one, which is the same in every turn."""
        place = _places(q, self.system.size)
        assembled = _places(self._turn, self.system.size)[np.arange(len(q)) % len(self._turn)]
        off = np.abs(place - assembled).max(axis=(1, 2)) / self.system.size
        self.residuals["pose"] = float(off.max())
        if off.max() > BRANCH_LIMIT:
            where = self.system.degrees(self.times[np.argmax(off > BRANCH_LIMIT)])
            raise Failure(Status.wrong_branch, f"at crank angle {where} the bodies are assembled another way")

    def _check_halving(self, coarse: Array, fine: Array) -> None:
        """Compare the accelerations of both runs, relative to their peak or to that of a turning arm of the size."""
        scale = self.poses.scale
        peak = max(np.abs(fine / scale).max(), self.scene.drive.speed**2)
        change = float(np.abs((fine - coarse) / scale).max() / peak)
        self.residuals["step halving"] = change
        if change > HALVING_LIMIT:
            raise Failure(
                Status.not_converged, f"accelerations change by {change:.2g} of their peak when the step is halved"
            )


def _places(q: Array, size: float) -> NDArray[np.complex128]:
    """Return centres of mass, and x axes of the linkage's size, of poses (n, 3 bodies): shape (n, bodies, 2), m."""
    x, y, angle = np.moveaxis(q.reshape(len(q), -1, 3), 2, 0)
    return np.stack([x + 1j * y, size * np.exp(1j * angle)], axis=-1)
