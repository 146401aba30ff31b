"""The scene's channels from coordinates and their rates, and MuJoCo's forces in the pins and of the drive."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from scenes.motion import Samples
from scenes.scene import GROUND

from .loads import applied
from .model import Linkage, Moving, Plane


def kinematics(linkage: Linkage, moving: Mapping[str, Moving], driven: Samples) -> dict[str, Samples]:
    """Return the channels that describe the motion, but the time."""
    scene, found = linkage.scene, {linkage.scene.drive_channel: driven}
    for point in scene.moving_points:
        body = scene.owners[point][0]
        for level, vector in zip(("", "v", "a"), moving[body].at(linkage.local(body, point)), strict=True):
            found |= {f"{point}.{level}x": vector.real, f"{point}.{level}y": vector.imag}
    for name in scene.turning:
        of = moving[name]
        found |= {f"{name}.angle": of.angle, f"{name}.omega": of.omega, f"{name}.alpha": of.alpha}
    return found


def forces(linkage: Linkage, moving: Mapping[str, Moving], held: Samples, ends: Samples) -> dict[str, Samples]:
    """Return the force channels.

    A guide is a joint of MuJoCo's tree, which has no constraint: what it exerts is what Newton's and Euler's equations
    of the slider leave.

    Args:
        linkage: the model.
        moving: what its bodies do.
        held: the forces of the pins, x and y of each, and the drive's effort, N, N m, shape (n, rows).
        ends: of the press forces' strokes, m.
    """
    scene = linkage.scene
    exerted: list[tuple[str, Plane, Any, Any]] = [(*force, 0.0) for force in applied(linkage, moving, ends)]
    effort = held[:, -1]
    found = {("drive.torque" if scene.driven_slide is None else "drive.force"): effort}
    for pin, fx, fy in zip(scene.pins, held[:, :-1:2].T, held[:, 1:-1:2].T, strict=True):
        found |= {f"{pin.channel}.fx": fx, f"{pin.channel}.fy": fy}
        for body, force in ((pin.first, -fx - 1j * fy), (pin.second, fx + 1j * fy)):
            exerted.append((body, moving[body].at(linkage.local(body, pin.point))[0], force, 0.0))
    left = {name for name in scene.bodies if linkage.slides(name)}
    while left:
        name = next(n for n in sorted(left) if not any(linkage.guide(other)[0] == n for other in left))
        carrier, _, along, first = linkage.guide(name)
        of, rigid = moving[name], linkage.bodies[name]
        place, (com, _, acceleration) = of.at(first)[0], of.at(complex(*rigid.com))
        needed = rigid.mass * (acceleration - complex(*(scene.gravity or (0, 0))))
        moment = rigid.inertia * of.alpha + ((com - place).conjugate() * needed).imag
        for on, at, force, couple in exerted:
            if on == name:
                needed = needed - force
                moment = moment - couple - ((at - place).conjugate() * force).imag
        across = 1j * along * np.exp(1j * moving[carrier].angle)
        normal = (across.conjugate() * needed).real
        found |= {f"{name}.guide_force": normal, f"{name}.guide_moment": moment}
        if carrier != GROUND:
            exerted.append((carrier, place, -across * normal, -moment))
        left.remove(name)
    return found
