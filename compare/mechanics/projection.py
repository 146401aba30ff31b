"""A motion on the constraints: what a computed one would be if its own poses met them.

In the closed poses, see `constraints`, the rest has no choice either: with Q the loads,

    J^T λ = M q'' - Q,

where λ are the reactions and the effort of the drive.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from scenes import Motion
from scenes.channels import Role
from scenes.model.motion import Samples

from .constraints import ClosedPoses, Matrices, planes
from .elements import applied, generalised, inertial
from .friction import by_law
from .mechanics import Mechanics
from .motion_vectors import MotionVectors
from .reference import Acting, fitted


class Projection(NamedTuple):
    """A motion on the constraints, and how they stand there."""

    closed: Motion  # every channel; on its switch a press force acts
    forces: Mapping[str, Samples]  # of it, with press forces on the sides of their switches where the motion's fit best
    branch: Samples  # see `ClosedPoses`, as the condition
    condition: Samples


def projected(mechanics: Mechanics, motion: Motion, ends: Sequence[float] | None = None) -> Projection:
    """A motion, whose kinematic channels are complete, on the constraints: not finite in a singular pose.

    The closing strokes of press forces end at `ends`, m; where the motion is of a whole cycle, it shows them itself.
    """
    if ends is None:
        ends = MotionVectors(mechanics.scene, motion).stroke_ends()
    parts = []
    for block in mechanics.constraints.blocks(motion):
        poses = mechanics.constraints.closed(block)
        given = (*mechanics.scene.channels.names(Role.time, Role.input), *(c for c in mechanics.friction if c in block))
        closed = {c: block[c] for c in given} | _kinematics(mechanics, poses)
        loaded = mechanics.forces and {*mechanics.friction} <= closed.keys()
        acting, fitting = _loads(mechanics, block, Motion(closed), poses.inverse, ends) if loaded else ({}, {})
        parts.append(({**closed, **acting}, fitting, {"branch": poses.branch, "condition": poses.condition}))
    closed, fitting, known = (
        {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
        for blocks in zip(*parts, strict=True)
    )
    return Projection(Motion(closed), fitting, **known)


def _kinematics(mechanics: Mechanics, poses: ClosedPoses) -> dict[str, Samples]:
    scene, constraints, channels = mechanics.scene, mechanics.constraints, dict[str, Samples]()
    (z, angle), (dz, omega), (ddz, alpha) = (planes(part) for part in (poses.q, poses.v, poses.a))
    for point, names in scene.channels.points.items():
        name = scene.owners[point][0]
        k = constraints.bodies[name]
        arm = constraints.arms[name][point] / mechanics.size * np.exp(1j * angle[:, k])
        spin = 1j * omega[:, k]
        vectors = z[:, k] + arm, dz[:, k] + spin * arm, ddz[:, k] + (1j * alpha[:, k] + spin**2) * arm
        for (x, y), vector in zip(names, vectors, strict=True):
            channels |= {x: mechanics.size * vector.real, y: mechanics.size * vector.imag}
    for name, rates in scene.channels.bodies.items():
        k = constraints.bodies[name]
        channels |= zip(rates, (angle[:, k], omega[:, k], alpha[:, k]), strict=True)
    return channels


def _loads(
    mechanics: Mechanics, motion: Motion, closed: Motion, inverse: Matrices, ends: Sequence[float]
) -> tuple[Mapping[str, Samples], Mapping[str, Samples]]:
    """The forces of a closed motion: press forces acting on their switches, and as they stand where they fit best."""
    own, computed = (MotionVectors(mechanics.scene, of) for of in (closed, motion))
    units = mechanics.constraints.units

    def misfit(acting: Acting) -> tuple[Samples, Mapping[str, Samples]]:
        # Multipliers from J^T lambda = M q'' - Q: with inertia as pushes the right side is minus all pushes, by rows in
        # units of their constraints.
        loaded = replace(own, acting=acting)
        pushes = generalised(loaded, (*inertial(loaded), *applied(loaded)), mechanics.size)  # Q - M q''
        multipliers = -(inverse.swapaxes(1, 2) @ pushes[..., np.newaxis])[..., 0] / units
        forces = dict(zip(mechanics.forces, multipliers.T, strict=True))
        given = [(channel, unit) for channel, unit in zip(forces, units, strict=True) if channel in motion]
        off = [unit * np.abs(forces[channel] - motion[channel]) for channel, unit in given]
        law = by_law(computed, forces) if mechanics.friction else {}
        return np.sum(off, axis=0) if off else np.zeros_like(motion["time"]), {**forces, **law}

    may = [np.concatenate(both) for both in zip(own.acts(ends), computed.acts(ends), strict=True)]
    return fitted(mechanics.presses, may, misfit)
