"""Other ways to the same motion, slower or less accurate than the core's, to show what they cost.

The half-angle form is that of equations (8), (10) and (14) of Yang (2023), doi:10.56578/jisc020103, with its misprints
corrected. Differences of positions are how many tools find velocities and accelerations.
"""

import numpy as np

from scenes import Scene
from scenes.drive import Driven
from scenes.model.motion import Samples

from .dyads import Vectors, cross, turned
from .kinematics import Linkage, kinematics
from .placing import Kinematics


def half_angle_position(
    d: Vectors,
    distance: Samples,
    r1: float,
    r2: float,
    reach: Samples,  # noqa: ARG001 - this form finds its own
    branch: int,
) -> tuple[Vectors, Vectors, Samples]:
    """Return p, q and p x q, as `dyads.rrr_position` does, from the angle of p by its half.

    |d - p| = r2 makes A cos + B sin = C with A = 2 r1 d_x, B = 2 r1 d_y, C = d^2 + r1^2 - r2^2, and the tangent of the
    half angle solves (A + C) t^2 - 2 B t + (C - A) = 0. It loses the digits of A + C where those cancel.
    """
    A, B, C = 2 * r1 * d.real, 2 * r1 * d.imag, distance * distance + (r1 - r2) * (r1 + r2)
    half = np.arctan((B + branch * np.sqrt(A * A + B * B - C * C)) / (A + C))
    p = r1 * np.exp(2j * half)
    q = p - d
    return p, q, cross(p, q)


def differenced(scene: Scene, linkage: Linkage, driven: Driven, *, step: float) -> Kinematics:
    """Return the kinematics, all rates by central differences of positions `step` apart, s.

    The error is of order step^2, and roundings grow with 1 / step^2.
    """
    moved = driven.rate * step, driven.acceleration * step**2 / 2
    before, k, after = (
        kinematics(
            scene,
            linkage,
            driven._replace(position=driven.position + sign * moved[0] + moved[1] * sign**2),
            rates=False,
        )
        for sign in (-1, 0, 1)
    )
    for point, z in k.z.items():
        k.v[point] = (after.z[point] - before.z[point]) / (2 * step)
        k.a[point] = (after.z[point] - 2 * z + before.z[point]) / step**2
    for body, u in k.u.items():
        forth, back = np.angle(after.u[body] / u), np.angle(u / before.u[body])
        k.omega[body], k.alpha[body] = (forth + back) / (2 * step), (forth - back) / step**2
        k.rate[body] = turned(k.omega[body], k.alpha[body])
    return k
