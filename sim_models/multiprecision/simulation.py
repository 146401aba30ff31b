"""One run at arbitrary precision: follow the pose through the samples, prove each, round the channels at the end."""

from collections.abc import Mapping

from flint import arb_mat, ctx

from scenes import Failure, Motion, Request, Scene, Status

from .channels import channels
from .constraints import LinkageEquations
from .continuation import Continuation
from .loads import GeneralisedForce, generalised_force
from .solution import Solution, proven_errors, solved
from .start import start
from .stroke import stroke_ends

ENOUGH = 1e-20  # largest proven error of the motion and of the forces, relative; far below a double's round-off


def build(scene: Scene, digits: int, request: Request) -> "MultiprecisionSimulation":
    """Find the pose at the start, and the ends of press forces' strokes, see `engine.build`."""
    with ctx.workdps(digits):  # puts back the precision it found
        linkage = LinkageEquations(scene)
        continuation = Continuation(linkage, digits)
        at_start = start(linkage, continuation)
        force = generalised_force(linkage, stroke_ends(linkage, continuation, at_start))
    return MultiprecisionSimulation(request, digits, linkage, force, at_start)


class MultiprecisionSimulation:
    """One prepared run, see `scenes.engine.Simulation`."""

    def __init__(
        self, request: Request, digits: int, linkage: LinkageEquations, force: GeneralisedForce, start: arb_mat
    ) -> None:
        self._request, self._digits = request, digits
        self._linkage, self._force, self._start = linkage, force, start
        self._solutions: list[Solution] = []
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}

    def solve(self) -> None:
        """Follow the pose through the samples and enclose each.

        Raises:
            Failure: the linkage is singular at some position of the drive, or the digits are too few.
        """
        linkage, scene = self._linkage, self._linkage.scene
        _, rates, accelerations = scene.drive.at(self._request.times(scene))
        driven = zip(self._request.commanded(scene).tolist(), rates.tolist(), accelerations.tolist(), strict=True)
        continuation = Continuation(linkage, self._digits)
        self._solutions = []
        q = self._start
        with ctx.workdps(self._digits):
            for position, rate, acceleration in driven:
                goal = linkage.drive(position)
                q = continuation.follow(q, goal)
                self._solutions.append(solved(linkage, self._force, continuation.enclose(q, goal), rate, acceleration))
            self.residuals = proven_errors(linkage, self._solutions)
        self.counters = continuation.counters
        for proven, what in (("constraints", "motion"), ("newton-euler", "forces")):
            if proven in self.residuals and not self.residuals[proven] <= ENOUGH:
                reason = f"{self._digits} digits prove the {what} only to {self.residuals[proven]:.0e}"
                raise Failure(Status.not_converged, reason)

    def read(self) -> Motion:
        """Return the channels requested, in double precision."""
        scene = self._linkage.scene
        with ctx.workdps(self._digits):
            samples = {"time": self._request.times(scene)} | channels(self._linkage, self._solutions)
        return Motion({channel: samples[channel] for channel in self._request.wanted(scene)})
