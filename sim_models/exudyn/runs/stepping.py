"""Time stepping: the whole motion integrated with a constant step.

A law's jerk jumps at its knots, and an integration that passes one oscillates for some twenty steps, by h. So every
piece of a law is integrated by itself: from steps before its first sample, as if it had always been the law, so that
the start transient has decayed by then.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import count, pairwise
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from scenes import Failure, Request, Scene, Status
from scenes.laws import Piece
from scenes.model.constraints import blocks

from ..ablations import ReducedSystem, SpatialSystem, add_extras
from ..drive import ExudynDrive, pieces
from ..loads import add_loads
from ..poses import Configuration
from ..settings import ExudynExtra, JacobianUse, TextbookTimeStepping, TimeStepping
from ..system import Array, ExudynSystem, exudyn
from .simulation import ExudynSimulation, failure

MAX_PRE_ROLL_HALVINGS = 5  # of the step, before a start counts as too near to a singular configuration
SLOWLY = 8  # times the steps before a start that a law takes at least: polynomials soon leave all range before theirs
MAX_SPEED_RATIO = 2.0  # times that at the start, at the same rate of the drive: no integration begins there
TRAPEZOIDAL = "TrapezoidalIndex2"
GAP_TOL = 1e-4  # of a linkage's size, and of the tolerance: gaps that are no more than round-off
MAX_DENSE = 10  # bodies: with more, a step's sparse equations take less, of 27 less than half
SAME_INSTANT_TOL = 1e-9  # of the time between samples: one on a knot begins a piece, whichever way it was rounded


class Stretch(NamedTuple):
    """The samples that one integration gives: those of a piece of the drive, or of all pieces."""

    pieces: Sequence[Piece]
    rows: slice  # of the samples
    stride: int  # steps from sample to sample
    zero: float  # s, when it begins
    begin: Configuration


class TimeSteppedSimulation(ExudynSimulation):
    """The pieces integrated in time, each once, or twice with results that are extrapolated."""

    def __init__(self, scene: Scene, options: TimeStepping, request: Request) -> None:
        si = isinstance(options, TextbookTimeStepping)
        super().__init__(scene, request, si=si)
        self.options, self.drive = options, ExudynDrive()
        self.stretches = self._stretches()
        kind = SpatialSystem if options.extra is ExudynExtra.SPATIAL else ExudynSystem
        kind = ReducedSystem if options.reduced else kind
        self.model = kind(scene, self.drive, si=si)
        add_loads(self.model, self._switches, self._at_start)
        step = self._step(self.stretches[0].stride)
        add_extras(self.model, options, step, forces=self.sampling.wants_forces(scene))
        _configure(self.model, options)
        self._runs = [self._buffer() for _ in range(2 if options.richardson else 1)]

    def _stretches(self) -> list[Stretch]:
        """Choose what to integrate: each piece of the drive that has samples, or in a first script all in one."""
        times, stride = self.times, ceil(self.options.steps / self.sampling.samples)
        if self.options.solver == TRAPEZOIDAL and self.options.richardson:
            # The trapezoidal rule has an undamped error that alternates from step to step.
            stride += stride % 2  # errors of a period of two steps cancel between two even numbers of steps
        parts = pieces(self.system.prescribed.law, float(times[-1]))
        if isinstance(self.options, TextbookTimeStepping):
            return [Stretch(parts, slice(len(times)), stride, 0.0, self._at_start)]
        begins = np.searchsorted(times, [part.begin - SAME_INSTANT_TOL * times[1] for part in parts])
        ends = pairwise([*begins.tolist(), len(times)])
        spans = [(part, slice(first, end)) for part, (first, end) in zip(parts, ends, strict=True) if first < end]
        firsts = self.poses.through(self._at_start, self.positions[[rows.start for _, rows in spans]])
        return [self._pre_rolled(firsts.rows(n), part, rows, stride) for n, (part, rows) in enumerate(spans)]

    def _pre_rolled(self, first: Configuration, part: Piece, rows: slice, stride: int) -> Stretch:
        """Let the integration of a piece begin before its first sample, given the state there.

        Before its start, a drive that does not repeat is outside the scene's range. Where the linkage is singular
        there, or nearly, smaller steps bring the beginning nearer to the start; and where a law takes few steps.
        """
        time = self.times[rows.start]
        # A polynomial or sine piece of a law, continued before its begin, may leave the linkage's range within a few
        # steps: steps are made shorter until the pre-roll is a small part of the span within which the piece is meant.
        while self.options.pre_roll * self._step(stride) > part.within / SLOWLY:
            stride *= 2
        for _ in range(MAX_PRE_ROLL_HALVINGS + 1):
            before = time - self.options.pre_roll * self.scene.cycle / (stride * self.sampling.samples)
            try:
                return Stretch([part], rows, stride, before, self._before(first, part, np.linspace(time, before)))
            except Failure as singular:
                reason = singular.reason
            stride *= 2
        raise Failure(Status.unsupported, f"time steps have to begin a little before the start, but there {reason}")

    def _before(self, first: Configuration, part: Piece, way: Array) -> Configuration:
        """Follow the state to the last of some instants, s, that lead there."""
        positions, poses = [float(part.at(time)[0]) for time in way.tolist()], self.poses
        farthest = max(positions, key=lambda position: abs(position - first.position))
        turned = poses.follow(first, farthest)
        # Large q' = dq/ds is the sign of a nearby singular pose: it grows without bound towards one.
        there, here = poses.length(turned.tangent), poses.length(first.tangent)
        if not self.scene.periodic and not there <= MAX_SPEED_RATIO * here:
            raise Failure(Status.cannot_assemble, f"the linkage nears a lock at {self.scene.where(farthest)}")
        return poses.follow(turned, positions[-1])

    def _step(self, stride: int) -> float:
        return self.scene.cycle / (stride * self.sampling.samples)

    def _solved(self) -> Array:
        self.counters = dict.fromkeys(("steps", "newton_iterations", "jacobians"), 0) | self.model.counts()
        for stretch in self.stretches:
            self.drive.run(stretch.pieces, stretch.zero)
            _set_initial(self.model, stretch)
            for level, samples in enumerate(self._runs):
                self._integrate(stretch, samples[:, stretch.rows], refinement=2**level)
        if not self.options.richardson:
            return self._runs[0]
        # Richardson's extrapolation: the h^2 terms of steps h and h/2 cancel.
        coarse, fine = self._runs
        return (4 * fine - coarse) / 3  # both methods are of order 2

    def _integrate(self, stretch: Stretch, samples: Array, refinement: int) -> None:
        """Integrate a stretch with a constant step, `refinement` times finer than asked for, into its samples.

        It begins some steps before the first sample. Exudyn's implicit solver makes the steps, and the recorder takes
        positions, rates, accelerations and multipliers after each of those that are samples. A step that does not
        converge is a Failure that says where. Of a system in fewer unknowns the others are found from them afterwards.
        """
        before, stride = refinement * self.options.pre_roll, refinement * stretch.stride
        step = self._step(stride)
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
        except exudyn.SolverError:
            raise self._explained(stretch, mbs.sys["dynamicSolver"].it.currentTime, step) from None
        except exudyn.ExudynError as error:
            raise failure(error, "integrating") from None
        finally:
            mbs.SetPostStepUserFunction(0)  # else the system and this run keep each other alive
        self._check_end(mbs.sys["dynamicSolver"])
        if reduced is not None:
            samples[:] = reduced.widened(recorded, self.poses, self.times[stretch.rows])

    def _recorder(self, samples: Array, before: int, stride: int) -> Callable[[Any, float], bool]:
        """The function that Exudyn calls at the start and after every step: it records the samples."""
        state, coordinates = self.model.state, self.model.coordinates
        levels = (state.GetODE2Coordinates, state.GetODE2Coordinates_t, state.GetODE2Coordinates_tt)
        getters = [*((get, coordinates) for get in levels), (state.GetAECoordinates, self.model.multipliers)]
        rows = [*zip(samples, getters, strict=False)]  # without forces, no multipliers
        steps = count(-before)

        def record(_mbs: Any, _time: float) -> bool:
            sample, remainder = divmod(next(steps), stride)
            if remainder == 0 and 0 <= sample < samples.shape[1]:
                for row, (get, chosen) in rows:
                    row[sample] = get()[chosen]
                with suppress(Failure):  # which would have to pass through Exudyn
                    self.poses.budget.check("")
                    return True
                return False
            return True

        return record

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
        """Tell why a step found no solution: poses, followed step by step from the beginning, may not either."""
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
        other = np.concatenate([*map(poses.branch, jacobians)]) * start.branch < 0
        if other.any():
            positions = self.positions[: int(other.argmax()) + 1]
            poses.through(start, positions, curved=False)  # it raises where it meets the singular pose
            where = self.scene.where(float(positions[-1]))
            raise Failure(Status.wrong_branch, f"the bodies are assembled the other way round at {where}", self._motion)


def _configure(model: ExudynSystem, options: TimeStepping) -> None:
    integration = model.settings.timeIntegration
    integration.solverType = getattr(exudyn.DynamicSolverType, options.solver)
    integration.generalizedAlpha.spectralRadius = options.spectral_radius
    if isinstance(options, TextbookTimeStepping):
        return
    # Start values come from the pose solver: positions, velocities and accelerations that satisfy all three levels of
    # the constraints, including the drive's own acceleration.
    integration.generalizedAlpha.computeInitialAccelerations = False  # those take no account of the drive's own
    integration.adaptiveStep = False  # it adds up time, and ends on a tiny step with absurd forces
    integration.newton.relativeTolerance = options.tolerance
    integration.newton.absoluteTolerance = GAP_TOL * model.size * options.tolerance
    integration.newton.useModifiedNewton = options.newton is not JacobianUse.FULL
    integration.newton.modifiedNewtonJacUpdatePerStep = options.newton is JacobianUse.ONE_A_STEP
    if len(model.bodies) > MAX_DENSE:
        model.settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
        model.settings.linearSolver.reuseAnalyzedPattern = True  # who is joined to whom is the same in every step


def _set_initial(model: ExudynSystem, stretch: Stretch) -> None:
    begin, values, initial = stretch.begin, model.state, exudyn.ConfigurationType.Initial
    _, rate, acceleration = stretch.pieces[0].at(stretch.zero)
    values.SetODE2Coordinates(model.narrowed(begin.q), initial)
    values.SetODE2Coordinates_t(model.narrowed(begin.velocities(rate)), initial)
    values.SetODE2Coordinates_tt(model.narrowed(begin.accelerations(rate, acceleration)), initial)
