"""By how much a group that cannot be assembled fails to close: the joint that stays open when all others close."""

import numpy as np

from scenes import Scene
from scenes.model.motion import Samples
from scenes.model.open_joint import open_joint

from .core.decomposition import Dyad, guides_cross
from .core.group_equations import FramePoses, Group, GroupEquations
from .core.newton_group import own_jacobian


def of_dyad(scene: Scene, dyad: Dyad, to_lock: float) -> str:
    """Return how far apart the legs end, by the distance beyond the singular pose, m; nothing of crossing guides."""
    one, two = (leg.body for leg in dyad.legs)
    return "" if guides_cross(dyad) else f": {one} and {two} end {scene.length(abs(to_lock))} apart"


def of_group(scene: Scene, group: Group, equations: GroupEquations, q: Samples, placed: FramePoses) -> str:
    """Return which joint of a larger group stays open, near coordinates q, shape (1, m), or nothing."""
    pins = len(group.pins)
    joints = {f"the guide of {slide.slider}": [2 * pins + row] for row, slide in enumerate(group.slides)}
    joints |= {pin.point: [row, pins + row] for row, pin in enumerate(group.pins)}
    units = np.tile([equations.size, equations.size, 1.0], equations.bodies)

    def pose(q: Samples) -> FramePoses:
        return equations.pose(q[np.newaxis], placed)

    joint, gap = open_joint(
        lambda q: equations.open(pose(q))[0],
        lambda q: own_jacobian(equations, pose(q))[0],
        *(q[0], units, joints, equations.size),
    )
    return f": with all else closed {joint} stays open by {scene.length(gap)}" if gap else ""
