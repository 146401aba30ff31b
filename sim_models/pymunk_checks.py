"""What can go wrong in a pymunk run without an error of its own, looked for in every step, not only at the samples."""

from collections.abc import Mapping
from math import ceil, degrees

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Status
from scenes.motion import Samples

from .pymunk_linkage import Linkage, branch
from .pymunk_run import Run

LARGEST_DRIFT = 1e-6  # rad; the crank is turned, not simulated, so only rounding adds up
LARGEST_GAP = 0.05  # of the crank's radius; the curvature of a step opens joints, by 0.004 at 5 deg in the toggle press
LARGEST_SOLVER_ERROR = 0.03  # of the largest acceleration; as much as steps of 5 deg put in by themselves
LARGEST_MISMATCH = 1e-6  # of the largest reaction; the two sides differ by nothing but rounding
CHUNK = 1000  # steps whose Jacobians are in memory at a time


def check_path(linkage: Linkage, run: Run, start_branch: Samples) -> tuple[dict[str, float], Samples]:
    """Return how far the run is off its path, relative, and the solver error |J v + C / dt| / dt, (steps + 1,), m/s^2.

    Raises:
        Failure: nonfinite; wrong_branch, the sign of det J is no longer `start_branch`; diverged, the crank drifts or a
            joint gapes.
    """
    q, v, angles = run.record[1:, :, :3], run.record[1:, :, 3:], run.crank_angles
    finite = np.all(np.isfinite(run.record[1:]), axis=(1, 2))
    _require(finite, angles, Status.nonfinite, "a pose or velocity is not finite")

    chunks = np.array_split(np.arange(len(q)), ceil(len(q) / CHUNK))
    measures = [_measure(linkage, q[rows], v[rows], angles[rows], run.dt) for rows in chunks]
    branches, drift, gap, solver_error = (np.concatenate(parts) for parts in zip(*measures, strict=True))
    gap /= max(map(abs, linkage.members[linkage.scene.drive.body].arms.values()))

    _require(branches == start_branch, angles, Status.wrong_branch, "the linkage flips to another assembly branch")
    _require(drift <= LARGEST_DRIFT, angles, Status.diverged, "the crank is not where the drive turns it")
    gaping = f"a joint gapes by over {LARGEST_GAP:.0%} of the crank's radius"
    _require(gap <= LARGEST_GAP, angles, Status.diverged, gaping)
    return {"drive_angle": float(drift.max()), "joint_gap": float(gap.max())}, solver_error


def check_convergence(
    linkage: Linkage, run: Run, channels: Mapping[str, Samples], solver_error: Samples
) -> dict[str, float]:
    """Return the solver error, by the largest acceleration, and how far the reactions are from the engine's impulses.

    Raises:
        Failure: nonfinite; not_converged, too few sweeps, or forces that are not those of the engine.
    """
    sampled = run.crank_angles[:: run.stride]
    finite = np.all(np.isfinite([*channels.values()]), axis=0)
    _require(finite, sampled, Status.nonfinite, "a result is not finite")

    points = linkage.scene.moving_points
    solver_error = solver_error / max(np.hypot(channels[f"{p}.ax"], channels[f"{p}.ay"]).max() for p in points)
    unsolved = f"the sweeps leave over {LARGEST_SOLVER_ERROR:.0%} of the largest acceleration unsolved"
    _require(solver_error <= LARGEST_SOLVER_ERROR, run.crank_angles, Status.not_converged, unsolved)
    residuals = {"solver": float(solver_error.max())}

    if linkage.scene.has_masses and run.joints:
        own = run.impulses / run.dt
        rebuilt = np.stack([_size(channels, joint) for joint in run.joints], axis=1)
        mismatch = np.abs(rebuilt - own).max(axis=1) / own.max()
        different = "the reactions are not the engine's impulses"
        _require(mismatch <= LARGEST_MISMATCH, sampled, Status.not_converged, different)
        residuals["impulses"] = float(mismatch.max())
    return residuals


def _require(fine: NDArray[np.bool_], crank_angles: Samples, status: Status, sentence: str) -> None:
    """Raise a Failure that names the first crank angle, rad, where it is not fine; both have shape (n,)."""
    first = int(np.argmin(fine))
    if not fine[first]:
        raise Failure(status, f"{sentence} at a crank angle of {degrees(crank_angles[first]):.1f} deg")


def _measure(linkage: Linkage, q: Samples, v: Samples, angles: Samples, dt: float) -> tuple[Samples, ...]:
    """Return the sign of det J, |C| of the drive, the largest |C| and |J v + C / dt| / dt of the joints, (n,) each."""
    J, C = linkage.jacobian(q), linkage.gaps(q, angles)
    unsolved = (np.einsum("nij,nj->ni", J, v.reshape(len(v), -1)) + C / dt) / dt
    return branch(J), np.abs(C[:, -1]), np.abs(C[:, :-1]).max(axis=1), np.abs(unsolved[:, :-1]).max(axis=1)


def _size(channels: Mapping[str, Samples], joint: str) -> Samples:
    """Return the size of a guide's or a pin's force, shape (n,), N."""
    if joint in channels:
        return np.abs(channels[joint])
    return np.hypot(channels[f"{joint}.fx"], channels[f"{joint}.fy"])
