"""The number of Gauss-Seidel sweeps that a step needs, by theory, from the joints and the masses of the space.

A sweep takes the joints in the order in which they were added, and gives each the impulse that would bring its own
error to zero. The errors J v of all joints change with their impulses by A = J M^-1 J^T, so a sweep multiplies what the
impulses lack by -(D + L)^-1 U, where D are the blocks of A of one joint each, L those below them and U those above:
block Gauss-Seidel (Saad, Iterative Methods for Sparse Linear Systems, 2003, section 4.1). Its spectral radius rho is
what a sweep leaves of an error in the long run. Steps that correct the part beta of a joint's error are stable if
rho**sweeps <= 1 / (1 + beta), whatever dt: a smaller step does not help.
"""

from collections.abc import Iterator
from functools import lru_cache
from math import ceil, inf, log, log1p

import numpy as np
import pymunk
from numpy.typing import NDArray

from scenes import Failure, Sampling, Scene, Status
from scenes.scene import GROUND

from .bodies import pair
from .constraints import LinkageConstraints, PoseArray
from .masses import fictitious_masses, masses_of
from .settings import PymunkSettings
from .space import Model
from .start import SCENES, begun, way

LEFT = 1e-4  # of an error that a step starts with
MOST = 20_000  # sweeps a step


def iterations_needed(scene: Scene, settings: PymunkSettings) -> float:
    """The number of sweeps with which the steps are stable throughout the drive's range, infinite with none.

    It is on the safe side: where few poses are bad, errors have no time to grow there before the sweeps reduce them.
    """
    rho = max(contractions(*begun(scene, masses_of(scene, settings, Sampling()))))
    return sweeps_needed(rho, settings.corrected(scene.drive.cycle / settings.steps))


@lru_cache(SCENES)
def enough_sweeps(scene: Scene) -> int:
    """The number of sweeps that leave next to nothing of an error, of fictitious masses, throughout the drive's range.

    Where the drive prescribes no body's motion, no choice of masses makes few sweeps converge.
    """
    rho = max(contractions(*begun(scene, fictitious_masses)))
    needed = log(LEFT) / log(rho) if 0 < rho < 1 else rho and inf
    if not needed <= MOST:
        raise Failure(Status.not_converged, f"a step would need {needed:.2g} sweeps over the joints, more than {MOST}")
    return ceil(needed)


def sweeps_needed(rho: float, correction: float) -> float:
    """The least number of sweeps for which steps that correct that part of an error are stable."""
    if not 0 < rho < 1:
        return 1.0 if rho == 0 else inf
    return float(max(1, ceil(log1p(correction) / -log(rho))))


def contractions(linkage: LinkageConstraints, pose: PoseArray) -> Iterator[float]:
    """Yield rho at places of the drive through its whole range; `pose` is that at its start."""
    drive = linkage.scene.drive
    driven = linkage.moved[drive.body].prescribed or linkage.scene.drive_on != GROUND
    still = np.zeros_like(pose)
    model = Model(linkage, pose, still, 0.0, "" if driven else "motor")
    for q in (pose, *(q for end in drive.extent for _, q in way(linkage, pose, drive.start, end))):
        model.place(q, still)
        yield contraction(model.space)


def contraction(space: pymunk.Space) -> float:
    """Return rho, the part of an error that a sweep over the joints leaves in the long run, in the present pose."""
    bodies = [body for body in space.bodies if body.body_type == pymunk.Body.DYNAMIC]
    if not space.constraints:
        return 0.0
    ease = np.array([[1 / body.mass, 1 / body.mass, 1 / body.moment] for body in bodies]).ravel()
    joints = []
    for joint in space.constraints:
        rows = _rows(joint)
        wide = np.zeros((rows.shape[1], len(bodies), 3))
        for body, own in zip((joint.a, joint.b), rows, strict=True):
            if body in bodies:
                wide[:, bodies.index(body)] = own
        joints.append(wide.reshape(len(wide), -1))
    J = np.concatenate(joints)
    owner = np.repeat(np.arange(len(joints)), [len(rows) for rows in joints])
    A = J * ease @ J.T
    done = owner[:, None] >= owner
    return float(np.abs(np.linalg.eigvals(np.linalg.solve(A * done, A * ~done))).max())


def _rows(joint: pymunk.Constraint) -> NDArray[np.float64]:
    """The velocities that a joint corrects at once, by the rates of its two bodies: shape (2, k, 3).

    Chipmunk solves a pivot as a 2 x 2 block. It does so with a groove too, and then keeps the normal's part; so a
    groove whose normal is an axis of that block, as here, is a block of one.
    """
    if isinstance(joint, pymunk.PivotJoint):
        ends = (joint.a, joint.anchor_a), (joint.b, joint.anchor_b)
        (r, s) = (complex(*anchor.rotated(body.angle)) for body, anchor in ends)
        return np.array([[[-1, 0, r.imag], [0, -1, -r.real]], [[1, 0, -s.imag], [0, 1, s.real]]])
    if isinstance(joint, pymunk.GrooveJoint | pymunk.PinJoint):
        s = complex(*joint.anchor_b.rotated(joint.b.angle))
        r = complex(*joint.b.position) + s - complex(*joint.a.position)
        if isinstance(joint, pymunk.GrooveJoint):
            n = 1j * complex(*(joint.groove_b - joint.groove_a).normalized().rotated(joint.a.angle))
        else:
            bar = r - complex(*joint.anchor_a.rotated(joint.a.angle))
            n = bar / abs(bar)
        return np.array([[[*pair(-n), -(r.conjugate() * n).imag]], [[*pair(n), (s.conjugate() * n).imag]]])
    return np.array([[[0.0, 0, -1]], [[0, 0, 1]]])  # a gear of ratio 1, a motor
