"""The core's formulas for one topology as a straight line of real expressions, recorded from the core itself."""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from scenes import Sampling, Scene
from scenes.drive import Driven, Samples
from scenes.scene import ConstantSpeed, PressForce

from ..channels import all_channels, known_channels
from ..core.continuation import Track
from ..core.decomposition import Linkage, decompose, members
from ..core.dyads import dot
from ..core.geometry import guide_of
from ..core.group_equations import Group
from ..core.kinetostatics import Reactions
from ..core.numbers import chosen
from .expressions import Expression, Inputs, Recorder
from .groups import RecordedBalance, RecordedPass, inputs_of
from .traced import Traced, traced


@dataclass(frozen=True)
class Program:
    """Channels as expressions of numbers of the scene, SI, by path, and of what the drive asks for."""

    make: Recorder
    request: Sampling  # with the channels wanted
    scene: Scene  # with numbers as expressions
    linkage: Linkage  # with the same
    closed: Mapping[Group, Expression]  # the larger groups' coordinates
    numbers: Mapping[str, Expression]
    channels: Mapping[str, Expression]
    strokes: Mapping[int, tuple[Expression, Expression]]  # by press force: its slider's displacement, m, and rate
    reach: Expression  # negative where a group does not reach, or its branch is open
    own: frozenset[str]  # channels wanted that are left to the core: how far larger groups are from a singular pose

    @cached_property
    def rows(self) -> list[Expression]:
        """The channels, and the reach last."""
        return [*self.channels.values(), self.reach]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The channels wanted, with the time and the drive's position, in the order of the files."""
        known = self.request.wanted(self.scene)
        return (*known, *(name for name in (*self.channels, *self.own) if name not in known))


def recorded(scene: Scene, paths: AbstractSet[str], channels: AbstractSet[str] | None = None) -> Program:
    """Record the core's own formulas of some channels, in which the numbers at `paths` stay open."""
    make = Recorder()
    numbers = {path: Traced(make, make.input(path, sampled=False)) for path in scene.numbers if path in paths}
    opened = scene.with_numbers(numbers)
    every = decompose(opened)
    channels = known_channels(scene, every.groups, channels)
    request = Sampling(channels=channels)
    forces = request.wants_forces(scene)
    linkage = needed(every, channels, forces=forces)
    driven: Any = Driven(*(Traced(make, make.input(name, sampled=True)) for name in Driven._fields))  # type: ignore[arg-type]
    if isinstance(opened.drive, ConstantSpeed):
        driven = driven._replace(rate=traced(make, opened.drive.speed), acceleration=traced(make, 0.0))
    way = RecordedPass(make, opened, linkage, driven)
    k = way.solve().k
    on = Reactions()
    presses = {number: load for number, load in enumerate(scene.loads) if isinstance(load, PressForce) and forces}
    strokes: dict[int, tuple[Expression, Expression]] = {}
    for number, load in presses.items():
        first = scene.bodies[load.body].points[0]
        t, through = guide_of(opened, first)
        s, ds = (traced(make, dot(t, x)) for x in (k.z[first] - through, k.v[first]))
        strokes[number] = s.x, ds.x
    if forces:
        ends: Any = {number: Traced(make, make.input(stroke_end_input(number), sampled=False)) for number in presses}
        on = RecordedBalance(opened, linkage, ends, k).solve(channels)
    own = {f"{group.P}.to_lock" for group in linkage.groups if isinstance(group, Group)}
    expressions: dict[str, Expression] = {}
    for names, take in all_channels(scene, linkage.groups):
        wanted = {name for name in names if channels is None or name in channels}
        if wanted and own.isdisjoint(wanted):
            value = traced(make, take(k, on))
            parts = zip(names, (value.x, value.y), strict=False)
            expressions |= {name: part for name, part in parts if name in wanted}
    least: Any = traced(make, np.inf)
    for reach in k.reach.values():
        least = np.minimum(least, reach)
    for branch in (group.branch for group in every.groups if not isinstance(group, Group)):
        if isinstance(branch, Traced):  # zero where the sketch leaves it open
            least = np.minimum(least, chosen(branch * branch > 0, 1.0, -1.0))
    left = frozenset(own if channels is None else own & channels)
    by_path = {path: number.x for path, number in numbers.items()}
    return Program(make, request, opened, linkage, way.closed, by_path, expressions, strokes, least.x, left)


def needed(whole: Linkage, channels: AbstractSet[str] | None, *, forces: bool) -> Linkage:
    """A decomposition without the last groups, unless a force, or a point or body of theirs, is wanted."""
    if channels is None or forces:
        return whole
    names = {channel.rpartition(".")[0] for channel in channels}
    count = len(whole.groups)
    while count and not any({body, *whole.carries[body]} & names for body in members(whole.groups[count - 1])):
        count -= 1
    return replace(whole, groups=whole.groups[:count])


def inputs_at(driven: Driven, tracks: Sequence[Mapping[Group, Track]]) -> Inputs:
    """The inputs of a line that are no numbers of the scene, at positions (n,), or (m, n) of machines' own.

    `tracks` are the branches of the larger groups, of the one machine or of each of m.
    """
    given: dict[str, Samples | float] = {**driven._asdict()}
    for group in tracks[0] if tracks else ():
        begin, allowed, branch = inputs_of(group)
        each = np.broadcast_to(driven.position, (len(tracks), driven.position.shape[-1]))
        guesses = [own[group].guess(position) for own, position in zip(tracks, each, strict=True)]
        given |= zip(begin, np.moveaxis(np.array([guess for guess, _ in guesses]), -1, 0), strict=True)
        given[allowed] = np.array([off for _, off in guesses])
        given[branch] = np.array([[own[group].branch] for own in tracks])
    return given


def stroke_end_input(number: int) -> str:
    """The name of the input that is where a press force's stroke ends, m, by the number of the load."""
    return f"stroke_end.{number}"
