"""A motion on the constraints: what a computed one would be if its own poses met them.

One step of Newton's method closes the joints with the drive where it really is. In the poses found, with γ the second
derivative of the constraints at q'' = 0 and Q the loads, the rest has no choice:

    J q' = e rate,   J q'' = e acceleration - γ(q, q'),   J^T λ = M q'' - Q,

where λ are the reactions and the effort of the drive.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from scenes import Motion, Scene
from scenes.motion import Samples, force_channels

from ..engines.motion_vectors import MotionVectors, Vectors, inertia
from ..engines.press_switches import Acting, acts, fitted, press_forces, stroke_ends
from .constraints import Constraints, Matrices, Poses, blocks, constraints_of, planes


@dataclass(frozen=True)
class Projection:
    """A motion on the constraints, and how they stand there."""

    closed: Motion  # every channel; on its switch a press force acts
    forces: Mapping[str, Samples]  # of it, with press forces on the sides of their switches where the motion's fit best
    branch: Samples  # the sign of det J in the poses as computed, shape (n,): it changes in a singular pose alone
    condition: Samples  # of J in the Frobenius norm, shape (n,)


def projected(scene: Scene, motion: Motion, ends: Sequence[float] | None = None) -> Projection:
    """Return a motion, whose kinematic channels are complete, on the constraints: not finite in a singular pose.

    The closing strokes of press forces end at `ends`, m; where the motion is of a whole cycle, it shows them itself.
    """
    constraints = constraints_of(scene)
    if ends is None:
        ends = stroke_ends(MotionVectors(scene, motion))
    parts = [_projected(constraints, block, ends) for block in blocks(constraints, motion)]
    return Projection(
        Motion(_joined([part.closed.samples for part in parts])),
        _joined([part.forces for part in parts]),
        np.concatenate([part.branch for part in parts]),
        np.concatenate([part.condition for part in parts]),
    )


def _joined(pieces: Sequence[Mapping[str, Samples]]) -> dict[str, Samples]:
    return {channel: np.concatenate([piece[channel] for piece in pieces]) for channel in pieces[0]}


def _projected(constraints: Constraints, motion: Motion, ends: Sequence[float]) -> Projection:
    """Return the projection of a part of a motion."""
    scene = constraints.scene
    given = {channel: motion[channel] for channel in ("time", scene.drive_channel)}
    q = constraints.poses(motion)
    J = constraints.jacobian(q)
    sign, size = constraints.determinant(J)
    step = constraints.solve(J, constraints.gaps(q, given[scene.drive_channel])[..., np.newaxis]).reshape(q.shape)
    q = q - np.where(np.isfinite(step), step, 0.0)
    J = constraints.jacobian(q)
    inverse = constraints.solve(J, np.broadcast_to(np.eye(len(constraints.units)), J.shape))
    _, rate, acceleration = (of[:, np.newaxis] / constraints.units[-1] for of in scene.drive.at(motion["time"]))
    v = (inverse[:, :, -1] * rate).reshape(q.shape)
    a = (inverse[:, :, -1] * acceleration - _times(inverse, constraints.bending(q, v))).reshape(q.shape)
    closed = Motion(given | _kinematics(constraints, q, v, a))
    branch = np.where(np.isnan(size), np.nan, sign)  # the determinant of what is not finite has a sign
    condition = np.linalg.norm(J, axis=(1, 2)) * np.linalg.norm(inverse, axis=(1, 2))
    ways = _loaded(constraints, motion, closed, inverse, ends) if scene.has_masses else (closed, {})
    return Projection(*ways, branch, condition)


def _loaded(
    constraints: Constraints, motion: Motion, closed: Motion, inverse: Matrices, ends: Sequence[float]
) -> tuple[Motion, Mapping[str, Samples]]:
    """Return the closed motion with its forces, press forces acting on their switches, and the forces that fit best."""
    own, computed = (MotionVectors(constraints.scene, of) for of in (closed, motion))
    presses = press_forces(constraints.scene)
    may = [
        np.concatenate([acts(of, load, end) for of in (own, computed)]) for load, end in zip(presses, ends, strict=True)
    ]

    def misfit(acting: Acting) -> tuple[Samples, Mapping[str, Samples]]:
        forces = _reactions(constraints, replace(own, acting=acting), inverse)
        units = [(channel, unit) for channel, unit in zip(forces, constraints.units, strict=True) if channel in motion]
        off = [unit * np.abs(forces[channel] - motion[channel]) for channel, unit in units]
        return np.sum(off, axis=0) if off else np.zeros_like(motion["time"]), forces

    forces, fitting = fitted(presses, may, misfit)
    return Motion({**closed.samples, **forces}), fitting


def _kinematics(constraints: Constraints, q: Poses, v: Poses, a: Poses) -> dict[str, Samples]:
    """Return the channels of points and bodies that turn."""
    scene, size, found = constraints.scene, constraints.size, dict[str, Samples]()
    (z, angle), (dz, omega), (ddz, alpha) = (planes(of) for of in (q, v, a))
    for point in scene.moving_points:
        name = scene.owners[point][0]
        k = constraints.bodies[name]
        arm = constraints.arms[name][point] / size * np.exp(1j * angle[:, k])
        spin = 1j * omega[:, k]
        vectors = z[:, k] + arm, dz[:, k] + spin * arm, ddz[:, k] + (1j * alpha[:, k] + spin**2) * arm
        for order, vector in zip(("", "v", "a"), vectors, strict=True):
            found |= {f"{point}.{order}x": size * vector.real, f"{point}.{order}y": size * vector.imag}
    for name in scene.turning:
        k = constraints.bodies[name]
        found |= {f"{name}.angle": angle[:, k], f"{name}.omega": omega[:, k], f"{name}.alpha": alpha[:, k]}
    return found


def _reactions(constraints: Constraints, state: MotionVectors, inverse: Matrices) -> dict[str, Samples]:
    """Return the force channels; forces and moments on a body are at its first point."""
    needed: list[Samples] = []
    for body in constraints.scene.bodies.values():
        first, (com, _, acceleration) = state.place(body.points[0]), state.com(body)
        force = (body.mass or 0.0) * acceleration
        moment = inertia(body) * state.turning(body.name)[2] + _cross(com - first, force)
        for push in state.applied(body):
            force, moment = force - push.force, moment - _cross(push.at - first, push.force)
        needed += [constraints.size * force.real, constraints.size * force.imag, moment]
    multipliers = _times(inverse.swapaxes(1, 2), np.stack(needed, axis=1)) / constraints.units
    return dict(zip(force_channels(constraints.scene), multipliers.T, strict=True))


def _cross(arm: Vectors, force: Vectors) -> Samples:
    cross: Samples = (arm.conj() * force).imag
    return cross


def _times(matrix: Matrices, vector: Samples) -> Samples:
    product: Samples = (matrix @ vector[..., np.newaxis])[..., 0]
    return product
