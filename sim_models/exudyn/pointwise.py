"""The pointwise route: poses that meet the constraints at every sample, and the rest from Exudyn's own terms there."""

from scenes import Request, Scene
from scenes.engine import equal_steps

from .loads import add_loads
from .poses import Configuration, PoseSolver
from .simulation import ExudynSimulation, wants_accelerations
from .start import begun
from .system import Array


def build(scene: Scene, request: Request) -> "PointwiseSimulation":
    """Assemble the linkage at the drive's start, see `engine.build`."""
    at_start, switches = begun(scene)
    poses = PoseSolver(scene)
    add_loads(poses.system, switches)
    return PointwiseSimulation(request, poses, at_start)


class PointwiseSimulation(ExudynSimulation):
    """Poses through the samples, and velocities, accelerations and reactions in them."""

    def __init__(self, request: Request, poses: PoseSolver, start: Configuration) -> None:
        super().__init__(equal_steps(request), poses)
        self._start = start
        self._driven = self.scene.drive.at(self.times)
        self._samples = self._buffer(accelerations=wants_accelerations(self.scene, request))

    def _solved(self) -> Array:
        """Follow the pose through the samples, cycle by cycle."""
        state, before, curved = self._start, self.poses.newton_iterations, self.poses.curvatures
        for turn in range(self.sampling.turns):
            rows = slice(turn * self.sampling.samples, (turn + 1) * self.sampling.samples + 1)
            position, rate, acceleration = (values[rows] for values in self._driven)
            states = self.poses.through(state, position, curved=len(self._samples) > 2)
            self._samples[0, rows] = states.q
            self._samples[1, rows] = states.velocities(rate)
            if len(self._samples) > 2:
                self._samples[2, rows] = states.accelerations(rate, acceleration)
            if len(self._samples) > 3:
                self._samples[3, rows] = self.poses.multipliers(states, rate, acceleration, self.times[rows])
            state = states.rows(-1)
        self.counters = {
            "poses": len(self.times),
            "newton_iterations": self.poses.newton_iterations - before,
            "acceleration_solves": self.poses.curvatures - curved,
        }
        return self._samples
