"""The scene's channels from Exudyn's coordinates and Lagrange multipliers.

Samples of coordinates have shape (n, 3 bodies): x, y and angle of every body in turn, or their rates. Points of the
plane are complex numbers, x + iy.
"""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .exudyn_system import System

Array: TypeAlias = NDArray[np.float64]


def kinematics(system: System, q: Array, v: Array, a: Array) -> dict[str, Array]:
    """Return the channels of points and angles, from positions, velocities and accelerations."""
    scene = system.scene
    x, y, angle = np.moveaxis(np.reshape([q, v, a], (3, len(q), -1, 3)), 3, 0)
    com = x + 1j * y
    motion = {name: (com[:, :, i], angle[:, :, i]) for i, name in enumerate(scene.bodies)}
    channels = {"crank_angle": motion[scene.drive.body][1][0]}
    for point in scene.moving_points:
        body = scene.owners[point][0]
        (c, dc, ddc), (phi, omega, alpha) = motion[body]
        arm = system.bodies[body].points[point] * np.exp(1j * phi)
        for prefix, vector in (
            ("", c + arm),
            ("v", dc + 1j * omega * arm),
            ("a", ddc + (1j * alpha - omega**2) * arm),
        ):
            channels |= {f"{point}.{prefix}x": vector.real, f"{point}.{prefix}y": vector.imag}
    for name, body_ in scene.bodies.items():
        if body_.slide is None:
            channels |= {
                f"{name}.{q}": rate for q, rate in zip(("angle", "omega", "alpha"), motion[name][1], strict=True)
            }
    return channels


def forces(system: System, multipliers: Array) -> dict[str, Array]:
    """Return the force channels, from multipliers of shape (n, constraints): -lambda is what acts on marker 1."""
    channels: dict[str, Array] = {}
    for pin, joint in system.pins.items():
        fx, fy = -multipliers[:, system.columns(joint)].T
        channels |= {f"{pin}.fx": fx, f"{pin}.fy": fy}
    for name, constraint in system.slides.items():
        force, moment = -multipliers[:, system.columns(constraint)].T
        # That moment is about the centre of mass C; about the first point P it is M_C + (C - P) x f.
        body = system.scene.bodies[name]
        lever = (system.bodies[name].points[body.points[0]].conjugate() * system.normal(body)).imag
        channels |= {f"{name}.guide_force": force, f"{name}.guide_moment": moment - lever * force}
    channels["drive.torque"] = -multipliers[:, system.columns(system.drive)[0]]
    return channels
