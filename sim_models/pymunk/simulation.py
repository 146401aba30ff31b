"""The runs of all levels, and what follows from them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np

from scenes import Failure, Motion, Request, Scene
from scenes.engine import equal_steps
from scenes.motion import Samples, force_channels

from .channels import found_channels, joint_forces
from .checks import check_finite, check_impulses, check_path
from .constraints import Linkage, Poses, branch, planes, with_ground
from .loads import Active, active_presses
from .masses import ballasted_masses, fictitious_masses, own_masses
from .settings import PymunkSettings
from .start import start
from .stepping import Run
from .stroke import stroke_ends

LIGHTER = 10  # times fewer sweeps do with the fictitious masses


@dataclass(frozen=True)
class Level:
    """What one run gave at the n samples: poses, rates, accelerations, and the channels that follow from them.

    These are those asked for, and where there are forces among them, all forces.
    """

    run: Run
    q: Poses
    v: Poses
    a: Poses
    acts: Active  # (n, press forces)
    samples: Mapping[str, Samples]


def loaded(scene: Scene, settings: PymunkSettings, request: Request) -> bool:
    """Return whether forces act on the bodies; where nobody asks for any, the drive alone moves fictitious masses."""
    return request.wants_forces(scene) and not settings.fictitious


def linkage_of(scene: Scene, settings: PymunkSettings, request: Request) -> Linkage:
    """Return the linkage with the masses that these settings give it.

    Raises:
        Failure: unsupported, cannot_assemble; see `Linkage`.
    """
    masses = ballasted_masses if loaded(scene, settings, request) else fictitious_masses
    return Linkage(scene, own_masses if settings.extra == "motor" else masses)


class PymunkSimulation:
    """One run for each level. Where nobody asks for forces, they have fictitious masses and fewer sweeps."""

    def __init__(self, scene: Scene, settings: PymunkSettings, request: Request) -> None:
        sampling = equal_steps(request)
        self._scene, self._sampling = scene, sampling
        self._wanted = frozenset(request.wanted(scene))
        self._loaded = loaded(scene, settings, request)
        self._linkage = linkage_of(scene, settings, request)
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
        """Return the extrapolated channels, having checked each run, and what follows from them all.

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

    def _level(self, run: Run) -> Level:
        before, after = run.record[: -1 : run.stride], run.record[1 :: run.stride]
        q, a = after[..., :3], (after[..., 3:] - before[..., 3:]) / run.dt
        v = after[..., 3:] - run.dt / 2 * a
        acts = run.acts if self._loaded else self._acting(q, v)
        return Level(run, q, v, a, acts, found_channels(self._linkage, self._wanted, q, v, a, acts))

    def _extrapolated(self, levels: Sequence[Level]) -> dict[str, Samples]:
        asked = [name for name in self._sampling.wanted(self._scene) if name in levels[0].samples]
        samples = {name: _richardson([level.samples[name] for level in levels]) for name in asked}
        # Where the levels have a press force now on and now off, no limit can be told from them.
        finest = levels[-1]
        switched = np.any([level.acts != finest.acts for level in levels], axis=(0, 2))
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
            residuals |= check_impulses(linkage, run.positions[:: run.stride], expected, run.impulses / run.dt)
        return residuals

    def _acting(self, q: Poses, v: Poses) -> Active:
        """Return, for the n samples, which press forces act, shape (n, press forces)."""
        (z, turn), (velocity, _) = planes(with_ground(q)), planes(with_ground(v))
        found = active_presses(self._linkage, z.T, turn.T, velocity.T, self._stroke_ends)
        return np.array(found, dtype=np.bool_).reshape(len(found), len(q)).T


def _richardson(values: Sequence[Samples]) -> Samples:
    """Return the limit dt -> 0 of up to four arrays with errors in dt^2, dt^3 and dt^4, at dt, dt/2, dt/4 and dt/8."""
    for factor in (4, 8, 16)[: len(values) - 1]:
        values = [(factor * fine - coarse) / (factor - 1) for coarse, fine in pairwise(values)]
    return values[0]
