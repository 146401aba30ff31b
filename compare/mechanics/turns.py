"""How often springs that twist have turned: whole turns of their angle count, and no pose shows them.

The angle is a function of the drive's position: here by the poses of one cycle, in small steps.
"""

from dataclasses import replace
from functools import lru_cache
from math import ceil, pi

import numpy as np

from scenes import Failure, Scene
from scenes.model.motion import Samples
from scenes.scene import TorsionSpring

from ..engines import registry

STEPS = 3600  # of a cycle: between two of them nothing comes near to half a turn
HAIR = 1e-9  # rad: what rounding makes of half a turn, which counts as that, not as its opposite


def on_its_turn(scene: Scene, spring: TorsionSpring, within: Samples, position: Samples) -> Samples:
    """The angles, known modulo a turn, on their turns at positions of the drive; all of shape (n,)."""
    if sign := spring.drives(scene):
        near = sign * position
    else:
        try:
            near = _near(scene, spring, position)
        except Failure:  # no other motion is known than this one
            near = np.unwrap(within)
            near -= 2 * pi * _turns(near[0])
    return np.asarray(near + np.remainder(within - near + pi, 2 * pi) - pi)


def _near(scene: Scene, spring: TorsionSpring, position: Samples) -> Samples:
    """The angles, but for less than half a turn; where the drive goes on for ever, each cycle adds whole turns."""
    (places, angles), drive = _course(scene, spring), scene.drive
    period = 2 * pi * abs(round(float(drive.after(1.0) - drive.after(0.0)) / (2 * pi))) if drive.repeats else 0.0
    cycles = np.floor((position - places[0]) / period) if period else 0.0
    gain = 2 * pi * np.round((np.interp(places[0] + period, places, angles) - angles[0]) / (2 * pi))
    return np.asarray(np.interp(position - cycles * period, places, angles) + cycles * gain)


@lru_cache(maxsize=16)
def _course(scene: Scene, spring: TorsionSpring) -> tuple[Samples, Samples]:
    """Positions of the drive over one cycle, increasing, and the angles there; each of shape (n,)."""
    places = np.linspace(*scene.drive.extent, STEPS + 1)
    turning = {f"{name}.angle": sign for name, sign in ((spring.second, 1), (spring.first, -1)) if name in scene.turning}
    unloaded = replace(scene, loads=(), springs=(), torsion_springs=())
    motion = registry.reference(unloaded, frozenset(turning))(places, np.zeros_like(places))
    angles = np.unwrap(sum((sign * motion[angle] for angle, sign in turning.items()), np.zeros_like(places)))
    start = np.interp(scene.drive.at(0.0).position, places, angles)
    return places, angles - 2 * pi * _turns(float(start))


def _turns(angle: float) -> int:
    """How many whole turns an angle is off the one from - pi to pi, this included."""
    return ceil((angle - pi - HAIR) / (2 * pi))
