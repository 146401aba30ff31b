"""What can go wrong in a pymunk run without an error of its own, looked for in every step, not only at the samples."""

from collections.abc import Mapping, Sequence
from math import ceil, degrees

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Status
from scenes.motion import Samples

from .pymunk_linkage import Linkage, Poses, branch
from .pymunk_run import Run

LARGEST_DRIFT = 1e-6  # rad; the crank is turned, not simulated, so only rounding adds up
LARGEST_GAP = 0.05  # of the crank's radius; the curvature of a step opens joints, by 0.004 at 5 deg in the toggle press
# Of the largest acceleration. Enough sweeps bring the first to zero whatever the step; measured, the accelerations are
# off by a third of it. The second is what the extrapolation starts from.
LARGEST_SOLVER_ERROR = 0.1
LARGEST_LEVEL_CHANGE = 0.1
LARGEST_MISMATCH = 1e-6  # of the largest reaction; the two sides differ by nothing but rounding
CHUNK = 1000  # steps whose Jacobians are in memory at a time


def check_path(linkage: Linkage, run: Run, start_branch: Samples) -> tuple[dict[str, float], Samples]:
    """Return how far the run is off its path, relative, and the acceleration that the sweeps left unsolved.

    That is J^-1 (J v + C / dt) / dt, shape (steps + 1, bodies, 3), m/s^2 and rad/s^2: near a lock, where J is nearly
    singular, a small residual of the constraints is a large error of the motion.

    Raises:
        Failure: nonfinite; wrong_branch, the sign of det J is no longer `start_branch`; diverged, the crank drifts or a
            joint gapes.
    """
    q, v, angles = run.record[1:, :, :3], run.record[1:, :, 3:], run.crank_angles
    finite = np.all(np.isfinite(run.record[1:]), axis=(1, 2))
    _require(finite, angles, Status.nonfinite, "a pose or velocity is not finite")

    chunks = np.array_split(np.arange(len(q)), ceil(len(q) / CHUNK))
    measures = [_measure(linkage, q[rows], v[rows], angles[rows], run.dt) for rows in chunks]
    branches, drift, gap, unsolved = (np.concatenate(parts) for parts in zip(*measures, strict=True))
    gap /= max(map(abs, linkage.members[linkage.scene.drive.body].arms.values()))

    _require(branches == start_branch, angles, Status.wrong_branch, "the linkage flips to another assembly branch")
    _require(drift <= LARGEST_DRIFT, angles, Status.diverged, "the crank is not where the drive turns it")
    gaping = f"a joint gapes by over {LARGEST_GAP:.0%} of the crank's radius"
    _require(gap <= LARGEST_GAP, angles, Status.diverged, gaping)
    return {"drive_angle": float(drift.max()), "joint_gap": float(gap.max())}, unsolved


def check_convergence(linkage: Linkage, run: Run, channels: Mapping[str, Samples], unsolved: Poses) -> dict[str, float]:
    """Return the solver's error, by the largest acceleration, and how far the reactions are from the engine's impulses.

    Raises:
        Failure: nonfinite; not_converged, too few sweeps, or forces that are not those of the engine.
    """
    sampled = run.crank_angles[:: run.stride]
    finite = np.all(np.isfinite([*channels.values()]), axis=0)
    _require(finite, sampled, Status.nonfinite, "a result is not finite")

    size = np.array([1.0, 1.0, linkage.size])  # angular accelerations count as those of the linkage's far end
    solved = np.diff(run.record[..., 3:], axis=0) / run.dt - unsolved
    solver_error = np.abs(unsolved * size).max(axis=(1, 2)) / np.abs(solved * size).max()
    sentence = f"the sweeps leave over {LARGEST_SOLVER_ERROR:.0%} of the largest acceleration unsolved"
    _require(solver_error <= LARGEST_SOLVER_ERROR, run.crank_angles, Status.not_converged, sentence)
    residuals = {"solver": float(solver_error.max())}

    if linkage.scene.has_masses and run.joints:
        own = run.impulses / run.dt
        rebuilt = np.stack([_size(channels, joint) for joint in run.joints], axis=1)
        mismatch = np.abs(rebuilt - own).max(axis=1) / own.max()
        different = "the reactions are not the engine's impulses"
        _require(mismatch <= LARGEST_MISMATCH, sampled, Status.not_converged, different)
        residuals["impulses"] = float(mismatch.max())
    return residuals


def check_levels(linkage: Linkage, levels: Sequence[Mapping[str, Samples]]) -> dict[str, float]:
    """Return how far the accelerations of the two finest levels are apart, by the largest; nothing for one level.

    Raises:
        Failure: not_converged, too far for an extrapolation.
    """
    if len(levels) == 1:
        return {}
    coarse, fine = (
        [level[f"{p}.{q}"] for p in linkage.scene.moving_points for q in ("ax", "ay")] for level in levels[-2:]
    )
    change = np.abs(np.subtract(fine, coarse)).max(axis=0) / np.abs(fine).max()
    sentence = f"the accelerations change by over {LARGEST_LEVEL_CHANGE:.0%} of the largest with the step"
    _require(change <= LARGEST_LEVEL_CHANGE, levels[0]["crank_angle"], Status.not_converged, sentence)
    return {"level_change": float(change.max())}


def _require(fine: NDArray[np.bool_], crank_angles: Samples, status: Status, sentence: str) -> None:
    """Raise a Failure that names the first crank angle, rad, where it is not fine; both have shape (n,)."""
    first = int(np.argmin(fine))
    if not fine[first]:
        raise Failure(status, f"{sentence} at a crank angle of {degrees(crank_angles[first]):.1f} deg")


def _measure(linkage: Linkage, q: Samples, v: Samples, angles: Samples, dt: float) -> tuple[Samples, ...]:
    """Return, for n steps, the sign of det J, |C| of the drive, the largest |C| of the joints, what is unsolved."""
    J, C = linkage.jacobian(q), linkage.gaps(q, angles)
    residual = (np.einsum("nij,nj->ni", J, v.reshape(len(v), -1)) + C / dt) / dt
    residual[:, -1] = 0  # the crank is turned, not solved
    unsolved = np.linalg.solve(J, residual[..., None]).reshape(q.shape)
    return branch(J), np.abs(C[:, -1]), np.abs(C[:, :-1]).max(axis=1), unsolved


def _size(channels: Mapping[str, Samples], joint: str) -> Samples:
    """Return the size of a guide's or a pin's force, shape (n,), N."""
    if joint in channels:
        return np.abs(channels[joint])
    return np.hypot(channels[f"{joint}.fx"], channels[f"{joint}.fy"])
