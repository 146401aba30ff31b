"""What a disagreement is explained from: a motion, what it should be, and how much of the distance a cause leaves over.

A cause predicts what its motion would be. What it leaves over, the distance of the motion from that prediction over its
distance from what it should be, is 0 for a cause that explains all and 1 for one that explains nothing.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Motion, Rows
from scenes.motion import Samples, quantity

from ...engines.reference import Reference, relative_errors, sizes
from .parts import ANGLES, FORCES, Part, parts

ROWS = 400  # at most, but for those about the worst: all of a usual run
ABOUT = 10  # rows on either side of the worst
SHORTEST = 4  # rows, in which a motion can be off alone
NEXT_TO_NOTHING = 1e-3  # of the square of the largest sample's deviation: what right samples have
EXACT = 0.01  # of the deviation: what causes leave over below it is rounding, and what an engine is off besides

NEARLY_ALL = 0.15  # of the deviation: the most that the cause named leaves over
EXPLAINED = 0.3  # the most that a cause worth a look leaves over

Channels = Mapping[str, Samples]


class Kind(StrEnum):
    """Causes of a disagreement."""

    unknown = "unknown"
    sign = "opposite sign"
    unit = "factor"
    offset = "offset"
    frame = "another frame"
    swap = "channels swapped"
    copy = "another's channel"
    pair = "another pair of bodies at the pin"
    moment = "moment about another point"
    term = "a term of the acceleration"
    lag = "late"
    drive = "drive"
    mass = "mass"
    inertia = "moment of inertia"
    com = "centre of mass"
    length = "length"
    place = "place on the ground"
    guide = "guide"
    load = "load"
    spring = "spring"
    gravity = "gravity"
    friction = "friction"
    missing = "missing"
    nonfinite = "not finite"
    held = "rows held"
    constant = "constant"
    spike = "spoilt sample"
    rows = "rows out of order"
    noise = "noise"
    differences = "differences of samples"
    branch = "another branch"
    solver = "discretisation"
    start = "start transient"
    coarse = "interpolation"
    code = "wrong line"


class Hypothesis(NamedTuple):
    """A cause, and the channels of the motion that it would give, at the rows of the evidence; all others stand."""

    kind: Kind
    place: str  # a body, joint, channel, "drive" or "all"
    amount: str
    sentence: str
    predicted: Channels
    freedom: int = 0  # numbers that were fitted


@dataclass(frozen=True)
class Evidence:
    """A motion and what it should be, at some rows of it."""

    reference: Reference
    motion: Motion  # as the engine returned it
    true: Motion  # at the rows
    rows: NDArray[np.intp]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The channels that are compared."""
        return tuple(c for c in self.motion.samples if c != "time" and c in self.reference.scale and c in self.true)

    @cached_property
    def given(self) -> Motion:
        """The motion at the rows."""
        return Motion({channel: samples[self.rows] for channel, samples in self.motion.samples.items()})

    @cached_property
    def scale(self) -> dict[str, Samples]:
        """What the deviation of each channel is divided by: its scale, or its magnitude where that is larger."""
        return {channel: sizes(self.true, channel, self.reference.scale[channel]) for channel in self.names}

    @cached_property
    def off(self) -> dict[str, float]:
        """The square of each channel's deviation, summed over the rows."""
        return {c: self._square(c, self.true[c]) for c in self.names}

    @cached_property
    def total(self) -> float:
        """The square of the whole deviation."""
        return sum(self.off.values())

    @cached_property
    def moved(self) -> float:
        """The part of the deviation that the kinematic channels have."""
        return self.outside(c for c in self.names if quantity(c) in FORCES)

    @cached_property
    def blind(self) -> bool:
        """Whether it has forces alone, which do not show whether a body is elsewhere."""
        drive = self.reference.scene.drive_channel
        return all(quantity(channel) in FORCES or channel == drive for channel in self.names)

    def difference(self, channel: str, other: Samples) -> Samples:
        """Return by how much the motion's channel is more than another, over its scale, angles modulo one turn."""
        return _apart(channel, self.given[channel], other) / self.scale[channel]

    def _square(self, channel: str, other: Samples) -> float:
        return float(np.sum(self.difference(channel, other) ** 2))

    def outside(self, channels: Iterable[str]) -> float:
        """Return what a cause leaves over that explains all of these channels and no other."""
        own = sum(self.off[channel] for channel in channels)
        return float(np.sqrt(max(self.total - own, 0.0) / self.total))

    def left(self, predicted: Channels) -> float:
        """Return what a prediction leaves over."""
        change = sum(self._square(c, predicted[c]) - self.off[c] for c in predicted if c in self.off)
        left = float(np.sqrt(max(self.total + change, 0.0) / self.total))
        return left if np.isfinite(left) else np.inf

    def late(self, by: float) -> Channels:
        """Return what the motion would be if all were late by a time, s; nothing where there is no motion."""
        if by not in self._late:
            drive, time = self.reference.scene.drive, self.true["time"] - by
            time = time if drive.repeats else np.clip(time, 0.0, drive.cycle)
            try:
                late = self.reference.at(drive.at(time).position, time)
                self._late[by] = {channel: late[channel] for channel in self.names}
            except Failure:
                self._late[by] = {}
        return self._late[by]

    @cached_property
    def _late(self) -> dict[float, Channels]:
        return {}

    @cached_property
    def parts(self) -> list[Part]:
        """Channels that a read-out treats alike, with what they are called: a channel, a vector, all of a body, ..."""
        return parts(self.names, self.reference.scene.drive_channel)


def away_from_switches(evidence: Evidence) -> Evidence:
    """Return the evidence without the samples on either side of a press force's switch, where rounding decides."""
    acts = np.array([act.any(axis=0) for act in evidence.reference.acts(evidence.true)])
    if not acts.size:
        return evidence
    switched = (np.diff(acts, axis=1) != 0).any(axis=0)
    kept = ~(np.append(switched, False) | np.append(False, switched))
    return _at(evidence, np.flatnonzero(kept))


def thinned(evidence: Evidence, most: int) -> Evidence:
    """Return the evidence at so many of its rows at most, evenly spread, and at the worst."""
    count = len(evidence.rows)
    if count <= most:
        return evidence
    off = sum(evidence.difference(channel, evidence.true[channel]) ** 2 for channel in evidence.names)
    return _at(evidence, np.unique([*np.linspace(0, count - 1, max(most, 2)).astype(np.intp), int(np.argmax(off))]))


def stretch(evidence: Evidence) -> Evidence | None:
    """Return the evidence at the rows from the first to the last that are off; None where these are few or all."""
    off = np.array([evidence.difference(c, evidence.true[c]) ** 2 for c in evidence.names]).sum(axis=0)
    bad = np.flatnonzero(off >= NEXT_TO_NOTHING * off.max())
    kept = np.arange(bad[0], bad[-1] + 1)
    return _at(evidence, kept) if SHORTEST <= len(kept) < len(off) else None


def _at(evidence: Evidence, kept: NDArray[np.intp]) -> Evidence:
    true = Motion({channel: samples[kept] for channel, samples in evidence.true.samples.items()})
    return replace(evidence, true=true, rows=evidence.rows[kept])


def evidence(reference: Reference, sampling: Rows, motion: Motion) -> Evidence:
    """Return a motion beside what the drive commands, at rows evenly spread and at those about the worst."""
    position, time = sampling.commanded(reference.scene), sampling.times(reference.scene)
    rows = np.arange(sampling.count)
    if sampling.count > ROWS:
        errors = relative_errors(motion, reference.at(position, time), reference.scale)
        about = np.max([*errors.values()], axis=0).argmax() + np.arange(-ABOUT, ABOUT + 1)
        spread = np.linspace(0, sampling.count - 1, ROWS).astype(np.intp)
        rows = np.unique([*spread, *about[(about >= 0) & (about < sampling.count)]])
    return Evidence(reference, motion, reference.at(position[rows], time[rows]), rows)


def factor(evidence: Evidence, channels: Iterable[str], basis: Channels) -> float:
    """Return the factor of a basis that is nearest to the motion's channels."""
    pairs = [(basis[c] / evidence.scale[c], evidence.given[c] / evidence.scale[c]) for c in channels]
    return sum(float(b @ m) for b, m in pairs) / (sum(float(b @ b) for b, _ in pairs) or 1.0)


def factor_of_change(evidence: Evidence, channel: str, basis: Samples) -> float:
    """Return the factor of a basis that is nearest to the deviation of a channel."""
    weighted = basis / evidence.scale[channel]
    return float(weighted @ evidence.difference(channel, evidence.true[channel]) / ((weighted @ weighted) or 1.0))


def fitted(
    evidence: Evidence, predict: Callable[[Samples], Channels], steps: Samples, rounds: int = 1
) -> tuple[Samples, Channels]:
    """Return the numbers for which a prediction leaves least over, and that prediction, by Gauss and Newton from zero.

    One round is exact for what is linear. `steps` are what the numbers are varied by, shape (k,).
    """
    x, now = np.zeros(len(steps)), predict(np.zeros(len(steps)))
    for _ in range(rounds):
        channels = [c for c in now if c in evidence.names]
        ways = [predict(x + step) for step in np.diag(steps)]
        if not all((now, *ways)):
            return x, {}
        slopes = [np.concatenate([_apart(c, way[c], now[c]) / evidence.scale[c] for c in channels]) for way in ways]
        off = np.concatenate([evidence.difference(c, now[c]) for c in channels])
        size = np.array([np.linalg.norm(slope) for slope in slopes])
        if not (np.isfinite(size).all() and np.isfinite(off).all()):
            return x, {}
        size[size == 0] = np.inf
        change = np.linalg.lstsq(np.array(slopes).T / size, off, rcond=1e-6)[0] / size * steps
        for shorter in (1.0, 0.5, 0.2, 0.05):
            then = predict(x + shorter * change)
            if then and (rounds == 1 or evidence.left(then) <= evidence.left(now)):
                x, now = x + shorter * change, then
                break
        else:
            break
    return x, now


def _apart(channel: str, one: Samples, other: Samples) -> Samples:
    """Return by how much samples of a channel are more than others, angles modulo one turn."""
    difference = one - other
    return np.remainder(difference + np.pi, 2 * np.pi) - np.pi if quantity(channel) in ANGLES else difference
