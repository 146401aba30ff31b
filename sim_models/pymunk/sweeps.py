"""The number of Gauss-Seidel sweeps that a step needs, by theory, from the constraints and the masses of the bodies.

A sweep takes the joints in the order in which they were added, and gives each the impulse that would bring its own
error to zero. The errors J v of all joints change with their impulses by A = J M^-1 J^T, so a sweep multiplies what the
impulses lack by -(D + L)^-1 U, where D are the blocks of A of one joint each, L those below them and U those above:
block Gauss-Seidel (Saad, Iterative Methods for Sparse Linear Systems, 2003, section 4.1). Its spectral radius rho is
what a sweep leaves of an error in the long run. Steps that correct the part beta of a joint's error are stable if
rho**sweeps <= 1 / (1 + beta), whatever dt: a smaller step does not help.
"""

from collections.abc import Iterator
from functools import lru_cache
from math import ceil, inf, log

import numpy as np

from scenes import Failure, Sampling, Scene, Status
from scenes.model.motion import Samples

from .constraints import LinkageConstraints
from .joints import RULES
from .masses import fictitious_masses, masses_of
from .planes import PoseArray
from .settings import PymunkSettings
from .start import MAX_SCENES, begun, way

MAX_LEFT = 1e-4  # of an error that a step starts with
MAX_SWEEPS = 20_000  # sweeps a step


def iterations_needed(scene: Scene, settings: PymunkSettings) -> float:
    """The number of sweeps with which the steps are stable throughout the drive's range, infinite with none.

    It is on the safe side: where few poses are bad, errors have no time to grow there before the sweeps reduce them.
    """
    rho = max(contractions(*begun(scene, masses_of(scene, settings, Sampling()))))
    return sweeps_needed(rho, 1 / (1 + settings.corrected(scene.cycle / settings.steps)))


@lru_cache(MAX_SCENES)
def enough_sweeps(scene: Scene) -> int:
    """The number of sweeps that leave next to nothing of an error, of fictitious masses, throughout the drive's range.

    Where the drive prescribes no body's motion, no choice of masses makes few sweeps converge.
    """
    needed = sweeps_needed(max(contractions(*begun(scene, fictitious_masses))), MAX_LEFT)
    if not needed <= MAX_SWEEPS:
        raise Failure(
            Status.not_converged, f"a step would need {needed:.2g} sweeps over the joints, more than {MAX_SWEEPS}"
        )
    return int(needed)


def sweeps_needed(rho: float, left: float) -> float:
    """The least number of sweeps that leave no more than a part of an error, infinite with none."""
    if not 0 < rho < 1:
        return 1.0 if rho == 0 else inf
    return float(max(1, ceil(log(left) / log(rho))))


def contractions(linkage: LinkageConstraints, pose: PoseArray) -> Iterator[float]:
    """Yield rho at places of the drive through its whole range; `pose` is that at its start."""
    law = linkage.drive.law
    yield contraction(linkage, pose)
    for end in law.extent:
        yield from (contraction(linkage, q) for _, q in way(linkage, pose, law.start, end))


def contraction(linkage: LinkageConstraints, q: PoseArray) -> float:
    """Return rho, the part of an error that a sweep leaves in the long run, in a pose, shape (1, bodies, 3)."""
    inertias = [linkage.moved[name] for name in linkage.members]
    # M^-1 by coordinate: zero for a prescribed body, and for the turn of one that cannot turn.
    ease = np.array([(1 / inertia.mass, 1 / inertia.mass, 1 / inertia.moment) for inertia in inertias]).ravel()
    # The space has no joints between bodies that are prescribed.
    joints = [rows for rows in _joints(linkage, linkage.jacobian(q)[0]) if (rows * ease).any()]
    if not joints:
        return 0.0
    J = np.concatenate(joints)
    owner = np.repeat(np.arange(len(joints)), [len(rows) for rows in joints])
    A = J * ease @ J.T
    # Block Gauss-Seidel: D + L is the part of A whose row belongs to the same or a later joint, U the rest.
    done = owner[:, None] >= owner
    return float(np.abs(np.linalg.eigvals(np.linalg.solve(A * done, A * ~done))).max())


def _joints(linkage: LinkageConstraints, J: Samples) -> list[Samples]:
    """The rows of the Jacobian J that a sweep solves at once, in the order of the space.

    Chipmunk solves a pivot as a 2 x 2 block. It does so with a groove too, and then keeps the normal's part; so a
    groove whose normal is an axis of that block, as here, is a block of one. It is met where it does not turn its
    slider, at the foot of a perpendicular; that differs from its constraint by the angle's, which a gear keeps zero.
    """
    joints, first = list[tuple[int, Samples]](), 0
    for joint in linkage.scene.joints:
        joints += RULES[type(joint)].swept(joint, linkage, J[first : first + joint.equations])
        first += joint.equations
    return [rows for _, rows in sorted(joints, key=lambda swept: swept[0])]
