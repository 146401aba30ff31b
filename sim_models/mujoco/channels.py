"""The scene's force channels, from MuJoCo's forces in the pins and of the drive."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from scenes.model.motion import Samples, force_channels

from ..coordinates.bodies import MovingBody
from ..coordinates.system import System


def forces(system: System, moving: Mapping[str, MovingBody], held: Samples, ends: Samples) -> dict[str, Samples]:
    """Return the force channels.

    A guide is a joint of MuJoCo's tree, which has no constraint: what it exerts is what Newton's and Euler's equations
    of the slider leave.

    Args:
        system: the linkage.
        moving: what its bodies do.
        held: the forces of the pins, x and y of each, and the drive's effort, N, N m, shape (n, rows).
        ends: of the press forces' strokes, m.
    """
    scene = system.scene

    exerted: list[tuple[str, Any, Any, Any]] = [(*load, 0.0) for load in system.applied(moving, ends)]
    channels = {force_channels(scene)[-1]: held[:, -1]}
    for pin, fx, fy in zip(scene.pins, held[:, :-1:2].T, held[:, 1:-1:2].T, strict=True):
        channels |= {f"{pin.channel}.fx": fx, f"{pin.channel}.fy": fy}
        for body, force in ((pin.first, -fx - 1j * fy), (pin.second, fx + 1j * fy)):
            exerted.append((body, moving[body].place(system.arms[body, pin.point]), force, 0.0))
    for name in reversed(system.carriers_first()):
        if name not in system.guides:
            continue
        carrier, _, along, first = system.guides[name]
        of, rigid = moving[name], system.bodies[name]
        foot, (com, _, acceleration) = of.place(first), of.at(complex(*rigid.com))
        needed = rigid.mass * (acceleration - complex(*(scene.gravity or (0, 0))))
        moment = rigid.inertia * of.alpha + ((com - foot).conjugate() * needed).imag
        for on, at, force, couple in exerted:
            if on == name:
                needed = needed - force
                moment = moment - couple - ((at - foot).conjugate() * force).imag
        across = 1j * along * moving[carrier].turn
        normal = (np.conj(across) * needed).real
        channels |= {f"{name}.guide_force": normal, f"{name}.guide_moment": moment}
        exerted.append((carrier, foot, -across * normal, -moment))
    return channels
