"""The part that both routes share: the system at its start, and its channels."""

import numpy as np

from scenes import Failure, Motion, ProcessorBudget, Request, Sampling, Scene, Status
from scenes.motion import quantity

from . import channels
from .poses import SECONDS, PoseSolver
from .system import Array, engine

SPRING_LIMIT = 1e-12  # of the linkage's size; a shorter spring's direction is round-off


def failure(error: Exception, doing: str) -> Failure:
    """Return what Exudyn raised as a failure, its many lines cut to one clause."""
    status = Status.diverged if isinstance(error, engine().SolverError) else Status.crashed
    clause = str(error).strip().splitlines()[0].partition(" [Python file")[0]
    return Failure(status, f"Exudyn gave up {doing}: {clause}")


def wants_accelerations(scene: Scene, request: Request) -> bool:
    """Return whether any channel needs accelerations."""
    return request.wants_forces(scene) or any(quantity(c) in ("ax", "ay", "alpha") for c in request.wanted(scene))


class ExudynSimulation:
    """A scene to be solved at equal steps of the time; `poses` are of its system, with loads."""

    def __init__(self, sampling: Sampling, poses: PoseSolver) -> None:
        self.sampling, self.poses, self.system = sampling, poses, poses.system
        self.scene = poses.system.scene
        self.times = sampling.times(self.scene)
        self.positions = sampling.commanded(self.scene)
        self.counters: dict[str, int] = {}
        self.residuals: dict[str, float] = {}

    def _buffer(self, *, accelerations: bool = True) -> Array:
        """Return room for samples of position, velocity, acceleration and, where forces are requested, multipliers."""
        levels = 4 if self.sampling.wants_forces(self.scene) else 3 if accelerations else 2
        return np.empty((levels, self.sampling.count, 3 * len(self.scene.bodies)))

    def solve(self) -> None:
        """Find the samples, and the channels from them.

        Raises:
            Failure: the pose cannot follow the drive, a step found no solution, or the budget is spent.
        """
        self.poses.budget = ProcessorBudget(SECONDS * self.sampling.turns, "the solution")
        self._q, v, *others = self._solved()
        wanted = set(self.sampling.wanted(self.scene))
        found = channels.kinematics(self.system, wanted, self._q, v, *others[:1])
        if len(others) > 1:
            found |= channels.forces(self.system, others[1], wanted)
        self._motion = Motion({"time": self.times} | found)

    def read(self) -> Motion:
        """Return the channels.

        Raises:
            Failure: a spring has no direction, or the poses are of another branch; it has the motion with it.
        """
        self._check_springs()
        self._check_branch()
        return self._motion

    def _solved(self) -> Array:
        """Return the samples, shape (2 to 4, n, 3 bodies)."""
        raise NotImplementedError

    def _check_branch(self) -> None:
        """Refuse poses of another branch than the start's."""

    def _check_springs(self) -> None:
        """Refuse an instant at which a spring pushes and has no direction, which Exudyn takes for no force."""
        ground = self.scene.ground
        for spring in self.scene.springs:
            first, second = (
                complex(*ground[name]) if name in ground else channels.place(self.system, name, self._q)
                for name in (spring.first[1], spring.second[1])
            )
            length = np.abs(second - first)
            if spring.length > 0 and not length.min() > SPRING_LIMIT * self.system.size:
                where, ends = self.scene.where(self.positions[np.argmin(length)]), (spring.first[1], spring.second[1])
                reason = f"a spring has no direction at {where}: {' and '.join(ends)} meet"
                raise Failure(Status.nonfinite, reason, self._motion)
