"""An ok run at a few rows of its first cycle, and what has to be noticed when a copy of it is wrong."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from scenes import Failure, Motion, Sampling, Status
from scenes.channels import Role
from scenes.drive import Drive
from scenes.model.inputs import Inputs
from scenes.model.motion import Samples

from ...engines.runner import Run, complete
from ...mechanics.motion_vectors import MotionVectors
from ...mechanics.reference import Reference, on_switch
from ...mechanics.round_off import Explained, perturbed
from ...mechanics.scales import apart, resting
from ..checks import Check
from ..errors import shown_groups
from ..measure import Measurement, Standard, assess, gates, missed
from ..verdict import BALANCES, judged
from . import spoilt_motion as spoilt
from .sizes import length, sizes

MIN_ROWS = 24  # that a cycle is thinned to: enough for every check, and a comparison takes some milliseconds
CLEAR_ERROR = 3.0  # times what the settings promise: clearly above any error that an ok run may have
EXCESSIVE_ERROR = 300.0  # times what the settings promise: an ok run has no excuse for so much, nor in its balances
MAX_ROUNDINGS = 100.0  # times how far the motion moves: the drive is off by as little too
MAX_DEVIATION = 1.0  # of a scale or magnitude: angles come round
BLIND = {"branch", *BALANCES}  # that all channels are off is no other branch, and may cancel in a balance
PUSH = 1e6  # times the largest force: of what a balance is relative to nothing else is left
MIN_MISFIT = 0.5  # of a push: what a balance finds then
MAX_ARM = 100.0  # sizes of the linkage: further off no centre of mass is


class Thinned:
    """An ok run at every k-th row of the first cycle, k the largest that leaves enough and divides the cycle."""

    def __init__(self, reference: Reference, sampling: Sampling, run: Run, explained: Explained) -> None:
        assert run.motion is not None
        assert run.settings is not None
        count = sampling.samples
        every = max(k for k in range(1, count + 1) if count % k == 0 and (k == 1 or count >= MIN_ROWS * k))
        rows = slice(0, count + 1, every)
        samples, moved, terms = (
            {channel: values[rows] for channel, values in table.items()}
            for table in (run.motion.samples, explained.sensitivity, explained.terms)
        )
        self.explained = Explained(explained.condition[rows], moved, terms=terms)
        self.motion = Motion(samples, run.motion.unsupported)
        self.reference, self.scene, self.settings = reference, reference.scene, run.settings
        asked = replace(sampling, samples=count // every, turns=1)
        self.sampling, self.run = asked, replace(run, motion=self.motion)
        self.true = reference.at(asked.inputs(self.scene))  # what it should be
        self.drive = self.scene.channels.drive.position
        # Where all channels are there, its own output has to show that it is wrong.
        self.complete = self.motion.samples.keys() >= {*self.scene.channels.names()}
        # What errors are relative to, by channel, within a factor of two, each of shape (n,).
        self.sizes = sizes(self.scene, reference.cycle, self.true, reference.scale)

    def excess(self, times: float) -> Mapping[str, Samples]:
        """Relative errors that are so many times what the run may have, by channel, each of shape (n,)."""
        promise, scaled = self.settings.promise, self.reference.scale.keys() - {"time"}
        return {
            channel: min(times * (self.settings.drive_promise if channel == self.drive else promise), MAX_DEVIATION)
            + np.nan_to_num(self.rounding[channel], posinf=0.0)
            for channel in self.motion.samples
            if channel in scaled
        }

    def amounts(self, times: float = EXCESSIVE_ERROR) -> Mapping[str, Samples]:
        """Such errors in the units of the channels."""
        return {channel: error * self.sizes[channel] for channel, error in self.excess(times).items()}

    @cached_property
    def rounding(self) -> Mapping[str, Samples]:
        """More than what round-off explains, relative, by channel: by the motion with numbers a few last places off."""
        try:
            others = [other.samples for other in perturbed(self.reference.mechanics, self.true)]
        except Failure:
            others = []
        moved = [Motion({channel: other[channel] - self.true[channel] for channel in other}) for other in others]
        rows = {self.scene.channels[c]: size for c, size in self.sizes.items()}
        relative = {row.name: [length(row, motion) / size for motion in moved] for row, size in rows.items()}
        return {c: MAX_ROUNDINGS * np.max([self.explained.left(c), *sizes], axis=0) for c, sizes in relative.items()}

    def assessed(self, motion: Motion, reference: Reference | None = None) -> Measurement:
        """The judgement of another motion in place of the run's."""
        standard = Standard(reference or self.reference, self.sampling, self.explained)
        return assess(standard, replace(self.run, motion=motion))


Noticed: TypeAlias = Callable[[Thinned], bool]  # whether the comparison notices what is wrong with a copy
Spoil: TypeAlias = Callable[[Motion], Motion]


def refused(spoil: Spoil, copy: Thinned) -> bool:
    """Whether a spoilt motion stops a CI run, by its own output where that is complete."""
    measured = copy.assessed(spoil(copy.motion))
    return measured.run.found_by != "reference" * copy.complete and stops(copy, measured)


def refused_if_moved(spoil: Spoil, copy: Thinned) -> bool:
    """The same of a motion with all its channels, which is not wrong where they stay within what it promises."""
    moved, allowed = spoil(copy.motion), copy.amounts(CLEAR_ERROR)
    deviation = {c: abs(apart(copy.scene.channels[c], moved[c], copy.motion[c])) for c in allowed}
    return all((deviation[c] <= allowed[c]).all() for c in allowed) or refused(spoil, copy)


def incomplete(spoil: Spoil, copy: Thinned) -> bool:
    """Whether a motion that is not what was asked for is refused as such, and stops a CI run."""
    itself = complete(replace(copy.run, motion=spoil(copy.motion)), copy.scene, copy.sampling)
    return itself.status is not Status.ok and refused(spoil, copy)


def stops(copy: Thinned, measured: Measurement) -> bool:
    """Whether a judged run stops a CI run: with a tolerance for every group, and with none at all."""
    return measured.run.status is not Status.ok and bool(missed([measured], [])) and _all_missed(copy, measured, np.inf)


def stops_without_a_motion(copy: Thinned) -> bool:
    """Whether a failed run stops a CI run."""
    failed = replace(copy.run, status=Status.crashed, reason="a canary", motion=None)
    return stops(copy, Measurement(failed, None, []))


def each_check_alone(sign: int, copy: Thinned) -> bool:
    """Whether checks notice by themselves that all channels are off, that they found no number, or too much."""
    scene, settings = copy.scene, copy.settings
    offsets = {channel: sign * amount for channel, amount in copy.amounts().items()}
    measured = copy.assessed(spoilt.shifted(copy.motion, offsets))
    names = {"drive", "closure", "branch", *shown_groups(scene), *(BALANCES if scene.has_masses else ())}
    alone = {name: [check for check in measured.checks if check.check == name] for name in names}
    too_much = EXCESSIVE_ERROR * max(settings.promise, settings.drive_promise)
    one_by_one = [[replace(check, worst=worst)] for check in measured.checks for worst in (float("nan"), too_much)]
    return (
        all(alone.values())  # a check that is not made notices nothing
        and stops(copy, measured)
        and (not scene.has_masses or _balances_notice(copy, sign * PUSH))  # single forces, since much cancels in them
        and all(judged(copy.run, checks).status is not Status.ok for checks in one_by_one)
        and all(_refuse(copy, alone[name]) for name in names - BLIND - {"closure"})
        and (_refuse(copy, alone["closure"]) or _across_is_open(copy, offsets))
    )


def _refuse(copy: Thinned, found: Sequence[Check]) -> bool:
    """Whether what checks found makes the run fail."""
    return judged(copy.run, found).status is not Status.ok


def _across_is_open(copy: Thinned, offsets: Mapping[str, Samples]) -> bool:
    """Whether closure alone notices places that are off at right angles to `offsets`: no guide is along both."""
    across = {channel: -amount if channel.endswith(".y") else amount for channel, amount in offsets.items()}
    found = copy.assessed(spoilt.shifted(copy.motion, across)).checks
    return _refuse(copy, [check for check in found if check.check == "closure"])


def _balances_notice(copy: Thinned, times: float) -> bool:
    """Whether each balance finds a force on a driven body far above all, and a couple above its moment."""
    return all(_balance_notices(copy, times, drive) for drive in copy.scene.drives)


def _balance_notices(copy: Thinned, times: float, drive: Drive) -> bool:
    scene, driven, effort, channels = copy.scene, drive.body, drive.effort_channel, copy.scene.channels
    force = times * max(float(copy.sizes[name].max()) for name in channels.names(Role.force))
    couple = MAX_ARM * force * copy.reference.mechanics.size
    if drive.slide is None:
        joint = next(channels.pins[pin.channel][0] for pin in scene.pins if driven in (pin.first, pin.second))
        both: dict[str, Samples | float] = {joint: force, effort: couple}
        power: dict[str, Samples | float] = {effort: couple}
    else:
        both, ends = {effort: force, channels.guides[driven].moment: couple}, (driven, drive.on)
        point = next(p for p in (scene.bodies[name].points[0] for name in ends) if p in scene.moving_points)
        along = MotionVectors(scene, copy.true).along(scene.bodies[driven])
        way = zip(channels.points[point].velocity, (along.real, along.imag), strict=True)
        # Its own speed may be nothing beside that of other points: for power it is made fast, too.
        power = both | {rate: times * part * float(copy.sizes[rate].max()) for rate, part in way}
    return all(
        max(check.worst for check in copy.assessed(spoilt.shifted(copy.motion, push)).checks if check.check == name)
        > MIN_MISFIT
        for name, push in {"Newton": both, "Euler": both, "power": power}.items()
    )


def each_channel_is_seen(copy: Thinned) -> bool:
    """Whether the error of each channel is seen where the reference is another, each channel's at its own rows."""
    excess, amounts = copy.excess(CLEAR_ERROR), copy.amounts(CLEAR_ERROR)
    count = copy.sampling.count
    # On a press force's switch the reference is that of the side that fits, with no error of the other's.
    unjudged = np.flatnonzero(resting(MotionVectors(copy.scene, copy.true)))  # with friction
    clear = np.setdiff1d(np.arange(count), [*on_switch(copy.reference.acts(copy.true)), *unjudged])
    rows = {channel: np.roll(clear, -n)[[0, len(clear) // 2]] for n, channel in enumerate(excess)}
    measured = _against(
        copy, {channel: amounts[channel] * np.isin(range(count), chosen) for channel, chosen in rows.items()}
    )
    if measured.comparison is None or measured.run.found_by != "reference" or not stops(copy, measured):
        return False
    largest, actual = {row.channel: row.max for row in measured.errors}, measured.comparison.actual
    seen = (
        channel in largest
        and not largest[channel] < actual[channel][chosen].max()  # no number where no floor is known
        and actual[channel][chosen].max() > excess[channel][chosen].min() / 2
        for channel, chosen in rows.items()
    )
    return all(seen) and _last_is_seen(copy)


def _last_is_seen(copy: Thinned) -> bool:
    """Whether errors in the last channel of each group alone break the promise, and miss every tolerance."""
    amounts = copy.amounts(CLEAR_ERROR)
    last = {copy.scene.channels[name].group: name for name in copy.excess(CLEAR_ERROR)}
    measured = _against(copy, {channel: amounts[channel] for channel in last.values()})
    least = min(map(np.min, copy.excess(CLEAR_ERROR).values())) / 2
    return measured.run.found_by == "reference" and _all_missed(copy, replace(measured, run=copy.run), least)


def _against(copy: Thinned, amounts: Mapping[str, Samples]) -> Measurement:
    """The judgement of the run against a reference that is off by some amounts, by channel, shape (n,)."""

    def at(inputs: Inputs) -> Motion:
        return spoilt.shifted(copy.reference.at(inputs), amounts)

    return copy.assessed(copy.motion, replace(copy.reference, at=at))


def _all_missed(copy: Thinned, measured: Measurement, tolerance: float) -> bool:
    """Whether a tolerance of each group of channels is missed."""
    scaled = copy.reference.scale.keys() & copy.motion.samples.keys() - {"time"}
    groups = {copy.scene.channels[name].group for name in scaled}
    held = replace(copy.scene, tolerances={copy.run.engine: dict.fromkeys(groups, tolerance)})
    gated = [*gates(held, [measured])]
    return {gate.group for gate in gated} == groups and len(missed([measured], gated)) >= len(groups)
