"""The drive's rates: those of a motion law at each instant, in place of their means over a step."""

import numpy as np

from scenes.motion import Samples

from .constraints import LinkageConstraints, Poses, solved


def with_rates_of_law(linkage: LinkageConstraints, time: Samples, q: Poses, v: Poses, a: Poses) -> tuple[Poses, Poses]:
    """Return the rates v and accelerations a of n poses q, shape (n, bodies, 3), corrected to those of the law.

    A step has the mean acceleration of the law, which near a knot, where the acceleration has a kink, is off by the
    first order in dt. What the driven body lacks by that moves all bodies in the ratio dq/dp, p the drive's position:
    the solution of J dq/dp = (0, ..., 0, 1). Errors in dt^2 are left, from the rates in the steps around the knot.
    """
    law = linkage.scene.drive.at(time)
    J = linkage.jacobian(q)
    of_drive = J[:, -1].reshape(q.shape)
    ratio = solved(J, np.broadcast_to(np.eye(J.shape[-1])[-1], J.shape[:2]))

    def corrected(values: Poses, wanted: Samples) -> Poses:
        lack = wanted - (of_drive * values).sum(axis=(1, 2))
        return np.asarray(values + lack[:, None, None] * ratio)

    return corrected(v, law.rate), corrected(a, law.acceleration)
