"""The runs of all levels, and what follows from them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np

from scenes import Motion, Sampling, Scene
from scenes.motion import Samples, asks_forces, channels, force_channels

from .pymunk_checks import check_convergence, check_finite, check_impulses, check_levels, check_path
from .pymunk_linkage import Linkage, Poses, branch, planes, with_ground
from .pymunk_loads import Acts, acting
from .pymunk_masses import ballasted_masses, fictitious_masses, own_masses
from .pymunk_reactions import joint_forces, motion_channels, reaction_channels
from .pymunk_run import Run
from .pymunk_settings import PymunkSettings
from .pymunk_start import start, stroke_ends

LIGHTER = 10  # times fewer sweeps do with the fictitious masses


@dataclass(frozen=True)
class Level:
    """What one run gave at the n samples, and how far it is off."""

    samples: Mapping[str, Samples]
    accelerations: Poses
    acts: Acts  # (n, press forces)
    residuals: Mapping[str, float]


class PymunkSimulation:
    """One run for each level. Where nobody asks for forces, they have fictitious masses and fewer sweeps."""

    def __init__(self, scene: Scene, settings: PymunkSettings, sampling: Sampling) -> None:
        self._scene, self._sampling = scene, sampling
        self._loaded = asks_forces(scene) and not settings.fictitious
        masses = ballasted_masses if self._loaded else fictitious_masses
        self._linkage = Linkage(scene, own_masses if settings.extra == "motor" else masses)
        spared = not (self._loaded or settings.fictitious or settings.extra == "motor")
        iterations = ceil(settings.iterations / LIGHTER) if spared else settings.iterations

        pose = start(self._linkage)
        self._branch = branch(self._linkage.jacobian(pose))
        self._stroke_ends = stroke_ends(self._linkage, pose)
        stride = ceil(settings.steps / sampling.samples)
        self._runs = [
            Run(
                self._linkage,
                pose,
                self._stroke_ends,
                sampling,
                stride * 2**level,
                iterations,
                settings,
                loaded=self._loaded,
            )
            for level in range(settings.levels)
        ]
        self.residuals: dict[str, float] = {}

    @property
    def counters(self) -> Mapping[str, int]:
        """Steps of all runs, sweeps times constraints in them, and what each step goes over."""
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
        """Check each run and return the extrapolated channels.

        Raises:
            Failure: nonfinite, wrong_branch, diverged or not_converged, with the drive's position where it happened.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            levels = [self._read(run) for run in self._runs]
        self.residuals = {name: max(level.residuals[name] for level in levels) for name in levels[0].residuals}
        positions = self._sampling.commanded(self._scene)
        self.residuals |= check_levels(self._linkage, positions, [level.accelerations for level in levels])
        samples = {name: _richardson([level.samples[name] for level in levels]) for name in levels[0].samples}
        # Where the levels have a press force now on and now off, no limit can be told from them.
        finest = levels[-1]
        switched = np.any([level.acts != finest.acts for level in levels], axis=(0, 2))
        for name in force_channels(self._scene):
            if name in samples:
                samples[name][switched] = finest.samples[name][switched]
        return Motion({"time": self._sampling.times(self._scene)} | samples)

    def _read(self, run: Run) -> Level:
        linkage, path = self._linkage, run.path
        residuals, unsolved = check_path(linkage, path, self._branch)
        accelerations = np.diff(run.record[..., 3:], axis=0) / run.dt
        sampled = slice(None, None, run.stride)
        q, a = path.q[sampled], accelerations[sampled]
        v = path.v[sampled] - run.dt / 2 * a
        samples = motion_channels(linkage, q, v, a)
        acts = run.acts
        if asks_forces(self._scene):
            if not self._loaded:
                acts = self._acting(q, v)
            reactions = reaction_channels(linkage, q, v, a, acts)
            samples |= {name: reactions[name] for name in channels(self._scene) if name in reactions}
        check_finite(self._scene, samples)
        residuals |= check_convergence(linkage, path, accelerations, unsolved)
        if run.joints:
            expected = joint_forces(linkage, q, v, a, reactions, run.joints)
            residuals |= check_impulses(linkage, path.positions[sampled], expected, run.impulses / run.dt)
        return Level(samples, a, acts, residuals)

    def _acting(self, q: Poses, v: Poses) -> Acts:
        """Return, for the n samples, which press forces act, shape (n, press forces)."""
        (z, turn), (velocity, _) = planes(with_ground(q)), planes(with_ground(v))
        found = acting(self._linkage, z.T, turn.T, velocity.T, self._stroke_ends)
        return np.array(found, dtype=np.bool_).reshape(len(found), len(q)).T


def _richardson(values: Sequence[Samples]) -> Samples:
    """Return the limit dt -> 0 of up to four arrays with errors in dt^2, dt^3 and dt^4, at dt, dt/2, dt/4 and dt/8."""
    for factor in (4, 8, 16)[: len(values) - 1]:
        values = [(factor * fine - coarse) / (factor - 1) for coarse, fine in pairwise(values)]
    return values[0]
