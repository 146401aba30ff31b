"""Angles that go on over whole turns, of springs that twist and of bodies: positions are solved in any order.

An angle is found modulo a turn at samples of the drive's way, and continued from one to the next by less than half a
turn. What moves by more than that between two samples, 1/3600 of the way, is continued by a wrong turn.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from math import pi, tau
from typing import TypeAlias

import numpy as np

from scenes import Scene
from scenes.model.motion import Samples

from ..core.decomposition import Linkage
from ..core.elements import twist, wound
from ..core.placing import Kinematics
from .motion_range import SAMPLES, motion_at

HALF_TURN = pi - 1e-9  # rad: by so much less clockwise it is one counter-clockwise

Winding: TypeAlias = Callable[[Samples], Samples]  # position of the drive -> an angle, within a small part of a turn


def windings(scene: Scene, linkage: Linkage) -> Mapping[str, Winding]:
    """By input, the angles of torsion springs, each followed over the drive's way; from -pi to pi at its start."""
    return _continued(scene, linkage, {name: partial(twist, spring) for name, spring in wound(scene).items()})


def attitudes(scene: Scene, linkage: Linkage, bodies: Iterable[str]) -> Mapping[str, Winding]:
    """By input, the angles of bodies in the same way."""
    return _continued(scene, linkage, {attitude(body): partial(_angle, body) for body in bodies})


def attitude(body: str) -> str:
    """The input that has a body's angle roughly, over whole turns; no name of a file has a blank."""
    return f"the angle of {body}"


def _angle(body: str, k: Kinematics) -> Samples:
    u = k.u[body]
    return np.asarray(np.arctan2(u.imag, u.real))


def _continued(
    scene: Scene, linkage: Linkage, angles: Mapping[str, Callable[[Kinematics], Samples]]
) -> Mapping[str, Winding]:
    """By name, angles that are found modulo a turn, each followed over the drive's way; -pi to pi at its start."""
    if not angles:
        return {}
    law, turns = linkage.drive.law, linkage.drive.slide is None
    start, (least, most) = np.array(law.start), law.extent
    way = np.linspace(least, least + tau if turns else most, SAMPLES + 1)
    k, found = motion_at(scene, linkage, np.append(way, start)), {}
    for name, modulo in angles.items():
        wrapped = modulo(k) + np.zeros(len(way) + 1)
        known = np.isfinite(wrapped[:-1])
        known[:1] |= not known.any()  # where no sample closes one stays, whose failure the solver reports
        angle = np.unwrap(wrapped[:-1][known])
        rough = partial(_followed, turns, way[known])
        # The whole number of turns is fixed at the drive's start, where the angle is to be within -pi..pi; -pi itself
        # counts as pi.
        change = wrapped[-1] + tau * (wrapped[-1] < -HALF_TURN) - rough(angle, start)
        found[name] = partial(rough, angle + tau * np.round(change / tau))
    return found


def _followed(turns: bool, way: Samples, angle: Samples, position: Samples) -> Samples:
    """An angle given along a way, beyond which a slider's stays, and a crank's goes on, turn after turn."""
    whole = np.floor((position - way[0]) / tau) if turns else np.zeros(())
    gain: Samples = tau * np.round((angle[-1] - angle[0]) / tau) * whole
    return gain + np.interp(position - tau * whole, way, angle)
