"""What follows from the pose of a sample, and the channels, rounded to double precision here and nowhere before."""

from collections.abc import Sequence
from math import ceil, tau
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat

from scenes.model.motion import Samples, force_channels, kinematic_channels

from .constraints import LinkageEquations
from .loads import GeneralisedForce
from .rows import angles, solved


class Solution(NamedTuple):
    """Balls that hold the solution of one sample, each of shape (rows, 1)."""

    q: arb_mat  # m, rad: x, y, θ of every body
    velocity: arb_mat
    acceleration: arb_mat
    multipliers: arb_mat  # N, N m, in the order of the force channels


def solution_in(
    linkage: LinkageEquations, force: GeneralisedForce, q: arb_mat, rate: arb, acceleration: arb
) -> Solution:
    """Return the solution in a pose, e being the drive's row.

    J q' = e rate, J q'' = e acceleration + centripetal, J^T λ = M q'' - Q.
    """
    rows, groups = linkage.constraints, linkage.groups
    J = rows.jacobian(q)
    velocity = solved(groups, J, linkage.drive(rate))
    total = solved(groups, J, linkage.drive(acceleration) + rows.centripetal(q, velocity))
    inertial = arb_mat([[m * a] for m, a in zip(linkage.mass, total.entries(), strict=True)])
    multipliers = solved(linkage.transposed_groups, J.transpose(), inertial - force(q, velocity))
    return Solution(q, velocity, total, multipliers)


def proven_errors(linkage: LinkageEquations, solutions: Sequence[Solution]) -> dict[str, float]:
    """Return the proven errors: of the motion, in the linkage's size, rad and the drive's pace; of the forces.

    A drive's pace is its rate, in rad/s, or in driven slider's travels per second. The error of the forces is that of
    any relative to the largest, or to what the heaviest body's inertia could take, where all are zero.
    """
    scene = linkage.scene
    pace = float(linkage.law.pace / (1 if scene.driven_slide is None else linkage.law.travel))
    levels = ([_radii(solution[level]) for solution in solutions] for level in range(3))
    motion = [np.max(radii / np.array(linkage.units)) / pace**order for order, radii in enumerate(levels)]
    errors = {"constraints": float(np.max(motion))}
    if scene.has_masses:
        force = np.max([_radii(solution.multipliers) for solution in solutions])
        peak = max(abs(float(ball)) for solution in solutions for ball in solution.multipliers.entries())
        heaviest = max(float(mass) for mass in linkage.mass[::3])
        scale = max(peak, heaviest * linkage.size * pace**2)
        errors["newton-euler"] = float(force / scale if scale > 0 else force)
    return errors


def channels(linkage: LinkageEquations, solutions: Sequence[Solution]) -> dict[str, Samples]:
    """Return all channels but the time, shape (n,), at the precision that the caller has set."""
    scene = linkage.scene
    names = (*kinematic_channels(scene)[1:], *force_channels(scene))
    table = np.array([[float(ball) for ball in _values(linkage, solution)] for solution in solutions])
    return dict(zip(names, table.T, strict=True))


def _values(linkage: LinkageEquations, solution: Solution) -> list[arb]:
    """Return the channels of one sample in the order of the files."""
    scene, points, (q, velocity, acceleration, multipliers) = linkage.scene, linkage.points, solution
    J = points.jacobian(q)
    levels = points.value(q), J * velocity, J * acceleration - points.centripetal(q, velocity)
    values = linkage.position.value(q).entries()
    for k in range(len(scene.moving_points)):
        values += [level[2 * k + axis, 0] for level in levels for axis in (0, 1)]
    for body in scene.turning:
        angle, *rates = (angles(level)[linkage.index[body]] for level in solution[:3])
        turns = ceil(float(angle) / tau - 0.5)  # whole ones, that leave it in (-π, π]
        values += [angle - 2 * arb.pi() * turns, *rates]
    return values + (multipliers.entries() if scene.has_masses else [])


def _radii(balls: arb_mat) -> Samples:
    return np.array([float(ball.rad()) for ball in balls.entries()])
