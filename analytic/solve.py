"""Scene and crank angles in, motion out: block by block, so that every temporary stays in cache."""

from collections.abc import Iterator
from math import degrees

import numpy as np
from numpy.typing import ArrayLike

from scenes import Failure, Motion, Scene, Status
from scenes.motion import Samples, channels
from scenes.scene import Body

from .decomposition import Decomposition, decompose
from .dyads import Vectors
from .kinematics import Kinematics, kinematics
from .kinetostatics import Reactions, kinetostatics
from .motion_range import describe

BLOCK = 8000  # angles: a complex temporary stays under 128 KiB, from where on the allocator maps fresh pages for each


def solve(scene: Scene, crank_angle: ArrayLike) -> Motion:
    """Solve a scene at the given crank angles, each on its own: in closed form, but for groups that hold no dyad.

    Args:
        scene: the mechanism.
        crank_angle: shape (n,), rad, in any order.

    Returns:
        Every channel of the scene, shape (n,), SI. The time is counted from the drive's start angle.

    Raises:
        Failure: `unsupported` when the sketch leaves a branch open, `cannot_assemble` at the first crank angle where
            the bodies do not reach.
    """
    return solve_decomposed(scene, decompose(scene), crank_angle)


def solve_decomposed(scene: Scene, linkage: Decomposition, crank_angle: ArrayLike) -> Motion:
    """Solve a scene as `solve` does, by a decomposition that is at hand."""
    angle = np.array(crank_angle, dtype=np.float64)
    vector_names, scalar_names = _names(scene)
    # Two large arrays: the system hands those out in huge pages, many small ones cost several times their writing.
    vectors = np.empty((len(vector_names), len(angle)), complex)
    scalars = np.empty((len(scalar_names), len(angle)))
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):  # not finite is an outcome, told by its status
        for start in range(0, len(angle), BLOCK):
            block = slice(start, start + BLOCK)
            k = kinematics(scene, linkage, angle[block])
            _check_reach(scene, linkage, k, angle[block])
            on = kinetostatics(scene, linkage, k) if scene.has_masses else Reactions()
            for row, vector in zip(vectors, _vectors(scene, k, on), strict=True):
                row[block] = vector
            for row, scalar in zip(scalars, _scalars(scene, k, on), strict=True):
                row[block] = scalar
    samples = {"time": (angle - scene.drive.start) / scene.drive.speed, "crank_angle": angle}
    for (x, y), row in zip(vector_names, vectors, strict=True):
        samples |= {x: row.real, y: row.imag}
    samples |= zip(scalar_names, scalars, strict=True)
    return Motion({channel: samples[channel] for channel in channels(scene)})


def _check_reach(scene: Scene, linkage: Decomposition, k: Kinematics, angle: Samples) -> None:
    for pin, reach in k.reach.items():  # in solving order: the first that fails is negative, what hangs on it is NaN
        if (reach < 0).any():
            first = degrees(angle[int(np.argmax(reach < 0))])
            why = f"{pin} cannot be reached at crank angle {first:.4f} deg; {describe(scene, linkage)}"
            raise Failure(Status.cannot_assemble, why)


def _names(scene: Scene) -> tuple[list[tuple[str, str]], list[str]]:
    """Return the channels' names, the vectors' by pairs, in the order of `_vectors` and `_scalars`."""
    vectors = [(f"{p}.{q}x", f"{p}.{q}y") for p in scene.moving_points for q in ("", "v", "a")]
    scalars = [f"{body.name}.{q}" for body in _turning(scene) for q in ("angle", "omega", "alpha")]
    if scene.has_masses:
        vectors += [(f"{pin.channel}.fx", f"{pin.channel}.fy") for pin in scene.pins]
        scalars += [f"{body.name}.{q}" for body in _sliding(scene) for q in ("guide_force", "guide_moment")]
        scalars += ["drive.torque"]
    return vectors, scalars


def _vectors(scene: Scene, k: Kinematics, on: Reactions) -> Iterator[Vectors]:
    for p in scene.moving_points:
        yield from (k.z[p], k.v[p], k.a[p])
    if scene.has_masses:
        for pin in scene.pins:
            yield on.pin[pin.point, pin.second]


def _scalars(scene: Scene, k: Kinematics, on: Reactions) -> Iterator[Samples]:
    for body in _turning(scene):
        u = k.u[body.name]
        yield from (np.arctan2(u.imag, u.real), k.omega[body.name], k.alpha[body.name])
    if scene.has_masses:
        for body in _sliding(scene):
            yield from on.guide[body.name]
        yield on.torque


def _turning(scene: Scene) -> list[Body]:
    return [body for body in scene.bodies.values() if body.slide is None]


def _sliding(scene: Scene) -> list[Body]:
    return [body for body in scene.bodies.values() if body.slide is not None]
