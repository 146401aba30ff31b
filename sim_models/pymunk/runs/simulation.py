"""The runs of all levels, and their extrapolation."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from math import ceil
from typing import TypeAlias

import numpy as np

from scenes import Failure, Motion, ProcessorBudget, Request, Sampling, Scene
from scenes.model.engine import equal_steps
from scenes.model.motion import Samples
from scenes.scene import MotionLaw

from ..channels import Motions, joint_forces, reaction_channels, wanted_channels, with_rates_of_law
from ..constraints import PoseArray, planes, with_ground
from ..loads import Active, active_presses
from ..masses import fictitious_masses, masses_of, own_masses
from ..settings import SECONDS, AnySettings, TextbookSettings
from ..start import Posed, assembles, begun, check_way
from ..stroke import stroke_ends
from .checks import check_finite, check_impulses, check_path
from .stepping import Integration
from .textbook import TextbookRun

LIGHTER = 10  # times fewer sweeps do with the fictitious masses

PymunkRun: TypeAlias = Integration | TextbookRun


def build(scene: Scene, settings: AnySettings, request: Request) -> "PymunkSimulation":
    """Prepare one run for each level from a consistent start, see `engine.build`.

    Where no forces are requested, they have fictitious masses and fewer sweeps.
    """
    sampling = equal_steps(request)
    if isinstance(settings, TextbookSettings):
        run = TextbookRun(scene, sampling, settings)
        return PymunkSimulation(sampling, begun(scene, own_masses), [run], [])
    masses = masses_of(scene, settings, sampling)
    start, ends = begun(scene, masses), stroke_ends(scene)
    if masses is fictitious_masses and not settings.fictitious:
        settings = replace(settings, iterations=ceil(settings.iterations / LIGHTER))
    strides = [ceil(settings.steps / sampling.samples) * 2**level for level in range(settings.levels)]
    return PymunkSimulation(sampling, start, [Integration(scene, sampling, n, settings, ends) for n in strides], ends)


class PymunkSimulation:
    """One run for each level."""

    def __init__(self, sampling: Sampling, start: Posed, runs: Sequence[PymunkRun], ends: Sequence[float]) -> None:
        self._linkage, self._q = start
        self._scene, self._sampling, self._runs, self._stroke_ends = self._linkage.scene, sampling, runs, ends
        self._branch = self._linkage.branch(self._q)
        self._channels: Mapping[str, Samples] = {}
        self.residuals: dict[str, float] = {}

    @property
    def counters(self) -> Mapping[str, int]:
        """Steps of all runs, sweeps times constraints in them, and the size of the model."""
        first, *others = (run.counters for run in self._runs)
        return first | {
            name: first[name] + sum(run[name] for run in others) for name in ("steps", "constraint_iterations")
        }

    def solve(self) -> None:
        """Step through the whole time, once for each level, and find the channels in the limit of the levels.

        Raises:
            Failure: timed_out.
        """
        budget = ProcessorBudget(SECONDS, "")
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows ends as `nonfinite` in `read`
            for run in self._runs:
                budget.task = f"the run of {run.steps.count} steps and those before"
                run.advance(budget)
            levels = zip(*(run.motions for run in self._runs), strict=True)
            motion = Motions(*(_richardson(values) for values in levels))
            if isinstance(self._scene.drive, MotionLaw):
                motion = with_rates_of_law(self._linkage, self._sampling.times(self._scene), motion)
            self._q, wanted = motion.q, frozenset(self._sampling.wanted(self._scene))
            self._channels = wanted_channels(self._linkage, wanted, motion, self._active(motion))

    def read(self) -> Motion:
        """The channels, having checked each run.

        Raises:
            Failure: nonfinite, wrong_branch, diverged or not_converged, with the drive's position where it happened;
                and with the motion.
        """
        wanted = [name for name in self._sampling.wanted(self._scene) if name in self._channels]
        own = {name: np.ascontiguousarray(self._channels[name]) for name in wanted}  # not parts of larger arrays
        samples = {"time": self._sampling.times(self._scene)} | own
        motion = Motion(samples)
        try:
            self.residuals = self._checked(samples)
        except Failure as failure:
            raise Failure(failure.status, failure.reason, motion) from None
        return motion

    @np.errstate(over="ignore", invalid="ignore")
    def _checked(self, samples: Mapping[str, Samples]) -> dict[str, float]:
        """Find the largest residual of each check of the runs.

        Where the bodies cannot be put together, pymunk opens joints, flips the linkage, or steps over it.
        """
        linkage, runs = self._linkage, self._runs
        try:
            residuals = [check_path(linkage, run.path, run.positions, self._branch) for run in runs]
            check_finite(self._scene, samples)
            residuals += [self._confirmed(run) for run in runs if run.joints]
        except Failure:
            check_way(self._scene)
            raise
        if not assembles(linkage, self._q, self._sampling.commanded(self._scene)):
            check_way(self._scene)
        names = dict.fromkeys(chain(*residuals))
        return {name: max(of_run[name] for of_run in residuals if name in of_run) for name in names}

    def _confirmed(self, run: PymunkRun) -> dict[str, float]:
        """Find the residual of the forces that follow from a run's motion, against the engine's own."""
        motion = run.motions
        reactions = reaction_channels(self._linkage, motion, run.active)
        expected, own = joint_forces(self._linkage, motion, reactions, run.joints), run.impulses / run.steps.size
        return check_impulses(self._linkage, run.positions[:: run.steps.stride], expected, own)

    def _active(self, motion: Motions) -> Active:
        """Tell for the n samples which press forces act, shape (n, press forces)."""
        (z, turn), (velocity, _) = planes(with_ground(motion.q)), planes(with_ground(motion.v))
        active = active_presses(self._linkage, z.T, turn.T, velocity.T, self._stroke_ends)
        return np.array(active, dtype=np.bool_).reshape(len(active), len(motion.q)).T


def _richardson(values: Sequence[PoseArray]) -> PoseArray:
    """Extrapolate up to four arrays with errors in dt^2, dt^3 and dt^4, at dt, dt/2, dt/4 and dt/8, to dt = 0."""
    for factor in (4, 8, 16)[: len(values) - 1]:
        values = [(factor * fine - coarse) / (factor - 1) for coarse, fine in pairwise(values)]
    return values[0]
