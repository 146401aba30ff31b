"""By how much a linkage that cannot be assembled fails to close: the joint that stays open when all others close.

A sentence for the user, so in doubles.
"""

from collections.abc import Iterable
from functools import partial
from typing import TypeAlias

import numpy as np
from flint import arb_mat
from numpy.typing import NDArray

from scenes.open_joint import open_joint

from .constraints import LinkageEquations

Array: TypeAlias = NDArray[np.float64]


def misfit(linkage: LinkageEquations, q: arb_mat, positions: Iterable[float]) -> str:
    """Return which joint stays open, near a pose q, at the first position of the drive where one does, or nothing."""
    scene = linkage.scene
    sliders = [body.name for body in scene.bodies.values() if body.slide is not None]
    joints = {f"the guide of {name}": [2 * row] for row, name in enumerate(sliders, start=len(scene.pins))}
    joints |= {pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(scene.pins)}
    rows, units = linkage.constraints, np.array(linkage.units)

    def pose(at: Array) -> arb_mat:
        return arb_mat([[value] for value in at.tolist()])

    def gaps(at: Array, position: float) -> Array:
        return np.array([float(gap) for gap in (rows.value(pose(at)) - linkage.drive(position)).entries()])

    def jacobian(at: Array) -> Array:
        return np.array(rows.jacobian(pose(at)).tolist(), dtype=float)

    start = np.array([float(value) for value in q.entries()])
    for position in positions:
        joint, gap = open_joint(partial(gaps, position=position), jacobian, start, units, joints, linkage.size)
        if gap:
            return f"; with all else closed {joint} stays open by {scene.length(gap)} at {scene.where(position)}"
    return ""
