"""An ok run at a few rows of its first cycle, and what has to be noticed when a copy of it is wrong."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from scenes import Motion, Sampling, Status
from scenes.motion import Samples, channels, quantity

from ..engines.press_switches import on_switch
from ..engines.reference import Reference, sizes
from ..engines.runner import Run, complete
from ..judge.errors import GROUPS
from ..judge.gates import gates, missed
from ..judge.measure import Measurement, assess
from ..judge.round_off import Explained
from ..judge.verdict import judged
from . import spoilt_motion as spoilt
from .fault import Clean

ROWS = 24  # the least that a cycle is thinned to: enough for every check, and a comparison takes some milliseconds
CLEAR = 3.0  # times what the settings promise: more than an ok run is off by, by more than it may be off itself
EXCESS = 300.0  # times what the settings promise: an ok run has no excuse for so much, not even in its balances
MOST = 1.0  # of a scale or magnitude: angles come round
ALONE = ("drive", "closure", "Newton")  # checks that have to notice by themselves that all channels are off


@dataclass(frozen=True)
class Thinned(Clean):
    """One ok run at a few rows."""

    explained: Explained

    def excess(self, times: float) -> Mapping[str, Samples]:
        """Return relative errors that are so many times what the run may have, by channel, each of shape (n,)."""
        assert self.run.settings is not None
        drive_promise = self.run.settings.drive_promise
        return {
            channel: min(times * (drive_promise if channel == self.drive else self.promise), MOST)
            + 10 * np.nan_to_num(self.explained.error(channel), posinf=0.0)
            for channel in self.motion.samples
            if channel in self.reference.scale and channel != "time"
        }

    def amounts(self, times: float = EXCESS) -> Mapping[str, Samples]:
        """Return such errors in the units of the channels."""
        return {
            channel: error * sizes(self.true, channel, self.reference.scale[channel])
            for channel, error in self.excess(times).items()
        }

    @property
    def complete(self) -> bool:
        """Whether all channels are there: then its own output has to show that it is wrong."""
        return self.motion.samples.keys() >= {*channels(self.scene)}

    def assessed(self, motion: Motion, reference: Reference | None = None) -> Measurement:
        """Return the judgement of another motion in place of the run's."""
        return assess(reference or self.reference, self.sampling, replace(self.run, motion=motion), self.explained)


Noticed: TypeAlias = Callable[[Thinned], bool]  # whether the comparison notices what is wrong with a copy


def thinned(reference: Reference, sampling: Sampling, run: Run, explained: Explained) -> Thinned:
    """Return an ok run at every k-th row of the first cycle, k the largest that leaves enough and divides the cycle."""
    assert run.motion is not None
    count = sampling.samples
    every = max(k for k in range(1, count + 1) if count % k == 0 and (k == 1 or count >= ROWS * k))
    rows = slice(0, count + 1, every)
    samples = {channel: values[rows] for channel, values in run.motion.samples.items()}
    known = Explained(explained.condition[rows], {c: values[rows] for c, values in explained.sensitivity.items()})
    fewer = replace(sampling, samples=count // every, turns=1)
    return Thinned(reference, fewer, replace(run, motion=Motion(samples, run.motion.unsupported)), known)


def refused(spoil: Callable[[Motion], Motion]) -> Noticed:
    """Return whether a spoilt motion stops a CI run, by its own output where that is complete."""

    def noticed(copy: Thinned) -> bool:
        found = copy.assessed(spoil(copy.motion))
        return found.run.found_by != "reference" * copy.complete and stops(copy, found)

    return noticed


def incomplete(spoil: Callable[[Motion], Motion]) -> Noticed:
    """Return whether a motion that is not what was asked for is refused as such, and stops a CI run."""

    def noticed(copy: Thinned) -> bool:
        spoilt_run = replace(copy.run, motion=spoil(copy.motion))
        itself = complete(spoilt_run, copy.scene, copy.sampling)
        return itself.status is not Status.ok and refused(spoil)(copy)

    return noticed


def stops(copy: Thinned, found: Measurement) -> bool:
    """Return whether a judged run stops a CI run: with a tolerance for every group, and with none at all."""
    return found.run.status is not Status.ok and bool(missed([found], [])) and _all_missed(copy, found, np.inf)


def stops_without_a_motion(copy: Thinned) -> bool:
    """Return whether a failed run stops a CI run."""
    failed = replace(copy.run, status=Status.crashed, reason="a canary", motion=None)
    return stops(copy, Measurement(failed, None, []))


def each_check_alone(sign: int) -> Noticed:
    """Return whether checks notice by themselves that all channels are off, that they found no number, or too much."""

    def noticed(copy: Thinned) -> bool:
        off = {channel: copy.motion[channel] + sign * amount for channel, amount in copy.amounts().items()}
        found = copy.assessed(spoilt.replaced(copy.motion, off))
        assert copy.run.settings is not None
        too_much = EXCESS * max(copy.run.settings.promise, copy.run.settings.drive_promise)
        alone = [[check for check in found.checks if check.check == name] for name in ALONE]
        alone += [[replace(own, worst=worst)] for own in found.checks for worst in (float("nan"), too_much)]
        return stops(copy, found) and all(judged(copy.run, own).status is not Status.ok for own in alone if own)

    return noticed


def each_channel_is_seen(copy: Thinned) -> bool:
    """Return whether the error of each channel is seen where the reference is another, each channel's at its own rows.

    The output itself is as good as before: the comparison with the reference alone can notice.
    """
    excess, amounts = copy.excess(CLEAR), copy.amounts(CLEAR)
    # On a press force's switch the reference is that of the side that fits, with no error of the other's.
    clear = np.setdiff1d(np.arange(copy.sampling.count), on_switch(copy.reference.acts(copy.true)))
    rows = {channel: np.roll(clear, -n)[[0, len(clear) // 2]] for n, channel in enumerate(excess)}

    def at(position: Samples, time: Samples) -> Motion:
        true = copy.reference.at(position, time)
        off = {channel: true[channel].copy() for channel in rows}
        for channel, own in rows.items():
            off[channel][own] += amounts[channel][own]
        return spoilt.replaced(true, off)

    found = copy.assessed(copy.motion, replace(copy.reference, at=at))
    if found.comparison is None or found.run.found_by != "reference" or not stops(copy, found):
        return False
    largest = {row.channel: row.max for row in found.errors}
    if not rows.keys() <= largest.keys():
        return False
    seen = (
        not largest[channel] < found.comparison.actual[channel][own].max()  # no number where no floor is known
        and found.comparison.actual[channel][own].max() > excess[channel][own].min() / 2
        for channel, own in rows.items()
    )
    return all(seen) and _all_missed(copy, replace(found, run=copy.run), min(map(np.min, excess.values())) / 2)


def _all_missed(copy: Thinned, found: Measurement, tolerance: float) -> bool:
    """Return whether a tolerance of each group of channels is missed."""
    groups = {
        GROUPS[quantity(channel)]
        for channel in copy.motion.samples
        if channel != "time" and channel in copy.reference.scale
    }
    held = replace(copy.scene, tolerances={copy.run.engine: dict.fromkeys(groups, tolerance)})
    gated = [*gates(held, [found])]
    return {gate.group for gate in gated} == groups and len(missed([found], gated)) >= len(groups)
