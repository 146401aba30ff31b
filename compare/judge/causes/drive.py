"""Causes in the drive: elsewhere than asked for, at another speed, by another entry of a law's table."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from scenes import Failure, Scene
from scenes.model.motion import Samples, quantity
from scenes.scene import ConstantSpeed, MotionLaw

from ...engines import registry
from .cause import Cause, Kind, Way
from .evidence import Channels, Evidence, Hypothesis, factor, fitted

ASTRAY = 1e-9  # relative: far above rounding
CONSTANT, LATE = 1e-2, 1e-3  # of what the drive is off by: it is off by one amount, and at a constant speed late
COURSE = 3  # numbers that where the drive really is counts for
SAME = 1e-9  # relative: speeds


def drive_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what would have been with the drive where it is, at another speed, or by another entry of its law."""
    scene = evidence.reference.scene
    drive, asked, there = scene.drive, evidence.true[scene.drive_channel], evidence.given[scene.drive_channel]
    off, at_one_speed = there - asked, isinstance(drive, ConstantSpeed)
    most = float(off[np.abs(off).argmax()])
    late = at_one_speed and np.ptp(off) <= LATE * abs(most)
    if off.any() and not late and (actual := _solved(evidence, scene, there)):
        constant = np.ptp(off) <= CONSTANT * abs(most)
        yield Hypothesis(_cause(Way.drive if constant else Way.drive_up_to, most), actual, 1 if constant else COURSE)
    if isinstance(drive, ConstantSpeed):
        yield from _speeds(evidence, scene, drive)
    else:
        yield from _offsets(evidence, scene, drive)


def strayed(evidence: Evidence) -> Cause | None:
    """Return that the drive is not where it was asked to be, which no engine has an excuse for."""
    drive = evidence.reference.scene.drive_channel
    if drive not in evidence.names:
        return None
    off = float(np.abs(evidence.given[drive] - evidence.true[drive]).max())
    far = off > ASTRAY * max(1.0, float(np.abs(evidence.true[drive]).max()))
    return _cause(Way.drive_up_to, off) if far else None


def _cause(way: Way, *amounts: float) -> Cause:
    return Cause(Kind.drive, "drive", way, amounts)


def _solved(evidence: Evidence, scene: Scene, position: Samples) -> Channels:
    """Return the channels of a scene with its drive at some positions, or nothing where there is no motion."""
    try:
        motion = registry.reference(scene)(position, evidence.true["time"])
    except Failure:
        return {}
    return {channel: motion[channel] for channel in evidence.names}


def _offsets(evidence: Evidence, scene: Scene, law: MotionLaw) -> Iterator[Hypothesis]:
    """Yield a drive that is off by a constant, and its channel not; and a law with another entry in its table."""
    asked, hair = evidence.true[scene.drive_channel], np.full(1, 1e-5 * np.ptp(law.extent))
    (by,), predicted = fitted(evidence, lambda x: _solved(evidence, scene, asked + x[0]), hair, 3)
    yield Hypothesis(_cause(Way.drive, float(by)), predicted, 1)
    for number in range(len(law.positions)):

        def predict(x: Samples, number: int = number) -> Channels:
            moved = list(law.positions)
            moved[number] += float(x[0])
            if law.periodic and number in (0, len(moved) - 1):
                moved[-1 - number] += float(x[0])
            other = replace(law, positions=tuple(moved))
            return _solved(evidence, replace(scene, drive=other), other.at(evidence.true["time"]).position)

        (by,), predicted = fitted(evidence, predict, hair)
        yield Hypothesis(_cause(Way.entry, number + 1, float(by)), predicted, 1)


def _speeds(evidence: Evidence, scene: Scene, drive: ConstantSpeed) -> Iterator[Hypothesis]:
    """Another speed: with its poses, with those asked for and other rates, or instants that are too far apart."""
    time, asked = evidence.true["time"], evidence.true[scene.drive_channel]
    there = evidence.given[scene.drive_channel] - drive.start
    rates = {float(there @ time / (time @ time)), -drive.speed}
    if velocities := [c for c in evidence.names if quantity(c) in ("vx", "vy", "omega")]:
        rates.add(drive.speed * factor(evidence, velocities, evidence.true.samples))
    others = [c for c in evidence.names if c != scene.drive_channel]

    def at(rate: float, way: Way) -> Channels:
        other = scene if way is Way.clock else replace(scene, drive=replace(drive, speed=rate))
        return _solved(evidence, other, asked if way is Way.rates else drive.start + rate * time)

    def without_drive(x: Samples, way: Way) -> Channels:
        predicted = at(drive.speed * (1 + float(x[0])), way)
        return {channel: predicted[channel] for channel in others} if predicted else {}

    for way in (Way.speed, Way.rates, Way.clock):
        (share,), _ = fitted(evidence, partial(without_drive, way=way), np.full(1, 1e-6), 4)
        for rate in (drive.speed * (1 + float(share)), *(rates if way is not Way.clock else ())):
            if not rate or abs(rate / drive.speed - 1) <= SAME or not (predicted := at(rate, way)):
                continue
            times = drive.speed / rate if way is Way.clock else rate / drive.speed
            for channels in (evidence.names, others):  # its channel may be as commanded
                yield Hypothesis(_cause(way, times - 1), {c: predicted[c] for c in channels}, 1)
