"""What is proven of a scene over its whole range, between the samples too, and the scene's limits held against that."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf, isfinite, nan, tau
from typing import Any, NamedTuple

import numpy as np

from scenes import Motion, Sampling, Scene
from scenes.channels import TRANSMISSION
from scenes.model.enclosures import Enclosure, Enclosures
from scenes.model.motion import Samples
from scenes.scene import LimitTable

from ..mechanics.axis import axis, cycle_name, grouped
from ..mechanics.quantities import Units, apart, limited, suited, with_unit

MAX_WIDTH_OF_PLACE = 1e-3  # of the drive's range
MET, MISSED, OPEN = "met", "missed", "not decided"
FORCES = ("N", "N*m", "W")  # units of what may go on from cycle to cycle


class HeldLimit(NamedTuple):
    """A limit of the scene, SI, the extreme that it limits, and whether it is met, missed or not decided."""

    limit: float
    enclosure: Enclosure  # with infinite bounds where nothing is proven
    outcome: str
    text: str  # in one line


class SampledRun(NamedTuple):
    """A run that is ok, and how far it may be off."""

    name: str
    motion: Motion
    promise: float  # relative
    scale: Mapping[str, float]  # by channel, what errors are divided by

    def of(self, scene: Scene, name: str) -> Samples:
        """A channel or magnitude at its samples, shape (n,); none of them where it is not given."""
        known = {*channels_of(scene, name, self.motion.samples)} <= self.motion.samples.keys()
        return values_of(scene, name, self.motion) if known else np.empty(0)

    def off(self, scene: Scene, name: str, value: float) -> float:
        """How far a value of a channel or magnitude may be off, SI."""
        sizes = [self.scale.get(channel, 1.0) for channel in channels_of(scene, name, self.motion.samples)]
        return self.promise * max([abs(value), *sizes]) * len(sizes)


def asked(scene: Scene, sampling: Sampling) -> frozenset[str] | None:
    """The channels asked for and the magnitudes that these make; None where all are."""
    if sampling.channels is None:
        return None
    made = (name for name, both in scene.channels.magnitudes.items() if sampling.channels.issuperset(both))
    return sampling.channels.union(made)


class LimitsVerdict(NamedTuple):
    """The verdict on all limits of a scene, which is none on its models."""

    word: str  # met, missed or not decided
    sentence: str

    def __str__(self) -> str:
        return f"limits {self.word}: {self.sentence}"


def verdict_on(limits: Sequence[HeldLimit]) -> LimitsVerdict | None:
    """How many limits are met, and those that are not; None without limits."""
    outcomes, open_limits = (
        {limit.outcome for limit in limits},
        [limit.text for limit in limits if limit.outcome != MET],
    )
    word = next((outcome for outcome in (MISSED, OPEN, MET) if outcome in outcomes), None)
    met = f"{len(limits) - len(open_limits)} of {len(limits)} limits are met at every position"
    return None if word is None else LimitsVerdict(word, f"{'; '.join([met, *open_limits])}.")


def held(
    scene: Scene,
    sampling: Sampling,
    proof: Enclosures,
    runs: Sequence[SampledRun] = (),
    shown: Units | None = None,
) -> Iterator[HeldLimit]:
    """Yield the scene's limits of what was asked for, held against what is proven, and against the samples of runs.

    Texts are in the units shown, or else in the file's. The first of the runs is the reference's. A limit is not met
    that a sample misses by more than its run may be off.
    """
    shown = suited(scene.units, ()) if shown is None else shown
    known, wanted = {row[:2]: row for row in proof.rows}, asked(scene, sampling)
    for name, limits in scene.limits.items():
        if not (wanted is None or name in wanted):
            continue
        rows = [known.get((name, end), Enclosure(name, end, -inf, inf, nan, nan)) for end in ("least", "most")]
        sampled, turn = [run.of(scene, name) for run in runs], 0.0
        # An angle is known but for whole turns: bounds, samples and limits are moved to the same turn before they are
        # compared.
        if scene.channels[name].modulo_turn:
            first, last = rows[0].low, rows[1].high
            if not isfinite(first + last) and sampled and sampled[0].size:
                first, last = float(sampled[0].min()), float(sampled[0].max())
            turn = tau * whole_turns(first, last, limits)
            sampled = [values + tau * np.round(((first + last) / 2 + turn - values) / tau) for values in sampled]
        part = _part(scene, proof) if scene.channels[name].unit in FORCES else ""
        for row, limit, sign in zip(rows, (limits.least, limits.most), (-1, 1), strict=True):
            if limit is not None:
                moved = row._replace(low=row.low + turn, high=row.high + turn)
                yield _held(scene, moved, limit, sign, [*zip(runs, sampled, strict=True)], part, shown)


def _held(
    scene: Scene,
    row: Enclosure,
    limit: float,
    sign: int,
    runs: Sequence[tuple[SampledRun, Samples]],
    part: str,
    shown: Units,
) -> HeldLimit:
    """One limit, of the most or with the sign -1 of the least; a proof of a `part` of the run can only miss it."""
    (factor, unit), (inner, outer) = limited(scene, row.channel, shown), sorted((sign * row.low, sign * row.high))
    # Bounds decide: missed if even the inner bound is beyond the limit, met if the outer one is within, else open. Then
    # samples: one of the reference beyond the limit by more than its promise makes it missed; one of another engine
    # makes it open, as one of the two must be wrong.
    outcome = MISSED if inner > sign * limit else MET if outer <= sign * limit and not part else OPEN
    low, high = (apart(factor * bound, factor * limit) for bound in (row.low, row.high))
    found = with_unit(low if low == high else f"between {low} and {high}", unit)
    if isfinite(row.position_low):
        found += f" {place(scene, row[4:])}{part}"
    for number, (run, values) in enumerate(runs):
        if outcome == MISSED or not values.size:
            break
        worst = int((sign * values).argmax())
        value, beyond = float(values[worst]), sign * (float(values[worst]) - limit)
        if beyond > 0:
            there = float(axis(scene).of(run.motion)[worst] / axis(scene).factor)
            amount = with_unit(apart(factor * value, factor * limit), unit)
            seen = f"{amount} {place(scene, (there, there))} in the samples of {run.name}"
            if beyond > run.off(scene, row.channel, value):
                outcome, found = (OPEN, f"{found}, but {seen}") if number else (MISSED, seen)
            else:
                found += f", and within its promise {seen}" * (number > 0)
    allowed = with_unit(grouped(f"{factor * limit:.7g}".replace("-", "−")), unit)
    text = f"{row.channel}: at {row.extreme} {allowed} {outcome}: {found}"
    return HeldLimit(limit, row, outcome, text)


def _part(scene: Scene, proof: Enclosures) -> str:
    """Of how many cycles forces are known where these are not all of a run."""
    whole = proof.cycles in (None, proof.turns)
    return "" if whole else f" over the first {proof.cycles} of {proof.turns} {cycle_name(scene)}s"


def whole_turns(first: float, last: float, limits: LimitTable) -> int:
    """By how many turns an angle, from `first` to `last`, rad, is moved to be held against its limits.

    They are those by which it violates the limits least. With a limit on one side alone that would be met by enough
    turns: it is moved to where it is nearest to it, unless it is met where it is and never passes that direction.
    An angle of a turn and more passes all directions: it stays, from -pi to pi at the drive's start.
    """
    given = [end for end in (limits.least, limits.most) if end is not None]
    # The nearest turn by the middles of limits and range.
    offset = sum(given) / len(given) - (first + last) / 2
    if not isfinite(offset) or (len(given) == 1 and last - first >= tau):
        return 0
    turns = round(offset / tau)
    passed = len(given) == 1 and abs(offset - tau * turns) < (last - first) / 2
    violated = (limits.least is not None and first < limits.least) or (limits.most is not None and last > limits.most)
    return turns if violated or passed else 0


def met(scene: Scene, motion: Motion) -> Any:
    """Whether each of m machines meets all limits of the scene at its samples, shape (m,); the motion's are (m, n)."""
    fulfilled = np.ones(len(motion["time"]), np.bool_)
    for name, limit in scene.limits.items():
        values = values_of(scene, name, motion)
        if scene.channels[name].modulo_turn:
            ends = zip(values.min(axis=-1).tolist(), values.max(axis=-1).tolist(), strict=True)
            values = values + tau * np.array([[whole_turns(*each, limit)] for each in ends])
        fulfilled &= (limit.least is None) | (values >= (limit.least or 0.0)).all(axis=-1)
        fulfilled &= (limit.most is None) | (values <= (limit.most or 0.0)).all(axis=-1)
    return fulfilled


def values_of(scene: Scene, name: str, motion: Motion) -> Samples:
    """A channel or magnitude at a motion's samples, shape (..., n), or NaN; angles go on over whole turns."""
    columns = [motion[channel] for channel in channels_of(scene, name, motion.samples)]
    if not columns:
        return np.full((*motion["time"].shape[:-1], 1), nan)
    if scene.channels[name].modulo_turn:
        return np.unwrap(columns[0], axis=-1)
    return np.asarray(np.hypot(*columns) if name in scene.channels.magnitudes else np.min(columns, axis=0))


def channels_of(scene: Scene, name: str, known: Iterable[str]) -> Sequence[str]:
    """The channels that a channel or a magnitude is of: of the least transmission angle those that are known."""
    if name == TRANSMISSION:
        return [channel for channel in known if scene.channels[channel].quantity == TRANSMISSION]
    return scene.channels.magnitudes.get(name, (name,))


def place(scene: Scene, ends: tuple[float, float]) -> str:
    """A part of the drive's range, SI, as messages name it: where it is narrow, one place."""
    drive_axis, (low, high) = axis(scene), ends
    wide = high - low > MAX_WIDTH_OF_PLACE * (
        scene.cycle if drive_axis.channel == "time" else max(drive.span for drive in scene.drives)
    )
    return f"from {drive_axis.text(*ends)}" if wide else f"at {drive_axis.text((low + high) / 2)}"
