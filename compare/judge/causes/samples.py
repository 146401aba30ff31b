"""Causes that need no model: channels missing or not finite, samples held, spoilt or out of order."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Rows, Scene
from scenes.model.motion import quantity

from ...engines.runner import ON_TIME
from ...mechanics.reference import Reference
from .cause import Cause, Kind, Way
from .evidence import NEXT_TO_NOTHING, Evidence, Hypothesis, stretch
from .parts import ANGLES, Part, common

FEW = 0.1  # of the samples
MOST = 0.8  # of the channels, that a spoilt row spoils
TELLING = 3  # channels, by which a row is known: one number or two are about those of many rows
ROUNDING = 1e-9  # of the square of the largest sample's deviation
FAR_LESS = 1e-2  # of the square of a row's deviation: what it has from the row that it really is


def incomplete(reference: Reference, sampling: Rows, motion: Motion) -> Cause | None:
    """Return the cause where something is not there to be compared."""
    wanted = sampling.wanted(reference.scene)
    missing = [c for c in wanted if c not in motion and c not in motion.unsupported]
    missing = missing or [c for c in wanted if c not in motion]
    if missing:
        way = Way.several_missing if len(missing) > 1 else Way.missing
        return Cause(Kind.missing, common(missing), way, (len(missing) - 1,), (missing[0],))
    other = [c for c in wanted if motion[c].dtype != np.float64]
    if other:
        return Cause(Kind.missing, common(other), Way.no_double, names=(other[0], str(motion[other[0]].dtype)))
    short = [c for c in wanted if motion[c].shape != (sampling.count,)]
    if short:
        counts = len(motion[short[0]]), sampling.count
        return Cause(Kind.missing, common(short), Way.of_other_size, counts, (short[0],))
    bad = [c for c in wanted if not np.isfinite(motion[c]).all()]
    if bad:
        return Cause(Kind.nonfinite, common(bad), Way.not_finite, names=(bad[0],))
    off = float(np.abs(motion["time"] - sampling.times(reference.scene)).max())
    return None if off <= ON_TIME * reference.scene.drive.cycle else _instants(reference.scene, sampling, motion, off)


def _instants(scene: Scene, sampling: Rows, motion: Motion, off: float) -> Cause:
    """Return the cause of instants that are not those asked for."""
    steps = np.diff(motion["time"])
    for kind, way, bad in ((Kind.held, Way.same_instant, steps == 0), (Kind.rows, Way.earlier_instant, steps < 0)):
        if bad.any():
            return Cause(kind, "all", way, (int(bad.argmax()) + 2,))
    asked = sampling.times(scene)
    share = float(motion["time"] @ asked / (asked @ asked)) - 1
    if np.abs(motion["time"] - (1 + share) * asked).max() <= 1e-3 * off:
        return Cause(Kind.drive, "drive", Way.cycle, (share,))
    return Cause(Kind.lag, "all", Way.instants, (off,))


def sample_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield samples that are held, out of order or spoilt, of all channels or of some."""
    yield from _held(evidence)
    yield from _out_of_order(evidence)
    yield from _spoilt(evidence)


def in_some_rows(evidence: Evidence, causes: Callable[[Evidence], Iterator[Hypothesis]]) -> Iterator[Hypothesis]:
    """Yield causes that act in the rows from the first to the last that are off, and in no others."""
    if (off := stretch(evidence)) is None:
        return
    scene, inside = evidence.reference.scene, np.isin(evidence.rows, off.rows)
    ends = tuple(float(off.true[scene.drive_channel][row]) for row in (0, -1))
    for hypothesis in causes(off):
        predicted = {c: evidence.true[c].copy() for c in hypothesis.predicted}
        for channel, values in hypothesis.predicted.items():
            predicted[channel][inside] = values
        yield Hypothesis(replace(hypothesis.cause, rows=ends), predicted, hypothesis.freedom + 1)


def _held(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield samples that repeat the one before, of all channels, of all of one stem, or of one channel."""
    stay = {}
    for channel in evidence.names:
        given, true = evidence.given[channel], evidence.true[channel]
        stay[channel] = np.append(False, (np.diff(given) == 0) & (np.abs(np.diff(true)) > 0))
    moving = [c for c in evidence.names if np.ptp(evidence.true[c]) > 1e-9 * evidence.reference.scale[c]]
    if not moving:
        return
    some = [c for c in moving if stay[c].any() and np.ptp(evidence.given[c]) > 0]
    same = np.all([np.diff(evidence.given[c]) == 0 for c in moving], axis=0)
    together = np.append(False, same & np.any([np.diff(evidence.true[c]) != 0 for c in moving], axis=0))
    if together.any():
        later = np.append(together[1:], False)  # of two rows that are the same, either may be the one that is right
        for rows in (_last_fresh(together), len(later) - 1 - _last_fresh(later[::-1])[::-1]):
            yield _of_rows(evidence, Kind.held, Way.row_held, list(evidence.names), rows)
    elif some and len(some) <= 6:
        predicted = {c: evidence.true[c][_last_fresh(stay[c])] for c in some}
        yield Hypothesis(Cause(Kind.held, common(some), Way.sample_held), predicted)


def _last_fresh(stay: NDArray[np.bool_]) -> NDArray[np.intp]:
    return np.maximum.accumulate(np.where(stay, 0, np.arange(len(stay))))


def _of_rows(
    evidence: Evidence, kind: Kind, way: Way, channels: Sequence[str], rows: NDArray[np.intp], freedom: int = 0
) -> Hypothesis:
    moved = np.flatnonzero(rows != np.arange(len(rows)))
    first = float(evidence.true[evidence.reference.scene.drive_channel][moved[0]])
    cause = Cause(kind, "all", way, (len(moved),), rows=(first,))
    return Hypothesis(cause, {c: evidence.true[c][rows] for c in channels}, freedom)


def _out_of_order(evidence: Evidence) -> Iterator[Hypothesis]:
    """Rows that are those of other instants, with the drive's channel or without it."""
    drive = evidence.reference.scene.drive_channel
    for channels in (list(evidence.names), [c for c in evidence.names if c != drive]):
        yield from _exchanged(evidence, channels)


def _exchanged(evidence: Evidence, channels: list[str]) -> Iterator[Hypothesis]:
    scale = evidence.reference.scale
    true, given = (_rows(of, channels, scale) for of in (evidence.true, evidence.given))
    off = np.sum((given - true) ** 2, axis=1)
    bad = np.flatnonzero(off > ROUNDING * off.max())
    distance = np.sum((given[bad, np.newaxis] - true[np.newaxis]) ** 2, axis=2)
    theirs = distance.min(axis=1) <= FAR_LESS * off[bad]
    if theirs.any():
        rows = np.arange(len(true))
        rows[bad[theirs]] = distance.argmin(axis=1)[theirs]
        shifts = (rows[bad] - bad)[theirs] % (len(true) - 1)
        if np.mean(shifts == np.median(shifts)) > 0.8 and theirs.sum() > 5:
            by = -int(np.median(shifts))
            by = by if 2 * abs(by) < len(true) else by + len(true) - 1
            cause = Cause(Kind.lag, "all", Way.late_rows, (by,), part=Part("all", tuple(channels)))
            yield Hypothesis(cause, {c: evidence.true[c][rows] for c in channels}, 1)
        elif len(channels) >= TELLING:
            yield _of_rows(evidence, Kind.rows, Way.row_order, channels, rows, 2)


def _rows(motion: Motion, channels: list[str], scale: Mapping[str, float]) -> NDArray[np.float64]:
    """Return all channels row by row, over their scales; angles by their sines and cosines."""
    angles = [c for c in channels if quantity(c) in ANGLES]
    columns = [motion[c] / scale[c] for c in channels if c not in angles]
    return np.array([*columns, *(wave(motion[c]) for c in angles for wave in (np.sin, np.cos))]).T


def _spoilt(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield a few samples that are off, whose neighbours are not."""
    off = np.array([evidence.difference(c, evidence.true[c]) ** 2 for c in evidence.names])
    by_row = off.sum(axis=0)
    bad = by_row > NEXT_TO_NOTHING * by_row.max()
    alone = bad & ~np.append(bad[1:], False) & ~np.append(False, bad[:-1])
    if not bad.any() or not alone[bad].all() or bad.sum() > max(1, FEW * len(bad)):
        return
    of = [c for c, own in zip(evidence.names, off, strict=True) if own[bad].sum() > NEXT_TO_NOTHING * off.sum()]
    predicted = {c: np.where(bad, evidence.given[c], evidence.true[c]) for c in of}
    place = common(of)
    if place == "all" and len(of) < MOST * len(evidence.names):
        return  # a peak of some channels, as where a solver has trouble
    first = float(evidence.true[evidence.reference.scene.drive_channel][bad.argmax()])
    yield Hypothesis(Cause(Kind.spike, place, Way.spoilt, (int(bad.sum()),), rows=(first,)), predicted)
