"""Many machines of one topology by the line of their formulas: their numbers have shape (m, 1), positions (n,).

The formulas are recorded once, with the numbers open in which machines differ, and evaluated for all machines at once.
Left to the core, one machine at a time, are channels that no line has (`Program.own`), and machines with a position
that the line does not reach or a value that is not finite. What stops the core is that machine's status alone.
"""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenes import Failure, InputError, Motion, Scene, Status
from scenes.arguments import finite_numbers, names
from scenes.drive import Driven, Samples
from scenes.file.changes import numbers_of, refused
from scenes.model.inputs import passing
from scenes.model.lookup import Later

from ..core.decomposition import decompose
from ..core.groups.continuation import Track
from ..core.groups.group_equations import Group, equations_of
from ..solve import Solver, not_reached, prepared, solver, where_open
from ..way.motion_range import in_line, motion_at
from ..way.slider import furthest
from ..way.windings import Winding
from .arithmetics.in_numpy import StraightLine
from .branches import branches
from .expressions import Line
from .meetings import Ending, meeting, near_meeting
from .program import Program, inputs_at, recorded

MAX_TOGETHER = 64  # machines whose strokes' ends are sought together


@dataclass(frozen=True)
class Machines:
    """The answers of m machines: channel name -> samples (m, n), SI, NaN where one does not assemble; how it ended."""

    samples: Mapping[str, Samples]
    status: Sequence[Status]
    reason: Sequence[str]  # why the status is not ok; empty where it is

    def __getitem__(self, channel: str) -> Samples:
        """Return the samples of a channel by its name, shape (m, n), in the unit of `scenes.channels`."""
        return Motion(self.samples)[channel]

    def __contains__(self, channel: str) -> bool:
        """Whether the channel was computed."""
        return channel in self.samples

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Return which machines are ok, shape (m,)."""
        return np.array([status is Status.ok for status in self.status], np.bool_)


def solve_many(
    scene: Scene,
    changes: Mapping[str, ArrayLike],
    position: ArrayLike,
    time: ArrayLike | None = None,
    channels: AbstractSet[str] | None = None,
) -> Machines:
    """Solve many machines that differ in some numbers, each as `solve` does; none spoils another.

    Args:
        scene: the mechanism.
        changes: by path in its file (`bodies.rocker.lengths.O-P3`), in the file's units, a number for each of m
            machines, shape (m,).
        position: the crank angle, rad, or the driven slider's displacement, m; shape (n,), or (m, n) for positions of
            each machine's own.
        time: as of `solve`, of shape (n,) or (m, n) too.
        channels: as of `solve`.

    Returns:
        The channels, each of shape (m, n), and the status of each machine, with where and why it does not go. Where
        all channels are asked for, the `to_lock` of a larger group is found when it is first looked up.

    Raises:
        Failure: the linkage has bodies that are held twice over.
        InputError: there is no number at a path, or one that cannot differ, or two paths lead to the same one.
        InputError: the numbers are not as many for each path; positions or instants are of another shape; or as of
            `solve`.
    """
    return many_solver(scene, changes, channels)(position, time)


@np.errstate(all="ignore")  # machines that no file could describe are named
def many_solver(
    scene: Scene,
    changes: Mapping[str, ArrayLike],
    channels: AbstractSet[str] | None = None,
    at_hand: tuple[Program, Line] | None = None,
) -> "ManySolver":
    """Return `solve_many` for many calls, with what it raises: the formulas are recorded only once.

    Unless there is a line `at_hand`, of which all numbers that differ are open.
    """
    numbers = numbers_of(scene, changes)
    many, count = scene.with_numbers(numbers), max(map(len, numbers.values()), default=1)
    asked = None if channels is None else frozenset(names("channels", channels))
    program, line = at_hand or _line(scene, frozenset(numbers), asked)
    failed = {machine: (Status.cannot_assemble, why) for machine, why in refused(many).items()}
    try:
        tracks = branches(scene, program, numbers, count)
        wound = solver(scene, program.request.channels).windings if scene.torsion_springs else {}
    except Failure:
        tracks, wound = None, {}
    ends = {} if tracks is None else _stroke_ends(many, program, tracks)
    return ManySolver(scene, program, line, numbers, ends, tracks, failed, count, wound)


@lru_cache(maxsize=4)  # block after block of machines of one scene are solved
def _line(scene: Scene, paths: frozenset[str], channels: frozenset[str] | None) -> tuple[Program, Line]:
    program = recorded(scene, paths, channels)
    return program, StraightLine(program.rows)


@dataclass(frozen=True)
class ManySolver:
    """The machines of one topology, prepared for many calls."""

    scene: Scene  # as drawn
    program: Program
    line: Line
    numbers: Mapping[str, Samples]  # that differ, by path, SI, shape (m, 1)
    stroke_ends: Mapping[str, Samples]  # by input, m, shape (m, 1)
    tracks: Sequence[Mapping[Group, Track]] | None  # of each machine's larger groups; None where all go alone
    failed: Mapping[int, Ending]  # machines that no file may describe, and why
    count: int  # m
    windings: Mapping[str, Winding]  # by input, as of the scene as drawn
    cores: dict[int, Solver] = field(default_factory=dict)  # of machines that the line does not have all of

    def __call__(self, position: ArrayLike, time: ArrayLike | None = None) -> Machines:
        """Solve as `solve_many` does, with what it returns and raises."""
        position, time = finite_numbers("position", position), time if time is None else finite_numbers("time", time)
        shape = (self.count, *(position.shape[-1:] or (1,)))
        for name, given in (("position", position), ("time", position if time is None else time)):
            if given.shape not in (shape[1:], shape):
                raise InputError(f"{name}: expected the shape {shape[1:]} or {shape}, found {given.shape}")
        several, by_core = self.between(position), self.program.own
        failed = dict(several.failed)
        late = by_core if self.program.request.channels is None else frozenset[str]()
        samples = several.block(slice(0, self.count), position, time, failed, by_core - late)
        every = samples | {channel: partial(several._late, channel, position, time) for channel in late}
        found = Later({channel: every[channel] for channel in self.program.names}) if late else samples
        return Machines(found, *told(failed, self.count))

    def _late(self, channel: str, position: Samples, time: Samples | None) -> Samples:
        """One channel that is left to the core."""
        return self.block(slice(0, self.count), position, time, dict(self.failed), frozenset([channel]))[channel]

    def between(self, position: Samples) -> "ManySolver":
        """The same for positions, (n,) or (m, n), with machines failed whose assemblies meet among or before them."""
        found = meeting([machine for machine in self.near if machine not in self.failed], self._followed, position)
        return replace(self, failed={**self.failed, **found}) if found else self

    @cached_property
    def near(self) -> Sequence[int]:
        """The machines whose assemblies may meet somewhere."""
        return near_meeting(self.scene, self.program, self.numbers, self.tracks or ())

    @np.errstate(all="ignore")  # a speed of zero, which is refused
    def block(
        self,
        rows: slice,
        position: Samples,
        time: Samples | None,
        failed: dict[int, Ending],
        left: AbstractSet[str] | None = None,
    ) -> dict[str, Samples]:
        """The channels of some machines, in the order of the files; NaN where one is stopped, which `failed` takes in.

        Their positions and instants have the shape (n,) or (rows, n). Of those that are left to the core some may be
        asked for; None for all.
        """
        by_core = self.program.own if left is None else left
        numbers = {path: values[rows] for path, values in {**self.numbers, **self.stroke_ends}.items()}
        shape = (rows.stop - rows.start, position.shape[-1])
        drive = {path: values for path, values in numbers.items() if path in ("drive.speed", "drive.start")}
        inputs = passing(self.scene.with_numbers(drive), position, time, axes=2)
        instants, driven = inputs.time, inputs.driven()
        if self.tracks is None:
            filled = np.full((len(self.program.rows), *shape), np.nan)
        else:
            given = {name: winding(position) for name, winding in self.windings.items()} | {"time": instants}
            filled = self.line({**numbers, **inputs_at(driven, self.tracks[rows]), **given})
        stopped = ~(filled[-1] >= 0)
        stopped[[machine - rows.start for machine in self.failed if rows.start <= machine < rows.stop]] = True
        if stopped.any():
            filled[:, stopped] = np.nan
        channels = {name: np.full(shape, np.nan) for name in by_core}
        channels |= zip(self.program.channels, filled, strict=False)
        # One sum finds any value that is not finite in a machine's rows.
        fine = ~stopped.any(axis=1) & np.isfinite(filled.sum(axis=(0, 2)))
        for row in range(shape[0]) if by_core else np.flatnonzero(~fine).tolist():
            if (machine := rows.start + row) not in self.failed:
                places = position[row] if position.ndim == 2 else position
                when = time[row] if time is not None and time.ndim == 2 else time
                unknown = {name: channels[name][row] for name in (by_core if fine[row] else channels)}
                if ending := self._alone(machine, places, when, unknown, followed=bool(fine[row])):
                    failed.setdefault(machine, ending)
        given = {"time": instants, self.scene.channels.drive.position: position}
        channels |= {name: np.broadcast_to(values, shape) for name, values in given.items()}
        return {name: channels[name] for name in self.program.names if name in channels}

    def _alone(
        self, machine: int, position: Samples, time: Samples | None, samples: Mapping[str, Samples], *, followed: bool
    ) -> Ending | None:
        """Let the core fill in a machine's samples, of the positions' shape; what stops it as of one run, if anything.

        Its larger groups are `followed` already where the line has all else.
        """
        ending: Ending | None = None
        try:
            core = self.cores.get(machine) or self._core(machine, followed=followed)
            k = motion_at(core.scene, core.linkage, position)
            reached = np.ones(position.shape, np.bool_)
            for reach in k.reach.values():
                reached &= ~(reach < 0)
            if (stop := not_reached(core.linkage, k, position)) is not None:
                ending = Status.cannot_assemble, f"{where_open(core.scene, core.linkage, *stop)}; {in_line(stop[0])}"
            motion = core(position[reached], time if time is None else time[reached])
        except Failure as failure:  # the joints do not go together, or friction holds them
            return failure.status, failure.reason
        for channel, values in samples.items():
            values[...] = np.nan
            values[reached] = motion[channel]
        if not all(np.isfinite(motion[channel]).all() for channel in samples):
            return ending or (Status.nonfinite, "a channel holds values that are not finite")
        return ending

    def _followed(self, machine: int) -> Solver:
        return self.cores.get(machine) or self._core(machine, followed=True)

    def _core(self, machine: int, *, followed: bool) -> Solver:
        """The core's solver of one machine, which is kept."""
        variant = self.scene.with_numbers({path: float(values[machine, 0]) for path, values in self.numbers.items()})
        whole, tracks = decompose(variant), self.tracks[machine] if self.tracks is not None and followed else {}
        tracked = {g: replace(track, equations=equations_of(variant, whole.bodies, g)) for g, track in tracks.items()}
        self.cores[machine] = prepared(variant, replace(whole, tracks=tracked), self.program.request.channels)
        return self.cores[machine]


def told(failed: Mapping[int, Ending], count: int) -> tuple[tuple[Status, ...], tuple[str, ...]]:
    """Return each machine's status, and why it is not ok."""
    endings = [failed.get(machine, (Status.ok, "")) for machine in range(count)]
    return tuple(status for status, _ in endings), tuple(why for _, why in endings)


def _stroke_ends(many: Scene, program: Program, tracks: Sequence[Mapping[Group, Track]]) -> dict[str, Samples]:
    """Where each machine's closing strokes end, m, shape (m, 1), by the load's place; none where no force is wanted."""
    # of all, as the line may be of numbers that do not differ too
    numbers = {path: np.broadcast_to(number.value, (len(tracks), 1)) for path, number in many.numbers.items()}
    parts = [slice(first, first + MAX_TOGETHER) for first in range(0, max(len(tracks), 1), MAX_TOGETHER)]

    def displaced(line: Line, rows: slice, way: Samples) -> Samples:
        machine = {path: values[rows] for path, values in numbers.items()}
        return line({**machine, **inputs_at(Driven(way, np.ones(()), np.zeros(())), tracks[rows])})

    ends: dict[str, Samples] = {}
    for place, moved in program.strokes.items():
        each = [
            np.broadcast_to(bound, (len(tracks), 1)) for bound in (many.presses[place].closing, *many.drive.law.extent)
        ]
        move = partial(displaced, StraightLine(moved))
        of_parts = [furthest(partial(move, rows), *(values[rows] for values in each)) for rows in parts]
        ends[place] = np.concatenate(of_parts)[:, np.newaxis]
    return ends
