"""By how much a linkage that cannot be assembled fails to close: the joint that stays open when all others close."""

from collections.abc import Iterable
from functools import partial

import numpy as np

from scenes.motion import Samples
from scenes.open_joint import open_joint

from .constraints import LinkageConstraints, Poses


def misfit(linkage: LinkageConstraints, q: Poses, positions: Iterable[float]) -> str:
    """Return which joint stays open, near a pose q, at the first position of the drive where one does, or nothing."""
    scene = linkage.scene
    joints = {f"the guide of {name}": [2 * row] for row, name in enumerate(linkage.slides, start=len(scene.pins))}
    joints |= {pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(scene.pins)}
    units = np.tile([linkage.size, linkage.size, 1.0], q.shape[1])

    def gaps(at: Samples, position: float) -> Samples:
        return np.asarray(linkage.gaps(at.reshape(q.shape), np.array([position]))[0])

    def jacobian(at: Samples) -> Samples:
        return np.asarray(linkage.jacobian(at.reshape(q.shape))[0])

    for position in positions:
        joint, gap = open_joint(partial(gaps, position=position), jacobian, q.ravel(), units, joints, linkage.size)
        if gap:
            return f"; with all else closed {joint} stays open by {scene.length(gap)} at {scene.where(position)}"
    return ""
