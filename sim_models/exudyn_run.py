"""What both ways to solve an Exudyn system share: the system at its start, and the checks of what comes out."""

from math import pi
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.motion import asks_forces

from . import exudyn_channels as channels
from .exudyn_loads import add_loads
from .exudyn_poses import Poses
from .exudyn_start import start
from .exudyn_system import System, engine

Array: TypeAlias = NDArray[np.float64]

SPRING_LIMIT = 1e-12  # of the linkage's size; a shorter spring's direction is round-off
DRIVE_LIMIT = 1e-9  # rad, or of a slider's travel; held at position level, more than round-off is a failed run


def failure(error: Exception, doing: str) -> Failure:
    """Return what Exudyn raised as a failure, its many lines cut to one clause."""
    status = Status.diverged if isinstance(error, engine().SolverError) else Status.crashed
    clause = str(error).strip().splitlines()[0].partition(" [Python file")[0]
    return Failure(status, f"Exudyn gave up {doing}: {clause}")


class Run:
    """One scene's system at its start, to be solved at some instants."""

    drive_limit = DRIVE_LIMIT

    def __init__(self, scene: Scene, sampling: Sampling) -> None:
        self.scene = scene
        self.system = System(scene)
        self.poses = Poses(self.system)
        self.start = start(self.poses)
        add_loads(self.system, self.poses, self.start)
        self.times = sampling.times(scene)
        self.positions = sampling.commanded(scene)
        self.sampling = sampling
        self.counters: dict[str, int] = {}
        self.residuals: dict[str, float] = {}

    def _buffer(self, *, accelerations: bool = True) -> Array:
        """Return room for samples of position, velocity, acceleration and, where forces are asked for, multipliers."""
        levels = 4 if asks_forces(self.scene) else 3 if accelerations else 2
        return np.empty((levels, self.sampling.count, 3 * len(self.scene.bodies)))

    def _motion(self, samples: Array) -> Motion:
        """Check samples of shape (2 to 4, n, 3 bodies) and return their channels."""
        finite = np.isfinite(samples).all(axis=(0, 2))
        if not finite.all():
            where = self.scene.where(self.positions[np.argmin(finite)])
            raise Failure(Status.nonfinite, f"values are not finite from {where} on")
        q, v, *others = samples
        self._check_drive(channels.driven(self.system, q))
        self._check_springs(q)
        kinematics = channels.kinematics(self.system, q, v, *others[:1])
        forces = channels.forces(self.system, others[1]) if len(others) > 1 else {}
        return Motion({"time": self.times} | kinematics | forces)

    def _check_springs(self, q: Array) -> None:
        """Refuse an instant at which a spring pushes and has no direction, which Exudyn takes for no force."""
        ground = self.scene.ground
        for spring in self.scene.springs:
            first, second = (
                complex(*ground[name]) if name in ground else channels.place(self.system, name, q)
                for name in (spring.first[1], spring.second[1])
            )
            length = np.abs(second - first)
            if spring.length > 0 and not length.min() > SPRING_LIMIT * self.system.size:
                where, ends = self.scene.where(self.positions[np.argmin(length)]), (spring.first[1], spring.second[1])
                raise Failure(Status.nonfinite, f"a spring has no direction at {where}: {' and '.join(ends)} meet")

    def _check_drive(self, position: Array) -> None:
        slip = float(np.abs(position - self.positions).max())
        least, most = self.scene.drive.extent
        crank = self.scene.driven_slide is None
        self.residuals["drive"] = slip / (2 * pi if crank else most - least)
        if not slip <= self.drive_limit * (1 if crank else most - least):
            off = f"{slip:.2g} {'rad' if crank else 'm'}"
            raise Failure(Status.diverged, f"{self.scene.drive.body} is not where the drive asks it to be, by {off}")
