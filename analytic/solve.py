"""Scene and positions of the drive in, motion out: block by block, so that every temporary stays in cache."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from scenes import Failure, Motion, Scene, Status
from scenes.drive import Driven
from scenes.motion import Samples, channels
from scenes.scene import ConstantSpeed

from .decomposition import Decomposition, Dyad, decompose, inner_joint, kind
from .dyads import Vectors, dot
from .kinematics import Kinematics, kinematics
from .kinetostatics import Reactions, kinetostatics
from .motion_range import describe
from .newton_group import Group, to_lock

BLOCK = (
    8000  # positions: a complex temporary stays under 128 KiB, from where on the allocator maps fresh pages for each
)


def solve(scene: Scene, position: ArrayLike, time: ArrayLike | None = None) -> Motion:
    """Solve a scene at the given positions of the drive, each on its own: in closed form, but for groups without dyads.

    Args:
        scene: the mechanism.
        position: the crank angle, rad, or the driven slider's displacement, m; shape (n,), in any order.
        time: the instants, s, shape (n,), which tell the rate and acceleration that the motion law asks for there.
            At a constant speed they are told by the position.

    Returns:
        Every channel of the scene, shape (n,), SI, and of every dyad `transmission` and `to_lock`.

    Raises:
        Failure: `unsupported` when the sketch leaves a branch open, `cannot_assemble` at the first position where the
            bodies do not reach.
        ValueError: the drive follows a law, and no instants are given.
    """
    return solve_decomposed(scene, decompose(scene), position, time)


def solve_decomposed(
    scene: Scene, linkage: Decomposition, position: ArrayLike, time: ArrayLike | None = None
) -> Motion:
    """Solve a scene as `solve` does, by a decomposition that is at hand."""
    position = np.array(position, dtype=np.float64)
    if isinstance(scene.drive, ConstantSpeed):
        time = (position - scene.drive.start) / scene.drive.speed
        driven = Driven(position, np.array(scene.drive.speed), np.array(0.0))
    elif time is None:
        raise ValueError("a drive that follows a law needs the instants")
    else:
        time = np.array(time, dtype=np.float64)
        driven = scene.drive.at(time)._replace(position=position)
    vector_names, scalar_names = _names(scene, linkage)
    # Two large arrays: the system hands those out in huge pages, many small ones cost several times their writing.
    vectors = np.empty((len(vector_names), len(position)), complex)
    scalars = np.empty((len(scalar_names), len(position)))
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):  # not finite is an outcome, told by its status
        for start in range(0, len(position), BLOCK):
            block = slice(start, start + BLOCK)
            k = kinematics(scene, linkage, Driven(*(x[block] if x.ndim else x for x in driven)))
            _check_reach(scene, linkage, k, position[block])
            on = kinetostatics(scene, linkage, k) if scene.has_masses else Reactions()
            for row, vector in zip(vectors, _vectors(scene, k, on), strict=True):
                row[block] = vector
            for row, scalar in zip(scalars, _scalars(scene, linkage, k, on), strict=True):
                row[block] = scalar
    samples = {"time": time, scene.drive_channel: position}
    for (x, y), row in zip(vector_names, vectors, strict=True):
        samples |= {x: row.real, y: row.imag}
    samples |= zip(scalar_names, scalars, strict=True)
    own = [name for group in linkage.groups for name in _lock_channels(group)]
    return Motion({channel: samples[channel] for channel in (*channels(scene), *own)})


def _check_reach(scene: Scene, linkage: Decomposition, k: Kinematics, position: Samples) -> None:
    for joint, reach in k.reach.items():  # in solving order: the first that fails is negative, what hangs on it is NaN
        if (reach < 0).any():
            first = position[int(np.argmax(np.broadcast_to(reach, position.shape) < 0))]
            why = f"{joint} cannot be reached at {scene.where(float(first))}; {describe(scene, linkage)}"
            raise Failure(Status.cannot_assemble, why)


def _names(scene: Scene, linkage: Decomposition) -> tuple[list[tuple[str, str]], list[str]]:
    """Return the channels' names, the vectors' by pairs, in the order of `_vectors` and `_scalars`."""
    vectors = [(f"{p}.{q}x", f"{p}.{q}y") for p in scene.moving_points for q in ("", "v", "a")]
    scalars = [f"{name}.{q}" for name in scene.turning for q in ("angle", "omega", "alpha")]
    if scene.has_masses:
        vectors += [(f"{pin.channel}.fx", f"{pin.channel}.fy") for pin in scene.pins]
        scalars += [f"{name}.{q}" for name in _sliding(scene) for q in ("guide_force", "guide_moment")]
        scalars += ["drive.torque" if scene.driven_slide is None else "drive.force"]
    return vectors, scalars + [name for group in linkage.groups for name in _lock_channels(group)]


def _vectors(scene: Scene, k: Kinematics, on: Reactions) -> Iterator[Vectors]:
    for p in scene.moving_points:
        yield from (k.z[p], k.v[p], k.a[p])
    if scene.has_masses:
        for pin in scene.pins:
            yield on.pin[pin.point, pin.second]


def _scalars(scene: Scene, linkage: Decomposition, k: Kinematics, on: Reactions) -> Iterator[Samples]:
    for name in scene.turning:
        u = k.u[name]
        yield from (np.arctan2(u.imag, u.real), k.omega[name], k.alpha[name])
    if scene.has_masses:
        for name in _sliding(scene):
            yield from on.guide[name]
        yield on.effort
    for group in linkage.groups:
        joint = inner_joint(group)
        if isinstance(group, Group):
            yield to_lock(linkage.tracks[group].equations, k.jacobian[joint])
        else:
            g1, g2, det = k.closure[joint]
            yield np.arctan2(np.abs(det), np.abs(dot(g1, g2)))
            if joint in k.to_lock:
                yield k.to_lock[joint]


def _lock_channels(group: Dyad | Group) -> list[str]:
    """Return what a group says about how near it is to a lock; two crossing guides lock at no length."""
    joint = inner_joint(group)
    if isinstance(group, Group):
        return [f"{joint}.to_lock"]
    return [f"{joint}.transmission", *([f"{joint}.to_lock"] if kind(group) in ("RRR", "RRP", "RPR") else [])]


def _sliding(scene: Scene) -> list[str]:
    return [body.name for body in scene.bodies.values() if body.slide is not None]
