"""Time stepping: the whole motion integrated with a constant step.

A law's jerk jumps at its knots, and an integration that passes one oscillates for some twenty steps, by h. So every
piece of a law is integrated by itself: from steps before its first sample, as if it had always been the law, so that
the start transient has decayed by then.
"""

from collections.abc import Callable, Sequence
from itertools import count, pairwise
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from scenes import Failure, Request, Sampling, Scene, Status
from scenes.engine import equal_steps

from .drive import Piece, RunningDrive, pieces
from .equations import blocks
from .extras import add_extras
from .loads import add_loads
from .poses import Configuration, PoseSolver
from .reduced import ReducedSystem
from .settings import Extra, Newton, TextbookTimeStepping, TimeStepping
from .simulation import ExudynSimulation, failure
from .spatial import SpatialSystem
from .start import begun
from .system import Array, ExudynSystem, engine

PRE_ROLL_HALVINGS = 5  # of the step, before a start counts as too near to a singular configuration
SINGULAR_SPEED = 2.0  # times that at the start, at the same rate of the drive: no integration begins there
TRAPEZOIDAL = "TrapezoidalIndex2"
ROUND_OFF = 1e-4  # of a linkage's size, and of the tolerance: gaps that are no more than round-off
DENSE = 10  # bodies: with more, a step's sparse equations take less, of 27 less than half
SAME_INSTANT = 1e-9  # of the time between samples: one on a knot begins a piece, whichever way it was rounded


class Stretch(NamedTuple):
    """The samples that one integration gives: those of a piece of the drive, or of all pieces."""

    pieces: Sequence[Piece]
    rows: slice  # of the samples
    stride: int  # steps from sample to sample
    zero: float  # s, when it begins
    begin: Configuration


def build(scene: Scene, settings: TimeStepping, request: Request) -> "TimeSteppedSimulation":
    """Assemble the linkage and set up its integration from before zero, see `engine.build`."""
    sampling, si = equal_steps(request), isinstance(settings, TextbookTimeStepping)
    at_start, switches = begun(scene, si=si)
    poses = PoseSolver(scene, si=si)
    add_loads(poses.system, switches)
    stretches = _stretches(poses, at_start, settings, sampling)
    kind = ReducedSystem if settings.reduced else SpatialSystem if settings.extra is Extra.SPATIAL else ExudynSystem
    drive = RunningDrive()
    model = kind(scene, drive, si=si)
    add_loads(model, switches)
    step = scene.drive.cycle / (stretches[0].stride * sampling.samples)
    add_extras(model, settings, step, forces=sampling.wants_forces(scene))
    _configure(model, settings)
    return TimeSteppedSimulation(sampling, poses, settings, model, drive, stretches, at_start)


def _stretches(poses: PoseSolver, at_start: Configuration, settings: TimeStepping, sampling: Sampling) -> list[Stretch]:
    """Return what to integrate: each piece of the drive that has samples, or in a first script all in one."""
    scene = poses.system.scene
    times = sampling.times(scene)
    parts = pieces(scene.drive, float(times[-1]))
    if isinstance(settings, TextbookTimeStepping):
        return [Stretch(parts, slice(len(times)), _stride(settings, sampling), 0.0, at_start)]
    begins = np.searchsorted(times, [part.begin - SAME_INSTANT * times[1] for part in parts])
    spans = [
        (part, slice(first, end))
        for part, (first, end) in zip(parts, pairwise([*begins.tolist(), len(times)]), strict=True)
        if first < end
    ]
    firsts = poses.through(at_start, sampling.commanded(scene)[[rows.start for _, rows in spans]])
    return [
        _pre_rolled(poses, firsts.rows(number), part, rows, settings, sampling)
        for number, (part, rows) in enumerate(spans)
    ]


def _stride(settings: TimeStepping, sampling: Sampling) -> int:
    """Return the steps from sample to sample."""
    stride = ceil(settings.steps / sampling.samples)
    if settings.solver == TRAPEZOIDAL and settings.richardson:
        stride += stride % 2  # errors of a period of two steps cancel between two even numbers of steps
    return stride


def _pre_rolled(
    poses: PoseSolver, first: Configuration, part: Piece, rows: slice, settings: TimeStepping, sampling: Sampling
) -> Stretch:
    """Return the integration of a piece, given the state in its first sample.

    Before its start, a drive that does not repeat is outside the scene's range. Where the linkage is singular there, or
    nearly, smaller steps bring the beginning nearer to the start.
    """
    scene, stride = poses.system.scene, _stride(settings, sampling)
    time = sampling.times(scene)[rows.start]
    for _ in range(PRE_ROLL_HALVINGS + 1):
        before = time - settings.pre_roll * scene.drive.cycle / (stride * sampling.samples)
        try:
            return Stretch([part], rows, stride, before, _before(poses, first, part, np.linspace(time, before)))
        except Failure as singular:
            reason = singular.reason
        stride *= 2
    raise Failure(Status.unsupported, f"time steps have to begin a little before the start, but there {reason}")


def _before(poses: PoseSolver, first: Configuration, part: Piece, way: Array) -> Configuration:
    """Return the state at the last of some instants, s, that lead there."""
    scene = poses.system.scene
    positions = [part.position(time) for time in way.tolist()]
    farthest = max(positions, key=lambda position: abs(position - first.position))
    turned = poses.follow(first, farthest)
    if not scene.drive.repeats and not poses.speed(turned) <= SINGULAR_SPEED * poses.speed(first):
        raise Failure(Status.cannot_assemble, f"the linkage nears a lock at {scene.where(farthest)}")
    return poses.follow(turned, positions[-1])


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
    if len(model.bodies) > DENSE:
        model.settings.linearSolver.solverType = engine().LinearSolverType.EigenSparse
        model.settings.linearSolver.reuseAnalyzedPattern = True  # who is joined to whom is the same in every step


def _set_initial(model: ExudynSystem, stretch: Stretch) -> None:
    """Set the initial coordinates, velocities and accelerations."""
    first, begin = stretch.pieces[0], stretch.begin
    rate, acceleration = first.rate(stretch.zero), first.second(stretch.zero)
    values, initial = model.state, engine().ConfigurationType.Initial
    values.SetODE2Coordinates(model.narrowed(begin.q), initial)
    values.SetODE2Coordinates_t(model.narrowed(begin.velocities(rate)), initial)
    values.SetODE2Coordinates_tt(model.narrowed(begin.accelerations(rate, acceleration)), initial)


class TimeSteppedSimulation(ExudynSimulation):
    """The pieces integrated in time, each once, or twice with results that are extrapolated."""

    def __init__(
        self,
        sampling: Sampling,
        poses: PoseSolver,
        options: TimeStepping,
        model: ExudynSystem,
        drive: RunningDrive,
        stretches: Sequence[Stretch],
        at_start: Configuration,
    ) -> None:
        super().__init__(sampling, poses)
        self.options, self.model, self.drive, self.stretches = options, model, drive, stretches
        self._at_start = at_start
        self._runs = [self._buffer() for _ in range(2 if options.richardson else 1)]

    def _solved(self) -> Array:
        self.counters = dict.fromkeys(("steps", "newton_iterations", "jacobians"), 0) | self.model.counts()
        for stretch in self.stretches:
            self.drive.run(stretch.pieces, stretch.zero)
            _set_initial(self.model, stretch)
            for level, samples in enumerate(self._runs):
                self._integrate(stretch, samples[:, stretch.rows], refinement=2**level)
        if not self.options.richardson:
            return self._runs[0]
        coarse, fine = self._runs
        return (4 * fine - coarse) / 3  # both methods are of order 2

    def _integrate(self, stretch: Stretch, samples: Array, refinement: int) -> None:
        before, stride = refinement * self.options.pre_roll, refinement * stretch.stride
        step = self.scene.drive.cycle / (stride * self.sampling.samples)
        steps = max(before + stride * (samples.shape[1] - 1), 1)
        integration = self.model.settings.timeIntegration
        integration.numberOfSteps, integration.endTime = steps, steps * step
        reduced = self.model if isinstance(self.model, ReducedSystem) else None
        recorded = samples if reduced is None else np.empty((*samples.shape[:2], reduced.unknowns))
        recorded.fill(np.nan)
        mbs = self.model.mbs
        mbs.SetPostStepUserFunction(self._recorder(recorded, before, stride))
        try:
            mbs.SolveDynamic(self.model.settings)
        except engine().SolverError:
            raise self._explained(stretch, mbs.sys["dynamicSolver"].it.currentTime, step) from None
        except engine().ExudynError as error:
            raise failure(error, "integrating") from None
        finally:
            mbs.SetPostStepUserFunction(0)  # else the system and this run keep each other alive
        self._check_end(mbs.sys["dynamicSolver"])
        if reduced is not None:
            samples[:] = reduced.widened(recorded, self.poses, self.times[stretch.rows])

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
                return self._in_time()
            return True

        return record

    def _in_time(self) -> bool:
        """Return whether the run may go on; an exception would have to pass through Exudyn."""
        try:
            self.poses.budget.check("")
        except Failure:
            return False
        return True

    def _check_end(self, solver: Any) -> None:
        """Count the work, and refuse a run that ended early, which Exudyn may call a success."""
        self.counters["steps"] += solver.it.currentStepIndex - 1  # it counts the start
        self.counters["newton_iterations"] += solver.it.newtonStepsCount
        self.counters["jacobians"] += solver.it.newtonJacobiCount
        where = f"at {self._where(solver.it.currentTime)}"
        self.poses.budget.check(f"the integration was {where}")
        early = solver.it.currentTime < self.model.settings.timeIntegration.endTime * (1 - 1e-9)
        if early or solver.output.simulationStoppedByUserFunction:
            raise Failure(Status.diverged, f"the run ended early, {where}")

    def _where(self, clock: float) -> str:
        return self.scene.where(self.drive.position(clock))

    def _explained(self, stretch: Stretch, clock: float, step: float) -> Failure:
        """Return why a step found no solution: poses, followed step by step from the beginning, may not either."""
        ends = float(self.times[stretch.rows][-1]) - stretch.zero
        way = [self.drive.position(min(number * step, ends)) for number in range(round(clock / step) + 2)]
        try:
            self.poses.through(stretch.begin, np.array(way), curved=False)
        except Failure as singular:
            return singular
        return Failure(Status.diverged, f"Newton's method found no solution for the step at {self._where(clock)}")

    def _check_branch(self) -> None:
        start, poses = self._at_start, self.poses
        jacobians = (poses.equations.jacobian(self._q[rows]) for rows in blocks(self._q))
        branch = np.concatenate([*map(poses.branch, jacobians)])
        other = branch * start.branch < 0
        if other.any():
            positions = self.positions[: int(other.argmax()) + 1]
            self.poses.through(start, positions, curved=False)  # it raises where it meets the singular pose
            where = self.scene.where(float(positions[-1]))
            raise Failure(Status.wrong_branch, f"the bodies are assembled the other way round at {where}", self._motion)
