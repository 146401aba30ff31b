"""Friction at pins and in guides, which changes the forces alone: the motion is prescribed.

What friction does on a joint's two bodies has the direction d in their coordinates, so the joint's rate is d q'. By the
equation of `channels`, J^T lambda + d f = M q'' - F, the forces of the joints and the drive are those without friction,
lambda_0, less J^-T d f. With the friction coefficients c, the senses s of the rates and the joints' own forces g,

    lambda = lambda_0 + sum J^-T d (c s g + viscous rate),    g = |the joint's part of lambda|

by Newton's method for g, continued by one factor on all coefficients. The matrix of its steps, the unit matrix without
friction, has a determinant that stays positive up to where two solutions meet, or where the forces grow without bound.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from scenes.channels import Role
from scenes.model.constraints import blocks
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples

from .constraints import LinkageConstraints, determinant_sign, solved
from .contacts import CONTACTS, Largest
from .planes import PoseArray, with_ground
from .start import closed

MIN_STEP = 1e-7  # of the factor; what takes a smaller one jams
MAX_GROWTH = 3.0  # of a force in a step, by the largest before: a larger one may belong to another solution
MAX_NEWTON_STEPS = 30
CONVERGED_TOL = 1e-10  # of the largest force, what the last step changes; the error left is its square


class RubbingJoints:
    """The joints of the scene's k frictions: what presses their parts together, and what friction takes of that."""

    def __init__(self, linkage: LinkageConstraints) -> None:
        scene = linkage.scene
        self.laws, names = scene.friction, scene.channels.names(Role.force)
        self.contacts = contacts = [CONTACTS[type(law)] for law in self.laws]
        self._guides = np.array([contact.sides for contact in contacts])
        each = [*zip(contacts, self.laws, strict=True)]
        self._forces = np.array([[names.index(name) for name in contact.carried(law, scene)] for contact, law in each])
        self._levers = np.array([contact.levers(law) for contact, law in each])
        self._radii = np.array([contact.radius(law) for contact, law in each])

    def pressed(self, forces: Samples, per_force: Samples) -> tuple[Samples, Samples]:
        """The joints' own forces, shape (n, k), N, and how they change with k others by which `forces` change."""
        # |.| and its gradient by type: a pin's resultant is smooth but at zero, where it gets no slope; a guide's is
        # the larger of two parts, with the sign of that one.
        parts = forces[:, self._forces] * self._levers
        sizes, resultant = np.abs(parts), np.hypot(*np.moveaxis(parts, -1, 0))[..., None]
        along = np.divide(parts, resultant, out=np.zeros(parts.shape), where=resultant > 0)
        larger = np.sign(parts) * (sizes.argmax(axis=2)[..., None] == (0, 1))
        slopes = np.where(self._guides[:, None], larger, along) * self._levers
        g = np.where(self._guides, sizes.max(axis=2), resultant[..., 0])
        return g, np.einsum("njp,njpk->njk", slopes, per_force[:, self._forces])

    def coefficients(self, factor: Samples) -> Samples:
        """What friction takes of the joints' own forces, m or 1, with factors, (n,), on all coefficients; (n, k)."""
        mu = np.multiply.outer(factor, [law.coefficient for law in self.laws])
        return np.where(self._guides, mu, self._radii * mu / np.sqrt(1 + mu**2))


def with_friction(
    linkage: LinkageConstraints, time: Samples, q: PoseArray, reactions: Mapping[str, Samples]
) -> dict[str, Samples]:
    """All force channels, shape (n,), from those without friction; minus infinity where the linkage jams."""
    # Closed to round-off, so that it is known on what side of a reversal a sample is.
    q, rate = closed(linkage, q), inputs_of(linkage.scene, time).driven().rate
    free, joints = np.stack([*reactions.values()], axis=1), RubbingJoints(linkage)
    found = [_solved(linkage, joints, q[rows], rate[rows], free[rows]) for rows in blocks(q)]
    names = linkage.scene.channels.names(Role.force, Role.friction)
    return dict(zip(names, np.concatenate(found).T, strict=True))


def _solved(
    linkage: LinkageConstraints, joints: RubbingJoints, q: PoseArray, of_drive: Samples, free: Samples
) -> Samples:
    """All forces, frictions and their power, shape (n, m + k + 1), by the m forces without the k frictions."""
    # J^-T d, one column a friction. By virtual work its last row, the effort of the drive per unit of friction, is also
    # the joint's rate per unit of the drive's rate, so that rates need no further solution.
    J, d = linkage.jacobian(q), np.moveaxis(directions(linkage, q), 1, 0)
    unit = np.stack(
        [solved(J.swapaxes(1, 2), direction.reshape(len(q), -1)).reshape(len(q), -1) for direction in d], axis=2
    )
    rate = unit[:, -1] * of_drive[:, None]  # of the joint: what it does to the drive, by virtual work
    largest = _largest(linkage, q, solved(J, of_drive[:, None] * np.eye(J.shape[1])[-1]))
    each = zip(joints.laws, joints.contacts, rate.T, strict=True)
    sense = np.stack([law.sense(rates, contact.largest(largest)) for law, contact, rates in each], axis=1)
    viscous = rate * np.array([law.viscous or 0.0 for law in joints.laws])
    free = free + np.einsum("nmk,nk->nm", unit, viscous)
    g, jams = _continued(joints, sense, unit, free)
    friction = joints.coefficients(np.ones(len(q))) * sense * g
    forces, friction = free + np.einsum("nmk,nk->nm", unit, friction), -friction - viscous
    found = np.column_stack([forces, friction, (friction * rate).sum(axis=1)])
    found[jams] -= np.inf
    return found


def directions(linkage: LinkageConstraints, q: PoseArray) -> PoseArray:
    """What a friction of 1 N m or 1 N does on all bodies, shape (n, frictions, bodies, 3)."""
    scene, index = linkage.scene, linkage.index
    slid = linkage.slide_gradients(with_ground(q)).real
    d = np.zeros((len(q), len(scene.friction), len(index), 3))
    for number, law in enumerate(scene.friction):
        CONTACTS[type(law)].direct(law, linkage, slid, d[:, number])
    return d[:, :, :-1]


def _largest(linkage: LinkageConstraints, q: PoseArray, v: PoseArray) -> Largest:
    """The largest rate of all bodies and the largest speed of all points."""
    speeds = []
    for name, member in linkage.members.items():
        i = linkage.index[name]
        arms = np.array([*member.points.values()]) * np.exp(1j * q[:, i, 2:])
        speeds.append(np.abs(v[:, i, :1] + 1j * v[:, i, 1:2] + 1j * v[:, i, 2:] * arms).max(axis=1))
    return Largest(np.abs(v[..., 2]).max(axis=1), np.max(speeds, axis=0))


def _continued(
    joints: RubbingJoints, senses: Samples, unit: Samples, free: Samples
) -> tuple[Samples, NDArray[np.bool_]]:
    """The joints' own forces, shape (n, k), from those without friction on, and where that ends before the factor 1."""
    # Continuation from the frictionless forces in one factor on all coefficients; steps double after success and are
    # halved on failure. A force that grows by more than MAX_GROWTH in a step may have jumped to another solution. A
    # linkage that needs steps below MIN_STEP jams before the factor is 1.
    g, _ = joints.pressed(free, unit)
    factor, step = np.zeros(len(g)), np.ones(len(g))
    while (rows := np.flatnonzero((factor < 1) & (step > MIN_STEP))).size:
        ahead = np.minimum(1, factor[rows] + step[rows])
        per_force = unit[rows] * (joints.coefficients(ahead) * senses[rows])[:, None]
        found, fits = _newton(joints, free[rows], per_force, g[rows])
        fits &= np.abs(found - g[rows]).max(axis=1) <= MAX_GROWTH * g[rows].max(axis=1)
        step[rows] = np.where(fits, 2, 0.5) * step[rows]
        factor[rows[fits]], g[rows[fits]] = ahead[fits], found[fits]
    return g, factor < 1


def _newton(joints: RubbingJoints, free: Samples, per_force: Samples, g: Samples) -> tuple[Samples, NDArray[np.bool_]]:
    """Solve for the joints' own forces from g on, shape (n, k), and tell where that converged on the branch."""
    for _ in range(MAX_NEWTON_STEPS):
        pressed, slopes = joints.pressed(free + np.einsum("nmk,nk->nm", per_force, g), per_force)
        # The matrix is regular with a positive determinant on the branch that starts without friction; a sign change
        # means that another solution has been passed.
        matrix = np.eye(g.shape[1]) - slopes
        signs = determinant_sign(matrix)
        matrix[signs == 0] = np.nan
        change = np.linalg.solve(matrix, (pressed - g)[..., None])[..., 0]
        g = g + change
        fits = (signs > 0) & (np.abs(change).max(axis=1) <= CONVERGED_TOL * np.abs(g).max(axis=1))
        if fits.all():
            break
    return g, fits
