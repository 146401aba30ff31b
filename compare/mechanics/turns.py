"""How often springs that twist have turned: whole turns of their angle count, and no pose shows them."""

from functools import lru_cache
from math import ceil, pi

import numpy as np

from scenes import Failure, Scene
from scenes.model.motion import Samples
from scenes.scene import TorsionSpring

from ..engines import registry
from .motion_vectors import MotionVectors

STEPS = 3600  # of a cycle: from one to the next no angle comes near to half a turn
HAIR = 1e-9  # rad: what rounding makes of half a turn, which counts as that, not as its opposite


def twist(state: MotionVectors, spring: TorsionSpring) -> Samples:
    """The angle of a torsion spring over a motion, rad, shape (n,), which goes on over whole turns."""
    scene, position = state.scene, state.motion[state.scene.drive_channel]
    within = state.angle(spring.second) - state.angle(spring.first)
    if sign := spring.drives(scene):
        near = sign * position
    else:
        try:
            places, angles = _course(scene, spring)
        except Failure:  # no other motion is known than this one
            return np.unwrap(np.remainder(within + pi, 2 * pi) - pi)
        once = 2 * pi * round(float(scene.drive.after(1.0) - scene.drive.after(0.0)) / (2 * pi))
        cycles = np.floor((position - places[0]) / abs(once)) if scene.drive.periodic and once else 0.0
        gain = np.interp(places[0] + abs(once), places, angles) - angles[0]  # whole turns
        near = np.interp(position - cycles * abs(once), places, angles) + cycles * gain
    return np.asarray(near + np.remainder(within - near + pi, 2 * pi) - pi)


@lru_cache(maxsize=16)
def _course(scene: Scene, spring: TorsionSpring) -> tuple[Samples, Samples]:
    """Positions of the drive over one cycle, increasing, and the angles there, from - pi to pi at time zero."""
    places, signs = np.linspace(*scene.drive.extent, STEPS + 1), {spring.second: 1, spring.first: -1}
    solve = registry.reference(scene, frozenset(f"{name}.angle" for name in signs if name in scene.turning))
    motion = solve(places, np.zeros_like(places))
    turning = (signs[name] * motion[f"{name}.angle"] for name in signs if name in scene.turning)
    angles = np.unwrap(sum(turning, np.zeros_like(places)))
    start = float(np.interp(scene.drive.at(0.0).position, places, angles))
    return places, angles - 2 * pi * ceil((start - pi - HAIR) / (2 * pi))
