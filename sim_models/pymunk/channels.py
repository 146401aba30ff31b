"""The scene's channels from the poses, rates and accelerations of its bodies.

pymunk gives the size of a joint's impulse only. The vectors follow from the change of the velocities: there are as many
constraints as coordinates, so M q'' = F + J^T lambda has one solution, and its lambda are the forces of the pins and
guides and the effort of the drive, in the order and with the signs of `scenes.motion.force_channels`.
"""

from collections.abc import Iterable, Mapping
from collections.abc import Set as AbstractSet

import numpy as np

from scenes.motion import Samples, force_channels
from scenes.scene import GROUND

from .constraints import Complex, LinkageConstraints, Plane, Poses, blocks, planes, solved, with_ground
from .loads import Active, forces
from .masses import held


def found_channels(
    linkage: LinkageConstraints, wanted: AbstractSet[str], q: Poses, v: Poses, a: Poses, active: Active
) -> dict[str, Samples]:
    """Return the channels wanted, shape (n,), and where there are forces among them, all forces."""
    found = motion_channels(linkage, wanted, q, v, a)
    if wanted.isdisjoint(force_channels(linkage.scene)):
        return found
    return found | reaction_channels(linkage, q, v, a, active)


def motion_channels(
    linkage: LinkageConstraints, wanted: AbstractSet[str], q: Poses, v: Poses, a: Poses
) -> dict[str, Samples]:
    """Return the channels wanted of points, bodies and the drive, shape (n,); q, v, a have shape (n, bodies, 3)."""
    scene = linkage.scene
    found = {scene.drive_channel: linkage.drive_position(q)}
    for point in scene.moving_points:
        names = [f"{point}.{order}{axis}" for order in ("", "v", "a") for axis in "xy"]
        if not wanted.isdisjoint(names):
            body = scene.owners[point][0]
            _, *vectors = _point(linkage.index[body], linkage.arm(body, point), q, v, a)
            parts = [part for vector in vectors for part in (vector.real, vector.imag)]
            found |= {name: part for name, part in zip(names, parts, strict=True) if name in wanted}
    for name in scene.turning:
        for quantity, values in (("angle", q), ("omega", v), ("alpha", a)):
            if f"{name}.{quantity}" in wanted:
                found[f"{name}.{quantity}"] = values[:, linkage.index[name], 2]
    return found


def reaction_channels(linkage: LinkageConstraints, q: Poses, v: Poses, a: Poses, active: Active) -> dict[str, Samples]:
    """Return all force channels, shape (n,) each: J^T lambda = M q'' - F, with the true masses.

    `active`, shape (n, press forces), are those that acted. The driven body counts too.
    """
    scene = linkage.scene
    lacking = np.zeros_like(q)
    z, turn = (values.T for values in planes(with_ground(q)))
    for name, r, force in forces(linkage, z, turn, active.T):
        if name != GROUND:
            lacking[:, linkage.index[name]] -= _wrench(r, force)
    gravity = complex(*scene.gravity) if scene.gravity else 0
    for name, member in linkage.members.items():
        i = linkage.index[name]
        r, _, _, acceleration = _point(i, member.com, q, v, a)
        lacking[:, i] += _wrench(r, member.mass * (acceleration - gravity))
        lacking[:, i, 2] += member.inertia * a[:, i, 2]
    poses = [solved(linkage.jacobian(q[rows]).swapaxes(1, 2), _flat(lacking[rows])) for rows in blocks(q)]
    multipliers = _flat(np.concatenate(poses))
    return dict(zip(force_channels(scene), multipliers.T, strict=True))


def joint_forces(
    linkage: LinkageConstraints, q: Poses, v: Poses, a: Poses, reactions: Mapping[str, Samples], joints: Iterable[str]
) -> Samples:
    """Return the sizes of the forces that joints of the engine must have had, shape (n, joints), N.

    They are the reactions, but a pin with ballast carries its inertia and weight too.
    """
    scene = linkage.scene
    gravity = complex(*scene.gravity) if scene.gravity else 0
    force: dict[str, Plane] = {joint: reactions[joint] for joint in joints if joint in reactions}
    force |= {joint: reactions[f"{joint}.fx"] + 1j * reactions[f"{joint}.fy"] for joint in joints if joint not in force}
    of = held(scene)
    for pin in scene.pins:
        for name, sign in ((pin.first, -1), (pin.second, 1)):
            if of.get(name) is pin and pin.channel in force:
                member = linkage.members[name]
                _, _, _, acceleration = _point(linkage.index[name], member.arms[pin.point], q, v, a)
                ballast = member.moved.mass - member.mass
                force[pin.channel] = force[pin.channel] + sign * ballast * (acceleration - gravity)
    return np.stack([np.abs(force[joint]) for joint in joints], axis=1)


def _point(i: int, arm: complex, q: Poses, v: Poses, a: Poses) -> tuple[Complex, Complex, Complex, Complex]:
    """Return a point's arm in the ground's frame, its position, velocity and acceleration, shape (n,) each."""
    r = arm * np.exp(1j * q[:, i, 2])
    z, w, dw = (values[:, i, 0] + 1j * values[:, i, 1] for values in (q, v, a))
    omega, alpha = v[:, i, 2], a[:, i, 2]
    return r, z + r, w + 1j * omega * r, dw + (1j * alpha - omega**2) * r


def _flat(poses: Poses) -> Samples:
    return poses.reshape(len(poses), -1)


def _wrench(r: Plane, force: Plane) -> Poses:
    """Return a force at the arm r as force and moment at the origin, shape (n, 3)."""
    force = np.broadcast_to(force, np.shape(r))
    return np.stack([force.real, force.imag, (np.conj(r) * force).imag], axis=-1)
