"""By how much a linkage that cannot be assembled fails to close: the joint that stays open when all others close."""

from collections.abc import Iterable

import numpy as np

from .equations import Equations
from .system import Array, ExudynSystem

HEAVY = 1e3  # weight of what is held closed: it gives way by a millionth of the gap
OPEN = 1e-9  # of the linkage's size: a gap larger than what the least squares leave


def misfit(system: ExudynSystem, equations: Equations, q: Array, positions: Iterable[float]) -> str:
    """Return which joint stays open at the first position of the drive where one does, and by how much, or nothing.

    Near the pose q, shape (3 bodies,), all joints give way alike, then the worst of them alone, the last of
    equals.
    """
    scene = system.scene
    joints = {f"the guide of {name}": system.columns(slide)[:1] for name, slide in system.slides.items()}
    joints |= {name: system.columns(pin) for name, pin in system.pins.items()}
    for position in positions:
        gaps = _closest(system, equations, q, position, [*joints.values()])
        worst = max(reversed(joints), key=lambda joint: float(f"{np.linalg.norm(gaps[joints[joint]]):.2g}"))
        gap = float(np.linalg.norm(_closest(system, equations, q, position, [joints[worst]])[joints[worst]]))
        if gap > OPEN * system.size:
            where = scene.where(position)
            return f"; with all else closed {worst} stays open by {scene.length(gap)} at {where}"
    return ""


def _closest(system: ExudynSystem, equations: Equations, q: Array, position: float, give_way: list[list[int]]) -> Array:
    """Return C of least squares near q, shape (constraints,), where all rows but those that give way are closed."""
    from scipy.optimize import least_squares  # late: only a linkage that fails needs it

    units = np.tile([system.size, system.size, 1.0], len(system.bodies))
    weights = np.full(q.shape, HEAVY)
    weights[np.concatenate(give_way)] = 1.0
    found = least_squares(
        lambda x: weights * equations.residual(x * units, position),
        q / units,
        lambda x: weights[:, np.newaxis] * equations.jacobian(x * units) * units,
        method="lm",
    )
    return equations.residual(found.x * units, position)
