"""Scene and positions of the drive in, motion out: block by block, so that every temporary stays in cache."""

from collections.abc import Callable, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, fields
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from scenes import Failure, InputError, Motion, Request, Scene, Status
from scenes.arguments import finite_numbers
from scenes.channels import Role
from scenes.drive import Driven
from scenes.model.inputs import Inputs, inputs_of, passing
from scenes.model.lookup import Later
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed

from .channels import FromBoth, all_channels, asked, of_larger
from .core.decomposition import Dyad, Linkage, decompose, guides_cross
from .core.elements import Given
from .core.groups.continuation import misfit
from .core.groups.group_equations import Group
from .core.kinematics import followed, kinematics, placed
from .core.kinetostatics import Reactions
from .core.placing import Kinematics
from .core.rubbing_joints import FrictionBalance
from .recorded.arithmetics.in_numpy import StraightLine, blocks
from .recorded.expressions import Line
from .recorded.program import Program, inputs_at, recorded
from .way.motion_range import describe, motion_at
from .way.singular import Meetings, meetings
from .way.slider import stroke_end
from .way.windings import Winding, windings

# glibc maps fresh pages for what is larger than the largest block of under 32 MiB that was given back so far, and gives
# back what is free above twice that: with its first limits, temporaries' pages are half of a solution's time.
np.empty(31 << 17)
RECORDED_FROM = 40_001  # positions of all calls, where recording, some ms, pays: the line takes half the formulas' time
LONG = 1000  # positions of a call: a shorter one is by the formulas whatever else is solved, to the last digit


def solve(
    scene: Scene,
    position: ArrayLike | None = None,
    time: ArrayLike | None = None,
    channels: AbstractSet[str] | None = None,
    *,
    inputs: Inputs | None = None,
) -> Motion:
    """Solve a scene at some inputs of its drives, each on its own: in closed form, but for groups without dyads.

    Expected are positions, instants, both, or inputs.

    Args:
        scene: the mechanism.
        position: the crank angle, rad, or the driven slider's displacement, m; shape (n,), in any order. Where there is
            none, the drive is where it is at the instants.
        time: the instants, s, shape (n,), from which the motion law has the rate and acceleration of the drive. At a
            constant speed the positions are enough, and the instants follow from them where none are given.
        inputs: the instants and the drives' positions, rates and accelerations, whatever the laws of the scene.
        channels: names of the channels to solve for, besides the time and the drive's position; None for all.

    Returns:
        The channels, each of shape (n,), SI; where all are asked for, `transmission` and `to_lock` too. The `to_lock`
        of a larger group, which takes many times as long as all else, is found when it is first looked up.

    Raises:
        Failure: as of `solver`, and `cannot_assemble` at the first position where the bodies do not reach, or where
            two assemblies meet between the positions and the sketch, which then leaves open the one that is meant.
        InputError: no scene, no such channel, or positions or instants that are no finite numbers.
        InputError: the drive follows a law, and no instants are given; or positions or instants are of another shape.
        InputError: none of positions, instants and inputs is given, or inputs beside the others.
    """
    core = solver(scene, channels)
    if (inputs is None) == (position is None and time is None):
        raise InputError("solve: expected either inputs, or position, time or both")
    if inputs is not None:
        return core(inputs)
    if position is None:
        return core(inputs_of(scene, finite_numbers("time", time)))
    return core(position, time)


def solver(scene: Scene, channels: AbstractSet[str] | None = None) -> "Solver":
    """Return `solve` of one scene for many calls: it is decomposed, and its larger groups are followed, only once.

    Raises:
        Failure: `unsupported` when the sketch leaves a branch open or a part is held twice over, `cannot_assemble` when
            a larger group does not close near the sketch.
        InputError: no scene, or no such channel.
    """
    return prepared(scene, decompose(scene), channels)


def prepared(scene: Scene, whole: Linkage, channels: AbstractSet[str] | None = None) -> "Solver":
    """Return the solver by a decomposition, of groups that are needed."""
    request, needed = asked(scene, whole, channels)
    linkage, forces = followed(scene, needed), request.wants_forces(scene)
    presses = scene.presses.items() if forces else ()
    ends = {place: stroke_end(scene, linkage, load.body, load.closing) for place, load in presses}
    return Solver(scene, linkage, ends, request, windings=windings(scene, linkage) if forces else {})


@dataclass(frozen=True)
class Solver:
    """One scene, prepared for many calls."""

    scene: Scene
    linkage: Linkage
    stroke_ends: Mapping[str, float]  # by place in the file, m, where forces are wanted
    request: Request
    at_hand: tuple[Program, Line] | None = None  # the formulas as they are recorded already
    motion_at: Callable[[Scene, Linkage, Driven], Kinematics] | None = None  # another way to the kinematics
    windings: Mapping[str, Winding] = field(default_factory=dict)  # by input, where forces are wanted
    as_sketched: bool = True  # whether its assembly is the one that the sketch picks

    def __call__(self, position: ArrayLike | Inputs, time: ArrayLike | None = None) -> Motion:
        """Solve at positions, and instants or none, or at inputs; with what `solve` returns and raises.

        Where the positions are an array in single precision, so is all that is computed.
        """
        if isinstance(position, Inputs):
            return self._at(position.checked(self.scene))
        single = self.at_hand is None and isinstance(position, np.ndarray) and position.dtype == np.float32
        position = finite_numbers("position", position).astype(np.float32 if single else np.float64, copy=False)
        return self._at(passing(self.scene, position, time), single=single)

    def _at(self, inputs: Inputs, *, single: bool = False) -> Motion:
        time, driven = inputs.time, inputs.driven()
        position = driven.position
        self.check_hull(position)
        # Recording pays after many positions in all calls together.
        self._solved[0] += len(position)
        line_pays = self.at_hand is not None or (len(position) >= LONG and self._solved[0] >= RECORDED_FROM)
        by_line = line_pays and not single and self.motion_at is None and self._is_recorded(driven)
        samples = self._by_line(driven, time) if by_line else None
        if samples is None:  # few positions, or the formulas tell where it does not reach
            samples = self._by_formulas(driven, time)
        drives = enumerate(self.scene.channels.names(Role.input))
        samples |= {"time": time, **{name: inputs.driven(drive).position for drive, name in drives}}
        wanted = *self.known, *self.own
        if not self.later:
            return Motion({channel: samples[channel] for channel in wanted})
        at = partial(self.motion_at or partial(kinematics, rates=False), self.scene, self.linkage)
        every = samples | {channel: partial(_taken, take, at, driven) for channel, take in self.later.items()}
        return Motion(Later({channel: every[channel] for channel in wanted}))

    def _is_recorded(self, driven: Driven) -> bool:
        """Whether the recorded line, in which a constant speed is the scene's own, is of such rates."""
        law = self.linkage.drive.law
        if not isinstance(law, ConstantSpeed):
            return True
        return bool((driven.rate == law.speed).all() and not driven.acceleration.any())

    def _by_line(self, driven: Driven, time: Samples) -> dict[str, Samples] | None:
        """The channels by the recorded line; None where it does not reach, or not all can be had from it."""
        program, line = self.recorded
        rows = line({**self.given_at(driven.position, time), **inputs_at(driven, [self.linkage.tracks])})[:, 0]
        return dict(zip(program.channels, rows, strict=False)) if (rows[-1] >= 0).all() else None

    def _by_formulas(self, driven: Driven, time: Samples) -> dict[str, Samples]:
        """The channels by the formulas themselves, block by block."""
        motion_at = self.motion_at or partial(kinematics, rates=self.needs_rates)
        scene, linkage, position = self.scene, self.linkage, driven.position
        kinds = position.dtype, np.result_type(position.dtype, np.complex64)
        rows = {
            names: np.empty(len(position), kinds[len(names) - 1])
            for names in self.channels
            if self.later.keys().isdisjoint(names)
        }
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):  # what is not finite gets a status

            def at(rows: Any) -> tuple[Given, Kinematics]:
                return self.given_at(position[rows], time[rows]), motion_at(scene, linkage, _rows(driven, rows))

            for _, block in blocks(1, len(position)):
                given, k = at(block)
                check_reach(scene, linkage, k, position[block])
                on = Reactions()
                if self.request.wants_forces(scene):
                    balance = FrictionBalance(scene, linkage, given, k)
                    on = balance.solve()
                    balance.check(block.start, at)
                for names, row in rows.items():
                    row[block] = self.channels[names](k, on)
        return {
            name: part for names, row in rows.items() for name, part in zip(names, (row.real, row.imag), strict=False)
        }

    def check_hull(self, position: Samples) -> None:
        """Raise Failure, `cannot_assemble`, where assemblies meet between positions asked for and the sketch."""
        if not self.as_sketched:
            return
        try:
            self.meetings.check(self.scene, self.linkage, position)
        except Failure:
            check_reach(self.scene, self.linkage, motion_at(self.scene, self.linkage, position), position)
            raise

    @cached_property
    def meetings(self) -> Meetings:
        """Where two assemblies meet."""
        return meetings(self.scene, self.linkage)

    def given_at(self, position: Samples, time: Samples) -> Given:
        """What elements need besides the motion, at positions of the drive and instants, s, of one shape."""
        wound = {name: winding(position) for name, winding in self.windings.items()}
        return {**self.stroke_ends, **wound, "position": position, "time": time}

    @cached_property
    def _solved(self) -> list[int]:
        """How many positions all calls so far had."""
        return [0]

    @cached_property
    def recorded(self) -> tuple[Program, Line]:
        """The recorded formulas, and the line that has their channels and the reach."""
        program, line = self.at_hand or (recorded(self.scene, frozenset(), self.request.channels), None)
        return program, line or StraightLine(program.rows)

    @cached_property
    def known(self) -> tuple[str, ...]:
        """The channels wanted that are no model's own, in the order of the files."""
        return self.request.wanted(self.scene)

    @cached_property
    def needs_rates(self) -> bool:
        """Whether any channel wanted is more than a place or an angle."""
        wanted = (self.scene.channels[name] for name in self.known)
        return any(channel.role is not Role.time and channel.order != 0 for channel in wanted)

    @cached_property
    def own(self) -> tuple[str, ...]:
        """The channels wanted that only this model has."""
        return tuple(name for names in self.channels for name in names if len(names) == 1 and name not in self.known)

    @cached_property
    def channels(self) -> Mapping[tuple[str, ...], FromBoth]:
        """The channels wanted, alone or as a vector's two, and what they are taken from."""
        every, wanted = all_channels(self.scene, self.linkage.groups), self.request.channels
        return {names: take for names, take in every if wanted is None or not wanted.isdisjoint(names)}

    @cached_property
    def later(self) -> Mapping[str, FromBoth]:
        """Those of the channels wanted that are found when they are first looked up, and what they are taken from."""
        costly = of_larger(self.linkage.groups)
        return {names[0]: take for names, take in self.channels.items() if not costly.isdisjoint(names)}

    def __getstate__(self) -> dict[str, Any]:
        """The fields alone: what follows from them has functions that no other process can be sent."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@np.errstate(invalid="ignore", divide="ignore", over="ignore")
def _taken(take: FromBoth, motion_at: Callable[[Driven], Kinematics], driven: Driven) -> Samples:
    """A channel, shape (n,), that follows from the poses alone, block by block."""
    row = np.empty_like(driven.position)
    for _, block in blocks(1, len(row)):
        row[block] = take(motion_at(_rows(driven, block)), Reactions())
    return row


def _rows(driven: Driven, rows: Any) -> Driven:
    """What the drive asks for at some of the positions."""
    return Driven(*(x[rows] if x.ndim else x for x in driven))


@np.errstate(invalid="ignore", divide="ignore", over="ignore")  # what hangs on a group that does not reach is NaN
def check_reach(scene: Scene, linkage: Linkage, k: Kinematics, position: Samples) -> None:
    """Raise Failure, `cannot_assemble`, at the first position where a group does not reach."""
    if (opened := not_reached(linkage, k, position)) is not None:
        why = f"{where_open(scene, linkage, *opened)}; {describe(scene, linkage, opened[1])}"
        raise Failure(Status.cannot_assemble, why, at=(opened[1], opened[0].P))


def not_reached(linkage: Linkage, k: Kinematics, position: Samples) -> tuple[Dyad | Group, float] | None:
    """The first of the positions where a group does not reach, and that group; None where all do."""
    first, least = None, len(position)
    for group in linkage.groups:  # in solving order: the first that fails is negative, what hangs on it is NaN
        short = np.broadcast_to(k.reach.get(group.P, 0.0), position.shape) < 0
        if short.any() and (row := int(short.argmax())) < least:
            first, least = (group, float(position[row])), row
    return first


def where_open(scene: Scene, linkage: Linkage, group: Dyad | Group, position: float) -> str:
    """Where a group does not reach, and which joint stays open by how much."""
    at = np.array([position])
    if isinstance(group, Group):
        track, frames = linkage.tracks[group], placed(scene, linkage, group, at)
        open_by = misfit(scene, group, track.equations, track.q[track.nearest(at)], frames.pose)
    elif guides_cross(group):
        open_by = ""
    else:  # their ends are apart by the distance beyond the singular pose
        k = kinematics(scene, linkage, Driven(at, np.ones(1), np.zeros(1)), rates=False)
        one, two = (leg.body for leg in group.legs)
        open_by = f": {one} and {two} end {scene.length(abs(float(np.ravel(k.to_lock[group.P])[0])))} apart"
    return f"{group.P} cannot be reached at {scene.where(position)}{open_by}"
