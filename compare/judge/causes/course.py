"""Causes in the course of right samples: late, smoothed, differences of each other, noisy."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from scenes import Motion
from scenes.model.motion import Samples, quantity

from .cause import Cause, Kind, Way
from .evidence import (
    EXPLAINED,
    NEARLY_ALL,
    NEXT_TO_NOTHING,
    SHORTEST,
    Channels,
    Evidence,
    Hypothesis,
    added,
    fitted,
    with_changes,
)
from .parts import ANGLES, Part, common, stem

SAMPLES_LATE = (0.5, 1.0, 2.0, 5.0)  # where the search for a lag starts, besides zero
CYCLES_LATE = tuple(k / 16 for k in range(1, 9))
WHOLE_SAMPLES = (1, 2, 3, -1, -2, -3)
EVEN = 1e-6  # of a step: by how much equal steps differ where instants are written at decimals
COARSE = (2, 3, 4, 5, 6, 8, 9, 10, 12)  # samples
FASTER = 2.0  # from each third of the start to the next, a transient dies away by more
LEAST_BEND = 1e-3  # of a second difference
WHITE = 0.3  # the largest correlation of the deviations of neighbours, that noise has
SPREAD = 0.15  # of the samples, that noise and what is interpolated have at least


def course_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what a wrong course would have given, for all channels that hold nearly all of the deviation."""
    for part in evidence.parts:
        if evidence.outside(part.channels) <= EXPLAINED:
            for cause in (_late, _late_by_samples, _differences, _smoothed, _growing, _interpolated):
                yield from cause(evidence, part)


def _late(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """All of a part late by one time, s, found by Gauss and Newton from several starts."""
    channels = part.channels
    time = evidence.motion["time"]
    step = float(time[1] - time[0])

    def predict(by: Samples, start: float = 0.0) -> Channels:
        late = evidence.late(start + float(by[0]))
        return {c: late[c] for c in channels} if late else {}

    def left(start: float) -> float:
        late = predict(np.zeros(1), start)
        return evidence.left(late) if late else np.inf

    drive = evidence.reference.scene.drive
    starts = [k * step for k in (0.0, *SAMPLES_LATE)]
    starts += [k * drive.cycle for k in CYCLES_LATE] * drive.repeats
    start = min((sign * by for by in starts for sign in (1, -1)), key=left)
    (by,), late = fitted(evidence, lambda by: predict(by, start), np.full(1, 1e-4 * step), 4)
    if late:
        by += start
        even = float(np.ptp(np.diff(time))) <= EVEN * step  # else a lag is no number of samples
        amounts = (float(by), float(by / step)) if even else (float(by),)
        yield Hypothesis(_lag(evidence, part, Way.late, *amounts), late, 1)


def _lag(evidence: Evidence, part: Part, way: Way, *amounts: float) -> Cause:
    kind = Kind.drive if part.channels == (evidence.reference.scene.drive_channel,) else Kind.lag
    return Cause(kind, part.place, way, amounts, part=part)


def _explained(evidence: Evidence, predicted: Channels) -> Channels:
    """Return those channels that a prediction explains in part at least."""
    return {c: own for c, own in predicted.items() if evidence.left({c: own}) < 1}


def _differences(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Rates that are differences of the motion's own poses or rates over its samples."""
    channels = part.channels
    source_of = {"vx": "x", "vy": "y", "omega": "angle", "ax": "vx", "ay": "vy", "alpha": "omega"}
    sources = {c: f"{stem(c)}.{source_of.get(quantity(c))}" for c in channels}
    if not all(source in evidence.motion for source in sources.values()):
        return
    time = evidence.motion["time"]
    below = {c: evidence.motion[source] for c, source in sources.items()}
    values = {c: np.unwrap(own) if sources[c].endswith("angle") else own for c, own in below.items()}
    for how, difference in _DIFFERENCES.items():
        predicted = _explained(evidence, {c: difference(values[c], time)[evidence.rows] for c in channels})
        cause = Cause(Kind.differences, common(predicted), Way.differences, names=(how,), part=part)
        yield Hypothesis(cause, predicted)


def _backward(values: Samples, time: Samples) -> Samples:
    steps = np.diff(values) / np.diff(time)
    return np.append(steps[:1], steps)


_DIFFERENCES: dict[str, Callable[[Samples, Samples], Samples]] = {"central": np.gradient, "backward": _backward}


def _late_by_samples(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield a part late by a few samples, the first one held."""
    last = len(evidence.rows) - 1
    for by in WHOLE_SAMPLES:
        rows = np.clip(np.arange(last + 1) - by, 0, last)
        predicted = {c: evidence.true[c][rows] for c in part.channels}
        yield Hypothesis(_lag(evidence, part, Way.late_rows, by), predicted)


def _smoothed(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield a part, or those of its channels that it explains, averaged over neighbouring samples."""
    bends = {c: np.diff(np.pad(evidence.true[c], 1, "edge"), 2) for c in part.channels}
    by = [float(added(evidence, [{c: bend}])[0][0]) for c, bend in bends.items()]
    typical = float(np.median([size for size in by if abs(size) > LEAST_BEND] or [0.0]))
    predicted = _explained(evidence, with_changes(evidence, (typical,), [bends]))
    yield Hypothesis(Cause(Kind.solver, common(predicted), Way.smoothed, (typical,), part=part), predicted, 1)


def _growing(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield a part whose errors grow steadily: from nothing by a slope of each channel's own, or by one factor."""
    true = evidence.true
    run = true["time"] - true["time"][0]
    away = [added(evidence, [{c: run}])[1] for c in part.channels]
    drifting = {c: own for each in away for c, own in each.items()}
    yield Hypothesis(Cause(Kind.solver, part.place, Way.drift, part=part), drifting, min(len(away), 2))
    (rate,), grown = added(evidence, [{c: true[c] * run for c in part.channels}])
    yield Hypothesis(Cause(Kind.solver, part.place, Way.growth, (float(rate * run[-1]),), part=part), grown, 1)


def _interpolated(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield a part that is right at every so many samples, and between them on lines or on a spline."""
    channels, rows = part.channels, evidence.rows
    if len(rows) < len(evidence.motion["time"]):
        return
    off = np.array([evidence.difference(c, evidence.true[c]) ** 2 for c in channels]).sum(axis=0)
    if np.mean(off > NEXT_TO_NOTHING * off.max()) < SPREAD:
        return  # a few rows are missed by nodes anyhow
    for every in COARSE:
        nodes = np.unique([*rows[::every], rows[-1]])
        if len(nodes) > 3 and off[nodes].sum() <= NEARLY_ALL**2 * off.sum():
            for degree, how in ((1, "linear"), (3, "cubic")):
                predicted = {c: _between(evidence.true, c, nodes, degree) for c in channels}
                cause = Cause(Kind.coarse, part.place, Way.between, (every,), (how,), part)
                yield Hypothesis(cause, predicted, 1)


def _between(true: Motion, channel: str, nodes: NDArray[np.intp], degree: int) -> Samples:
    """Return a channel at all instants as a spline through some rows has it."""
    from scipy.interpolate import make_interp_spline

    time, samples = true["time"], np.unwrap(true[channel]) if quantity(channel) in ANGLES else true[channel]
    return np.asarray(make_interp_spline(time[nodes], samples[nodes], degree)(time))


def starting(evidence: Evidence) -> Cause | None:
    """Return that the fewest channels that hold nearly all of the deviation have a start transient, if they have.

    Their deviation, over their largest sizes, is in the first rows, and dies away from there.
    """
    part, off = _fewest(evidence)
    size = np.array([evidence.scale[c] / evidence.scale[c].max() for c in part.channels])
    by_row = np.sum((size * off) ** 2, axis=0)
    early = np.array_split(by_row[: len(by_row) // 4], 3)
    first, second, third = (float(part.sum()) for part in early)
    if not (len(by_row) > 4 * SHORTEST and first + second + third >= (1 - NEARLY_ALL**2) * by_row.sum()):
        return None
    if not (first > FASTER * second > FASTER**2 * third > 0 and by_row[0] > by_row.max() / FASTER):
        return None
    return Cause(Kind.start, part.place, Way.transient, part=part)


def _fewest(evidence: Evidence) -> tuple[Part, NDArray[np.float64]]:
    """Return the fewest channels that hold nearly all of the deviation, and how far off they are."""
    parts = [part for part in evidence.parts if evidence.outside(part.channels) <= NEARLY_ALL]
    fewest = min(parts, key=lambda part: len(part.channels))
    return fewest, np.array([evidence.difference(c, evidence.true[c]) for c in fewest.channels])


def noisy(evidence: Evidence) -> Cause | None:
    """Return that the fewest channels that hold nearly all of the deviation are noisy, if they are.

    The deviations of neighbouring samples have nothing to do with each other then, and no few of them are all of it.
    """
    part, off = _fewest(evidence)
    square = float(np.sum(off**2))
    spread = square**2 / float(np.sum(np.sum(off**2, axis=0) ** 2)) / off.shape[1]
    if np.sum(off[:, 1:] * off[:, :-1]) > WHITE * square or spread < SPREAD:
        return None
    return Cause(Kind.noise, part.place, Way.noisy, part=part)
