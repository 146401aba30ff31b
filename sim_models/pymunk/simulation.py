"""The runs of all levels, and their extrapolation."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from math import ceil
from typing import NamedTuple

import numpy as np

from scenes import Failure, Motion, ProcessorBudget, Request, Sampling, Scene
from scenes.engine import equal_steps
from scenes.motion import Samples
from scenes.scene import MotionLaw

from . import stepping
from .channels import found_channels, joint_forces, reaction_channels
from .checks import check_finite, check_impulses, check_path
from .constraints import LinkageConstraints, Masses, Poses, planes, with_ground
from .drive import with_rates_of_law
from .loads import Active, active_presses
from .masses import ballasted_masses, fictitious_masses, own_masses
from .settings import SECONDS, PymunkSettings
from .start import assembles, begun, check_way
from .stepping import Integration
from .stroke import stroke_ends

LIGHTER = 10  # times fewer sweeps do with the fictitious masses


class Motions(NamedTuple):
    """Poses, rates and accelerations at the n samples, shape (n, bodies, 3)."""

    q: Poses
    v: Poses
    a: Poses


def loaded(scene: Scene, settings: PymunkSettings, request: Request) -> bool:
    """Return whether forces act on the bodies; where none are requested, the drive alone moves fictitious masses."""
    return request.wants_forces(scene) and not settings.fictitious


def masses_of(scene: Scene, settings: PymunkSettings, request: Request) -> Masses:
    """Return the masses that these settings give the linkage."""
    masses = ballasted_masses if loaded(scene, settings, request) else fictitious_masses
    return own_masses if settings.extra == "motor" else masses


def build(scene: Scene, settings: PymunkSettings, request: Request) -> "PymunkSimulation":
    """Prepare one run for each level from a consistent start, see `engine.build`.

    Where no forces are requested, they have fictitious masses and fewer sweeps.
    """
    sampling, with_forces = equal_steps(request), loaded(scene, settings, request)
    masses = masses_of(scene, settings, request)
    linkage, pose = begun(scene, masses)
    if not (with_forces or settings.fictitious or settings.extra == "motor"):
        settings = replace(settings, iterations=ceil(settings.iterations / LIGHTER))
    ends = stroke_ends(scene)
    strides = [ceil(settings.steps / sampling.samples) * 2**level for level in range(settings.levels)]
    runs = [stepping.build(scene, masses, ends, sampling, n, settings, loaded=with_forces) for n in strides]
    return PymunkSimulation(sampling, linkage, runs, ends, pose)


class PymunkSimulation:
    """One run for each level."""

    def __init__(
        self,
        sampling: Sampling,
        linkage: LinkageConstraints,
        runs: Sequence[Integration],
        stroke_ends: Sequence[float],
        start: Poses,
    ) -> None:
        self._scene, self._sampling, self._linkage, self._runs = linkage.scene, sampling, linkage, runs
        self._stroke_ends, self._branch = stroke_ends, linkage.branch(start)
        self._wanted = frozenset(sampling.wanted(linkage.scene))
        self._q: Poses = start
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
            levels = zip(*(_at_samples(run) for run in self._runs), strict=True)
            q, v, a = (_richardson(values) for values in levels)
            self._q = q
            if isinstance(self._scene.drive, MotionLaw):
                v, a = with_rates_of_law(self._linkage, self._sampling.times(self._scene), q, v, a)
            self._channels = found_channels(self._linkage, self._wanted, q, v, a, self._active(q, v))

    def read(self) -> Motion:
        """Return the channels, having checked each run.

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
        """Return the largest residual of each check of the runs.

        Where the bodies cannot be put together, pymunk opens joints, flips the linkage, or steps over it.
        """
        linkage, runs = self._linkage, self._runs
        try:
            found = [check_path(linkage, run.record[1:], run.positions, self._branch) for run in runs]
            check_finite(self._scene, samples)
            found += [self._confirmed(run) for run in runs if run.joints]
        except Failure:
            check_way(self._scene)
            raise
        if not assembles(linkage, self._q, self._sampling.commanded(self._scene)):
            check_way(self._scene)
        names = dict.fromkeys(chain(*found))
        return {name: max(residuals[name] for residuals in found if name in residuals) for name in names}

    def _confirmed(self, run: Integration) -> dict[str, float]:
        """Return the residual of the forces that follow from a run's motion, against the engine's own."""
        linkage, (q, v, a) = self._linkage, _at_samples(run)
        reactions = reaction_channels(linkage, q, v, a, run.active)
        expected = joint_forces(linkage, q, v, a, reactions, run.joints)
        return check_impulses(linkage, run.positions[:: run.steps.stride], expected, run.impulses / run.steps.size)

    def _active(self, q: Poses, v: Poses) -> Active:
        """Return, for the n samples, which press forces act, shape (n, press forces)."""
        (z, turn), (velocity, _) = planes(with_ground(q)), planes(with_ground(v))
        found = active_presses(self._linkage, z.T, turn.T, velocity.T, self._stroke_ends)
        return np.array(found, dtype=np.bool_).reshape(len(found), len(q)).T


def _at_samples(run: Integration) -> Motions:
    before, after = run.record[: -1 : run.steps.stride], run.record[1 :: run.steps.stride]
    a = (after[..., 3:] - before[..., 3:]) / run.steps.size
    return Motions(after[..., :3], after[..., 3:] - run.steps.size / 2 * a, a)


def _richardson(values: Sequence[Poses]) -> Poses:
    """Return the limit dt -> 0 of up to four arrays with errors in dt^2, dt^3 and dt^4, at dt, dt/2, dt/4 and dt/8."""
    for factor in (4, 8, 16)[: len(values) - 1]:
        values = [(factor * fine - coarse) / (factor - 1) for coarse, fine in pairwise(values)]
    return values[0]
