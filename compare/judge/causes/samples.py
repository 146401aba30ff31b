"""Causes that need no model: channels missing or not finite, samples held, spoilt or out of order."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Rows, Scene
from scenes.model.motion import quantity

from ...engines.runner import ON_TIME
from ...mechanics.reference import Reference
from .cause import ANGLES, Cause, Kind, common
from .evidence import NEXT_TO_NOTHING, Evidence, Hypothesis

FEW = 0.1  # of the samples
MOST = 0.8  # of the channels, that a spoilt row spoils
TELLING = 3  # channels, by which a row is known: one number or two are about those of many rows
ROUNDING = 1e-9  # of the square of the largest sample's deviation
FAR_LESS = 1e-2  # of the square of a row's deviation: what it has from the row that it really is


def incomplete(reference: Reference, sampling: Rows, motion: Motion) -> Cause | None:
    """Return the cause where something is not there to be compared."""
    wanted = sampling.wanted(reference.scene)
    if missing := [c for c in wanted if c not in motion]:
        text = "{one} and {count} more are missing" if len(missing) > 1 else "{one} is missing"
        return Cause(Kind.missing, common(missing), text, (len(missing) - 1,), (missing[0],))
    for kind, text, bad in (
        (Kind.missing, "{one} is of {two}, not float64", lambda own: own.dtype != np.float64),
        (Kind.missing, "{one} has {count} samples of {of}", lambda own: own.shape != (sampling.count,)),
        (Kind.nonfinite, "{one} is not finite", lambda own: not np.isfinite(own).all()),
    ):
        if wrong := [c for c in wanted if bad(motion[c])]:
            first = motion[wrong[0]]
            return Cause(kind, common(wrong), text, (first.size, sampling.count), (wrong[0], str(first.dtype)))
    off = float(np.abs(motion["time"] - sampling.times(reference.scene)).max())
    return None if off <= ON_TIME * reference.scene.drive.cycle else _instants(reference.scene, sampling, motion, off)


def _instants(scene: Scene, sampling: Rows, motion: Motion, off: float) -> Cause:
    steps = np.diff(motion["time"])
    for kind, text, bad in (
        (Kind.held, "row {count} has the instant of the row before", steps == 0),
        (Kind.rows, "row {count} is of an earlier instant than the row before", steps < 0),
    ):
        if bad.any():
            return Cause(kind, "all", text, (int(bad.argmax()) + 2,))
    asked = sampling.times(scene)
    share = float(motion["time"] @ asked / (asked @ asked)) - 1
    if np.abs(motion["time"] - (1 + share) * asked).max() <= 1e-3 * off:
        return Cause(Kind.drive, "drive", "the drive's cycle is {share} of itself too {long}", (share,))
    return Cause(Kind.lag, "all", "the samples are off the instants asked for, by up to {number} s", (off,))


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
    same, moved = (np.array([np.diff(of[c]) for c in moving]) for of in (given, true))
    stay = dict(zip(moving, np.insert((same == 0) & (moved != 0), 0, False, axis=1), strict=True))
    some = [c for c in moving if stay[c].any() and np.ptp(given[c]) > 0]
    together = np.append(False, (same == 0).all(axis=0) & (moved != 0).any(axis=0))
    if together.any():
        later = np.append(together[1:], False)  # of two rows that are the same, either may be the one that is right
        for rows in (_last_fresh(together), len(later) - 1 - _last_fresh(later[::-1])[::-1]):
            yield _of_rows(evidence, Kind.held, "{place} repeats a row, first at {where}", evidence.names, rows)
    elif some and len(some) <= 6:
        predicted = {c: true[c][_last_fresh(stay[c])] for c in some}
        yield Hypothesis(Cause(Kind.held, common(some), "{place} repeats a sample"), predicted)


def _last_fresh(stay: NDArray[np.bool_]) -> NDArray[np.intp]:
    return np.maximum.accumulate(np.where(stay, 0, np.arange(len(stay))))


def _of_rows(
    evidence: Evidence, kind: Kind, text: str, channels: Sequence[str], rows: NDArray[np.intp], freedom: int = 0
) -> Hypothesis:
    first = float(evidence.true[evidence.drive][(rows != np.arange(len(rows))).argmax()])
    return Hypothesis(Cause(kind, "all", text, rows=(first,)), {c: evidence.true[c][rows] for c in channels}, freedom)


def _out_of_order(evidence: Evidence, channels: tuple[str, ...]) -> Iterator[Hypothesis]:
    scale = evidence.reference.scale
    true, given = (_rows(of, channels, scale) for of in (evidence.true, evidence.given))
    off = np.sum((given - true) ** 2, axis=1)
    bad = np.flatnonzero(off > ROUNDING * off.max())
    distance = np.sum((given[bad, np.newaxis] - true[np.newaxis]) ** 2, axis=2)
    theirs = distance.min(axis=1) <= FAR_LESS * off[bad]
    if theirs.any() and len(channels) >= TELLING:
        rows = np.arange(len(true))
        rows[bad[theirs]] = distance.argmin(axis=1)[theirs]
        yield _of_rows(evidence, Kind.rows, "{place} has rows of other instants, first at {where}", channels, rows, 3)


def _rows(motion: Motion, channels: Sequence[str], scale: Mapping[str, float]) -> NDArray[np.float64]:
    """Return all channels row by row, over their scales; angles by their sines and cosines."""
    angles = [c for c in channels if quantity(c) in ANGLES]
    columns = [motion[c] / scale[c] for c in channels if c not in angles]
    return np.array([*columns, *(wave(motion[c]) for c in angles for wave in (np.sin, np.cos))]).T


def _spoilt(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield a few samples that are off, whose neighbours are not."""
    bad = evidence.by_row > NEXT_TO_NOTHING * evidence.by_row.max()
    if not bad.any() or (bad[1:] & bad[:-1]).any() or bad.sum() > max(1, FEW * len(bad)):
        return
    least = NEXT_TO_NOTHING * evidence.total
    of = [c for c, own in evidence.deviation.items() if np.sum(own[bad] ** 2) > least]
    predicted = {c: np.where(bad, evidence.given[c], evidence.true[c]) for c in of}
    place = common(of)
    if place == "all" and len(of) < MOST * len(evidence.names):
        return  # a peak of some channels, as where a solver has trouble
    first = float(evidence.true[evidence.drive][bad.argmax()])
    text = "{place} is spoilt at {where}, its neighbours are not"
    yield Hypothesis(Cause(Kind.spike, place, text, rows=(first,)), predicted)
