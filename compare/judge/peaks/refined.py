"""More samples of the reference where a quantity is largest or least, and where a press force comes or goes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Motion
from scenes.motion import Samples

from ...engines.reference import Reference
from .curves import LEAST, Curve

FINE, ROUNDS = 10, 3  # parts of a step on either side, time and again: to 1e-3 of the cycle's own steps


def refined(reference: Reference, found: Sequence[Curve]) -> Motion:
    """Return the reference's cycle with samples added, in the order of the time, as far as the linkage closes there."""
    drive, motion = reference.scene.drive, reference.cycle
    parts, step = [motion], float(motion["time"][1])
    for _ in range(ROUNDS):
        near = motion["time"][_places(reference, found, motion, step)]
        step /= FINE
        time = np.add.outer(near, step * np.arange(-FINE, FINE + 1)).ravel()
        time = np.unique(time % drive.cycle if drive.repeats else np.clip(time, 0.0, drive.cycle))
        try:
            motion = reference.at(drive.at(time).position, time)
        except Failure:
            break
        parts.append(motion)
    _, rows = np.unique(np.concatenate([part["time"] for part in parts]), return_index=True)
    return Motion({name: np.concatenate([part[name] for part in parts])[rows] for name in parts[0].samples})


def _places(reference: Reference, found: Sequence[Curve], motion: Motion, step: float) -> NDArray[np.intp]:
    """Return the samples where quantities are largest or least, and those on either side of a press force's switch."""
    rows = [row for curve in found for row in _extremes(curve, motion)]
    close = np.diff(motion["time"]) < 1.5 * step
    for act in reference.acts(motion):
        rows += np.flatnonzero(close & (act[0, 1:] != act[0, :-1])).tolist()
    return np.unique(rows)


def _extremes(curve: Curve, motion: Motion) -> list[int]:
    values = curve.values(motion)
    if curve.kind == "displacement":
        return [int(values.argmin()), int(values.argmax())]
    if curve.kind == "path":
        return [int(row) for part in (values.real, values.imag) for row in (part.argmin(), part.argmax())]
    sizes: Samples = np.abs(values)
    return [int(sizes.argmin() if curve.kind in LEAST else sizes.argmax())]
