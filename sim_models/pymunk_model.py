"""pymunk, an impulse-based physics engine, set up to be a second-order solver of linkages.

Chipmunk, its C core, steps a linkage like a leapfrog, provided that its joints correct their whole position error in
every step (`error_bias` = 0; the default leaves an error of first order, enough to flip a toggle linkage):

    p_k = p_{k-1} + dt v_{k-1},    M (v_k - v_{k-1}) / dt = F + J(p_k)^T lambda_k,    J(p_k) v_k = -C(p_k) / dt

The rates v_k belong to t_k + dt/2. Hence at t_k the velocity is (v_{k-1} + v_k) / 2, the acceleration
(v_k - v_{k-1}) / dt and the reaction lambda_k, with errors in dt^2 and dt^3, which Richardson extrapolation over dt,
dt/2 and dt/4 takes away one after the other. How well Gauss-Seidel sweeps solve the last equation is for
`iterations`: too few do not blur the result but flip the linkage, whatever dt.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np

from scenes import Motion, Sampling, Scene, Settings
from scenes.motion import Samples

from .pymunk_checks import check_convergence, check_levels, check_path
from .pymunk_linkage import Linkage, branch
from .pymunk_reactions import motion_channels, reaction_channels
from .pymunk_run import PREROLL, Run
from .pymunk_start import start


@dataclass(frozen=True)
class PymunkSettings(Settings):
    """How finely to step, and how well to solve each step."""

    steps: int  # steps a turn of the coarsest run, at least: rounded up to a multiple of the samples
    levels: int  # runs for the Richardson extrapolation, 1 to 3, each with twice the steps of the one before
    iterations: int  # Gauss-Seidel sweeps over all joints in a step

    def __post_init__(self) -> None:
        # Without sweeps, pymunk's C core ends the whole process.
        if self.steps < 1 or self.levels not in (1, 2, 3) or self.iterations < 1:
            raise ValueError(f"expected steps and iterations of at least 1 and 1 to 3 levels, found {self}")


def _settings(steps: int, levels: int, iterations: int) -> PymunkSettings:
    runs = " + ".join(str(steps * 2**level) for level in range(levels))
    return PymunkSettings(f"{runs} steps, {iterations} sweeps", steps, levels, iterations)


# 1000 sweeps are enough for the toggle press; at a tenth of its speed, where the load dwarfs the inertia, 2000 are.
DEFAULT = _settings(360, 2, 2000)
LADDER = (
    _settings(72, 1, 500),
    _settings(144, 1, 500),
    _settings(360, 1, 500),
    _settings(72, 2, 1000),
    _settings(72, 3, 1000),
    _settings(144, 3, 1000),
)
LONG_LADDER = (
    _settings(1440, 1, 500),
    _settings(360, 3, 1000),
    _settings(360, 3, 2000),
)


def version() -> str:
    """Return the versions of pymunk and of Chipmunk, its C core."""
    import pymunk

    return f"pymunk {pymunk.version}, Chipmunk {pymunk.chipmunk_version.partition('-')[0]}"


def build(scene: Scene, settings: PymunkSettings, sampling: Sampling) -> "PymunkSimulation":
    """Prepare one run for each level, from a consistent start.

    Raises:
        Failure: unsupported, a body without mass or inertia; cannot_assemble, with the crank angle.
    """
    return PymunkSimulation(Linkage(scene), settings, sampling)


class PymunkSimulation:
    """The runs of all levels, and what follows from them."""

    def __init__(self, linkage: Linkage, settings: PymunkSettings, sampling: Sampling) -> None:
        self._linkage = linkage
        self._sampling = sampling
        pose = start(linkage)
        self._branch = branch(linkage.jacobian(pose))
        self._iterations = settings.iterations
        stride = ceil(settings.steps / sampling.samples)
        self._runs = [Run(linkage, pose, sampling, stride * 2**n, settings.iterations) for n in range(settings.levels)]
        self.residuals: dict[str, float] = {}

    @property
    def counters(self) -> Mapping[str, int]:
        """Steps of all runs, and sweeps times joints in them."""
        steps = sum(PREROLL + run.steps for run in self._runs)
        return {"steps": steps, "constraint_iterations": steps * self._iterations * len(self._runs[0].joints)}

    def solve(self) -> None:
        """Step through the whole time, once for each level."""
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows ends as `nonfinite` in `read`
            for run in self._runs:
                run.advance()

    def read(self) -> Motion:
        """Check each run and return the extrapolated channels.

        Raises:
            Failure: nonfinite, wrong_branch, diverged or not_converged, with the crank angle where it happened.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            levels, residuals = zip(*(self._read(run) for run in self._runs), strict=True)
        columns = {name: [level[name] for level in levels] for name in levels[0]}
        self.residuals = {name: max(run[name] for run in residuals) for name in residuals[0]}
        self.residuals |= check_levels(self._linkage, levels)
        time = {"time": self._sampling.times(self._linkage.scene)}
        return Motion(time | {name: _richardson(values) for name, values in columns.items()})

    def _read(self, run: Run) -> tuple[Mapping[str, Samples], Mapping[str, float]]:
        """Return the channels of one run, but `time`, and how far it is off."""
        linkage = self._linkage
        after, before = run.record[1 :: run.stride], run.record[: -1 : run.stride]
        q, v = after[..., :3], (after[..., 3:] + before[..., 3:]) / 2
        a = (after[..., 3:] - before[..., 3:]) / run.dt
        residuals, unsolved = check_path(linkage, run, self._branch)
        channels = motion_channels(linkage, q, v, a)
        if linkage.scene.has_masses:
            channels |= reaction_channels(linkage, q, v, a)
        return channels, residuals | check_convergence(linkage, run, channels, unsolved)


def _richardson(values: Sequence[Samples]) -> Samples:
    """Return the limit dt -> 0 of up to three arrays with errors in dt^2 and dt^3, at dt, dt/2 and dt/4."""
    for factor in (4, 8)[: len(values) - 1]:
        values = [(factor * fine - coarse) / (factor - 1) for coarse, fine in pairwise(values)]
    return values[0]
