"""By how much a linkage that cannot be assembled fails to close: the joint that stays open when all others close."""

from collections.abc import Iterable
from functools import partial

import numpy as np

from scenes.open_joint import open_joint

from .equations import Equations
from .system import Array, ExudynSystem


def misfit(system: ExudynSystem, equations: Equations, q: Array, positions: Iterable[float]) -> str:
    """Return which joint stays open, near a pose q, at the first position of the drive where one does, or nothing."""
    scene = system.scene
    joints = {f"the guide of {name}": system.columns(slide)[:1] for name, slide in system.slides.items()}
    joints |= {name: system.columns(pin) for name, pin in system.pins.items()}
    units = np.tile([system.size, system.size, 1.0], len(q) // 3)

    def gaps(at: Array, position: float) -> Array:
        return equations.residual(at, position)

    for position in positions:
        found = partial(gaps, position=position)
        joint, gap = open_joint(found, equations.jacobian, q, units, joints, system.size)
        if gap:
            return f"; with all else closed {joint} stays open by {scene.length(gap)} at {scene.where(position)}"
    return ""
