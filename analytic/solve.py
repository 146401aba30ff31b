"""Scene and positions of the drive in, motion out: block by block, so that every temporary stays in cache."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from scenes import Failure, Motion, Scene, Status
from scenes.drive import Driven
from scenes.motion import Samples, asks_forces, channels, quantity
from scenes.scene import ConstantSpeed

from .channels import Channels, FromBoth, scalar_channels, vector_channels
from .decomposition import Decomposition, decompose, members
from .kinematics import kinematics
from .kinetostatics import Reactions, kinetostatics
from .motion_range import describe
from .placing import Kinematics

BLOCK = (
    8000  # positions: a complex temporary stays under 128 KiB, from where on the allocator maps fresh pages for each
)

MotionAt: TypeAlias = Callable[[Scene, Decomposition, Driven], Kinematics]


class Solver(Protocol):
    """Positions of the drive, and instants where it follows a law, to motion."""

    def __call__(self, position: ArrayLike, time: ArrayLike | None = None) -> Motion:
        """Solve, as `solve` says."""


def solve(scene: Scene, position: ArrayLike, time: ArrayLike | None = None) -> Motion:
    """Solve a scene at the given positions of the drive, each on its own: in closed form, but for groups without dyads.

    Args:
        scene: the mechanism.
        position: the crank angle, rad, or the driven slider's displacement, m; shape (n,), in any order.
        time: the instants, s, shape (n,), which tell the rate and acceleration that the motion law asks for there.
            At a constant speed the position tells all of that, and the instants where none are given.

    Returns:
        Every channel that the scene asks for, shape (n,), SI; if that is all, `transmission` and `to_lock` too.

    Raises:
        Failure: `unsupported` when the sketch leaves a branch open, `cannot_assemble` at the first position where the
            bodies do not reach.
        ValueError: the drive follows a law, and no instants are given.
    """
    return solver(scene)(position, time)


def solver(scene: Scene) -> Solver:
    """Return `solve` of one scene, which decomposes it, and follows what Newton solves, only once.

    Raises:
        Failure: `unsupported`, as `solve` says.
    """
    return partial(solve_decomposed, scene, decompose(scene))


def solve_decomposed(
    scene: Scene,
    linkage: Decomposition,
    position: ArrayLike,
    time: ArrayLike | None = None,
    motion_at: MotionAt | None = None,
) -> Motion:
    """Solve a scene as `solve` does, by a decomposition that is at hand, and another way to its motion if there is one.

    The precision is single where that of the positions is.
    """
    single = isinstance(position, np.ndarray) and position.dtype == np.float32
    position = np.array(position, dtype=np.float32 if single else np.float64)
    time, driven = _driven(scene, position, time)
    linkage = _needed(scene, linkage)
    motion_at = motion_at or partial(kinematics, rates=_asks_rates(scene))
    vectors, scalars = _asked(scene, vector_channels(scene)), _asked(scene, scalar_channels(scene, linkage))
    # Two large arrays: the system hands those out in huge pages, many small ones cost several times their writing.
    planes = np.empty((len(vectors), len(position)), np.result_type(position, np.complex64))
    lines = np.empty((len(scalars), len(position)), position.dtype)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):  # not finite is an outcome, told by its status
        for start in range(0, len(position), BLOCK):
            block = slice(start, start + BLOCK)
            k = motion_at(scene, linkage, Driven(*(x[block] if x.ndim else x for x in driven)))
            _check_reach(scene, linkage, k, position[block])
            on = kinetostatics(scene, linkage, k) if asks_forces(scene) else Reactions()
            for rows, takes in ((planes, vectors.values()), (lines, scalars.values())):
                for row, take in zip(rows, takes, strict=True):
                    row[block] = take(k, on)
    samples = {"time": time, scene.drive_channel: position}
    for (x, y), row in zip(vectors, planes, strict=True):
        samples |= {x: row.real, y: row.imag}
    samples |= {name: row for (name,), row in zip(scalars, lines, strict=True)}
    known = dict.fromkeys(channels(scene))
    own = (name for (name,) in scalars if name not in known)
    return Motion({channel: samples[channel] for channel in (*known, *own)})


def _driven(scene: Scene, position: Samples, time: ArrayLike | None) -> tuple[Samples, Driven]:
    if time is not None:
        time = np.array(time, dtype=np.float64)
    if isinstance(scene.drive, ConstantSpeed):
        told = (position - scene.drive.start) / scene.drive.speed if time is None else time
        return told, Driven(position, np.array(scene.drive.speed), np.array(0.0))
    if time is None:
        raise ValueError("a drive that follows a law needs the instants")
    return time, scene.drive.at(time)._replace(position=position)


def _asked(scene: Scene, known: Iterator[Channels]) -> dict[tuple[str, ...], FromBoth]:
    return {names: take for names, take in known if scene.asked is None or scene.asked.intersection(names)}


def _asks_rates(scene: Scene) -> bool:
    still = ("time", "crank_angle", "displacement", "x", "y", "angle")
    return any(quantity(channel) not in still for channel in channels(scene))


def _needed(scene: Scene, linkage: Decomposition) -> Decomposition:
    """Return the linkage without the last groups, unless a force, or a point or body of theirs, is asked for."""
    if scene.asked is None or asks_forces(scene):
        return linkage
    asked = {channel.rpartition(".")[0] for channel in scene.asked}
    count = len(linkage.groups)
    while count and not any({body, *linkage.carries[body]} & asked for body in members(linkage.groups[count - 1])):
        count -= 1
    return replace(linkage, groups=linkage.groups[:count])


def _check_reach(scene: Scene, linkage: Decomposition, k: Kinematics, position: Samples) -> None:
    for joint, reach in k.reach.items():  # in solving order: the first that fails is negative, what hangs on it is NaN
        if (reach < 0).any():
            first = position[int(np.argmax(np.broadcast_to(reach, position.shape) < 0))]
            why = f"{joint} cannot be reached at {scene.where(float(first))}; {describe(scene, linkage)}"
            raise Failure(Status.cannot_assemble, why)
