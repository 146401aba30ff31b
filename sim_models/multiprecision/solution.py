"""The solution of one sample: velocities, accelerations and multipliers that follow from the pose."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat

from scenes.motion import Samples

from . import blocks
from .constraints import LinkageEquations
from .loads import GeneralisedForce


class Solution(NamedTuple):
    """Balls that hold the solution of one sample, each of shape (rows, 1)."""

    q: arb_mat  # m, rad: x, y, θ of every body
    velocity: arb_mat
    acceleration: arb_mat
    multipliers: arb_mat  # N, N m, in the order of the force channels


def solved(linkage: LinkageEquations, force: GeneralisedForce, q: arb_mat, rate: arb, acceleration: arb) -> Solution:
    """Return the solution in a pose, e being the drive's row.

    J q' = e rate, J q'' = e acceleration + centripetal, J^T λ = M q'' - Q.
    """
    rows, groups = linkage.constraints, linkage.groups
    J = rows.jacobian(q)
    velocity = blocks.solved(groups, J, linkage.drive(rate))
    total = blocks.solved(groups, J, linkage.drive(acceleration) + rows.centripetal(q, velocity))
    inertial = arb_mat([[m * a] for m, a in zip(linkage.mass, total.entries(), strict=True)])
    multipliers = blocks.solved(linkage.transposed_groups, J.transpose(), inertial - force(q, velocity))
    return Solution(q, velocity, total, multipliers)


def proven_errors(linkage: LinkageEquations, solutions: Sequence[Solution]) -> dict[str, float]:
    """Return the proven errors: of the motion, in the linkage's size, rad and the drive's pace; of the forces.

    A drive's pace is its rate, in rad/s, or in driven slider's travels per second. The error of the forces is that of
    any relative to the largest, or to what the heaviest body's inertia could take, where all are zero.
    """
    scene = linkage.scene
    pace = float(linkage.law.pace / (1 if scene.driven_slide is None else linkage.law.travel))
    units = np.array(linkage.units)
    motion = [
        np.max(_radii(derivative) / units) / pace**order
        for solution in solutions
        for order, derivative in enumerate(solution[:3])
    ]
    errors = {"constraints": float(np.max(motion))}
    if scene.has_masses:
        force = np.max([_radii(solution.multipliers) for solution in solutions])
        peak = np.max(np.abs([[float(ball) for ball in solution.multipliers.entries()] for solution in solutions]))
        heaviest = max(float(mass) for mass in linkage.mass[::3])
        scale = max(peak, heaviest * linkage.size * pace**2)
        errors["newton-euler"] = float(force / scale if scale > 0 else force)
    return errors


def _radii(balls: arb_mat) -> Samples:
    return np.array([float(ball.rad()) for ball in balls.entries()])
