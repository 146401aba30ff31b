"""Causes that need no model: channels missing or not finite, samples held, spoilt or out of order."""

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Rows, Scene
from scenes.motion import quantity

from ...engines.reference import Reference
from ...engines.runner import ON_TIME
from .evidence import NEXT_TO_NOTHING, Evidence, Hypothesis, Kind, stretch
from .parts import ANGLES, common

FEW = 0.1  # of the samples
MOST = 0.8  # of the channels, that a spoilt row spoils
TELLING = 3  # channels, by which a row is known: one number or two are about those of many rows
FAR_LESS = 1e-2  # of the square of a row's deviation: what it has from the row that it really is


def incomplete(reference: Reference, sampling: Rows, motion: Motion) -> tuple[Kind, str, str] | None:
    """Return kind, place and sentence of what is not there to be compared."""
    wanted = sampling.wanted(reference.scene)
    missing = [c for c in wanted if c not in motion and c not in motion.unsupported]
    missing = missing or [c for c in wanted if c not in motion]
    if missing:
        more = f" and {len(missing) - 1} more are" if len(missing) > 1 else " is"
        return Kind.missing, common(missing), f"{missing[0]}{more} missing"
    other = [c for c in wanted if motion[c].dtype != np.float64]
    if other:
        return Kind.missing, common(other), f"{other[0]} is of {motion[other[0]].dtype}, not float64"
    short = [c for c in wanted if motion[c].shape != (sampling.count,)]
    if short:
        return Kind.missing, common(short), f"{short[0]} has {len(motion[short[0]])} samples of {sampling.count}"
    bad = [c for c in wanted if not np.isfinite(motion[c]).all()]
    if bad:
        return Kind.nonfinite, common(bad), f"{bad[0]} is not finite"
    off = float(np.abs(motion["time"] - sampling.times(reference.scene)).max())
    if not off <= ON_TIME * reference.scene.drive.cycle:
        return _instants(reference.scene, sampling, motion, off)
    return None


def _instants(scene: Scene, sampling: Rows, motion: Motion, off: float) -> tuple[Kind, str, str]:
    """Return what is wrong with the instants."""
    steps = np.diff(motion["time"])
    if (steps == 0).any():
        return Kind.held, "all", f"row {int((steps == 0).argmax()) + 2} has the instant of the row before"
    if (steps < 0).any():
        return Kind.rows, "all", f"row {int((steps < 0).argmax()) + 2} is of an earlier instant than the row before"
    asked = sampling.times(scene)
    share = float(motion["time"] @ asked / (asked @ asked)) - 1
    if np.abs(motion["time"] - (1 + share) * asked).max() <= 1e-3 * off:
        return (
            Kind.drive,
            "drive",
            f"the drive's cycle is {abs(share):.3g} of itself too {'long' if share > 0 else 'short'}",
        )
    return Kind.lag, "all", f"the samples are off the instants asked for, by up to {off:.3g} s"


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
    ends = (scene.where(float(off.true[scene.drive_channel][row])) for row in (0, -1))
    where = " from {} to {}".format(*ends)
    for cause in causes(off):
        predicted = {c: evidence.true[c].copy() for c in cause.predicted}
        for channel, values in cause.predicted.items():
            predicted[channel][inside] = values
        amount, sentence = f"{cause.amount}{where}".strip(), cause.sentence + where
        yield cause._replace(amount=amount, sentence=sentence, predicted=predicted, freedom=cause.freedom + 1)


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
            yield _of_rows(evidence, Kind.held, "all", list(evidence.names), rows, "repeats a row")
    elif some and len(some) <= 6:
        predicted = {c: evidence.true[c][_last_fresh(stay[c])] for c in some}
        place = common(some)
        yield Hypothesis(Kind.held, place, "", f"{place} repeats a sample", predicted)


def _last_fresh(stay: NDArray[np.bool_]) -> NDArray[np.intp]:
    return np.maximum.accumulate(np.where(stay, 0, np.arange(len(stay))))


def _of_rows(
    evidence: Evidence, kind: Kind, place: str, channels: list[str], rows: NDArray[np.intp], what: str
) -> Hypothesis:
    moved = np.flatnonzero(rows != np.arange(len(rows)))
    where = evidence.reference.scene.where(float(evidence.true[evidence.reference.scene.drive_channel][moved[0]]))
    many = f"{len(moved)} rows" if len(moved) > 1 else "one row"
    predicted = {c: evidence.true[c][rows] for c in channels}
    return Hypothesis(kind, place, many, f"{place} {what}, first at {where}", predicted)


def _out_of_order(evidence: Evidence) -> Iterator[Hypothesis]:
    """Rows that are those of other instants, with the drive's channel or without it."""
    drive = evidence.reference.scene.drive_channel
    for channels in (list(evidence.names), [c for c in evidence.names if c != drive]):
        yield from _exchanged(evidence, channels)


def _exchanged(evidence: Evidence, channels: list[str]) -> Iterator[Hypothesis]:
    scale = evidence.reference.scale
    true, given = (_rows(of, channels, scale) for of in (evidence.true, evidence.given))
    off = np.sum((given - true) ** 2, axis=1)
    bad = np.flatnonzero(off > NEXT_TO_NOTHING * off.max())
    distance = np.sum((given[bad, np.newaxis] - true[np.newaxis]) ** 2, axis=2)
    theirs = distance.min(axis=1) <= FAR_LESS * off[bad]
    if theirs.any():
        rows = np.arange(len(true))
        rows[bad[theirs]] = distance.argmin(axis=1)[theirs]
        shifts = (rows[bad] - bad) % (len(true) - 1)
        if np.mean(shifts == np.median(shifts)) > 0.8 and len(bad) > 5:
            by = -int(np.median(shifts))
            by = by if 2 * abs(by) < len(true) else by + len(true) - 1
            late = f"{abs(by)} sample{'s' * (abs(by) > 1)} {'late' if by > 0 else 'early'}"
            yield Hypothesis(Kind.lag, "all", late, f"all is {late}", {c: evidence.true[c][rows] for c in channels}, 1)
        elif len(channels) >= TELLING:
            yield _of_rows(evidence, Kind.rows, "all", channels, rows, "has rows of other instants")._replace(freedom=1)


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
    sentence = f"{place} is spoilt at {evidence.reference.scene.where(first)}, its neighbours are not"
    yield Hypothesis(Kind.spike, place, f"{bad.sum()} sample{'s' if bad.sum() > 1 else ''}", sentence, predicted)
