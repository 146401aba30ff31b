"""Time stepping: the whole motion integrated with a constant step."""

from collections.abc import Callable
from itertools import count
from math import ceil
from typing import Any

import numpy as np

from scenes import Failure, Request, Sampling, Scene, Status
from scenes.engine import equal_steps

from .drive import RunningDrive
from .extras import add_extras
from .loads import add_loads
from .poses import Configuration, PoseSolver
from .reduced import ReducedSystem
from .settings import Extra, Newton, TextbookTimeStepping, TimeStepping
from .simulation import ExudynSimulation, failure
from .spatial import SpatialSystem
from .start import start
from .stroke import press_switches
from .system import Array, ExudynSystem, engine

PRE_ROLL_HALVINGS = 5  # of the step, before a start counts as too near to a singular configuration
SINGULAR_SPEED = 2.0  # times the largest of the cycle, at the same rate of the drive: no integration begins there
TRAPEZOIDAL = "TrapezoidalIndex2"
ROUND_OFF = 1e-4  # of a linkage's size, and of the tolerance: gaps that are no more than round-off


def build(scene: Scene, settings: TimeStepping, request: Request) -> "TimeSteppedSimulation":
    """Assemble the linkage through a cycle and set up its integration from before zero, see `engine.build`."""
    sampling, si = equal_steps(request), isinstance(settings, TextbookTimeStepping)
    poses = PoseSolver(scene, si=si)
    at_start = start(poses)
    switches = press_switches(poses, at_start)
    add_loads(poses.system, switches)
    one_cycle = slice(sampling.samples if scene.drive.repeats else None)
    cycle = poses.through(at_start, sampling.commanded(scene)[one_cycle], curved=False)
    stride, begin = _pre_rolled(poses, at_start, cycle, settings, sampling.samples)
    step = scene.drive.cycle / (stride * sampling.samples)
    pre_roll, finest = settings.pre_roll * step, 2 if settings.richardson else 1
    steps = finest * (settings.pre_roll + stride * (sampling.count - 1))
    drive = RunningDrive(scene.drive, pre_roll, step / finest, steps)
    kind = ReducedSystem if settings.reduced else SpatialSystem if settings.extra is Extra.SPATIAL else ExudynSystem
    model = kind(scene, drive, si=si)
    add_loads(model, switches)
    add_extras(model, settings, step, forces=sampling.wants_forces(scene))
    _configure(model, settings)
    _set_initial(model, begin, scene)
    return TimeSteppedSimulation(sampling, poses, settings, model, stride)


def _pre_rolled(
    poses: PoseSolver, start: Configuration, cycle: Configuration, settings: TimeStepping, samples: int
) -> tuple[int, Configuration]:
    """Return the steps from sample to sample, and the state in which the integration begins.

    Before its start, a drive that does not repeat is outside the scene's range. Where the linkage is singular there, or
    nearly, smaller steps bring the beginning nearer to the start.
    """
    drive = poses.system.scene.drive
    stride = ceil(settings.steps / samples)
    if settings.solver == TRAPEZOIDAL and settings.richardson:
        stride += stride % 2  # errors of a period of two steps cancel between two even numbers of steps
    for _ in range(PRE_ROLL_HALVINGS + 1):
        try:
            return stride, _before(poses, start, cycle, drive.cycle / (stride * samples), settings.pre_roll)
        except Failure as singular:
            reason = singular.reason
        stride *= 2
    raise Failure(Status.unsupported, f"time steps have to begin a little before the start, but there {reason}")


def _before(poses: PoseSolver, start: Configuration, cycle: Configuration, step: float, steps: int) -> Configuration:
    """Return the state that many steps, s each, before the start."""
    scene = poses.system.scene
    positions = scene.drive.at(-step * np.arange(steps + 1)).position
    way = poses.through(start, positions, curved=False)
    fast = ~(poses.speed(way) <= SINGULAR_SPEED * poses.speed(cycle).max())
    if fast.any() and not scene.drive.repeats:
        where = scene.where(float(positions[fast.argmax()]))
        raise Failure(Status.cannot_assemble, f"the linkage nears a lock at {where}")
    return way.rows(-1)


def _configure(model: ExudynSystem, options: TimeStepping) -> None:
    """Choose the integrator in Exudyn's simulation settings."""
    integration = model.settings.timeIntegration
    integration.solverType = getattr(engine().DynamicSolverType, options.solver)
    integration.generalizedAlpha.spectralRadius = options.spectral_radius
    if isinstance(options, TextbookTimeStepping):
        return
    integration.generalizedAlpha.computeInitialAccelerations = False  # those take no account of the drive's own
    integration.adaptiveStep = False  # it adds up time, and ends on a tiny step with absurd forces
    integration.newton.relativeTolerance = options.tolerance
    integration.newton.absoluteTolerance = ROUND_OFF * model.size * options.tolerance
    integration.newton.useModifiedNewton = options.newton is not Newton.FULL
    integration.newton.modifiedNewtonJacUpdatePerStep = options.newton is Newton.ONE_A_STEP


def _set_initial(model: ExudynSystem, begin: Configuration, scene: Scene) -> None:
    """Set the initial coordinates, velocities and accelerations."""
    _, rate, acceleration = scene.drive.at(-model.pre_roll)
    values, initial = model.state, engine().ConfigurationType.Initial
    values.SetODE2Coordinates(model.narrowed(begin.q), initial)
    values.SetODE2Coordinates_t(model.narrowed(begin.velocities(rate)), initial)
    values.SetODE2Coordinates_tt(model.narrowed(begin.accelerations(rate, acceleration)), initial)


class TimeSteppedSimulation(ExudynSimulation):
    """One integration in time, or two whose results are extrapolated."""

    def __init__(
        self, sampling: Sampling, poses: PoseSolver, options: TimeStepping, model: ExudynSystem, stride: int
    ) -> None:
        super().__init__(sampling, poses)
        self.options, self.model, self.stride = options, model, stride
        self._runs = [self._buffer() for _ in range(2 if options.richardson else 1)]

    def solve(self) -> None:
        """Integrate.

        Raises:
            Failure: a step found no solution, or the run ended early.
        """
        self.counters = dict.fromkeys(("steps", "newton_iterations", "jacobians"), 0) | self.model.counts()
        for level, samples in enumerate(self._runs):
            self._integrate(samples, refinement=2**level)

    def _integrate(self, samples: Array, refinement: int) -> None:
        before, stride = refinement * self.options.pre_roll, refinement * self.stride
        integration = self.model.settings.timeIntegration
        integration.numberOfSteps = before + stride * (self.sampling.count - 1)
        integration.endTime = self.model.pre_roll + self.times[-1]
        reduced = self.model if isinstance(self.model, ReducedSystem) else None
        recorded = samples if reduced is None else np.empty((*samples.shape[:2], reduced.unknowns))
        recorded.fill(np.nan)
        mbs = self.model.mbs
        mbs.SetPostStepUserFunction(self._recorder(recorded, before, stride))
        try:
            mbs.SolveDynamic(self.model.settings)
        except engine().SolverError:
            where = self._where(mbs.sys["dynamicSolver"].it.currentTime)
            raise Failure(Status.diverged, f"Newton's method found no solution for the step at {where}") from None
        except engine().ExudynError as error:
            raise failure(error, "integrating") from None
        finally:
            mbs.SetPostStepUserFunction(0)  # else the system and this run keep each other alive
        self._check_end(mbs.sys["dynamicSolver"])
        if reduced is not None:
            samples[:] = reduced.widened(recorded, self.poses, self.times)

    def _recorder(self, samples: Array, before: int, stride: int) -> Callable[[Any, float], bool]:
        """Return the function that Exudyn calls at the start and after every step: it records the samples."""
        state, coordinates = self.model.state, self.model.coordinates
        getters = [
            (state.GetODE2Coordinates, coordinates),
            (state.GetODE2Coordinates_t, coordinates),
            (state.GetODE2Coordinates_tt, coordinates),
        ]
        if len(samples) > 3:
            getters.append((state.GetAECoordinates, self.model.multipliers))
        steps = count(-before)

        def record(_mbs: Any, _time: float) -> bool:
            sample, between = divmod(next(steps), stride)
            if between == 0 and 0 <= sample < samples.shape[1]:
                for row, (get, chosen) in zip(samples, getters, strict=True):
                    row[sample] = get()[chosen]
            return True

        return record

    def _check_end(self, solver: Any) -> None:
        """Count the work, and refuse a run that ended early, which Exudyn may call a success."""
        self.counters["steps"] += solver.it.currentStepIndex - 1  # it counts the start
        self.counters["newton_iterations"] += solver.it.newtonStepsCount
        self.counters["jacobians"] += solver.it.newtonJacobiCount
        where = f"at {self._where(solver.it.currentTime)}"
        if solver.output.simulationTimeout:
            raise Failure(Status.timed_out, f"Exudyn's own time limit ended the run {where}")
        early = solver.it.currentTime < (self.model.pre_roll + self.times[-1]) * (1 - 1e-9)
        if early or solver.output.simulationStoppedByUserFunction:
            raise Failure(Status.diverged, f"the run ended early, {where}")

    def _where(self, clock: float) -> str:
        return self.scene.where(float(self.scene.drive.at(clock - self.model.pre_roll).position))

    def _result(self) -> Array:
        samples = self._runs[-1]
        if self.options.richardson:
            coarse, fine = self._runs
            samples = (4 * fine - coarse) / 3  # both methods are of order 2
        return samples
