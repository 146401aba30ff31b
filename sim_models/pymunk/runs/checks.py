"""Checks of every step of a run, not only of the samples, for failures that pymunk does not report."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene, Status
from scenes.model.motion import Samples

from ..constraints import LinkageConstraints, PoseArray, blocks

# Rad of a crank, or by a slider's travel; the driven body's motion is prescribed, so only round-off adds up.
LARGEST_DRIFT = 1e-6
# Of the crank's radius, or of half a slider's travel; the curvature of a step opens joints, by 0.004 at 5 deg in the
# toggle press.
LARGEST_GAP = 0.05
LARGEST_MISMATCH = 1e-6  # of the largest reaction; the two sides differ by round-off


def check_path(linkage: LinkageConstraints, path: PoseArray, positions: Samples, start: Samples) -> dict[str, float]:
    """The drift of the drive and the largest opening of a joint, relative.

    `path` are the poses and rates after n steps, shape (n, bodies, 6), `positions` those of the drive, shape (n,).

    Raises:
        Failure: nonfinite; wrong_branch, the sign of det J is no longer that of the `start`; diverged, the driven body
            drifts or a joint opens.
    """
    scene = linkage.scene
    known: NDArray[np.bool_] = np.all(np.isfinite(path), axis=(1, 2))
    _require(scene, known, positions, Status.nonfinite, "a pose or velocity is not finite")

    measures = [_measure(linkage, path[rows, :, :3], positions[rows]) for rows in blocks(path)]
    branches, drift, gap = (np.concatenate(parts) for parts in zip(*measures, strict=True))
    driven = linkage.members[scene.drive.body]
    if scene.driven_slide is None:
        gap /= max(map(abs, driven.points.values())) or linkage.size  # it may have its pivot alone
        opening = f"a joint opens by over {LARGEST_GAP:.0%} of the crank's radius"
    else:
        low, high = scene.drive.extent
        drift /= high - low
        gap /= (high - low) / 2
        opening = f"a joint opens by over {LARGEST_GAP:.0%} of half the drive's travel"

    _require(scene, branches == start, positions, Status.wrong_branch, "the linkage flips to another branch")
    if linkage.moved[scene.drive.body].prescribed:
        drifting = f"'{scene.drive.body}' is not where the drive takes it"
        _require(scene, drift <= LARGEST_DRIFT, positions, Status.diverged, drifting)
    _require(scene, gap <= LARGEST_GAP, positions, Status.diverged, opening)
    return {"drive": float(drift.max()), "joint_gap": float(gap.max())}


def check_finite(scene: Scene, channels: Mapping[str, Samples]) -> None:
    """Raise a Failure, nonfinite, with the first position of the drive where a channel is not finite."""
    known: NDArray[np.bool_] = np.all(np.isfinite([*channels.values()]), axis=0)
    _require(scene, known, channels[scene.drive_channel], Status.nonfinite, "a result is not finite")


def check_impulses(
    linkage: LinkageConstraints, positions: Samples, expected: Samples, own: Samples
) -> dict[str, float]:
    """How far the joints' forces are from the engine's own, both of shape (n, joints), N, by the largest.

    Raises:
        Failure: not_converged, forces that are not those of the engine.
    """
    mismatch = np.abs(expected - own).max(axis=1) / (expected.max() or 1.0)
    sentence = "the reactions are not the engine's impulses"
    _require(linkage.scene, mismatch <= LARGEST_MISMATCH, positions, Status.not_converged, sentence)
    return {"impulses": float(mismatch.max())}


def _require(scene: Scene, holds: NDArray[np.bool_], positions: Samples, status: Status, sentence: str) -> None:
    """Raise a Failure that names the first position of the drive where `holds` is false; both have shape (n,)."""
    first = int(np.argmin(holds))
    if not holds[first]:
        raise Failure(status, f"{sentence} at {scene.where(positions[first])}")


def _measure(linkage: LinkageConstraints, q: PoseArray, positions: Samples) -> tuple[Samples, ...]:
    """Return, for some steps, the sign of det J, |C| of the drive, the largest |C| of the joints."""
    C = np.abs(linkage.gaps(q, positions))
    C[:, 2 * len(linkage.scene.pins) + 1 : -1 : 2] *= linkage.size  # the sliders' angles count as gaps at the far end
    return linkage.branch(q), C[:, -1], C[:, :-1].max(axis=1)
