"""A result of another program, judged as an engine's run is, but for what it is written at: so many decimals.

The half of the last decimal explains an error of a channel, and that of the instants what the motion does meanwhile. In
the checks of the result's own output it explains what they find in the reference, written as the result is.

Besides the channels of engines a result may give magnitudes, as `P.force`, and transmission angles. A magnitude is the
length of a vector of the reference, by its two channels, and is judged on their scale and in their group. A
transmission angle is the reference's own, on a scale of 1 rad, among the positions.
"""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from scenes import Failure, Inputs, Instants, Motion, Settings, Status
from scenes.model.inputs import passing
from scenes.model.motion import Samples

from ..engines import registry
from ..engines.registry import Solve
from ..mechanics.mechanics import SHOWN_GROUPS, Mechanics
from ..mechanics.motion_vectors import Acts
from ..mechanics.reference import Reference
from ..mechanics.round_off import MAX_EXCUSED, Explained, explain
from ..mechanics.scales import relative_errors, sizes
from .checks import Check, checks
from .measure import Measurement, Standard, assess
from .verdict import BALANCES

if TYPE_CHECKING:
    from ..results.result import Result

Parts: TypeAlias = Mapping[str, tuple[str, str]]  # by magnitude, the channels of its components
Halves: TypeAlias = Mapping[str, Samples]  # of the last decimals, by channel, each of shape (n,), SI

MAX_RATIO_OF_CHECKS = 3.0  # to what they find in the reference: the roundings of two motions differ by chance
SEED = 20261122


def assess_result(reference: Reference, result: "Result") -> Measurement:
    """The judgement of a result, at its own instants, in the channels that it has; by a reference in doubt too."""
    request, run, halves = result.request, result.run, result.half_decimals
    reference, inputs = with_derived(reference, request.channels or ()), request.inputs(reference.scene)
    drive, driven = reference.scene.channels.drive.position, inputs.driven()
    if run.motion is not None and drive in halves:
        placed = _in_place(reference.mechanics, run.motion[drive], driven.position, halves[drive])
        run = replace(run, motion=Motion({**run.motion.samples, drive: placed}))
        halves = {channel: half for channel, half in halves.items() if channel != drive}
    try:
        true = reference.at(inputs)
        explained = _explained_by_decimals(reference, request, halves, true, driven.rate)
    except Failure:  # which is named when it is compared
        return assess(Standard(reference, request, Explained(np.empty(0), {})), run)
    promise = (run.settings or Settings("")).promise
    meanwhile = {**halves, drive: np.abs(driven.rate) * halves["time"]}  # of the drive, by the instants
    excused = partial(_excused, reference, meanwhile, true, explained.terms, promise)
    held = replace(reference, floor=replace(reference.floor, doubt=""))  # with few channels nothing else is a check
    measured = assess(Standard(held, request, explained), run, excused)
    run = measured.run
    if run.status is Status.wrong_branch and not any(check.check == "closure" for check in measured.checks):
        run = replace(run, status=Status.inaccurate)  # its units or frame may be others
    if reference.floor.doubt and run.found_by == "reference":
        run = replace(run, reason=f"{run.reason}; the reference itself is in doubt")
    return replace(measured, run=run)


def _in_place(mechanics: Mechanics, position: Samples, asked: Samples, half: Samples) -> Samples:
    """Where the drive is by the time, but for what its decimals, which excuse no other channel, do not explain."""
    deviation = position - asked
    left: Samples = np.sign(deviation) * np.maximum(
        np.abs(deviation) - np.minimum(half, MAX_EXCUSED * mechanics.way), 0.0
    )
    return asked + left


def _explained_by_decimals(
    reference: Reference, request: Instants, halves: Halves, true: Motion, rate: Samples
) -> Explained:
    """Errors that round-off and decimals explain, at the instants of a result."""
    moved, off = _meanwhile(reference, halves["time"], true, rate), dict[str, Samples]()
    for channel in reference.mechanics.groups:
        row = reference.scene.channels[channel]
        both = row.components if row.axis else (channel,)
        # Both components of a vector are rounded: its error is bounded by the norm of their halves.
        half = np.linalg.norm([halves[c] for c in both if c in halves] or [np.zeros(1)], axis=0)
        off[channel] = half / sizes(true, row, reference.scale[channel]) + moved.get(channel, 0.0)
    return explain(reference, request, off)


def _meanwhile(reference: Reference, time: Samples, true: Motion, rate: Samples) -> dict[str, Samples]:
    """How far each channel moves while the instants are off as written, relative, shape (n,)."""
    scene, moved = reference.scene, dict[str, Samples]()
    position = np.abs(rate) * time
    for sign in (1, -1) if position.any() else ():
        with suppress(Failure):  # beyond the end of the drive
            there = true[scene.channels.drive.position] + sign * position
            other = reference.at(passing(scene, there, true["time"] + sign * time))
            for channel, error in relative_errors(scene.channels, other, true, reference.scale).items():
                moved[channel] = np.maximum(moved.get(channel, 0.0), error)
    return moved


def _excused(
    reference: Reference, halves: Halves, true: Motion, terms: Mapping[str, Samples], promise: float, given: Motion
) -> list[Check]:
    """What checks find in a result's own motion; nothing where they find it in the reference's as it may be written."""
    draw, complete = np.random.default_rng(SEED), given.samples.keys() >= reference.mechanics.units.keys()
    # The reference written as the result is: random errors within the half decimals. What a check finds in that, times
    # a factor for chance, is what decimals excuse in the result.
    rounded = {c: true[c] + draw.uniform(-1, 1, len(true["time"])) * halves.get(c, 0.0) for c in given.samples}

    def found(motion: Motion) -> list[Check]:
        may = reference.acts(motion, true) if complete else None  # decimals may put a slider beyond a press's switch
        arguments = reference.mechanics, motion, reference.travel, promise, may, reference.stroke_ends
        return checks(*arguments, reference.scale)  # forces of nothing but decimals have no scale of their own

    allowed = found(Motion(rounded | {"time": true["time"]}))
    # A balance adds up many channels, each of which is held against the reference by itself: it has no other limit.
    most = {
        _of(each): min(
            MAX_RATIO_OF_CHECKS * each.worst, np.inf if each.check in BALANCES else MAX_EXCUSED * _times(terms, each.of)
        )
        for each in allowed
    }
    return [replace(each, worst=0.0) if each.worst <= most.get(_of(each), 0.0) else each for each in found(given)]


def _times(terms: Mapping[str, Samples], channel: str) -> float:
    """How many times the size of a channel the largest of its terms is, once at least."""
    return max(float(np.max(terms.get(channel, 1.0))), 1.0)


def _of(check: Check) -> tuple[str, str]:
    """What a check is of; those of groups are of whichever channel is worst."""
    return check.check, "" if check.check in SHOWN_GROUPS else check.of


# What a result gives besides channels, with a reference that has that too.


@dataclass(frozen=True)
class _WithMagnitudes(Reference):
    parts: Parts = field(default_factory=dict)

    def fitting(self, motion: Motion, true: Motion, may: Sequence[Acts]) -> Motion:
        """`true` on the side of a press force's switch where the motion's forces fit best, with magnitudes of that."""
        return _extended(super().fitting(motion, true, may), self.parts)


def with_derived(reference: Reference, given: Collection[str]) -> Reference:
    """Return a reference with what a result gives besides channels; itself where that is nothing."""
    names = [name for name in given if name not in reference.mechanics.units]
    if not names:
        return reference
    channels = reference.scene.channels
    parts = {name: both for name, both in channels.magnitudes.items() if name in names}
    likes = {name: parts[name][0] if name in parts else "" for name in names}  # a channel that it is judged as
    known = reference.mechanics
    neighbours, mechanics = known.neighbours, copy(known)
    mechanics.units = known.units | {name: channels[name].unit for name in names}
    mechanics.groups = known.groups | {name: channels[name].group for name in names}
    if neighbours and len(parts) < len(names):  # which solve the channels of engines, no angles
        neighbours = tuple(registry.reference(other.scene) for other in known.perturbed)
    # A copy of the mechanics whose cached neighbours also return what is derived, so that round-off explains it as any
    # channel.
    mechanics.__dict__["neighbours"] = tuple(_solver(solve, parts) for solve in neighbours)
    values = {each.name: getattr(reference, each.name) for each in fields(Reference)}
    values["scale"] = {**reference.scale, **{name: reference.scale.get(like, 1.0) for name, like in likes.items()}}
    return _WithMagnitudes(**{**values, "mechanics": mechanics, "at": _solver(reference.at, parts)}, parts=parts)


def _solver(solve: Solve, parts: Parts) -> Solve:
    def extended(inputs: Inputs) -> Motion:
        return _extended(solve(inputs), parts)

    return extended


def _extended(motion: Motion, parts: Parts) -> Motion:
    lengths = {name: np.hypot(motion[x], motion[y]) for name, (x, y) in parts.items()}
    return Motion({**motion.prompt.samples, **lengths}, motion.unsupported)
