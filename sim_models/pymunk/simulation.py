"""The runs of all levels, and their extrapolation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil

import numpy as np

from scenes import Failure, Motion, Request, Sampling, Scene
from scenes.engine import equal_steps
from scenes.motion import Samples, force_channels

from . import stepping
from .channels import found_channels, joint_forces
from .checks import check_finite, check_impulses, check_path
from .constraints import LinkageConstraints, Poses, branch, planes, with_ground
from .loads import Active, active_presses
from .masses import ballasted_masses, fictitious_masses, own_masses
from .settings import PymunkSettings
from .start import start
from .stepping import Integration
from .stroke import stroke_ends

LIGHTER = 10  # times fewer sweeps do with the fictitious masses


@dataclass(frozen=True)
class Level:
    """A run's poses, rates and accelerations at the n samples, and its channels.

    These are the ones requested, and where there are forces among them, all forces.
    """

    run: Integration
    q: Poses
    v: Poses
    a: Poses
    active: Active  # (n, press forces)
    samples: Mapping[str, Samples]


def loaded(scene: Scene, settings: PymunkSettings, request: Request) -> bool:
    """Return whether forces act on the bodies; where none are requested, the drive alone moves fictitious masses."""
    return request.wants_forces(scene) and not settings.fictitious


def linkage_of(scene: Scene, settings: PymunkSettings, request: Request) -> LinkageConstraints:
    """Return the linkage with the masses that these settings give it.

    Raises:
        Failure: unsupported, cannot_assemble; see `LinkageConstraints`.
    """
    masses = ballasted_masses if loaded(scene, settings, request) else fictitious_masses
    return LinkageConstraints(scene, own_masses if settings.extra == "motor" else masses)


def build(scene: Scene, settings: PymunkSettings, request: Request) -> "PymunkSimulation":
    """Prepare one run for each level from a consistent start, see `engine.build`.

    Where no forces are requested, they have fictitious masses and fewer sweeps.
    """
    sampling, with_forces = equal_steps(request), loaded(scene, settings, request)
    linkage = linkage_of(scene, settings, request)
    if not (with_forces or settings.fictitious or settings.extra == "motor"):
        settings = replace(settings, iterations=ceil(settings.iterations / LIGHTER))
    pose = start(linkage)
    ends = stroke_ends(linkage, pose)
    strides = [ceil(settings.steps / sampling.samples) * 2**level for level in range(settings.levels)]
    runs = [stepping.build(linkage, pose, ends, sampling, n, settings, loaded=with_forces) for n in strides]
    return PymunkSimulation(sampling, linkage, runs, ends, branch(linkage.jacobian(pose)))


class PymunkSimulation:
    """One run for each level."""

    def __init__(
        self,
        sampling: Sampling,
        linkage: LinkageConstraints,
        runs: Sequence[Integration],
        stroke_ends: Sequence[float],
        branch: Samples,
    ) -> None:
        self._scene, self._sampling, self._linkage, self._runs = linkage.scene, sampling, linkage, runs
        self._stroke_ends, self._branch = stroke_ends, branch
        self._wanted = frozenset(sampling.wanted(linkage.scene))
        self.residuals: dict[str, float] = {}

    @property
    def counters(self) -> Mapping[str, int]:
        """Steps of all runs, sweeps times constraints in them, and the size of the model."""
        first, *others = (run.counters for run in self._runs)
        return first | {
            name: first[name] + sum(run[name] for run in others) for name in ("steps", "constraint_iterations")
        }

    def solve(self) -> None:
        """Step through the whole time, once for each level."""
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows ends as `nonfinite` in `read`
            for run in self._runs:
                run.advance()

    def read(self) -> Motion:
        """Return the extrapolated channels, having checked each run.

        Raises:
            Failure: nonfinite, wrong_branch, diverged or not_converged, with the drive's position where it happened;
                and with the motion.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            levels = [self._level(run) for run in self._runs]
            samples = self._extrapolated(levels)
            motion = Motion({"time": self._sampling.times(self._scene)} | samples)
            try:
                of_levels = [self._checked(level) for level in levels]
            except Failure as failure:
                raise Failure(failure.status, failure.reason, motion) from None
        self.residuals = {name: max(found[name] for found in of_levels) for name in of_levels[0]}
        return motion

    def _level(self, run: Integration) -> Level:
        before, after = run.record[: -1 : run.steps.stride], run.record[1 :: run.steps.stride]
        q, a = after[..., :3], (after[..., 3:] - before[..., 3:]) / run.steps.size
        v = after[..., 3:] - run.steps.size / 2 * a
        active = run.active if run.forces else self._active(q, v)
        return Level(run, q, v, a, active, found_channels(self._linkage, self._wanted, q, v, a, active))

    def _extrapolated(self, levels: Sequence[Level]) -> dict[str, Samples]:
        wanted = [name for name in self._sampling.wanted(self._scene) if name in levels[0].samples]
        samples = {name: _richardson([level.samples[name] for level in levels]) for name in wanted}
        # Where the levels differ in a press force that is on or off, they have no limit.
        finest = levels[-1]
        switched = np.any([level.active != finest.active for level in levels], axis=(0, 2))
        for name in force_channels(self._scene):
            if name in samples:
                samples[name][switched] = finest.samples[name][switched]
        return samples

    def _checked(self, level: Level) -> dict[str, float]:
        """Return the residuals of all checks of a run."""
        linkage, run = self._linkage, level.run
        residuals = check_path(linkage, run.record[1:], run.positions, self._branch)
        check_finite(self._scene, level.samples)
        if run.joints:
            expected = joint_forces(linkage, level.q, level.v, level.a, level.samples, run.joints)
            found = run.impulses / run.steps.size
            residuals |= check_impulses(linkage, run.positions[:: run.steps.stride], expected, found)
        return residuals

    def _active(self, q: Poses, v: Poses) -> Active:
        """Return, for the n samples, which press forces act, shape (n, press forces)."""
        (z, turn), (velocity, _) = planes(with_ground(q)), planes(with_ground(v))
        found = active_presses(self._linkage, z.T, turn.T, velocity.T, self._stroke_ends)
        return np.array(found, dtype=np.bool_).reshape(len(found), len(q)).T


def _richardson(values: Sequence[Samples]) -> Samples:
    """Return the limit dt -> 0 of up to four arrays with errors in dt^2, dt^3 and dt^4, at dt, dt/2, dt/4 and dt/8."""
    for factor in (4, 8, 16)[: len(values) - 1]:
        values = [(factor * fine - coarse) / (factor - 1) for coarse, fine in pairwise(values)]
    return values[0]
