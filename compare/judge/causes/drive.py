"""Causes in the drive: elsewhere than asked for, at another speed, by another entry of a law's table."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from scenes import Failure, Scene
from scenes.motion import Samples, quantity
from scenes.scene import ConstantSpeed, MotionLaw

from ...engines import registry
from .evidence import Channels, Evidence, Hypothesis, Kind, factor, fitted

ASTRAY = 1e-9  # relative: far above rounding
SPEED, RATES = "the drive runs at another speed", "the drive has rates of another speed"
CLOCK = "all instants are too far apart"


def drive_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what would have been with the drive where it is, at another speed, or by another entry of its law."""
    scene = evidence.reference.scene
    asked, there = evidence.true[scene.drive_channel], evidence.given[scene.drive_channel]
    off = there - asked
    actual = _solved(evidence, scene, there)
    if actual and np.ptp(off) <= 1e-3 * np.abs(off).max() and isinstance(scene.drive, ConstantSpeed):
        actual = {}  # it is late, by one time
    if actual and off.any():
        size = float(off[np.abs(off).argmax()])
        amount = scene.amount("angle" if scene.driven_slide is None else "length", size, 3)
        constant = "" if np.ptp(off) <= 1e-2 * abs(size) else "up to "
        yield Hypothesis(Kind.drive, "drive", amount, f"the drive is off by {constant}{amount}", actual, 1)
    yield from _offset(evidence, scene)
    if isinstance(scene.drive, ConstantSpeed):
        yield from _speeds(evidence, scene, scene.drive)
    else:
        yield from _entries(evidence, scene, scene.drive)


def strayed(evidence: Evidence) -> Hypothesis | None:
    """Return that the drive is not where it was asked to be, which no engine has an excuse for."""
    drive = evidence.reference.scene.drive_channel
    if drive not in evidence.names:
        return None
    off = np.abs(evidence.given[drive] - evidence.true[drive]).max()
    if not off > ASTRAY * max(1.0, float(np.abs(evidence.true[drive]).max())):
        return None
    scene = evidence.reference.scene
    by = scene.amount("angle" if scene.driven_slide is None else "length", float(off), 3)
    return Hypothesis(Kind.drive, "drive", by, f"the drive is off by up to {by}", {})


def _solved(evidence: Evidence, scene: Scene, position: Samples) -> Channels:
    """Return the motion of a scene with the drive at positions, or nothing where there is none."""
    try:
        found = registry.reference(scene)(position, evidence.true["time"])
    except Failure:
        return {}
    return {channel: found[channel] for channel in evidence.names}


def _offset(evidence: Evidence, scene: Scene) -> Iterator[Hypothesis]:
    """Yield the drive off by a constant, and its channel not: at a constant speed that is a lag."""
    if isinstance(scene.drive, ConstantSpeed):
        return
    asked = evidence.true[scene.drive_channel]

    def predict(x: Samples) -> Channels:
        return _solved(evidence, scene, asked + x[0])

    (by,), predicted = fitted(evidence, predict, np.full(1, 1e-5 * np.ptp(scene.drive.extent)), 3)
    yield Hypothesis(Kind.drive, "drive", f"{by:.4g}", f"the drive is off by a constant, {by:.4g}", predicted, 1)


def _speeds(evidence: Evidence, scene: Scene, drive: ConstantSpeed) -> Iterator[Hypothesis]:
    """Another speed: with its poses, with those asked for and other rates, or instants that are too far apart."""
    time, asked = evidence.true["time"], evidence.true[scene.drive_channel]
    there = evidence.given[scene.drive_channel] - drive.start
    rates = {float(there @ time / (time @ time)), -drive.speed}
    if velocities := [c for c in evidence.names if quantity(c) in ("vx", "vy", "omega")]:
        rates.add(drive.speed * factor(evidence, velocities, evidence.true.samples))
    others = [c for c in evidence.names if c != scene.drive_channel]

    def at(rate: float, what: str) -> Channels:
        other = scene if what == CLOCK else replace(scene, drive=replace(drive, speed=rate))
        return _solved(evidence, other, asked if what == RATES else drive.start + rate * time)

    def fitted_rate(what: str) -> float:
        """Return the rate that explains most, of those near the one asked for."""

        def predict(x: Samples) -> Channels:
            predicted = at(drive.speed * (1 + float(x[0])), what)
            return {channel: predicted[channel] for channel in others} if predicted else {}

        return drive.speed * (1 + float(fitted(evidence, predict, np.full(1, 1e-6), 4)[0][0]))

    for what in (SPEED, RATES, CLOCK):
        for rate in (fitted_rate(what), *(rates if what != CLOCK else ())):
            if not rate or abs(rate / drive.speed - 1) <= 1e-9 or not (predicted := at(rate, what)):
                continue
            share = drive.speed / rate if what == CLOCK else rate / drive.speed
            how = "backwards" if abs(share + 1) < 1e-3 else f"{100 * (share - 1):+.3g} %"
            for channels in (evidence.names, others):  # its channel may be as commanded
                seen = {channel: predicted[channel] for channel in channels}
                yield Hypothesis(Kind.drive, "drive", how, f"{what}, {how}", seen, 1)


def _entries(evidence: Evidence, scene: Scene, law: MotionLaw) -> Iterator[Hypothesis]:
    """Yield a law with one entry of its table that is another."""
    for number in range(len(law.positions)):

        def predict(x: Samples, number: int = number) -> Channels:
            moved = list(law.positions)
            moved[number] += float(x[0])
            if law.periodic and number in (0, len(moved) - 1):
                moved[-1 - number] += float(x[0])
            drive = replace(law, positions=tuple(moved))
            return _solved(evidence, replace(scene, drive=drive), drive.at(evidence.true["time"]).position)

        (by,), predicted = fitted(evidence, predict, np.full(1, 1e-5 * np.ptp(law.extent)), 1)
        sentence = f"entry {number + 1} of the drive's law is off by {by:.3g}"
        yield Hypothesis(Kind.drive, "drive", f"entry {number + 1}", sentence, predicted, 1)
