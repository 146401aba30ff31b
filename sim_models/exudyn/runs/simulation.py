"""What both routes share, the system at its start and its channels; and the pointwise route."""

from collections.abc import Mapping

import numpy as np

from scenes import Failure, Motion, ProcessorBudget, Request, Scene, Status
from scenes.elements.springs import PointPair
from scenes.model.engine import equal_steps
from scenes.model.inputs import inputs_of

from .. import channels
from ..friction import JointFriction
from ..loads import add_loads
from ..poses import SECONDS, PoseSolver
from ..start import begun
from ..system import Array, exudyn

MIN_SPRING = 1e-12  # of the linkage's size; a shorter spring's direction is round-off


def failure(error: Exception, doing: str) -> Failure:
    """What Exudyn raised as a failure, its many lines cut to one clause."""
    status = Status.diverged if isinstance(error, exudyn.SolverError) else Status.crashed
    clause = str(error).strip().splitlines()[0].partition(" [Python file")[0]
    return Failure(status, f"Exudyn gave up {doing}: {clause}")


class ExudynSimulation:
    """A scene to be solved at equal steps of the time; `poses` are of its system, with loads."""

    def __init__(self, scene: Scene, request: Request, *, si: bool = False) -> None:
        self.scene, self.sampling = scene, equal_steps(request)
        self._at_start, self._switches = begun(scene, si=si)
        self.poses = PoseSolver(scene, si=si)
        self.system = self.poses.system
        add_loads(self.system, self._switches, self._at_start)
        inputs = self.sampling.inputs(scene)
        self.times, self.positions = inputs.time, inputs.driven().position
        self._jam: Failure | None = None
        self.counters: dict[str, int] = {}
        self.residuals: dict[str, float] = {}

    def _buffer(self) -> Array:
        """Make room for samples of position, velocity, acceleration and, where forces are requested, multipliers."""
        levels = 4 if self.sampling.wants_forces(self.scene) else 3
        return np.empty((levels, self.sampling.count, 3 * len(self.scene.bodies)))

    def solve(self) -> None:
        """Find the samples, and the channels from them."""
        self.poses.budget = ProcessorBudget(SECONDS * self.sampling.turns, "the solution")
        self._q, v, a, *multipliers = self._solved()
        every = channels.kinematics(self.system, self._q, v, a)
        if multipliers:
            every |= self._forces(*multipliers)
        wanted = set(self.sampling.wanted(self.scene))
        # None of them a part of a larger array, which would stay in memory.
        samples = {name: np.ascontiguousarray(values) for name, values in every.items() if name in wanted}
        self._motion = Motion({"time": self.times} | samples)

    def _forces(self, multipliers: Array) -> dict[str, Array]:
        """The channels of friction and forces; that friction jams is told later, after what makes it doubtful."""
        resisting: Mapping[str, Array] = {}
        if self.scene.friction:
            rates = inputs_of(self.scene, self.times).driven().rate
            try:
                multipliers, resisting = JointFriction(self.poses).act(self._q, multipliers, self.positions, rates)
            except Failure as jam:
                self._jam = jam
        return {**resisting, **channels.forces(self.system, multipliers)}

    def read(self) -> Motion:
        """The channels, unless a spring has no direction at an instant, which Exudyn takes for no force."""
        for pair in self.scene.of_type(PointPair).values():
            (_, p), (_, q) = pair.ends
            length = np.abs(channels.place(self.system, q, self._q) - channels.place(self.system, p, self._q))
            if pair.needs_direction and not length.min() > MIN_SPRING * self.system.size:
                where = self.scene.where(self.positions[np.argmin(length)])
                reason = f"a {pair.noun} has no direction at {where}: {p} and {q} meet"
                raise Failure(Status.nonfinite, reason, self._motion)
        self._check_branch()
        if self._jam is not None:
            raise self._jam
        return self._motion

    def _check_branch(self) -> None:
        """Refuse poses of another branch than the start's; those that are followed have the same."""

    def _solved(self) -> Array:
        """Find the samples, shape (3 or 4, n, 3 bodies); accelerations that nobody asks for are not a number."""
        raise NotImplementedError


class PointwiseSimulation(ExudynSimulation):
    """Poses that meet the constraints at every sample, and the rest from Exudyn's own terms there."""

    def __init__(self, scene: Scene, request: Request) -> None:
        super().__init__(scene, request)
        self._driven = inputs_of(scene, self.times).driven()
        accelerations = any(scene.channels[name].order == 2 for name in self.sampling.wanted(scene))
        self._samples = self._buffer()
        self._curved = accelerations or len(self._samples) > 3

    def _solved(self) -> Array:
        """Follow the pose through the samples, cycle by cycle."""
        state, before, curved = self._at_start, self.poses.newton_iterations, self.poses.curvatures
        # Cycle by cycle, from the last state of one to the next: arrays stay of one cycle's size, and angles count on.
        for turn in range(self.sampling.turns):
            rows = slice(turn * self.sampling.samples, (turn + 1) * self.sampling.samples + 1)
            position, rate, acceleration = (values[rows] for values in self._driven)
            states = self.poses.through(state, position, curved=self._curved)
            self._samples[:3, rows] = states.q, states.velocities(rate), states.accelerations(rate, acceleration)
            if len(self._samples) > 3:
                self._samples[3, rows] = self.poses.multipliers(states, rate, acceleration, self.times[rows])
            state = states.rows(-1)
        iterations, solves = self.poses.newton_iterations - before, self.poses.curvatures - curved
        self.counters = {"poses": len(self.times), "newton_iterations": iterations, "acceleration_solves": solves}
        return self._samples
