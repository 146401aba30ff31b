"""What can go wrong in a pymunk run without an error of its own, looked for in every step, not only at the samples."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene, Status
from scenes.engine import ESTIMATE
from scenes.motion import Samples

from .constraints import Linkage, Poses, branch, solved

# Rad of a crank, or by a slider's travel; the driven body is moved, not simulated, so only rounding adds up.
LARGEST_DRIFT = 1e-6
# Of the crank's radius, or of half a slider's travel; the curvature of a step opens joints, by 0.004 at 5 deg in the
# toggle press.
LARGEST_GAP = 0.05
# Of a channel's peak: of one level, and of what is extrapolated, and so meant to be good to a per cent.
LARGEST_ERROR, LARGEST_EXTRAPOLATED_ERROR = 0.1, 0.01
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
    known = np.all(np.isfinite(path.q) & np.isfinite(path.v), axis=(1, 2))
    _require(scene, known, positions, Status.nonfinite, "a pose or velocity is not finite")

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


def solver_error(linkage: Linkage, accelerations: Poses, unsolved: Poses) -> dict[str, float]:
    """Return what the sweeps left unsolved, by the largest acceleration; both have shape (n, bodies, 3)."""
    return {"solver": float(_sizes(linkage, unsolved).max() / _sizes(linkage, accelerations - unsolved).max())}


def finite(channels: Mapping[str, Samples]) -> NDArray[np.bool_]:
    """Return where all channels are finite, shape (n,)."""
    found: NDArray[np.bool_] = np.all(np.isfinite([*channels.values()]), axis=0)
    return found


def check_finite(scene: Scene, channels: Mapping[str, Samples]) -> None:
    """Raise a Failure, nonfinite, with the first position of the drive where a channel is not finite."""
    _require(scene, finite(channels), channels[scene.drive_channel], Status.nonfinite, "a result is not finite")


def check_closed(scene: Scene, positions: Samples, error: Samples, largest: float) -> dict[str, float]:
    """Return the largest of the channels' errors, shape (n,), which are to be no larger than `largest` anywhere.

    Raises:
        Failure: not_converged, too far.
    """
    sentence = f"the constraints contradict the result by over {largest:.0%} of its peak"
    _require(scene, error <= largest, positions, Status.not_converged, sentence)
    return {ESTIMATE: float(error.max())}


def check_impulses(linkage: Linkage, positions: Samples, expected: Samples, found: Samples) -> dict[str, float]:
    """Return how far the joints' forces are from the engine's own, both of shape (n, joints), N, by the largest.

    Raises:
        Failure: not_converged, forces that are not those of the engine.
    """
    mismatch = np.abs(expected - found).max(axis=1) / (expected.max() or 1.0)
    sentence = "the reactions are not the engine's impulses"
    _require(linkage.scene, mismatch <= LARGEST_MISMATCH, positions, Status.not_converged, sentence)
    return {"impulses": float(mismatch.max())}


def level_change(linkage: Linkage, accelerations: Sequence[Poses]) -> dict[str, float]:
    """Return how far those of the two finest levels are apart, by the largest; nothing for one level."""
    if len(accelerations) == 1:
        return {}
    coarse, fine = accelerations[-2:]
    return {"level_change": float(_sizes(linkage, fine - coarse).max() / _sizes(linkage, fine).max())}


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
    unsolved = solved(J, residual)
    gap = np.abs(C[:, :-1])
    gap[:, 2 * len(linkage.scene.pins) + 1 :: 2] *= linkage.size  # the sliders' angles count as gaps at the far end
    return branch(J), np.abs(C[:, -1]), gap.max(axis=1), unsolved
