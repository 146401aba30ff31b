"""Causes that all of a result shares: another frame and other units, and the drive elsewhere or at another speed.

The factor f, the angle α and the place b of `compare.results.frame` are fitted together; a frame that is not turned,
not shifted, or of the same unit needs fewer of them.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from scenes import Scene
from scenes.channels import Role
from scenes.fields import Number, put, walk
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND, ConstantSpeed, DriveLaw, HarmonicLaw

from ...results.frame import KNOWN, LENGTHS, Frame, seen, unit_near, vectors
from .cause import Cause, Kind, Part
from .evidence import Channels, Evidence, Hypothesis

KNOWN_FRAME_TOL = 1e-4  # relative: what is fitted and is this near to none, or to a known unit, is taken for it
ROUND_OFF_TOL = 1e-9  # relative
CONSTANT, LATE = 1e-2, 1e-3  # of what the drive is off by: it is off by one amount, and at a constant speed late
PRICE_OF_COURSE = 3  # numbers that where the drive really is counts for
BY_ANGLE = "all rates are by the crank's angle, per {one}, in place of the time"
AXIS = "the crank's angle, by which the rows are, is in {one} in place of {two}"
UP_TO, BY = "the drive is off by up to {displacement}", "the drive is off by {displacement}"
SPEED, RATE = "the drive runs at another speed, {faster}", "the drive has rates of another speed, {faster}"
CLOCK = "all instants are too far apart, {faster}"


def frame_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield other frames and units of all of a result, rates by the crank's angle, and that angle in another unit."""
    yield from _frame(evidence, mirrored=False)
    yield from _frame(evidence, mirrored=True)
    scene, true = evidence.scene, evidence.true
    if not isinstance(scene.drive.law, ConstantSpeed) or scene.drive.slide is not None:
        return
    orders = _orders(evidence)
    for unit, name, other in (("rad", "radian", "deg"), ("deg", "degree", "rad")):
        size = KNOWN["rad"][unit]
        rates = {c: (size / scene.drive.law.speed) ** order * true[c] for c, order in orders.items()}
        yield Hypothesis(Cause(Kind.unit, "all", BY_ANGLE, names=(name,)), rates)
        there = evidence.passing(scene, size / KNOWN["rad"][other] * true[scene.channels.drive.position])
        others = {c: there[c] for c in evidence.names if c != scene.channels.drive.position and there}
        yield Hypothesis(Cause(Kind.unit, "drive", AXIS, names=(unit, other)), others)


def _orders(evidence: Evidence) -> dict[str, int]:
    """By channel of a rate the order of the derivative by the time."""
    rows = (evidence.channels[c] for c in evidence.names)
    return {row.name: row.order for row in rows if row.role is Role.kinematic and row.order}


def _frame(evidence: Evidence, *, mirrored: bool) -> Iterator[Hypothesis]:
    """Yield the frame and unit of length that are nearest, in as few numbers as explain them."""
    channels = evidence.channels
    pairs = (pair for pair in vectors(channels, evidence.names) if channels[pair[0]].order in (0, 1))
    true = {c: evidence.true[c] for pair in pairs if {*pair} <= {*evidence.names} for c in pair}
    # A similarity g = a z + b is linear in the four numbers Re a, Im a, Re b, Im b: places and velocities seen from a
    # frame not turned, and turned by 90 degrees, and unit shifts of places are the columns of one least-squares
    # problem. What is near a known unit or no turn is then taken for exactly that, and costs no number.
    ways = [seen(channels, Frame(turn, mirrored=mirrored), true) for turn in (0.0, np.pi / 2)]  # by the parts of a
    shifted = {c: channels[c].axis if channels[c].order == 0 else "" for c in true}
    ways += [
        {c: np.full(samples.shape, float(shifted[c] == axis)) for c, samples in true.items()} for axis in "xy"
    ]  # of b
    re, im, x, y = evidence.added(ways, {c: 0 * samples for c, samples in true.items()})[0].tolist()
    a, b = complex(re, im), complex(x, y)
    if not abs(a) > ROUND_OFF_TOL:
        return
    unit = unit_near(abs(a), "m", KNOWN_FRAME_TOL)
    factor = 1 / LENGTHS[unit] if unit else abs(a)
    angle = float(np.angle(a)) if abs(np.angle(a)) > KNOWN_FRAME_TOL else 0.0
    b = b if abs(b) > KNOWN_FRAME_TOL * evidence.reference.stroke * factor else 0j
    if not unit and (angle or b):
        return  # four numbers that are fitted explain much of anything
    causes = []
    if mirrored or angle or b:
        origin = -b / (factor * np.exp(1j * angle))
        amounts = (1.0, angle, origin.real, -origin.imag) if mirrored else (0.0, -angle, origin.real, origin.imag)
        causes.append(Cause(Kind.frame, "all", "all is in another frame, {frame}", amounts))
    if unit != "m":
        all_lengths = Part("all lengths", evidence.names, many=True)
        text = "all lengths are in {one} in place of {two}" if unit else "all lengths are {times}"
        causes.append(Cause(Kind.unit, "all", text, (factor,), (unit, "m"), all_lengths))
    if causes:
        relative = any(drive.on != GROUND for drive in evidence.scene.drives)
        given = {c: evidence.true[c] for c in evidence.names}
        other = seen(channels, Frame(angle, b, mirrored, factor, relative), given)
        predicted = {
            c: samples for c, samples in other.items() if c != evidence.drive or evidence.off[c] > ROUND_OFF_TOL
        }
        freedom = bool(angle) + 2 * bool(b) + (not unit)
        yield Hypothesis(replace(causes[0], besides=tuple(causes[1:])), predicted, freedom)


def drive_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what would have been with the drive where it is, at another speed, or by another entry of its law."""
    scene, asked, there = evidence.scene, evidence.true[evidence.drive], evidence.given[evidence.drive]
    law = scene.drive.law
    deviation, at_one_speed = there - asked, isinstance(law, ConstantSpeed)
    most = float(deviation[np.abs(deviation).argmax()])
    late = at_one_speed and np.ptp(deviation) <= LATE * abs(most)
    if deviation.any() and not late and (actual := evidence.passing(scene, there)):
        constant = np.ptp(deviation) <= CONSTANT * abs(most)
        yield Hypothesis(_drive(BY if constant else UP_TO, most), actual, 1 if constant else PRICE_OF_COURSE)
    if isinstance(law, ConstantSpeed):
        yield from _speeds(evidence, scene, law)
    else:
        yield from _offsets(evidence, scene, law)


def strayed(evidence: Evidence) -> Cause | None:
    """Return that the drive is not where it was asked to be, which no engine has an excuse for."""
    drive = evidence.drive
    if drive not in evidence.names:
        return None
    deviation = float(np.abs(evidence.given[drive] - evidence.true[drive]).max())
    return (
        _drive(UP_TO, deviation)
        if deviation > ROUND_OFF_TOL * max(1.0, float(np.abs(evidence.true[drive]).max()))
        else None
    )


def _drive(text: str, *amounts: float) -> Cause:
    return Cause(Kind.drive, "drive", text, amounts)


def _offsets(evidence: Evidence, scene: Scene, law: DriveLaw) -> Iterator[Hypothesis]:
    """Yield a drive that is off by a constant, and its channel not; and a law with another one of its positions."""
    asked, hair = evidence.true[scene.channels.drive.position], [1e-5 * np.ptp(law.extent)]
    (displacement,), predicted = evidence.fitted(lambda x: evidence.passing(scene, asked + x[0]), hair, 3)
    yield Hypothesis(_drive(BY, float(displacement)), predicted, 1)
    entries = [number for number in walk(law, "drive") if number.quantity.dimension == "position"]
    ends = [entries[0], entries[-1]] if law.periodic and not isinstance(law, HarmonicLaw) else []
    for entry in entries:

        def predict(x: Samples, entry: Number = entry) -> Channels:
            moved = {number.at: number.value + float(x[0]) for number in (ends if entry in ends else [entry])}
            other: DriveLaw = put(law, moved)
            return evidence.solved(changed := scene.with_law(other), inputs_of(changed, evidence.true["time"]))

        (displacement,), predicted = evidence.fitted(predict, hair)
        cause = Cause(Kind.drive, "drive", "{one} is off by {displacement}", (float(displacement),), (entry.path,))
        yield Hypothesis(cause, predicted, 1)


def _speeds(evidence: Evidence, scene: Scene, law: ConstantSpeed) -> Iterator[Hypothesis]:
    """Another speed: with its poses, with those asked for and other rates, or instants that are too far apart."""
    time, asked = evidence.true["time"], evidence.true[scene.channels.drive.position]
    there = evidence.given[scene.channels.drive.position] - law.start
    # Candidates of the speed: by the drive's own positions, backwards, and by the velocities returned.
    rates = {float(there @ time / (time @ time)), -law.speed}
    if velocities := {c: evidence.true[c] for c, order in _orders(evidence).items() if order == 1}:
        rates.add(law.speed * (1 + float(evidence.added([velocities])[0][0])))
    others = [c for c in evidence.names if c != scene.channels.drive.position]

    def at(rate: float, text: str) -> Channels:
        other = scene if text == CLOCK else scene.with_law(replace(law, speed=rate))
        return evidence.passing(other, asked if text == RATE else law.start + rate * time)

    def without_drive(x: Samples, text: str) -> Channels:
        predicted = at(law.speed * (1 + float(x[0])), text)
        return {channel: predicted[channel] for channel in others} if predicted else {}

    for text in (SPEED, RATE, CLOCK):
        (share,), _ = evidence.fitted(partial(without_drive, text=text), [1e-6], 4)
        for rate in (law.speed * (1 + float(share)), *(rates if text != CLOCK else ())):
            if not rate or abs(rate / law.speed - 1) <= ROUND_OFF_TOL or not (predicted := at(rate, text)):
                continue
            times = law.speed / rate if text == CLOCK else rate / law.speed
            for channels in (evidence.names, others):  # its channel may be as commanded
                yield Hypothesis(_drive(text, times - 1), {c: predicted[c] for c in channels}, 1)
