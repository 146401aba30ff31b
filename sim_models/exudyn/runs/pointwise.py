"""The pointwise route: poses that meet the constraints at every sample, and the rest from Exudyn's own terms there."""

from scenes import Request, Scene

from ..system import Array
from .simulation import ExudynSimulation


class PointwiseSimulation(ExudynSimulation):
    """Poses through the samples, and velocities, accelerations and reactions in them."""

    def __init__(self, scene: Scene, request: Request) -> None:
        super().__init__(scene, request)
        self._driven = scene.drive.at(self.times)
        self._samples = self._buffer(accelerations=self._wants_accelerations)

    def _solved(self) -> Array:
        """Follow the pose through the samples, cycle by cycle."""
        state, before, curved = self._at_start, self.poses.newton_iterations, self.poses.curvatures
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
