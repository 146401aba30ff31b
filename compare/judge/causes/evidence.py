"""What a disagreement is explained from: a motion, what it should be, and how much of the distance a cause leaves over.

A cause predicts what its motion would be. What it leaves over, the distance of the motion from that prediction over its
distance from what it should be, is 0 for a cause that explains all and 1 for one that explains nothing.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Motion, Rows, Scene
from scenes.model.inputs import Inputs, inputs_of, passing
from scenes.model.motion import Samples

from ...engines import registry
from ...mechanics.motion_vectors import MotionVectors
from ...mechanics.reference import Reference
from ...mechanics.scales import apart, resting, sizes
from .cause import Cause, Part, parts

MAX_ROWS = 400  # but for those about the worst: all of a usual run
ROWS_BESIDE_WORST = 10  # on either side
MIN_ROWS = 4  # in which a motion can be off alone
RIGHT_SAMPLE_TOL = 1e-3  # of the square of the largest sample's deviation: what right samples have
CAUSE_TOL = 0.01  # of the deviation: what causes leave over below it is rounding, and what an engine is off besides

MAX_REST = 0.15  # of the deviation, that the cause named leaves over
PRICE_OF_NUMBER = 0.25  # of what is left over, for each number that was fitted
MAX_RATIO_OF_ROUNDS = 0.99  # of what two rounds leave over: beyond it a further round is worth no more
MAX_REST_TRIED = 0.3  # of the deviation, that a cause worth a look leaves over

Channels = Mapping[str, Samples]


class Hypothesis(NamedTuple):
    """A cause, and the channels of the motion that it would give, at the rows of the evidence; all others stand."""

    cause: Cause
    predicted: Channels
    freedom: int = 0  # numbers that were fitted


class Evidence:
    """A motion, as the engine returned it, and what it should be, at some rows of it."""

    def __init__(self, reference: Reference, motion: Motion, true: Motion, rows: NDArray[np.intp]) -> None:
        self.reference, self.motion, self.rows = reference, motion, rows
        self.scene, self.drive = reference.scene, reference.scene.channels.drive.position
        self.true, self.given = true, Motion({c: samples[rows] for c, samples in motion.samples.items()})  # at the rows
        compared = (c for c in motion.samples if c != "time" and c in reference.scale and c in true)
        self.names = tuple(compared)  # the channels that are compared
        # What the deviation of each channel is divided by: its scale, or its magnitude where that is larger.
        self.channels = self.scene.channels
        self.scale = {c: sizes(true, self.channels[c], reference.scale[c]) for c in self.names}
        self.deviation = {c: self.difference(c, true[c]) for c in self.names}  # more than it should be
        squares = {c: deviation**2 for c, deviation in self.deviation.items()}
        self.off = {c: float(np.sum(square)) for c, square in squares.items()}  # summed over the rows
        self.by_row = np.asarray(np.sum([*squares.values()], axis=0))  # summed over the channels
        self.total = sum(self.off.values())  # the square of the whole deviation
        forces = [c for c in self.names if self.channels[c].is_force]  # whether nearly all of it is in them
        self.of_forces = bool(forces) and self.total > 0 and self.outside(forces) <= MAX_REST
        self._late: dict[float, Channels] = {}

    def difference(self, channel: str, other: Samples) -> Samples:
        """Return by how much the motion's channel is more than another, over its scale, angles modulo one turn."""
        return apart(self.channels[channel], self.given[channel], other) / self.scale[channel]

    def outside(self, channels: Iterable[str]) -> float:
        """Return the rest that a cause leaves over which explains all of these channels and no other."""
        explained = sum(self.off.get(channel, 0.0) for channel in channels)  # none of those that were not asked for
        return float(np.sqrt(max(self.total - explained, 0.0) / self.total))

    def left(self, predicted: Channels) -> float:
        """Return the rest that a prediction leaves over."""
        # The square of the distance is a sum over channels. Most predictions change few channels, so that only these
        # terms of the sum are found anew.
        squares = {c: float(np.sum(self.difference(c, predicted[c]) ** 2)) for c in predicted if c in self.off}
        change = sum(square - self.off[c] for c, square in squares.items())
        left = float(np.sqrt(max(self.total + change, 0.0) / self.total))
        return left if np.isfinite(left) else np.inf

    def solved(self, scene: Scene, inputs: Inputs | None = None) -> Channels:
        """Return all channels of a scene, at the inputs asked for or others; nothing where it has no motion."""
        with suppress(Failure), np.errstate(all="ignore"):
            solve = self.reference.at if scene is self.scene else registry.reference(scene)
            return solve(self.true.inputs(scene) if inputs is None else inputs).samples
        return {}

    def passing(self, scene: Scene, position: Samples) -> Channels:
        """Return the same with the drive at other positions at the instants asked for."""
        return self.solved(scene, passing(scene, position, self.true["time"]))

    def late(self, delay: float) -> Channels:
        """Return the motion as if all were late by a time, s; nothing where there is no motion."""
        if delay not in self._late:
            scene, time = self.scene, self.true["time"] - delay
            time = time if scene.periodic else np.clip(time, 0.0, scene.cycle)
            self._late[delay] = self.solved(scene, inputs_of(scene, time))
        return self._late[delay]

    @cached_property
    def parts(self) -> list[Part]:
        """Channels that a read-out treats alike, and hold nearly all: a channel, a vector, all of a body, ..."""
        return [part for part in parts(self.channels, self.names) if self.outside(part.channels) <= MAX_REST_TRIED]

    def at(self, kept: NDArray[np.intp]) -> "Evidence":
        """Return the evidence at some of its rows."""
        true = Motion({channel: samples[kept] for channel, samples in self.true.samples.items()})
        return Evidence(self.reference, self.motion, true, self.rows[kept])

    def with_amounts(self, cause: Cause, *changes: Channels) -> Hypothesis:
        """Return a cause with the amounts of changes that leave least over, and the channels with them."""
        amounts, predicted = self.added(changes)
        return Hypothesis(replace(cause, amounts=tuple(amounts.tolist())), predicted, len(changes))

    def added(self, changes: Sequence[Channels], now: Channels | None = None) -> tuple[Samples, Channels]:
        """The amounts, shape (k,), of changes to the truth or `now` that leave least, and the truth with them."""
        channels = [c for c in self.names if any(c in change for change in changes)]
        nothing = np.zeros(len(self.rows))
        basis = [[change.get(c, nothing) / self.scale[c] for c in channels] for change in changes]
        deviations = [self.difference(c, now[c]) if now else self.deviation[c] for c in channels]
        amounts = least_squares(np.reshape(basis, (len(changes), -1)).T, np.ravel(deviations))
        return amounts, self.changed(amounts, changes)

    def changed(self, amounts: Iterable[float], changes: Sequence[Channels]) -> Channels:
        """Return the channels that are changed, by so much of each change."""
        return summed(amounts, changes, self.true.samples)

    def fitted(
        self, predict: Callable[[Samples], Channels], steps: Sequence[float], rounds: int = 1
    ) -> tuple[Samples, Channels]:
        """Return the numbers whose prediction leaves least over, and that prediction, by Gauss and Newton from zero.

        One round is exact for what is linear. `steps` are what the numbers are varied by.
        """
        x, now = np.zeros(len(steps)), predict(np.zeros(len(steps)))
        for _ in range(rounds):
            # Gauss and Newton's method with slopes by differences, one prediction a number. Where the whole change
            # leaves more than before, shorter ones are tried: with the numbers far off a linkage may not close, or a
            # dead point be passed. It ends where a round gains less than a hundredth, or no shorter change gains.
            ways = [predict(x + step) for step in np.diag(steps)]
            if not all((now, *ways)):
                return x, {}
            slopes = [{c: apart(self.channels[c], way[c], now[c]) for c in now if c in self.names} for way in ways]
            change = self.added(slopes, now)[0] * steps
            for shorter in (1.0, 0.5, 0.2, 0.05):
                then = predict(x + shorter * change)
                if then and (rounds == 1 or self.left(then) <= self.left(now)):
                    break
            else:
                return x, now
            settled = self.left(then) > MAX_RATIO_OF_ROUNDS * self.left(now)
            x, now = x + shorter * change, then
            if settled:
                break
        return x, now


def summed(amounts: Iterable[float], changes: Iterable[Mapping[str, Any]], now: Mapping[str, Any]) -> dict[str, Any]:
    """What is there now, by name, and so much of each change."""
    total: dict[str, Any] = {}
    for amount, change in zip(amounts, changes, strict=True):
        for name, values in change.items():
            total[name] = total.get(name, now[name]) + amount * values
    return total


def least_squares(columns: NDArray[np.float64], target: Samples) -> Samples:
    """Return the amounts of columns, shape (n, k), that are nearest to something together; of empty ones nothing."""
    size = np.linalg.norm(columns, axis=0)
    if not (np.isfinite(size).all() and np.isfinite(target).all()):
        return np.zeros(len(size))
    # Columns are brought to unit length first, so that `rcond` compares directions, not the units of the numbers.
    # Directions that the columns hold to less than a millionth get nothing: the amounts of two nearly equal columns
    # would else be large and of opposite sign.
    size[size == 0] = np.inf
    return np.asarray(np.linalg.lstsq(columns / size, target, rcond=1e-6)[0] / size)


def away_from_switches(evidence: Evidence) -> Evidence:
    """Return the evidence without the samples on either side of a press force's switch, where rounding decides.

    It stays whole where hardly any of the deviation is elsewhere.
    """
    acts = np.array([act.any(axis=0) for act in evidence.reference.acts(evidence.true)])
    if not acts.size:
        return evidence
    switched = (np.diff(acts, axis=1) != 0).any(axis=0)
    elsewhere = evidence.at(np.flatnonzero(~(np.append(switched, False) | np.append(False, switched))))
    return elsewhere if elsewhere.total > CAUSE_TOL**2 * evidence.total else evidence


def evidence(reference: Reference, sampling: Rows, motion: Motion) -> Evidence:
    """Return a motion beside what the drive commands, at rows evenly spread and at those about the worst."""
    true = reference.at(sampling.inputs(reference.scene))
    whole = Evidence(reference, motion, true, np.arange(sampling.count))
    if reference.mechanics.friction:
        whole = whole.at(np.flatnonzero(~resting(MotionVectors(reference.scene, true))))
    return thinned(whole, MAX_ROWS, ROWS_BESIDE_WORST)


def thinned(evidence: Evidence, most: int, beyond: int = 0) -> Evidence:
    """Return the evidence at so many of its rows, evenly spread, and at those about the worst."""
    count = len(evidence.rows)
    if count <= most:
        return evidence
    near = int(np.argmax(evidence.by_row)) + np.arange(-beyond, beyond + 1)
    spread = np.linspace(0, count - 1, max(most, 2)).astype(np.intp)
    return evidence.at(np.unique([*spread, *near[(near >= 0) & (near < count)]]))


def price(left: float, freedom: int) -> float:
    """Return the price by which a cause is ranked: its rest, and more by each number that was fitted."""
    return left * (1 + PRICE_OF_NUMBER * freedom)
