"""Scene and crank angles in, motion out: block by block, so that every temporary stays in cache."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenes import Motion, Scene
from scenes.motion import Samples, channels

from .decomposition import decompose
from .dyads import Vectors
from .kinematics import Kinematics, kinematics
from .kinetostatics import Reactions, kinetostatics

BLOCK = 16384  # angles: measured best; temporaries stay in the shared cache, and the calls spread their cost thinly


def solve(scene: Scene, crank_angle: ArrayLike) -> Motion:
    """Solve a scene at the given crank angles, in closed form, each angle on its own.

    Args:
        scene: the mechanism.
        crank_angle: shape (n,), rad, in any order.

    Returns:
        Every channel of the scene, shape (n,), SI. The time is counted from the drive's start angle.

    Raises:
        Failure: `unsupported` when the linkage is no chain of RRR and RRP dyads, `cannot_assemble` at the first crank
            angle where the bodies do not reach.
    """
    angle = np.array(crank_angle, dtype=np.float64)
    linkage = decompose(scene)
    rows: dict[tuple[str, ...], NDArray[np.generic]] = {}
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):  # not finite is an outcome, told by its status
        for start in range(0, len(angle), BLOCK):
            block = slice(start, start + BLOCK)
            k = kinematics(scene, linkage, angle[block])
            on = kinetostatics(scene, linkage, k) if scene.has_masses else None
            for names, values in _answers(scene, k, on):
                if names not in rows:
                    rows[names] = np.empty(angle.shape, values.dtype)
                rows[names][block] = values
    samples: dict[str, Samples] = {
        "time": (angle - scene.drive.start) / scene.drive.speed,
        "crank_angle": angle,
    }
    for names, row in rows.items():
        samples |= zip(names, (row.real, row.imag), strict=False)  # a real row has one name, a vector two
    return Motion({channel: samples[channel] for channel in channels(scene)})


def _answers(scene: Scene, k: Kinematics, on: Reactions | None) -> Iterator[tuple[tuple[str, ...], Vectors | Samples]]:
    """Yield the channels' names and values: a vector's two channels as one complex array."""
    for p in scene.moving_points:
        yield (f"{p}.x", f"{p}.y"), k.z[p]
        yield (f"{p}.vx", f"{p}.vy"), k.v[p]
        yield (f"{p}.ax", f"{p}.ay"), k.a[p]
    for name, body in scene.bodies.items():
        if body.slide is None:
            u = k.u[name]
            yield (f"{name}.angle",), np.arctan2(u.imag, u.real)
            yield (f"{name}.omega",), k.omega[name]
            yield (f"{name}.alpha",), k.alpha[name]
    if on is not None:
        for pin in scene.pins:
            yield (f"{pin.channel}.fx", f"{pin.channel}.fy"), on.pin[pin.point, pin.second]
        for slider, (force, moment) in on.guide.items():
            yield (f"{slider}.guide_force",), force
            yield (f"{slider}.guide_moment",), moment
        yield ("drive.torque",), on.torque
