"""What can go wrong in a pymunk run without an error of its own, looked for in every step, not only at the samples."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene, Status
from scenes.motion import Samples

from .pymunk_linkage import Linkage, Poses, branch

# Rad of a crank, or by a slider's travel; the driven body is moved, not simulated, so only rounding adds up.
LARGEST_DRIFT = 1e-6
# Of the crank's radius, or of half a slider's travel; the curvature of a step opens joints, by 0.004 at 5 deg in the
# toggle press.
LARGEST_GAP = 0.05
# Of the largest acceleration. Enough sweeps bring the first to zero whatever the step; measured, the accelerations are
# off by a third of it. The second is what the extrapolation starts from.
LARGEST_SOLVER_ERROR = 0.1
LARGEST_LEVEL_CHANGE = 0.1
LARGEST_MISMATCH = 1e-6  # of the largest reaction; the two sides differ by nothing but rounding
CHUNK = 1000  # steps whose Jacobians are in memory at a time


@dataclass(frozen=True)
class Path:
    """Poses q and rates v after n steps, where the drive was to be, and how much of an error each step corrects."""

    q: Poses
    v: Poses
    positions: Samples
    dt: float  # s
    correction: float  # of the whole error, 0 to 1


def check_path(linkage: Linkage, path: Path, start_branch: Samples) -> tuple[dict[str, float], Poses]:
    """Return how far a run is off its path, relative, and the acceleration that the sweeps left unsolved.

    That is J^-1 (J v + correction C / dt) / dt, shape (n, bodies, 3), m/s^2 and rad/s^2: near a lock, where J is nearly
    singular, a small residual of the constraints is a large error of the motion.

    Raises:
        Failure: nonfinite; wrong_branch, the sign of det J is no longer `start_branch`; diverged, the driven body
            drifts or a joint gapes.
    """
    scene, positions = linkage.scene, path.positions
    finite = np.all(np.isfinite(path.q) & np.isfinite(path.v), axis=(1, 2))
    _require(scene, finite, positions, Status.nonfinite, "a pose or velocity is not finite")

    chunks = np.array_split(np.arange(len(positions)), ceil(len(positions) / CHUNK))
    measures = [_measure(linkage, path, rows) for rows in chunks]
    branches, drift, gap, unsolved = (np.concatenate(parts) for parts in zip(*measures, strict=True))
    driven = linkage.members[scene.drive.body]
    if scene.driven_slide is None:
        gap /= max(map(abs, driven.arms.values())) or linkage.size  # it may have its pivot alone
        gaping = f"a joint gapes by over {LARGEST_GAP:.0%} of the crank's radius"
    else:
        low, high = scene.drive.extent
        drift /= high - low
        gap /= (high - low) / 2
        gaping = f"a joint gapes by over {LARGEST_GAP:.0%} of half the drive's travel"

    _require(scene, branches == start_branch, positions, Status.wrong_branch, "the linkage flips to another branch")
    if driven.prescribed:
        drifting = f"'{scene.drive.body}' is not where the drive takes it"
        _require(scene, drift <= LARGEST_DRIFT, positions, Status.diverged, drifting)
    _require(scene, gap <= LARGEST_GAP, positions, Status.diverged, gaping)
    return {"drive": float(drift.max()), "joint_gap": float(gap.max())}, unsolved


def check_convergence(linkage: Linkage, path: Path, accelerations: Poses, unsolved: Poses) -> dict[str, float]:
    """Return the solver's error, by the largest acceleration; all have shape (n, bodies, 3).

    Raises:
        Failure: not_converged, too few sweeps.
    """
    solver_error = _sizes(linkage, unsolved).max(axis=(1, 2)) / _sizes(linkage, accelerations - unsolved).max()
    sentence = f"the sweeps leave over {LARGEST_SOLVER_ERROR:.0%} of the largest acceleration unsolved"
    _require(linkage.scene, solver_error <= LARGEST_SOLVER_ERROR, path.positions, Status.not_converged, sentence)
    return {"solver": float(solver_error.max())}


def check_finite(scene: Scene, channels: Mapping[str, Samples]) -> None:
    """Raise a Failure, nonfinite, with the first position of the drive where a channel is not finite."""
    finite = np.all(np.isfinite([*channels.values()]), axis=0)
    _require(scene, finite, channels[scene.drive_channel], Status.nonfinite, "a result is not finite")


def check_impulses(linkage: Linkage, positions: Samples, expected: Samples, found: Samples) -> dict[str, float]:
    """Return how far the joints' forces are from the engine's own, both of shape (n, joints), N, by the largest.

    Raises:
        Failure: not_converged, forces that are not those of the engine.
    """
    mismatch = np.abs(expected - found).max(axis=1) / (expected.max() or 1.0)
    sentence = "the reactions are not the engine's impulses"
    _require(linkage.scene, mismatch <= LARGEST_MISMATCH, positions, Status.not_converged, sentence)
    return {"impulses": float(mismatch.max())}


def check_levels(linkage: Linkage, positions: Samples, accelerations: Sequence[Poses]) -> dict[str, float]:
    """Return how far those of the two finest levels are apart, by the largest; nothing for one level.

    Raises:
        Failure: not_converged, too far for an extrapolation.
    """
    if len(accelerations) == 1:
        return {}
    coarse, fine = accelerations[-2:]
    change = _sizes(linkage, fine - coarse).max(axis=(1, 2)) / _sizes(linkage, fine).max()
    sentence = f"the accelerations change by over {LARGEST_LEVEL_CHANGE:.0%} of the largest with the step"
    _require(linkage.scene, change <= LARGEST_LEVEL_CHANGE, positions, Status.not_converged, sentence)
    return {"level_change": float(change.max())}


def _sizes(linkage: Linkage, accelerations: Poses) -> Poses:
    """Return |accelerations|; angular ones count as those of the linkage's far end."""
    sizes: Poses = np.abs(accelerations * [1.0, 1.0, linkage.size])
    return sizes


def _require(scene: Scene, fine: NDArray[np.bool_], positions: Samples, status: Status, sentence: str) -> None:
    """Raise a Failure that names the first position of the drive where it is not fine; both have shape (n,)."""
    first = int(np.argmin(fine))
    if not fine[first]:
        raise Failure(status, f"{sentence} at {scene.where(positions[first])}")


def _measure(linkage: Linkage, path: Path, rows: NDArray[np.intp]) -> tuple[Samples, ...]:
    """Return, for some steps, the sign of det J, |C| of the drive, the largest |C| of the joints, what is unsolved."""
    q, v = path.q[rows], path.v[rows]
    J, C = linkage.jacobian(q), linkage.gaps(q, path.positions[rows])
    residual = (np.einsum("nij,nj->ni", J, v.reshape(len(v), -1)) + path.correction * C / path.dt) / path.dt
    residual[:, -1] = 0  # the driven body is moved, not solved
    unsolved = np.linalg.solve(J, residual[..., None]).reshape(q.shape)
    gap = np.abs(C[:, :-1])
    gap[:, 2 * len(linkage.scene.pins) + 1 :: 2] *= linkage.size  # the sliders' angles count as gaps at the far end
    return branch(J), np.abs(C[:, -1]), gap.max(axis=1), unsolved
