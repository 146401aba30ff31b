"""Scene and positions of the drive in, motion out: block by block, so that every temporary stays in cache."""

from collections.abc import Callable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from itertools import chain
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from scenes import Failure, InputError, Motion, Request, Sampling, Scene, Status
from scenes.arguments import finite_numbers, known_names
from scenes.drive import Driven
from scenes.motion import Samples, quantity
from scenes.scene import ConstantSpeed, PressForce

from .channels import Channels, FromBoth, scalar_channels, vector_channels
from .dead_points import stroke_end
from .decomposition import Decomposition, decompose, inner_joint, members
from .dyads import Vectors
from .group_equations import Group
from .kinematics import Linkage, followed, kinematics, placed
from .kinetostatics import Reactions, StrokeEnds, kinetostatics
from .misfit import of_dyad, of_group
from .motion_range import describe
from .placing import Kinematics

BLOCK = 8000  # positions, whose temporaries stay in cache
# glibc maps fresh pages for what is larger than the largest block of under 32 MiB that was given back so far, and gives
# back what is free above twice that: with its first limits, temporaries' pages are half of a solution's time.
np.empty(31 << 17)
STILL = ("time", "crank_angle", "displacement", "x", "y", "angle")  # quantities that need no rates

MotionAt: TypeAlias = Callable[[Scene, Linkage, Driven], Kinematics]


def solve(
    scene: Scene, position: ArrayLike, time: ArrayLike | None = None, channels: AbstractSet[str] | None = None
) -> Motion:
    """Solve a scene at the given positions of the drive, each on its own: in closed form, but for groups without dyads.

    Args:
        scene: the mechanism.
        position: the crank angle, rad, or the driven slider's displacement, m; shape (n,), in any order.
        time: the instants, s, shape (n,), from which the motion law has the rate and acceleration of the drive. At a
            constant speed the positions are enough, and the instants follow from them where none are given.
        channels: names of the channels to solve for, besides the time and the drive's position; None for all.

    Returns:
        The channels, each of shape (n,), SI; where all are asked for, `transmission` and `to_lock` too.

    Raises:
        Failure: as of `solver`, and `cannot_assemble` at the first position where the bodies do not reach.
        InputError: no scene, no such channel, or positions or instants that are no finite numbers.
        InputError: the drive follows a law, and no instants are given; or positions or instants are of another shape.
    """
    return solver(scene, channels)(position, time)


def solver(scene: Scene, channels: AbstractSet[str] | None = None) -> "Solver":
    """Return `solve` of one scene for many calls: it is decomposed, and its larger groups are followed, only once.

    Args:
        scene: the mechanism.
        channels: as of `solve`.

    Returns:
        A function of positions and instants, both as of `solve`.

    Raises:
        Failure: `unsupported` when the sketch leaves a branch open or a part is held twice over, `cannot_assemble` when
            a larger group does not close near the sketch.
        InputError: no scene, or no such channel.
    """
    return prepared(scene, decompose(scene), channels)


def prepared(
    scene: Scene, whole: Decomposition, channels: AbstractSet[str] | None = None, machines: int = 1
) -> "Solver":
    """Return the solver of a scene by a decomposition that is at hand, without the groups that are not needed.

    Raises:
        InputError: there is no such channel.
    """
    if channels is not None:
        every = (*vector_channels(scene), *scalar_channels(scene, whole.groups))
        known = ("time", scene.drive_channel, *chain.from_iterable(names for names, _ in every))
        channels = known_names("channels", channels, known)
    request = Sampling(channels=channels)
    forces = request.wants_forces(scene)
    linkage = followed(scene, _needed(whole, request.channels, forces=forces))
    presses = {n: load for n, load in enumerate(scene.loads) if isinstance(load, PressForce) and forces}
    strokes = {n: (load.body, np.asarray(load.closing).tobytes()) for n, load in presses.items()}
    ends = {stroke: stroke_end(scene, linkage, n, machines) for stroke, n in {s: n for n, s in strokes.items()}.items()}
    return Solver(scene, linkage, {n: ends[stroke] for n, stroke in strokes.items()}, request)


@dataclass(frozen=True)
class Solver:
    """One scene, prepared for many calls."""

    scene: Scene
    linkage: Linkage
    stroke_ends: StrokeEnds  # where forces are wanted
    request: Request

    def __call__(self, position: ArrayLike, time: ArrayLike | None = None, motion_at: MotionAt | None = None) -> Motion:
        """Solve as `solve` does, with what it returns and raises.

        Args:
            position: as of `solve`; where it is an array in single precision, so is all that is computed.
            time: as of `solve`.
            motion_at: another way to the kinematics.
        """
        scene, linkage = self.scene, self.linkage
        single = isinstance(position, np.ndarray) and position.dtype == np.float32
        position = finite_numbers("position", position).astype(np.float32 if single else np.float64, copy=False)
        time, driven = driven_at(scene, position, time)
        if position.ndim != 1 or time.ndim != 1:
            raise InputError(f"position, time: expected the shape (n,) of both, found {position.shape}")
        motion_at = motion_at or partial(kinematics, rates=self.rates)
        answer = Answer(self, position.shape, position.dtype)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):  # what is not finite gets a status
            for start in range(0, len(position), BLOCK):
                block = slice(start, start + BLOCK)
                k = motion_at(scene, linkage, Driven(*(x[block] if x.ndim else x for x in driven)))
                check_reach(scene, linkage, k, position[block])
                for row, values in answer.taken(k, self.reactions(k)):
                    row[block] = values
        return Motion(answer.samples(time, position))

    @cached_property
    def known(self) -> tuple[str, ...]:
        """The channels wanted that are no model's own, in the order of the files."""
        return self.request.wanted(self.scene)

    @cached_property
    def vectors(self) -> Mapping[tuple[str, ...], FromBoth]:
        """The channels wanted that are a vector's, and what they are taken from."""
        return _chosen(vector_channels(self.scene), self.request.channels)

    @cached_property
    def scalars(self) -> Mapping[tuple[str, ...], FromBoth]:
        """The other channels wanted."""
        return _chosen(scalar_channels(self.scene, self.linkage.groups), self.request.channels)

    @cached_property
    def rates(self) -> bool:
        """Whether any channel wanted needs velocities or accelerations."""
        return any(quantity(channel) not in STILL for channel in self.known)

    @cached_property
    def forces(self) -> bool:
        """Whether any channel wanted is a force."""
        return self.request.wants_forces(self.scene)

    def __getstate__(self) -> dict[str, Any]:
        """Return what it is made of; what follows from that has functions that no other process can be sent."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def reactions(self, k: Kinematics) -> Reactions:
        """Return the reactions that are wanted, or none."""
        if not self.forces:
            return Reactions()
        return kinetostatics(self.scene, self.linkage, self.stroke_ends, k, self.request.channels)


class Answer:
    """Where the samples of the channels that a solver is asked for go, of any shape of positions."""

    def __init__(self, solver: Solver, shape: tuple[int, ...], precision: DTypeLike) -> None:
        self.known, self.vectors, self.scalars = solver.known, solver.vectors, solver.scalars
        self.drive_channel = solver.scene.drive_channel
        # Two large arrays: the system hands those out in huge pages, many small ones cost several times their writing.
        self.planes = np.empty((len(self.vectors), *shape), np.result_type(precision, np.complex64))
        self.lines = np.empty((len(self.scalars), *shape), precision)

    def taken(self, k: Kinematics, on: Reactions) -> Iterator[tuple[NDArray[Any], Vectors | Samples]]:
        """Yield where samples go, of the answer's shape, and those of a block of positions."""
        for rows, takes in ((self.planes, self.vectors.values()), (self.lines, self.scalars.values())):
            for row, take in zip(rows, takes, strict=True):
                yield row, take(k, on)

    def filled(self, k: Kinematics, on: Reactions, position: Samples) -> dict[str, Samples]:
        """Return the channels by name of an answer that is one block."""
        for row, values in self.taken(k, on):
            row[...] = values
        return self.samples(np.empty(0), np.broadcast_to(position, self.lines.shape[1:]))

    def samples(self, time: Samples, position: Samples) -> dict[str, Samples]:
        """Return the channels by name, in the order of the files, with the instants and the positions of the drive."""
        samples = {"time": time, self.drive_channel: position}
        for (x, y), row in zip(self.vectors, self.planes, strict=True):
            samples |= {x: row.real, y: row.imag}
        samples |= {name: row for (name,), row in zip(self.scalars, self.lines, strict=True)}
        own = (name for (name,) in self.scalars if name not in self.known)
        return {channel: samples[channel] for channel in (*self.known, *own)}


def driven_at(scene: Scene, position: Samples, time: ArrayLike | None) -> tuple[Samples, Driven]:
    """Return the instants, s, and what the drive asks for at them and at its positions, both of one shape.

    Raises:
        InputError: the drive follows a law, and no instants are given; or there are not as many as positions.
    """
    if time is not None:
        time = finite_numbers("time", time)
    if not position.ndim or (time is not None and time.shape[-1:] != position.shape[-1:]):
        found = f"{position.shape}" if time is None else f"{position.shape} and {time.shape}"
        raise InputError(f"position, time: expected the shape (n,) of both, found {found}")
    if isinstance(scene.drive, ConstantSpeed):
        instants = (position - scene.drive.start) / scene.drive.speed if time is None else time
        return instants, Driven(position, np.array(scene.drive.speed), np.array(0.0))
    if time is None:
        raise InputError("a drive that follows a law needs the instants")
    return time, scene.drive.at(time)._replace(position=position)


def _chosen(known: Iterator[Channels], wanted: AbstractSet[str] | None) -> dict[tuple[str, ...], FromBoth]:
    return {names: take for names, take in known if wanted is None or not wanted.isdisjoint(names)}


def _needed(whole: Decomposition, wanted: AbstractSet[str] | None, *, forces: bool) -> Decomposition:
    """Return a decomposition without the last groups, unless a force, or a point or body of theirs, is wanted."""
    if wanted is None or forces:
        return whole
    names = {channel.rpartition(".")[0] for channel in wanted}
    count = len(whole.groups)
    while count and not any({body, *whole.carries[body]} & names for body in members(whole.groups[count - 1])):
        count -= 1
    return replace(whole, groups=whole.groups[:count])


@np.errstate(invalid="ignore", divide="ignore", over="ignore")  # what hangs on a group that does not reach is NaN
def check_reach(scene: Scene, linkage: Linkage, k: Kinematics, position: Samples) -> None:
    """Raise at the first position where a group does not reach.

    Raises:
        Failure: `cannot_assemble`.
    """
    for joint, reach in k.reach.items():  # in solving order: the first that fails is negative, what hangs on it is NaN
        if (reach < 0).any():
            row = int(np.argmax(np.broadcast_to(reach, position.shape) < 0))
            first = float(position[row])
            why = f"{where_open(scene, linkage, joint, first)}; {describe(scene, linkage, first)}"
            raise Failure(Status.cannot_assemble, why)


def where_open(scene: Scene, linkage: Linkage, joint: str, position: float) -> str:
    """Return where a group, known by its inner joint, does not reach, and which joint stays open by how much."""
    group, at = next(group for group in linkage.groups if inner_joint(group) == joint), np.array([position])
    if isinstance(group, Group):
        track, frames = linkage.tracks[group], placed(scene, linkage, group, at)
        open_by = of_group(scene, group, track.equations, track.q[track.nearest(at)], frames.pose)
        return sentence(scene, joint, position, open_by)
    to_lock = kinematics(scene, linkage, Driven(at, np.ones(1), np.zeros(1)), rates=False).to_lock[joint]
    return sentence(scene, joint, position, of_dyad(scene, group, float(np.ravel(to_lock)[0])))


def sentence(scene: Scene, joint: str, position: float, open_by: str) -> str:
    """Return where a group, known by its inner joint, does not reach."""
    return f"{joint} cannot be reached at {scene.where(position)}{open_by}"
