"""Causes in what is read from a right motion: signs, factors, frames, channels swapped, late or spoilt samples."""

from collections.abc import Iterator, Mapping
from itertools import combinations, product
from math import pi

import numpy as np

from scenes.motion import Samples, quantity
from scenes.scene import GROUND

from ...engines.motion_vectors import MotionVectors, Vectors
from .evidence import EXPLAINED, Channels, Evidence, Hypothesis, Kind, factor, factor_of_change
from .parts import ANGLES, FORCES, Part, in_words, place_of, stem

NEAR = 5e-3  # relative: a fitted number that is this near to a known one is taken for it
FACTORS = {
    0.0: "zero",
    1e3: "mm in place of m",
    1e-3: "m in place of mm",
    180 / pi: "degrees in place of radians",
    pi / 180: "radians in place of degrees",
    30 / pi: "rpm in place of rad/s",
    pi / 30: "rad/s in place of rpm",
    2 * pi: "2 pi",
    0.5 / pi: "1 / (2 pi)",
    2.0: "double",
    0.5: "half",
    9.80665: "N in place of kgf",
    1 / 9.80665: "kgf in place of N",
}
CHOICE = 2  # numbers that one of many other channels counts for


def read_out_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what a wrong read-out would have given, for all channels that hold nearly all of the deviation."""
    parts = [part for part in evidence.parts if evidence.outside(part[1]) <= EXPLAINED]
    for part in parts:
        for cause in (_scaled, _shifted, _turned, _copied):
            yield from cause(evidence, part)
    yield from _swapped(evidence)
    yield from _terms(evidence, parts)
    yield from _moments(evidence)


def _scaled(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    (name, channels), true = part, evidence.true
    place = place_of(part)
    if all(np.ptp(evidence.motion[c]) == 0 < np.ptp(true[c]) for c in channels):
        held = {c: evidence.given[c] for c in channels}
        zero = all((held[c] == 0).all() for c in channels)
        yield Hypothesis(Kind.constant, place, "zero" * zero, f"{name} is {'zero' if zero else 'constant'}", held)
        return
    mirrored = name == "all along y" or name == "all along x"
    what = "points the other way" if mirrored else "has the opposite sign"
    what += ", as on the other body" * (len(channels) > 1 and all(quantity(c) in FORCES for c in channels))
    kind = Kind.frame if mirrored else Kind.sign
    yield Hypothesis(kind, place, "", f"{name} {what}", {c: -true[c] for c in channels})
    for unit in (180 / pi, pi / 180) if {quantity(c) for c in channels} <= {*ANGLES} else ():
        predicted = {c: unit * true[c] for c in channels}
        yield Hypothesis(Kind.unit, place, FACTORS[unit], f"{name} is in {FACTORS[unit]}", predicted, 1)
    times = factor(evidence, channels, true.samples)
    known = next((n for n in FACTORS if abs(abs(times) - n) <= NEAR * n), None)
    number, wrong = in_words(times)
    amount = number if known is None else ("" if times >= 0 else "-") + _unit(known, channels)
    predicted = {c: times * true[c] for c in channels}
    sentence = f"{name} is {wrong}"
    sentence += f", {amount}" * ("in place of" in amount)
    yield Hypothesis(Kind.unit, place, amount, sentence, predicted, int(known is None or times < 0))


def _unit(factor: float, channels: tuple[str, ...]) -> str:
    """Return the name of a known factor of channels."""
    of_forces = all(quantity(channel) in FORCES for channel in channels)
    return (
        {1e3: "N in place of kN", 1e-3: "kN in place of N"}.get(factor, FACTORS[factor])
        if of_forces
        else FACTORS[factor]
    )


def _shifted(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield an offset of one channel, of a vector, or of one quantity of all."""
    (name, channels), place = part, place_of(part)
    quantities = {quantity(channel) for channel in channels}
    if len(quantities) > 1 and not (len(channels) == 2 and _vectors(channels)):
        return
    time = evidence.true["time"] - evidence.true["time"][0]
    off = {c: evidence.difference(c, evidence.true[c]) * evidence.scale[c] for c in channels}
    by = {q: _mean(q, [off[c] for c in channels if quantity(c) == q]) for q in quantities}
    predicted = {c: evidence.true[c] + by[quantity(c)] for c in channels}
    amount = ", ".join(f"{value:.3g}" for value in by.values())
    scene = evidence.reference.scene
    rate = scene.drive.at(time).rate
    if place == "drive" and quantities <= {"torque", "force"} and np.ptp(rate) == 0 and rate[0] * sum(by.values()) > 0:
        return  # friction of the drive
    kind = Kind.drive if channels == (scene.drive_channel,) else Kind.offset
    yield Hypothesis(kind, place, amount, f"{name} is off by a constant, {amount}", predicted, len(by))


def _mean(quantity: str, off: list[Samples]) -> float:
    """Return the mean of deviations; of angles, which count modulo one turn, on the circle."""
    return float(np.angle(np.mean(np.exp(1j * np.array(off)))) if quantity in ANGLES else np.mean(off))


def _vectors(channels: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return the pairs of components, or none where some channel is no component or its other one is missing."""
    pairs = [(c, c[:-1] + "y") for c in channels if c[-1] == "x"]
    return pairs if 2 * len(pairs) == len(channels) and all(y in channels for _, y in pairs) else []


def _turned(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Vectors in a body's frame, turned by a constant angle, or with their components swapped."""
    (name, channels), true, place = part, evidence.true, place_of(part)
    pairs = _vectors(channels)
    if not pairs:
        return
    scene, state = evidence.reference.scene, MotionVectors(evidence.reference.scene, evidence.true)
    vectors = {x: true[x] + 1j * true[y] for x, y in pairs}
    given = {x: evidence.given[x] + 1j * evidence.given[y] for x, y in pairs}

    def turned(by: Mapping[str, Vectors]) -> Channels:
        found = {x: vectors[x] * by[x] for x in vectors}
        return {x: v.real for x, v in found.items()} | {f"{x[:-1]}y": v.imag for x, v in found.items()}

    for body in scene.turning:
        for sign, whose in ((-1, f"the frame of {body}"), (1, f"the frame of {body}, turned the wrong way")):
            frame = np.exp(sign * 1j * state.angle(body))
            yield Hypothesis(Kind.frame, place, whose, f"{name} is in {whose}", turned(dict.fromkeys(vectors, frame)))
    if len(pairs) > 1:
        pins = {pin.channel: (pin.first, pin.second) for pin in scene.pins}
        for end, which in ((0, "first"), (-1, "last")):
            owner = {x: pins.get(stem(x), scene.owners.get(stem(x), (GROUND,)))[end] for x in vectors}
            whose = f"the frames of the {which} bodies at the joints"
            frames = {x: np.exp(-1j * state.angle(name)) for x, name in owner.items()}
            yield Hypothesis(Kind.frame, place, whose, f"{name} is in {whose}", turned(frames))
    weight = {x: evidence.scale[x] ** -2 for x in vectors}
    angle = float(np.angle(sum(complex(np.sum(weight[x] * given[x] * vectors[x].conj())) for x in vectors)))
    amount = evidence.reference.scene.amount("angle", angle)
    by_angle = turned(dict.fromkeys(vectors, np.exp(1j * np.array(angle))))
    free = int(abs(abs(angle) - pi / 2) > NEAR)  # at a right angle it may be swapped components
    yield Hypothesis(Kind.frame, place, amount, f"{name} is turned by {amount}", by_angle, free)
    swapped = {x: true[y] for x, y in pairs} | {y: true[x] for x, y in pairs}
    yield Hypothesis(Kind.swap, place, "components", f"{name} has its components swapped", swapped)


def _copied(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Another joint's, point's or body's channels in place of these, or added to them, or taken from them."""
    (name, channels), true, place = part, evidence.true, place_of(part)
    own = {stem(channel) for channel in channels}
    if len(own) > 1:
        return
    (one,) = own
    for other in dict.fromkeys(stem(channel) for channel in evidence.names):
        theirs = {c: c.replace(one, other, 1) if one != "drive" else f"{other}.{quantity(c)}" for c in channels}
        if other == one or not all(t in true for t in theirs.values()):
            continue
        at_one_pin = other.split("/")[0] == one.split("/")[0]
        for sign, a, b in ((1, 0, 1), (-1, 0, -1), (1, 1, 1), (-1, 1, -1)):
            predicted = {c: a * true[c] + b * true[t] for c, t in theirs.items()}
            relative = a == 1 and quantity(channels[0]) in ("angle", "omega", "alpha")
            kind = Kind.pair if at_one_pin else Kind.frame if relative and sign < 0 else Kind.copy
            what = {(0, 1): "is that of", (0, -1): "is the opposite of that of"}.get((a, b))
            what = what or ("has added to it that of" if b > 0 else "is relative to that of")
            yield Hypothesis(kind, place, other, f"{name} {what} {other}", predicted, 0 if at_one_pin else CHOICE)
    if len(channels) == 1:
        alike = [c for c in evidence.names if stem(c) == one and c != channels[0]]
        for channel in alike:
            sentence = f"{name} is a copy of {channel}"
            yield Hypothesis(Kind.copy, place, channel, sentence, {channels[0]: true[channel]}, CHOICE)


def _swapped(evidence: Evidence) -> Iterator[Hypothesis]:
    """Two joints', points' or bodies' channels in place of each other."""
    stems: dict[str, dict[str, str]] = {}
    for channel in evidence.names:
        stems.setdefault(stem(channel), {})[quantity(channel)] = channel
    names = [name for name in stems if name != "drive"]
    for one, other in combinations(names, 2):
        shared = stems[one].keys() & stems[other].keys()
        for order in (shared, *_ORDERS):
            both = [(stems[one][q], stems[other][q]) for q in order if q in shared]
            if both and evidence.outside([c for pair in both for c in pair]) <= EXPLAINED:
                predicted = {a: evidence.true[b] for a, b in both} | {b: evidence.true[a] for a, b in both}
                kind = Kind.pair if one.split("/")[0] == other.split("/")[0] else Kind.swap
                yield Hypothesis(kind, one, other, f"{one} and {other} are swapped", predicted)


_ORDERS = (
    {"x", "y", "vx", "vy", "ax", "ay"},
    {"angle", "omega", "alpha"},
    {"x", "y"},
    {"vx", "vy"},
    {"ax", "ay"},
    {"fx", "fy"},
    {"angle"},
    {"omega"},
    {"alpha"},
    {"guide_force"},
)


def _terms(evidence: Evidence, parts: list[Part]) -> Iterator[Hypothesis]:
    """Accelerations of points without, or with the opposite sign of, what a body's turning adds to them."""
    scene, state = evidence.reference.scene, MotionVectors(evidence.reference.scene, evidence.true)
    for part in parts:
        name, channels = part
        pairs = _vectors(channels)
        if not pairs or {quantity(c) for c in channels} != {"ax", "ay"}:
            continue
        terms = {"centripetal": lambda w, _: -(w**2), "tangential": lambda _, alpha: 1j * alpha}
        ways = (("lacks its", 1), ("has the opposite sign of its", 2))
        for end, (term, of), (how, times) in product((0, -1), terms.items(), ways):
            predicted: dict[str, Samples] = {}
            for x, y in pairs:
                body = scene.owners[stem(x)][end]
                _, omega, alpha = state.turning(body)
                first = scene.bodies[body].points[0] if body != GROUND else stem(x)
                added = of(omega, alpha) * (state.place(stem(x)) - state.place(first))
                predicted |= {x: evidence.true[x] - times * added.real, y: evidence.true[y] - times * added.imag}
            yield Hypothesis(Kind.term, place_of(part), term, f"{name} {how} {term} term", predicted)


def _moments(evidence: Evidence) -> Iterator[Hypothesis]:
    """Moments of guides about another point than the slider's first."""
    scene = evidence.reference.scene
    for body in scene.bodies:
        channel, force = f"{body}.guide_moment", f"{body}.guide_force"
        if channel in evidence.names and evidence.outside([channel]) <= EXPLAINED:
            lever = factor_of_change(evidence, channel, evidence.true[force])
            predicted = {channel: evidence.true[channel] + lever * evidence.true[force]}
            sentence = f"{body}'s guide moment is about another point, {scene.length(lever, 3)} away"
            yield Hypothesis(Kind.moment, body, f"{lever:.4g}", sentence, predicted, 1)
