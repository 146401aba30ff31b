"""Many machines of one topology in the same array operations: their numbers have shape (m, 1), positions (n,).

What does not differ stays a plain number, or samples of shape (n,), and is found once for all machines.
"""

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenes import Failure, InputError, Motion, Scene, Status
from scenes.arguments import finite_numbers
from scenes.machines import machines, refused
from scenes.motion import Samples

from .decomposition import Decomposition, decompose, inner_joint
from .group_equations import Group
from .kinematics import kinematics
from .kinetostatics import Reactions, StrokeEnds
from .misfit import of_dyad
from .motion_range import in_line
from .numbers import of_machines, row_by_row
from .placing import Kinematics
from .solve import BLOCK, Answer, Solver, driven_at, prepared, sentence, where_open

TOGETHER = 64  # machines whose larger groups are followed together
NOWHERE = complex(np.nan, np.nan)

Ending: TypeAlias = tuple[Status, str]  # and why, empty where it is ok


@dataclass(frozen=True)
class Machines:
    """The answers of m machines: channel name -> samples of shape (m, n), SI; and how each machine ended.

    Where a machine does not assemble, its samples are NaN.
    """

    samples: Mapping[str, Samples]
    status: Sequence[Status]
    reason: Sequence[str]  # why the status is not ok; empty where it is

    def __getitem__(self, channel: str) -> Samples:
        """Return the samples of a channel by its name, shape (m, n), in the unit of `scenes.motion.UNITS`.

        Raises:
            KeyError: there is no such channel; the message names the nearest one.
        """
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
        The channels, each of shape (m, n), and the status of each machine, with where and why it cannot assemble.

    Raises:
        Failure: the linkage has bodies that are held twice over.
        InputError: there is no number at a path, or one that cannot differ, or two paths lead to the same one.
        InputError: the numbers are not as many for each path; positions or instants are of another shape; or as of
            `solve`.
    """
    return many_solver(scene, changes, channels)(position, time)


def many_solver(
    scene: Scene, changes: Mapping[str, ArrayLike], channels: AbstractSet[str] | None = None
) -> "ManySolver":
    """Return `solve_many` for many calls, with what it raises: the machines are decomposed only once."""
    with np.errstate(all="ignore"):  # machines that no file could describe are named
        many = machines(scene, changes)
        count = len(np.ravel(next(iter(changes.values())))) if changes else 1
        whole = decompose(many)
        failed = {machine: (Status.cannot_assemble, why) for machine, why in refused(many).items()}
        for group in whole.groups:
            for machine in np.flatnonzero(np.isnan(1 if isinstance(group, Group) else group.branch)).tolist():
                why = f"the sketch leaves the assembly branch open: {in_line(group)}"
                failed.setdefault(machine, (Status.unsupported, why))
        together = TOGETHER if any(isinstance(group, Group) for group in whole.groups) else count
        parts = []
        each = of_machines((many, whole)) if together < count else lambda _: (many, whole)
        for first in range(0, max(count, 1), max(together, 1)):
            rows = slice(first, min(first + together, count))
            some, groups = each(rows)
            parts.append((rows, prepared(some, groups, channels, rows.stop - first)))
    return ManySolver(many, whole, failed, parts, count)


@dataclass(frozen=True)
class Block:
    """Some machines at some positions: what is known there, and where a group does not reach."""

    rows: slice
    columns: slice
    k: Kinematics
    on: Reactions
    position: Samples  # of the drive, rad or m, shape (columns,) or (rows, columns)
    unreached: NDArray[np.bool_] | None  # shape (rows, columns); None where all reach


@dataclass(frozen=True)
class ManySolver:
    """The machines of one topology, prepared for many calls."""

    scene: Scene  # with numbers of shape (m, 1)
    whole: Decomposition  # with the same
    failed: Mapping[int, Ending]  # machines that are solved at no position
    parts: Sequence[tuple[slice, Solver]]  # some machines after others
    count: int  # m

    def __call__(self, position: ArrayLike, time: ArrayLike | None = None) -> Machines:
        """Solve as `solve_many` does, with what it returns and raises."""
        position, time = finite_numbers("position", position), time if time is None else finite_numbers("time", time)
        shape = (self.count, *(position.shape[-1:] or (1,)))
        for name, given in (("position", position), ("time", position if time is None else time)):
            if given.shape not in (shape[1:], shape):
                raise InputError(f"{name}: expected the shape {shape[1:]} or {shape}, found {given.shape}")
        _, first = self.parts[0]
        answer = Answer(first, shape, np.float64)
        endings = Endings(self.count, self.failed)
        for block in self.blocks(position, time, endings):
            finite: NDArray[np.bool_] = np.array(True)
            for row, values in answer.taken(block.k, block.on):
                part = row[block.rows, block.columns]
                part[...] = values
                finite = finite & np.isfinite(part.view(np.float64).sum(axis=-1))
                if block.unreached is not None:
                    part[block.unreached] = NOWHERE if np.iscomplexobj(row) else np.nan
            endings.check(block.rows, finite)
        with np.errstate(all="ignore"):  # a speed of zero, which is refused
            instants, _ = driven_at(self.scene, position, time)
        samples = answer.samples(*(np.broadcast_to(x, shape) for x in (instants, position)))
        return Machines(samples, *endings.told())

    def blocks(self, position: Any, time: ArrayLike | None, endings: "Endings") -> Iterator[Block]:
        """Yield what is known of blocks of machines and positions, whose temporaries stay in cache."""
        n = position.shape[-1]
        height = max(1, 2 * BLOCK // max(n, 1))  # numbers of machines are cut for each block, which is best done seldom
        with np.errstate(all="ignore"), row_by_row(n):  # what is not finite gets a status
            for whole, solver in self.parts_and_ones(endings):
                some = of_machines(solver) if height < whole.stop - whole.start else None
                for first in range(whole.start, whole.stop, height):
                    rows = slice(first, min(first + height, whole.stop))
                    part = solver if some is None else some(slice(rows.start - whole.start, rows.stop - whole.start))
                    for start in range(0, n, BLOCK):
                        columns = slice(start, min(start + BLOCK, n))
                        at = _part(position, rows, columns)
                        when = None if time is None else _part(np.asarray(time, np.float64), rows, columns)
                        _, here = driven_at(part.scene, at, when)
                        k = kinematics(part.scene, part.linkage, here, rates=part.rates)
                        beyond = endings.reached(rows, part, k, np.broadcast_to(here.position, _shape(rows, columns)))
                        yield Block(rows, columns, k, part.reactions(k), here.position, beyond)

    @property
    def stroke_ends(self) -> StrokeEnds:
        """Return each press force's end of the stroke, of all machines."""
        _, first = self.parts[0]
        return {
            number: np.concatenate([np.reshape(part.stroke_ends[number], (-1, 1)) for _, part in self.parts])
            for number in first.stroke_ends
        }

    def parts_and_ones(self, endings: "Endings") -> Iterator[tuple[slice, Solver]]:
        """Yield some machines after others, then those of which a larger group is to be followed alone."""
        yield from self.parts
        _, some = self.parts[0]
        for machine in sorted(endings.alone):
            endings.alone.remove(machine)
            each = of_machines((self.scene, self.whole))
            try:
                one, groups = each((machine, 0))
                yield slice(machine, machine + 1), prepared(one, groups, some.request.channels)
            except Failure as failure:
                endings.failed[machine] = failure.status, failure.reason


class Endings:
    """How each machine ends: the first thing that stops it."""

    def __init__(self, count: int, failed: Mapping[int, Ending]) -> None:
        self.count, self.failed = count, dict(failed)
        self.alone: set[int] = set()  # machines that are to be solved alone, for a larger group's sake

    def reached(self, rows: slice, part: Solver, k: Kinematics, position: Samples) -> NDArray[np.bool_] | None:
        """Note where a group of a machine does not reach first; return all such places, None for none."""
        beyond: NDArray[np.bool_] | None = None
        for joint, reach in k.reach.items():
            if (reach < 0).any():
                short = np.broadcast_to(reach < 0, position.shape)
                new = short if beyond is None else short & ~beyond
                beyond = short.copy() if beyond is None else beyond | short
                group = next(group for group in part.linkage.groups if inner_joint(group) == joint)
                company = isinstance(group, Group) and part.linkage.tracks[group].machines
                for row in np.flatnonzero(new.any(axis=1)).tolist():
                    machine = rows.start + row
                    if machine in self.failed or machine in self.alone:
                        continue
                    if company:
                        self.alone.add(machine)
                        beyond[row] = True
                        continue
                    at = int(new[row].argmax())
                    where = float(position[row, at])
                    if isinstance(group, Group):
                        one, linkage = of_machines((part.scene, part.linkage))((row, 0))
                        why = where_open(one, linkage, joint, where)
                    else:
                        to_lock = np.broadcast_to(k.to_lock[joint], position.shape)
                        why = sentence(part.scene, joint, where, of_dyad(part.scene, group, float(to_lock[row, at])))
                    self.failed[machine] = Status.cannot_assemble, f"{why}; {in_line(group)}"
        return beyond

    def check(self, rows: slice, finite: NDArray[np.bool_]) -> None:
        """Note machines of which a sample is not finite, shape (rows,)."""
        why = "a channel holds values that are not finite"
        for row in np.flatnonzero(~np.broadcast_to(finite, rows.stop - rows.start)).tolist():
            if (machine := rows.start + row) not in self.alone:
                self.failed.setdefault(machine, (Status.nonfinite, why))

    def told(self) -> tuple[tuple[Status, ...], tuple[str, ...]]:
        """Return each machine's status, and why it is not ok."""
        endings = [self.failed.get(machine, (Status.ok, "")) for machine in range(self.count)]
        return tuple(status for status, _ in endings), tuple(why for _, why in endings)


def _part(samples: Any, rows: slice, columns: slice) -> Any:
    """Return the samples, shape (n,) or (m, n), of some machines and positions."""
    return samples[rows, columns] if len(samples.shape) == 2 else samples[columns]


def _shape(rows: slice, columns: slice) -> tuple[int, int]:
    return rows.stop - rows.start, columns.stop - columns.start
