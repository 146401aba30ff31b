"""The runs of all levels, their extrapolation, and their checks."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from math import ceil

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Motion, ProcessorBudget, Request, Scene, Status
from scenes.channels import POWER
from scenes.model.constraints import blocks
from scenes.model.engine import equal_steps
from scenes.model.motion import Samples

from ..channels import Motions, joint_forces, reaction_channels, wanted_channels, with_rates_of_law
from ..constraints import LinkageConstraints
from ..friction import with_friction
from ..loads import applied, instants, stroke_ends
from ..masses import between_bodies, fictitious_masses, masses_of, own_masses
from ..planes import PoseArray
from ..settings import SECONDS, AnySettings, TextbookSettings
from ..start import assembles, begun, obstacle
from ..sweeps import enough_sweeps
from .motors import forces_with_motors
from .stepping import Integration, TextbookRun

# Rad of a crank, or by a slider's travel; the driven body's motion is prescribed, so only round-off adds up.
MAX_DRIFT = 1e-6
# Of the crank's radius, or of half a slider's travel; the curvature of a step opens joints, by 0.004 at 5 deg in the
# toggle press.
MAX_GAP = 0.05
MAX_MISMATCH = 1e-6  # of the largest reaction; the two sides differ by round-off
LIGHTER = 10  # times fewer sweeps do with the fictitious masses


class PymunkSimulation:
    """One run for each level from a consistent start; with fictitious masses and fewer sweeps without forces."""

    def __init__(self, scene: Scene, settings: AnySettings, request: Request) -> None:
        self._scene, self._sampling = scene, equal_steps(request)
        self._times = self._sampling.times(scene)
        self._stroke_ends: Sequence[float] = []
        if isinstance(settings, TextbookSettings):
            self._runs: Sequence[Integration | TextbookRun] = [TextbookRun(scene, self._sampling, settings)]
            self._linkage, self._q = begun(scene, own_masses)
        else:
            masses = masses_of(scene, settings, self._sampling)
            self._linkage, self._q = begun(scene, masses)
            self._stroke_ends = ends = stroke_ends(scene)
            if masses is fictitious_masses and not settings.fictitious:
                settings = replace(settings, iterations=ceil(settings.iterations / LIGHTER))
            if between_bodies(scene):
                settings = replace(settings, iterations=max(settings.iterations, enough_sweeps(scene)))
            strides = [ceil(settings.steps / self._sampling.samples) * 2**level for level in range(settings.levels)]
            self._runs = [Integration(scene, self._sampling, n, settings, ends) for n in strides]
        self._branch = self._linkage.branch(self._q)
        self._channels: Mapping[str, Samples] = {}
        self.residuals: dict[str, float] = {}

    @property
    def counters(self) -> Mapping[str, int]:
        """Steps of all runs, sweeps times constraints in them, and the size of the model."""
        first, *others = (run.counters for run in self._runs)
        added = ("steps", "constraint_iterations")
        return first | {name: first[name] + sum(run[name] for run in others) for name in added}

    def solve(self) -> None:
        """Step through the whole time, once for each level, and find the channels in the limit of the levels."""
        budget = ProcessorBudget(SECONDS, "")
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows ends as `nonfinite` in `read`
            for run in self._runs:
                budget.task = f"the run of {run.steps.count} steps and those before"
                run.advance(budget)
            runs = [run.motions for run in self._runs]
            motion = Motions(*(_richardson(values) for values in zip(*runs, strict=True)))
            if not self._scene.steady:
                motion = with_rates_of_law(self._linkage, self._times, motion)
            self._q, forces = motion.q, self._sampling.wants_forces(self._scene)
            self._channels = wanted_channels(self._linkage, self._times, motion, self._stroke_ends, forces=forces)
            if between_bodies(self._scene):  # that of the runs: it need not be linear in the coordinates
                position = _richardson([self._linkage.drive_position(run.q) for run in runs])
                self._channels = {**self._channels, self._scene.channels.drive.position: position}

    def read(self) -> Motion:
        """The channels, having checked each run; a Failure names the drive's position and has the motion with it."""
        wanted = [name for name in self._sampling.wanted(self._scene) if name in self._channels]
        channels = {name: np.ascontiguousarray(self._channels[name]) for name in wanted}  # not parts of larger arrays
        motion = Motion({"time": self._times} | channels)
        try:
            self.residuals = self._checked(motion.samples)
        except Failure as failure:
            raise Failure(failure.status, failure.reason, motion) from None
        return motion

    @np.errstate(over="ignore", invalid="ignore")
    def _checked(self, samples: Mapping[str, Samples]) -> dict[str, float]:
        """Find the largest residual of each check of the runs."""
        linkage, runs = self._linkage, self._runs
        try:
            residuals = [check_path(linkage, run.path, run.positions, self._branch) for run in runs]
            commanded = self._sampling.commanded(self._scene)
            if (power := self._channels.get(POWER)) is not None:
                _require(self._scene, power != -np.inf, commanded, Status.jammed, "friction holds the linkage")
            finite: NDArray[np.bool_] = np.all(np.isfinite([*samples.values()]), axis=0)
            _require(self._scene, finite, commanded, Status.nonfinite, "a result is not finite")
            residuals += [self._confirmed(run) for run in runs if isinstance(run, Integration) and run.joints]
        except Failure as failure:  # where bodies cannot be put together, pymunk opens joints, flips, or steps over it
            raise Failure(*(obstacle(self._scene) or (failure.status, failure.reason))) from None
        assembled = assembles(linkage, self._q, commanded)
        if not assembled and (found := obstacle(self._scene)):
            raise Failure(*found)
        names = dict.fromkeys(chain(*residuals))
        return {name: max(of_run[name] for of_run in residuals if name in of_run) for name in names}

    def _confirmed(self, run: Integration) -> dict[str, float]:
        """Find the residual of the forces that follow from a run's motion, against the engine's own."""
        motion = run.motions
        instant = instants(self._linkage, self._times, motion.q, run.rates)
        forces = applied(self._linkage, instant, run.active)
        reactions = reaction_channels(self._linkage, motion, forces)
        expected, found = joint_forces(self._linkage, motion, reactions, run.joints), run.impulses / run.steps.size
        residuals = check_impulses(self._linkage, run.positions[:: run.steps.stride], expected, found)
        return residuals | (self._rubbed(run, forces, reactions) if self._scene.friction else {})

    def _rubbed(self, run: Integration, forces: PoseArray, reactions: Mapping[str, Samples]) -> dict[str, float]:
        """Find how far the forces with friction are from those of the engine's own motors, by the largest.

        No run fails by it: where a joint hardly moves, it takes the motors more sweeps to give way than a step has.
        """
        motion = run.motions
        found = with_friction(self._linkage, self._times, motion.q, reactions)
        expected = joint_forces(self._linkage, motion, found, run.joints)
        measured, alike = forces_with_motors(self._linkage, run, forces, found)
        mismatch = np.abs(expected - measured)[alike].max(initial=0.0)
        return {"friction": float(mismatch / (expected[alike].max(initial=0.0) or 1.0))}


def _richardson(values: Sequence[PoseArray]) -> PoseArray:
    """Extrapolate up to four arrays with errors in dt^2, dt^3 and dt^4, at dt, dt/2, dt/4 and dt/8, to dt = 0."""
    # Neville's scheme: each pass cancels the leading power of dt, with the factor 2^2, 2^3, 2^4.
    for factor in (4, 8, 16)[: len(values) - 1]:
        values = [(factor * fine - coarse) / (factor - 1) for coarse, fine in pairwise(values)]
    return values[0]


# --- checks of every step of a run, not only of the samples, for failures that pymunk does not report ----------------


def check_path(linkage: LinkageConstraints, path: PoseArray, positions: Samples, start: Samples) -> dict[str, float]:
    """The drift of the drive and the largest opening of a joint, relative.

    `path` are the poses and rates after n steps, shape (n, bodies, 6), `positions` those of the drive, shape (n,).
    It raises Failure: nonfinite; wrong_branch, the sign of det J is no longer that of the `start`; diverged.
    """
    scene = linkage.scene
    known: NDArray[np.bool_] = np.all(np.isfinite(path), axis=(1, 2))
    _require(scene, known, positions, Status.nonfinite, "a pose or velocity is not finite")

    branches, drift, gap = np.empty((3, len(path)))
    for rows in blocks(path):
        q = path[rows, :, :3]
        C = np.abs(linkage.gaps(q, positions[rows]))
        # Rows alternate in guides, offset and angle: angles are turned into lengths by the linkage's size.
        C[:, 2 * len(scene.pins) + 1 : -1 : 2] *= linkage.size  # the sliders' angles count as gaps at the far end
        branches[rows], drift[rows], gap[rows] = linkage.branch(q), C[:, -1], C[:, :-1].max(axis=1)
    if linkage.drive.slide is None:
        radius = max(map(abs, linkage.members[linkage.drive.body].points.values()))
        gap, most = gap / (radius or linkage.size), "the crank's radius"  # it may have its pivot alone
    else:
        travel = linkage.drive.span
        drift, gap, most = drift / travel, gap / (travel / 2), "half the drive's travel"

    _require(scene, branches == start, positions, Status.wrong_branch, "the linkage flips to another branch")
    if linkage.moved[linkage.drive.body].prescribed or between_bodies(scene):
        drifting = f"'{linkage.drive.body}' is not where the drive takes it"
        _require(scene, drift <= MAX_DRIFT, positions, Status.diverged, drifting)
    opening = f"a joint opens by over {MAX_GAP:.0%} of {most}"
    _require(scene, gap <= MAX_GAP, positions, Status.diverged, opening)
    return {"drive": float(drift.max()), "joint_gap": float(gap.max())}


def check_impulses(
    linkage: LinkageConstraints, positions: Samples, expected: Samples, found: Samples
) -> dict[str, float]:
    """How far the joints' forces are from the engine's own, both of shape (n, joints), N, by the largest."""
    mismatch = np.abs(expected - found).max(axis=1) / (expected.max() or 1.0)
    sentence = "the reactions are not the engine's impulses"
    _require(linkage.scene, mismatch <= MAX_MISMATCH, positions, Status.not_converged, sentence)
    return {"impulses": float(mismatch.max())}


def _require(scene: Scene, holds: NDArray[np.bool_], positions: Samples, status: Status, sentence: str) -> None:
    """Raise a Failure that names the first position of the drive where `holds` is false; both have shape (n,)."""
    first = int(np.argmin(holds))
    if not holds[first]:
        raise Failure(status, f"{sentence} at {scene.where(positions[first])}")
