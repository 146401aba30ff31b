"""Causes in the samples: missing, held, spoilt, out of order, late, smoothed, noisy, or differences of each other."""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Rows, Scene
from scenes.model.motion import Samples

from ...engines.runner import INSTANT_TOL
from ...mechanics.reference import Reference
from .cause import Cause, Kind, Part, common
from .evidence import MAX_REST, MIN_ROWS, RIGHT_SAMPLE_TOL, Channels, Evidence, Hypothesis

MAX_SHARE_OF_ROWS = 0.1  # that are spoilt
MIN_SHARE_OF_CHANNELS = 0.8  # that a spoilt row spoils
MIN_CHANNELS = 3  # by which a row is known: one number or two are about those of many rows
ROUND_OFF_TOL = 1e-9  # of the square of the largest sample's deviation
SAME_ROW_TOL = 1e-2  # of the square of a row's deviation: what it has from the row that it really is
SAMPLES_LATE = (0.5, 1.0, 2.0, 5.0)  # where the search for a lag starts, besides zero
CYCLES_LATE = tuple(k / 16 for k in range(1, 9))
WHOLE_SAMPLES = (1, 2, 3, -1, -2, -3)
EVEN_STEP_TOL = 1e-6  # of a step: by how much equal ones differ where instants are written at decimals
COARSE = (2, 3, 4, 5, 6, 8, 9, 10, 12)  # samples
MIN_DECAY = 2.0  # of a transient, from each third of the start to the next
MIN_BEND = 1e-3  # of a second difference
MAX_CORRELATION = 0.3  # of the deviations of neighbours, that noise has
MIN_SPREAD = 0.15  # of the samples, that noise and what is interpolated have


def incomplete(reference: Reference, sampling: Rows, motion: Motion) -> Cause | None:
    """Return the cause where something is not there to be compared."""
    wanted = sampling.wanted(reference.scene)
    if missing := [c for c in wanted if c not in motion]:
        text = "{one} and {count} more are missing" if len(missing) > 1 else "{one} is missing"
        return Cause(Kind.missing, common(reference.scene.channels, missing), text, (len(missing) - 1,), (missing[0],))
    for kind, text, bad in (
        (Kind.missing, "{one} is of {two}, not float64", lambda samples: samples.dtype != np.float64),
        (Kind.missing, "{one} has {count} samples of {of}", lambda samples: samples.shape != (sampling.count,)),
        (Kind.nonfinite, "{one} is not finite", lambda samples: not np.isfinite(samples).all()),
    ):
        if wrong := [c for c in wanted if bad(motion[c])]:
            first = motion[wrong[0]]
            place, amounts = common(reference.scene.channels, wrong), (first.size, sampling.count)
            return Cause(kind, place, text, amounts, (wrong[0], str(first.dtype)))
    deviation = float(np.abs(motion["time"] - sampling.times(reference.scene)).max())
    return (
        None
        if deviation <= INSTANT_TOL * reference.scene.cycle
        else _instants(reference.scene, sampling, motion, deviation)
    )


def _instants(scene: Scene, sampling: Rows, motion: Motion, deviation: float) -> Cause:
    steps = np.diff(motion["time"])
    for kind, text, bad in (
        (Kind.held, "row {count} has the instant of the row before", steps == 0),
        (Kind.rows, "row {count} is of an earlier instant than the row before", steps < 0),
    ):
        if bad.any():
            return Cause(kind, "all", text, (int(bad.argmax()) + 2,))
    asked = sampling.times(scene)
    share = float(motion["time"] @ asked / (asked @ asked)) - 1
    if np.abs(motion["time"] - (1 + share) * asked).max() <= 1e-3 * deviation:
        return Cause(Kind.drive, "drive", "the drive's cycle is {share} of itself too {long}", (share,))
    return Cause(Kind.lag, "all", "the samples are off the instants asked for, by up to {number} s", (deviation,))


def sample_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield samples that are held, out of order or spoilt, of all channels or of some."""
    yield from _held(evidence)
    for channels in (evidence.names, tuple(c for c in evidence.names if c != evidence.drive)):
        yield from _out_of_order(evidence, channels)
    yield from _spoilt(evidence)


def _held(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield samples that repeat the one before, of all channels, of all of one stem, or of one channel."""
    true, given = evidence.true, evidence.given
    moving = [c for c in evidence.names if np.ptp(true[c]) > 1e-9 * evidence.reference.scale[c]]
    if not moving:
        return
    same, moved = (np.array([np.diff(samples[c]) for c in moving]) for samples in (given, true))
    stay = dict(zip(moving, np.insert((same == 0) & (moved != 0), 0, False, axis=1), strict=True))
    some = [c for c in moving if stay[c].any() and np.ptp(given[c]) > 0]
    together = np.append(False, (same == 0).all(axis=0) & (moved != 0).any(axis=0))
    if together.any():
        later = np.append(together[1:], False)  # of two rows that are the same, either may be the one that is right
        for rows in (_last_fresh(together), len(later) - 1 - _last_fresh(later[::-1])[::-1]):
            yield _of_rows(evidence, Kind.held, "{place} repeats a row, first at {where}", evidence.names, rows)
    elif some and len(some) <= 6:
        predicted = {c: true[c][_last_fresh(stay[c])] for c in some}
        yield Hypothesis(Cause(Kind.held, common(evidence.channels, some), "{place} repeats a sample"), predicted)


def _last_fresh(stay: NDArray[np.bool_]) -> NDArray[np.intp]:
    return np.maximum.accumulate(np.where(stay, 0, np.arange(len(stay))))


def _of_rows(
    evidence: Evidence, kind: Kind, text: str, channels: Sequence[str], rows: NDArray[np.intp], freedom: int = 0
) -> Hypothesis:
    first = float(evidence.true[evidence.drive][(rows != np.arange(len(rows))).argmax()])
    return Hypothesis(Cause(kind, "all", text, rows=(first,)), {c: evidence.true[c][rows] for c in channels}, freedom)


def _out_of_order(evidence: Evidence, channels: tuple[str, ...]) -> Iterator[Hypothesis]:
    true, given = (_rows(evidence, motion, channels) for motion in (evidence.true, evidence.given))
    squares = np.sum((given - true) ** 2, axis=1)
    bad = np.flatnonzero(squares > ROUND_OFF_TOL * squares.max())
    distance = np.sum((given[bad, np.newaxis] - true[np.newaxis]) ** 2, axis=2)
    theirs = distance.min(axis=1) <= SAME_ROW_TOL * squares[bad]
    if theirs.any() and len(channels) >= MIN_CHANNELS:
        rows = np.arange(len(true))
        rows[bad[theirs]] = distance.argmin(axis=1)[theirs]
        yield _of_rows(evidence, Kind.rows, "{place} has rows of other instants, first at {where}", channels, rows, 3)


def _rows(evidence: Evidence, motion: Motion, channels: Sequence[str]) -> NDArray[np.float64]:
    """Return all channels row by row, over their scales; angles by their sines and cosines."""
    angles, scale = [c for c in channels if evidence.channels[c].is_angle], evidence.reference.scale
    columns = [motion[c] / scale[c] for c in channels if c not in angles]
    return np.array([*columns, *(wave(motion[c]) for c in angles for wave in (np.sin, np.cos))]).T


def _spoilt(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield a few samples that are off, whose neighbours are not."""
    bad = evidence.by_row > RIGHT_SAMPLE_TOL * evidence.by_row.max()
    if not bad.any() or (bad[1:] & bad[:-1]).any() or bad.sum() > max(1, MAX_SHARE_OF_ROWS * len(bad)):
        return
    least = RIGHT_SAMPLE_TOL * evidence.total
    spoilt = [c for c, deviation in evidence.deviation.items() if np.sum(deviation[bad] ** 2) > least]
    predicted = {c: np.where(bad, evidence.given[c], evidence.true[c]) for c in spoilt}
    place = common(evidence.channels, spoilt)
    if place == "all" and len(spoilt) < MIN_SHARE_OF_CHANNELS * len(evidence.names):
        return  # a peak of some channels, as where a solver has trouble
    first = float(evidence.true[evidence.drive][bad.argmax()])
    text = "{place} is spoilt at {where}, its neighbours are not"
    yield Hypothesis(Cause(Kind.spike, place, text, rows=(first,)), predicted)


def course_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what a wrong course would have given, for all channels that hold nearly all of the deviation."""
    for part, causes in product(evidence.parts, (_late, _differences, _smoothed, _growing, _interpolated)):
        yield from causes(evidence, part)


def _late(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """All of a part late by one time, s, by Gauss and Newton from several starts; or by samples, the first held."""
    time, rows = evidence.motion["time"], np.arange(len(evidence.rows))
    step, scene = float(time[1] - time[0]), evidence.scene
    kind = Kind.drive if part.channels == (evidence.drive,) else Kind.lag

    def predict(lag: Samples, start: float = 0.0) -> Channels:
        late = evidence.late(start + float(lag[0]))
        return {c: late[c] for c in part.channels if late}

    # The deviation as a function of the lag has many local minima over a cycle: Gauss-Newton starts from the best of
    # several lags of samples and of parts of a cycle.
    starts = [k * step for k in (0.0, *SAMPLES_LATE)] + [k * scene.cycle for k in CYCLES_LATE] * scene.periodic
    either = (sign * time_late for time_late in starts for sign in (1, -1))
    start = min(either, key=lambda first: evidence.left(predict(np.zeros(1), first)))
    (lag,), late = evidence.fitted(lambda x: predict(x, start), [1e-4 * step], 4)
    if late:
        lag = float(lag) + start
        even = float(np.ptp(np.diff(time))) <= EVEN_STEP_TOL * step  # else a lag is no number of samples
        yield Hypothesis(part.cause(kind, "{part} {is} {late}", *((lag, lag / step) if even else (lag,))), late, 1)
    for count in WHOLE_SAMPLES:
        predicted = {c: evidence.true[c][np.clip(rows - count, 0, rows[-1])] for c in part.channels}
        yield Hypothesis(part.cause(kind, "{part} {is} {late_rows}", count), predicted)


def _explained(evidence: Evidence, predicted: Channels) -> Channels:
    """Return those channels that a prediction explains in part at least."""
    return {c: values for c, values in predicted.items() if evidence.left({c: values}) < 1}


def _differences(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Rates that are differences of the motion's own poses or rates over its samples."""
    known = {c: evidence.channels.below(c) for c in part.channels}
    sources = {c: source for c, source in known.items() if source is not None and source in evidence.motion}
    if len(sources) < len(known):
        return
    time, below = evidence.motion["time"], {c: evidence.motion[source] for c, source in sources.items()}
    values = {
        c: np.unwrap(samples) if evidence.channels[sources[c]].is_angle else samples for c, samples in below.items()
    }
    text, before = "{part} {is} {one} differences of samples", [0, *range(len(time) - 1)]
    central = {c: np.gradient(samples, time) for c, samples in values.items()}
    backward = {c: (np.diff(samples) / np.diff(time))[before] for c, samples in values.items()}
    for how, rates in (("central", central), ("backward", backward)):
        predicted = _explained(evidence, {c: rate[evidence.rows] for c, rate in rates.items()})
        place = common(evidence.channels, predicted)
        yield Hypothesis(Cause(Kind.differences, place, text, names=(how,), part=part), predicted)


def _smoothed(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield a part, or those of its channels that it explains, averaged over neighbouring samples."""
    # Smoothing adds a share of the second difference to each sample; the share is fitted, one for all channels.
    bends = {c: np.diff(np.pad(evidence.true[c], 1, "edge"), 2) for c in part.channels}
    sizes = [float(evidence.added([{c: bend}])[0][0]) for c, bend in bends.items()]
    typical = float(np.median([size for size in sizes if abs(size) > MIN_BEND] or [0.0]))
    predicted = _explained(evidence, evidence.changed((typical,), [bends]))
    text = "{part} {is} smoothed over {its} samples"
    place = common(evidence.channels, predicted)
    yield Hypothesis(Cause(Kind.solver, place, text, (typical,), part=part), predicted, 1)


def _growing(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield a part whose errors grow steadily: from nothing by a slope of each channel's own, or by one factor."""
    true, end = evidence.true, float(np.ptp(evidence.true["time"]))
    run = (true["time"] - true["time"][0]) / end
    drifting = {c: evidence.added([{c: run}])[1][c] for c in part.channels}
    yield Hypothesis(part.cause(Kind.solver, "{part} {is} drifting away steadily"), drifting, min(len(drifting), 2))
    growing = part.cause(Kind.solver, "{part} {is} growing steadily, by {growth} at the end")
    yield evidence.with_amounts(growing, {c: true[c] * run for c in part.channels})


def _interpolated(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield a part that is right at every so many samples, and between them on lines or on a spline."""
    rows = evidence.rows
    if len(rows) < len(evidence.motion["time"]):
        return
    squares = np.sum([evidence.deviation[c] ** 2 for c in part.channels], axis=0)
    if np.mean(squares > RIGHT_SAMPLE_TOL * squares.max()) < MIN_SPREAD:
        return  # a few rows are missed by nodes anyhow
    from scipy.interpolate import make_interp_spline

    time, true = evidence.true["time"], {c: evidence.true[c] for c in part.channels}
    values = {c: np.unwrap(samples) if evidence.channels[c].is_angle else samples for c, samples in true.items()}
    for every, (degree, how) in product(COARSE, ((1, "linear"), (3, "cubic"))):
        nodes = np.unique([*rows[::every], rows[-1]])
        if len(nodes) > 3 and squares[nodes].sum() <= MAX_REST**2 * squares.sum():
            predicted = {
                c: make_interp_spline(time[nodes], samples[nodes], degree)(time) for c, samples in values.items()
            }
            cause = part.cause(Kind.coarse, "{part} {is} {one} between every {count}th sample", every, names=(how,))
            yield Hypothesis(cause, predicted, 1)


def irregular(evidence: Evidence) -> Cause | None:
    """Return that the fewest channels that hold nearly all of the deviation are noisy, or have a start transient.

    Of noise, the deviations of neighbouring samples have nothing to do with each other, and no few of them are all of
    it. Those of a transient, over their largest sizes, are in the first rows, and die away from there.
    """
    parts = [part for part in evidence.parts if evidence.outside(part.channels) <= MAX_REST]
    part = min(parts, key=lambda part: len(part.channels))
    deviations = np.array([evidence.deviation[c] for c in part.channels])
    square, by_row = float(np.sum(deviations**2)), np.sum(deviations**2, axis=0)
    # White noise: neighbouring deviations do not correlate, and the fourth moment by row is not carried by a few rows.
    if np.sum(
        deviations[:, 1:] * deviations[:, :-1]
    ) <= MAX_CORRELATION * square and square**2 >= MIN_SPREAD * by_row.size * np.sum(by_row**2):
        return part.cause(Kind.noise, "{part} {is} noisy")
    size = np.array([evidence.scale[c] / evidence.scale[c].max() for c in part.channels])
    by_row = np.sum((size * deviations) ** 2, axis=0)
    first, second, third = (float(part.sum()) for part in np.array_split(by_row[: len(by_row) // 4], 3))
    most = len(by_row) > 4 * MIN_ROWS and first + second + third >= (1 - MAX_REST**2) * by_row.sum()
    dying = first > MIN_DECAY * second > MIN_DECAY**2 * third > 0 and by_row[0] > by_row.max() / MIN_DECAY
    return part.cause(Kind.start, "{part} {has} a start transient") if most and dying else None
