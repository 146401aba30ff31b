"""The scene's channels from the poses, rates and accelerations of its bodies.

pymunk tells the size of a joint's impulse only. The vectors follow from what it did to the velocities: there are as
many constraints as coordinates, so M q'' = F + J^T lambda has one solution, and its lambda are the forces of the pins
and guides and the torque of the drive, in the order and with the signs of `scenes.motion.force_channels`.
"""

import numpy as np

from scenes.motion import Samples, force_channels

from .pymunk_linkage import Complex, Linkage, Poses


def motion_channels(linkage: Linkage, q: Poses, v: Poses, a: Poses) -> dict[str, Samples]:
    """Return the channels of points and bodies but `time`, shape (n,) each; q, v and a have shape (n, bodies, 3)."""
    scene = linkage.scene
    channels = {"crank_angle": q[:, linkage.crank, 2]}
    for point in scene.moving_points:
        body = scene.owners[point][0]
        _, *vectors = _point(linkage.index[body], linkage.arm(body, point), q, v, a)
        for order, vector in zip(("", "v", "a"), vectors, strict=True):
            channels |= {f"{point}.{order}x": vector.real, f"{point}.{order}y": vector.imag}
    for name, body_index in linkage.index.items():
        if name in scene.bodies and scene.bodies[name].slide is None:
            for quantity, values in (("angle", q), ("omega", v), ("alpha", a)):
                channels[f"{name}.{quantity}"] = values[:, body_index, 2]
    return channels


def reaction_channels(linkage: Linkage, q: Poses, v: Poses, a: Poses) -> dict[str, Samples]:
    """Return the force channels, shape (n,) each: J^T lambda = M q'' - F, with the true masses, the crank's too."""
    scene = linkage.scene
    wrenches = np.zeros_like(q)
    for name, member in linkage.members.items():
        i = linkage.index[name]
        r, _, _, acceleration = _point(i, member.com, q, v, a)
        gravity = complex(*scene.gravity) if scene.gravity else 0
        wrenches[:, i] += _wrench(r, member.mass * (acceleration - gravity))
        wrenches[:, i, 2] += member.inertia * a[:, i, 2]
    for load in scene.loads:
        i = linkage.index[load.body]
        r, *_ = _point(i, linkage.arm(load.body, load.at), q, v, a)
        wrenches[:, i] -= _wrench(r, complex(*load.force))
    transposed = linkage.jacobian(q).swapaxes(1, 2)
    multipliers = np.linalg.solve(transposed, wrenches.reshape(len(q), -1, 1))
    return dict(zip(force_channels(scene), multipliers[..., 0].T, strict=True))


def _point(i: int, arm: complex, q: Poses, v: Poses, a: Poses) -> tuple[Complex, Complex, Complex, Complex]:
    """Return a point's arm in the ground's frame, its position, velocity and acceleration, shape (n,) each."""
    r = arm * np.exp(1j * q[:, i, 2])
    z, w, dw = (values[:, i, 0] + 1j * values[:, i, 1] for values in (q, v, a))
    omega, alpha = v[:, i, 2], a[:, i, 2]
    return r, z + r, w + 1j * omega * r, dw + (1j * alpha - omega**2) * r


def _wrench(r: Complex, force: Complex | complex) -> Poses:
    """Return a force at the arm r as force and moment at the origin, shape (n, 3)."""
    force = np.broadcast_to(force, r.shape)
    return np.stack([force.real, force.imag, (np.conj(r) * force).imag], axis=-1)
