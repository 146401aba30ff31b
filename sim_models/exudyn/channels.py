"""The scene's channels from Exudyn's coordinates and Lagrange multipliers.

Samples of coordinates have shape (n, 3 bodies): x, y and angle of every body in turn, or their rates. Points of the
plane are complex numbers, x + iy.
"""

import numpy as np
from numpy.typing import NDArray

from scenes.channels import Role
from scenes.scene import GROUND

from .system import Array, ExudynSystem


def place(system: ExudynSystem, point: str, q: Array) -> NDArray[np.complex128]:
    """Where a point is, shape (n,), m."""
    body = system.scene.owners[point][0]
    if body == GROUND:
        return np.full(len(q), complex(*system.scene.ground[point]))
    com, angle = system.pose_of(body, q)
    return np.asarray(com + system.bodies[body].points[point] * np.exp(1j * angle))


def kinematics(system: ExudynSystem, q: Array, v: Array, a: Array | None = None) -> dict[str, Array]:
    """The channels of points and angles, by coordinates, their rates and accelerations; without these not a number."""
    scene, levels = system.scene, (q, v, np.full_like(q, np.nan) if a is None else a)
    samples = {scene.channels.drive.position: system.driven(q)}
    for point, names in scene.channels.points.items():
        body = scene.owners[point][0]
        (c, phi), (dc, omega), (ddc, alpha) = (system.pose_of(body, level) for level in levels)
        arm = system.bodies[body].points[point] * np.exp(1j * phi)
        vectors = c + arm, dc + 1j * omega * arm, ddc + (1j * alpha - omega**2) * arm
        for (x, y), vector in zip(names, vectors, strict=True):
            samples |= {x: vector.real, y: vector.imag}
    for body, rates in scene.channels.bodies.items():
        samples |= zip(rates, (system.pose_of(body, level)[1] for level in levels), strict=True)
    return samples


def forces(system: ExudynSystem, multipliers: Array) -> dict[str, Array]:
    """The force channels, from multipliers in their order, shape (n, constraints)."""
    scene = system.scene
    # The system's joints are added in the order of the force channels, so that multipliers and channels correspond one
    # to one. A force of the first body on the later one is -lambda.
    every = dict(zip(scene.channels.names(Role.force), -system.force_unit * multipliers.T, strict=True))
    for joint in scene.joints:
        system.rules[type(joint)].read(joint, system, every)
    return every
