"""What a disagreement is explained from: a motion, what it should be, and how much of the distance a cause leaves over.

A cause predicts what its motion would be. What it leaves over, the distance of the motion from that prediction over its
distance from what it should be, is 0 for a cause that explains all and 1 for one that explains nothing.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Motion, Rows
from scenes.model.motion import Samples, quantity

from ...mechanics.reference import Reference
from ...mechanics.scales import relative_errors, sizes
from ...results.frame import COMPONENTS
from .cause import Cause
from .parts import ANGLES, FORCES, Part, parts, stem

ROWS = 400  # at most, but for those about the worst: all of a usual run
ABOUT = 10  # rows on either side of the worst
FEW = 3  # bodies, joints and points
SHORTEST = 4  # rows, in which a motion can be off alone
NEXT_TO_NOTHING = 1e-3  # of the square of the largest sample's deviation: what right samples have
EXACT = 0.01  # of the deviation: what causes leave over below it is rounding, and what an engine is off besides

NEARLY_ALL = 0.15  # of the deviation: the most that the cause named leaves over
PRICE = 0.25  # of what is left over, for each number that was fitted
SETTLED = 0.99  # of what was left over before: a further round is worth no more
EXPLAINED = 0.3  # the most that a cause worth a look leaves over

Channels = Mapping[str, Samples]


class Hypothesis(NamedTuple):
    """A cause, and the channels of the motion that it would give, at the rows of the evidence; all others stand."""

    cause: Cause
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
    def of_forces(self) -> bool:
        """Whether nearly all of the deviation is in forces."""
        forces = [c for c in self.names if quantity(c) in FORCES]
        return bool(forces) and self.total > 0 and self.outside(forces) <= NEARLY_ALL

    @cached_property
    def elsewhere(self) -> bool:
        """Whether it has channels of so many bodies and joints that what is wrong in the scene is in several."""
        return len({stem(channel) for channel in self.names}) > FEW

    def along(self, axis: str) -> tuple[str, ...]:
        """Return all components of vectors along an axis, x or y."""
        return tuple(c for c in self.names if quantity(c) in COMPONENTS and c[-1] == axis)

    def difference(self, channel: str, other: Samples) -> Samples:
        """Return by how much the motion's channel is more than another, over its scale, angles modulo one turn."""
        return apart(channel, self.given[channel], other) / self.scale[channel]

    def _square(self, channel: str, other: Samples) -> float:
        return float(np.sum(self.difference(channel, other) ** 2))

    def outside(self, channels: Iterable[str]) -> float:
        """Return the rest that a cause leaves over which explains all of these channels and no other."""
        own = sum(self.off[channel] for channel in channels)
        return float(np.sqrt(max(self.total - own, 0.0) / self.total))

    def left(self, predicted: Channels) -> float:
        """Return the rest that a prediction leaves over."""
        change = sum(self._square(c, predicted[c]) - self.off[c] for c in predicted if c in self.off)
        left = float(np.sqrt(max(self.total + change, 0.0) / self.total))
        return left if np.isfinite(left) else np.inf

    def late(self, by: float) -> Channels:
        """Return the motion as if all were late by a time, s; nothing where there is no motion."""
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


def price(left: float, freedom: int) -> float:
    """Return the price by which a cause is ranked: its rest, and more by each number that was fitted."""
    return left * (1 + PRICE * freedom)


def factor(evidence: Evidence, channels: Iterable[str], basis: Channels) -> float:
    """Return the factor of a basis that is nearest to the motion's channels."""
    pairs = [(basis[c] / evidence.scale[c], evidence.given[c] / evidence.scale[c]) for c in channels]
    return sum(float(b @ m) for b, m in pairs) / (sum(float(b @ b) for b, _ in pairs) or 1.0)


def added(evidence: Evidence, changes: Sequence[Channels]) -> tuple[Samples, Channels]:
    """Return the amounts of changes of channels that leave least over, shape (k,), and the channels with them."""
    channels = [c for c in evidence.names if any(c in change for change in changes)]
    nothing = np.zeros(len(evidence.rows))
    basis = [[change.get(c, nothing) / evidence.scale[c] for c in channels] for change in changes]
    off = [evidence.difference(c, evidence.true[c]) for c in channels]
    amounts = least_squares(np.reshape(basis, (len(changes), -1)).T, np.ravel(off))
    return amounts, with_changes(evidence, amounts, changes)


def with_changes(evidence: Evidence, amounts: Iterable[float], changes: Sequence[Channels]) -> Channels:
    """Return the channels that are changed, by so much of each change."""
    total: dict[str, Samples] = {}
    for amount, change in zip(amounts, changes, strict=True):
        for c, by in change.items():
            total[c] = total.get(c, evidence.true[c]) + amount * by
    return total


def least_squares(columns: NDArray[np.float64], off: Samples) -> Samples:
    """Return the amounts of columns, shape (n, k), that are nearest to something together; of empty ones nothing."""
    size = np.linalg.norm(columns, axis=0)
    if not (np.isfinite(size).all() and np.isfinite(off).all()):
        return np.zeros(len(size))
    size[size == 0] = np.inf
    return np.asarray(np.linalg.lstsq(columns / size, off, rcond=1e-6)[0] / size)


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
        slopes = [np.concatenate([apart(c, way[c], now[c]) / evidence.scale[c] for c in channels]) for way in ways]
        off = np.concatenate([evidence.difference(c, now[c]) for c in channels])
        change = least_squares(np.array(slopes).T, off) * steps
        for shorter in (1.0, 0.5, 0.2, 0.05):
            then = predict(x + shorter * change)
            if then and (rounds == 1 or evidence.left(then) <= evidence.left(now)):
                break
        else:
            return x, now
        settled = evidence.left(then) > SETTLED * evidence.left(now)
        x, now = x + shorter * change, then
        if settled:
            break
    return x, now


def apart(channel: str, one: Samples, other: Samples) -> Samples:
    """Return by how much samples of a channel are more than others, angles modulo one turn."""
    difference = one - other
    return np.remainder(difference + np.pi, 2 * np.pi) - np.pi if quantity(channel) in ANGLES else difference
