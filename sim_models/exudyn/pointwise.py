"""The pointwise route: states that meet the constraints at every sample, and what Exudyn's own terms make of them."""

from dataclasses import dataclass

from scenes import Request, Scene, Settings

from .simulation import Array, Run, wants_accelerations


@dataclass(frozen=True)
class Pointwise(Settings):
    """Solve position, velocity, acceleration and reactions at every sample, without integrating."""


class PointwiseRun(Run):
    """A motion made of its states."""

    def __init__(self, scene: Scene, request: Request) -> None:
        super().__init__(scene, request)
        self._driven = scene.drive.at(self.times)
        self._samples = self._buffer(accelerations=wants_accelerations(scene, request))

    def solve(self) -> None:
        """Follow the pose through the samples, cycle by cycle.

        Raises:
            Failure: the pose cannot follow the drive.
        """
        state, before, curved = self.start, self.poses.newton_iterations, self.poses.curvatures
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

    def _result(self) -> Array:
        return self._samples
