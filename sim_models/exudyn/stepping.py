"""Time stepping: the whole motion integrated with a constant step, and what the poses know about it checked."""

from collections.abc import Callable
from itertools import count
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Motion, Request, Scene, Status
from scenes.engine import ESTIMATE
from scenes.scene import ConstantSpeed

from .checks import check_channels
from .extras import Extras
from .loads import add_loads
from .poses import State
from .reduced import ReducedSystem
from .settings import Extra, Textbook, TimeStepping, configure
from .simulation import Array, Run, failure
from .spatial import SpatialSystem
from .system import System, engine

BRANCH_LIMIT = 0.05  # of the linkage's size; a body that far from its assembled place is on another branch
PRE_ROLL_HALVINGS = 5  # of the step, before a start counts as too near to where the linkage locks
LOCK_NEARS = 2.0  # times as fast as anywhere in the cycle, for the same drive: it is not worth starting there
DRIFT_LIMIT = 1e-3  # of the drive, as DRIVE_LIMIT: steps of index 2 hold the rate only, and integrate one that varies


class SteppedRun(Run):
    """One integration in time, or two whose results are extrapolated."""

    def __init__(self, scene: Scene, settings: TimeStepping, request: Request) -> None:
        self.options = settings
        super().__init__(scene, request, si=isinstance(settings, Textbook))
        self.stride = ceil(settings.steps / self.sampling.samples)  # steps from sample to sample
        if settings.solver == "TrapezoidalIndex2":
            if settings.richardson:
                self.stride += self.stride % 2  # what rings in every other step cancels between two even numbers
            if not isinstance(scene.drive, ConstantSpeed):
                self.drive_limit = DRIFT_LIMIT
        self._runs = [self._buffer() for _ in range(2 if settings.richardson else 1)]
        self._assembled = self._assembled_cycle()
        begin = self._rolled_back()
        self.model = self._integrated()
        self._prepare(begin)

    def _assembled_cycle(self) -> State:
        """Return the states at a cycle's samples, which prove it possible and tell the branch."""
        one = slice(self.sampling.samples if self.scene.drive.repeats else None)
        return self.poses.through(self.start, self.positions[one])

    def _rolled_back(self) -> State:
        """Return the state in which the integration begins.

        Before its start, a drive that does not repeat leads where the scene never goes. Where the linkage locks there,
        or nearly, smaller steps bring the beginning nearer to the start.
        """
        for _ in range(PRE_ROLL_HALVINGS + 1):
            self.step = self.scene.drive.cycle / (self.stride * self.sampling.samples)
            try:
                return self._before(self.options.pre_roll)
            except Failure as locked:
                reason = locked.reason
            self.stride *= 2
        raise Failure(Status.unsupported, f"time steps have to begin a little before the start, but there {reason}")

    def _before(self, steps: int) -> State:
        """Return the state that many steps before the start."""
        positions = self.scene.drive.at(-self.step * np.arange(steps + 1)).position
        way = self.poses.through(self.start, positions, curved=False)
        fastest = LOCK_NEARS * self.poses.speed(self._assembled).max()
        fast = ~(self.poses.speed(way) <= fastest)
        if fast.any() and not self.scene.drive.repeats:
            where = self.scene.where(float(positions[fast.argmax()]))
            raise Failure(Status.cannot_assemble, f"the linkage nears a lock at {where}")
        return way.rows(-1)

    def _integrated(self) -> System:
        """Return the system that moves in time: the one of the poses, unless another is asked for."""
        if not self.options.reduced and self.options.extra is not Extra.SPATIAL:
            return self.system
        kind = ReducedSystem if self.options.reduced else SpatialSystem
        model = kind(self.scene, si=isinstance(self.options, Textbook))
        add_loads(model, self.poses, self.start)
        return model

    def _prepare(self, begin: State) -> None:
        """Set the integrator, and its initial values."""
        self.lead = self.options.pre_roll * self.step
        self._extras = Extras(self.model, self.options, self.step, forces=len(self._runs[0]) > 3)
        configure(self.model.settings, self.options, self.system.size)
        drive, values, initial = self.scene.drive.at(-self.lead), self.model.state, engine().ConfigurationType.Initial
        for place, of_plane in (
            (values.SetODE2Coordinates, begin.q),
            (values.SetODE2Coordinates_t, begin.velocities(drive.rate)),
            (values.SetODE2Coordinates_tt, begin.accelerations(drive.rate, drive.acceleration)),
        ):
            place(self.model.narrowed(of_plane), initial)

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
        integration.endTime = self.lead + self.times[-1]
        self.model.course.run(self.lead, self.step / refinement, integration.numberOfSteps)
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
        """Return what Exudyn calls at the start and after every step: it keeps the state of those that are samples."""
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
        early = solver.it.currentTime < (self.lead + self.times[-1]) * (1 - 1e-9)
        if early or solver.output.simulationStoppedByUserFunction:
            raise Failure(Status.diverged, f"the run ended early, {where}")

    def _where(self, clock: float) -> str:
        return self.scene.where(float(self.scene.drive.at(clock - self.lead).position))

    def _result(self) -> Array:
        samples = self._runs[-1]
        if self.options.richardson:
            coarse, fine = self._runs
            samples = (4 * fine - coarse) / 3  # both methods are of order 2
        return samples

    def _check(self, samples: Array, motion: Motion) -> None:
        """Refuse what left the drive or the branch as well, or is not what the equations of motion ask for."""
        super()._check(samples, motion)
        self._check_branch(samples[0])
        q = self._assembled.q
        self.residuals[ESTIMATE] = check_channels(
            self.system, motion.samples, self._channels(self._asked(len(samples))), q, self.positions
        )

    def _asked(self, levels: int) -> Array:
        """Return what the equations of motion ask for in the assembled poses, shape (levels, samples, 3 bodies)."""
        states = self._assembled
        times = self.times[: len(states.q)]
        _, rate, acceleration = self.scene.drive.at(times)
        asked = [states.q, states.velocities(rate), states.accelerations(rate, acceleration)]
        if levels > 3:
            asked.append(self.poses.multipliers(states, rate, acceleration, times + self.system.course.lead))
        return np.array(asked)

    def _check_branch(self, q: Array) -> None:
        """Compare every pose with the assembled one, which is the same in every cycle."""
        place = _places(q, self.system.size)
        assembled = _places(self._assembled.q, self.system.size)[np.arange(len(q)) % len(self._assembled.q)]
        off = np.abs(place - assembled).max(axis=(1, 2)) / self.system.size
        self.residuals["pose"] = float(off.max())
        if off.max() > BRANCH_LIMIT:
            where = self.scene.where(self.positions[np.argmax(off > BRANCH_LIMIT)])
            raise Failure(Status.wrong_branch, f"at {where} the bodies are assembled another way")


def _places(q: Array, size: float) -> NDArray[np.complex128]:
    """Return centres of mass, and x axes of the linkage's size, of poses (n, 3 bodies): shape (n, bodies, 2), m."""
    x, y, angle = np.moveaxis(q.reshape(len(q), -1, 3), 2, 0)
    return np.stack([x + 1j * y, size * np.exp(1j * angle)], axis=-1)
