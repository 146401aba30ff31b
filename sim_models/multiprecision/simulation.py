"""One run at arbitrary precision: follow the pose through the samples, prove each, round the channels at the end."""

from collections.abc import Mapping

import numpy as np
from flint import ctx

from scenes import Failure, Motion, ProcessorBudget, Request, Scene, Status

from .constraints import LinkageEquations
from .continuation import Continuation
from .drive import Command, commands
from .loads import generalised_force
from .settings import MultiprecisionSettings
from .solution import Solution, channels, proven_errors, solution_in
from .start import start, stroke_ends

ENOUGH = 1e-20  # largest proven error of the motion and of the forces, relative; far below a double's round-off


class MultiprecisionSimulation:
    """One prepared run, see `scenes.model.engine.Simulation`."""

    def __init__(self, scene: Scene, settings: MultiprecisionSettings, request: Request) -> None:
        """Find the pose at the start, and the ends of press forces' strokes, see `engine.build`."""
        self._request, self._settings = request, settings
        self._commands: list[Command] = []
        self._solutions: list[Solution] = []
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}
        budget = ProcessorBudget(settings.seconds, "the start from the sketch")
        with ctx.workdps(settings.digits):  # puts back the precision that was there before
            self._linkage = LinkageEquations(scene)
            continuation = Continuation(self._linkage, settings.digits, budget)
            self._start = start(self._linkage, continuation)
            budget.task = "the end of the closing stroke"
            self._force = generalised_force(self._linkage, stroke_ends(self._linkage, continuation, self._start))

    def solve(self) -> None:
        """Follow the pose through the samples and enclose each.

        Raises:
            Failure: the linkage is singular at some position of the drive, or the digits or the time are too few.
        """
        linkage, digits = self._linkage, self._settings.digits
        budget = ProcessorBudget(self._settings.seconds_for(self._request), "the motion")
        continuation = Continuation(linkage, digits, budget)
        self._solutions = []
        q = self._start
        with ctx.workdps(digits):
            self._commands = commands(linkage.law, self._request)
            for number, command in enumerate(self._commands, start=1):
                budget.task = f"sample {number} of {self._request.count}"
                goal = linkage.drive(float(command.position))  # the drive's channel is where the pose is
                q = continuation.follow(q, goal)
                pose = continuation.enclose(q, goal)
                self._solutions.append(solution_in(linkage, self._force, pose, command.rate, command.acceleration))
            self.residuals = proven_errors(linkage, self._solutions)
        self.counters = continuation.counters
        for proven, what in (("constraints", "motion"), ("newton-euler", "forces")):
            if proven in self.residuals and not self.residuals[proven] <= ENOUGH:
                reason = f"{digits} digits prove the {what} only to {self.residuals[proven]:.0e}"
                raise Failure(Status.not_converged, reason)

    def read(self) -> Motion:
        """Return the channels requested, in double precision."""
        scene = self._linkage.scene
        with ctx.workdps(self._settings.digits):
            time = np.array([float(command.time) for command in self._commands])
            samples = {"time": time} | channels(self._linkage, self._solutions)
        return Motion({channel: samples[channel] for channel in self._request.wanted(scene)})
