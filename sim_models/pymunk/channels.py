"""The scene's channels from the poses, rates and accelerations of its bodies.

pymunk gives the size of a joint's impulse only. The vectors follow from the change of the velocities: there are as many
constraints as coordinates, so M q'' = F + J^T lambda has one solution, and its lambda are the forces of the pins and
guides and the effort of the drive, in the order and with the signs of the channels of `scenes.channels.Role.force`.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from scenes.channels import Role
from scenes.model.constraints import blocks
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND

from .constraints import LinkageConstraints, solved
from .friction import with_friction
from .loads import active_presses, applied, instants
from .masses import held
from .planes import ComplexArray, PlaneVector, PoseArray


class Motions(NamedTuple):
    """Poses, rates and accelerations of all bodies at n samples, shape (n, bodies, 3)."""

    q: PoseArray
    v: PoseArray
    a: PoseArray

    def of_point(self, i: int, arm: complex) -> tuple[ComplexArray, ComplexArray, ComplexArray, ComplexArray]:
        """A point's arm in the ground's frame, its position, velocity and acceleration, shape (n,) each."""
        r = arm * np.exp(1j * self.q[:, i, 2])
        z, w, dw = (values[:, i, 0] + 1j * values[:, i, 1] for values in self)
        omega, alpha = self.v[:, i, 2], self.a[:, i, 2]
        return r, z + r, w + 1j * omega * r, dw + (1j * alpha - omega**2) * r


def with_rates_of_law(linkage: LinkageConstraints, time: Samples, motion: Motions) -> Motions:
    """Correct rates and accelerations to those of the motion law.

    A step has the mean acceleration of the law, which near a knot, where the acceleration has a kink, is off by the
    first order in dt. What the driven body lacks by that moves all bodies in the ratio dq/dp, p the drive's position:
    the solution of J dq/dp = (0, ..., 0, 1). Errors in dt^2 are left, from the rates in the steps around the knot.
    """
    q, law = motion.q, inputs_of(linkage.scene, time).driven()
    # All constraints but the drive's keep their rates; a unit of the drive's rate moves the bodies by `ratio`, and the
    # drive's lack is spread by it.
    J = linkage.jacobian(q)
    of_drive = J[:, -1].reshape(q.shape)
    ratio = solved(J, np.broadcast_to(np.eye(J.shape[-1])[-1], J.shape[:2]))

    def corrected(values: PoseArray, wanted: Samples) -> PoseArray:
        lack = wanted - (of_drive * values).sum(axis=(1, 2))
        return np.asarray(values + lack[:, None, None] * ratio)

    v = corrected(motion.v, law.rate)
    return Motions(q, v, corrected(motion.a, law.acceleration - _curvature(linkage, Motions(q, v, 0 * v))))


def _curvature(linkage: LinkageConstraints, motion: Motions) -> Samples:
    """The drive's acceleration where that of all coordinates is zero, shape (n,): of a bar that turns."""
    drive = linkage.drive
    if drive.slide is None or drive.on == GROUND:
        return np.zeros(len(motion.q))
    ends = (drive.body, linkage.first_arm(drive.body)), (drive.on, linkage.back_end)
    first, end = (np.array(motion.of_point(linkage.index[name], arm)) for name, arm in ends)
    _, bar, rate, acceleration = first - end
    # Second derivative of a length |b|: (b . b'' + (b x b')^2 / |b|^2) / |b|.
    squared = (np.conj(bar) * acceleration + (np.conj(bar) * rate).imag ** 2 / np.abs(bar) ** 2).real
    return np.asarray(squared / np.abs(bar))


def wanted_channels(
    linkage: LinkageConstraints, time: Samples, motion: Motions, stroke_ends: Sequence[float], *, forces: bool
) -> dict[str, Samples]:
    """The channels, shape (n,), those of forces if wanted; `stroke_ends` are those of the press forces, m."""
    scene = linkage.scene
    samples = {scene.channels.drive.position: linkage.drive_position(motion.q)}
    for point, names in scene.channels.points.items():
        body = scene.owners[point][0]
        _, *vectors = motion.of_point(linkage.index[body], linkage.arm(body, point))
        for (x, y), vector in zip(names, vectors, strict=True):
            samples |= {x: vector.real, y: vector.imag}
    for body, rates in scene.channels.bodies.items():
        samples |= zip(rates, (level[:, linkage.index[body], 2] for level in motion), strict=True)
    if not forces:
        return samples
    instant = instants(linkage, time, motion.q, motion.v)
    found = reaction_channels(linkage, motion, applied(linkage, instant, active_presses(linkage, instant, stroke_ends)))
    return samples | (with_friction(linkage, time, motion.q, found) if scene.friction else found)


def reaction_channels(linkage: LinkageConstraints, motion: Motions, forces: PoseArray) -> dict[str, Samples]:
    """The force channels without friction, (n,): J^T lambda = M q'' - F, of true masses; `forces`, (n, bodies, 3)."""
    q, _, a = motion
    # Newton-Euler in coordinates of each body's origin: the inertia force acts at the centre of mass, with the lever r,
    # and adds its moment about the origin.
    lacking = 0.0 - forces
    for name, member in linkage.members.items():
        i = linkage.index[name]
        r, _, _, acceleration = motion.of_point(i, member.com)
        force = member.mass * (acceleration - linkage.gravity)
        lacking[:, i] += np.stack([force.real, force.imag, (np.conj(r) * force).imag], axis=-1)
        lacking[:, i, 2] += member.inertia * a[:, i, 2]
    flat = lacking.reshape(len(q), -1)
    poses = [solved(linkage.jacobian(q[rows]).swapaxes(1, 2), flat[rows]) for rows in blocks(q)]
    multipliers = np.concatenate(poses).reshape(len(q), -1)
    return dict(zip(linkage.scene.channels.names(Role.force), multipliers.T, strict=True))


def joint_forces(
    linkage: LinkageConstraints, motion: Motions, reactions: Mapping[str, Samples], joints: Iterable[str]
) -> Samples:
    """What the engine's joints must bear, (n, joints), N: reactions, and of pins their ballast's inertia and weight."""
    force: dict[str, PlaneVector] = {joint: reactions[joint] for joint in joints if joint in reactions}
    pins = {joint: linkage.scene.channels.pins[joint] for joint in joints if joint not in force}
    force |= {joint: reactions[x] + 1j * reactions[y] for joint, (x, y) in pins.items()}
    for name, pin in held(linkage.scene).items():
        if pin.channel in force:
            member, sign = linkage.members[name], -1 if name == pin.first else 1
            _, _, _, acceleration = motion.of_point(linkage.index[name], member.points[pin.point])
            # The engine's joint also carries its ballast, a point mass at the pin: d'Alembert's force of that mass.
            ballast = linkage.moved[name].mass - member.mass
            force[pin.channel] = force[pin.channel] + sign * ballast * (acceleration - linkage.gravity)
    return np.stack([np.abs(force[joint]) for joint in joints], axis=1)
