"""Causes in what is read from a right motion: signs, factors, frames, channels swapped, late or spoilt samples."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.model.motion import UNITS, Samples, quantity
from scenes.scene import GROUND

from ...mechanics.motion_vectors import MotionVectors, Vectors
from ...results.frame import unit_near
from .cause import Cause, Kind, Way
from .evidence import EXPLAINED, Channels, Evidence, Hypothesis, added, factor, with_changes
from .parts import ANGLES, FORCES, TURNING, Part, stem

KNOWN_NUMBER = 5e-3  # relative: a fitted number that is this near to a known one is taken for it
FACTORS = (0.0, 2.0, 0.5, 2 * pi, 0.5 / pi)  # besides those of units
CHOICE = 2  # numbers that one of many other channels counts for


def read_out_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what a wrong read-out would have given, for all channels that hold nearly all of the deviation."""
    parts = [part for part in evidence.parts if evidence.outside(part.channels) <= EXPLAINED]
    for part in parts:
        for causes in (_scaled, _shifted, _turned, _copied, _terms):
            yield from causes(evidence, part)
    yield from _swapped(evidence)
    yield from _moments(evidence)


def _scaled(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    channels, place, true = part.channels, part.place, evidence.true
    if all(np.ptp(evidence.motion[c]) == 0 < np.ptp(true[c]) for c in channels):
        held = {c: evidence.given[c] for c in channels}
        way = Way.constant if any(own.any() for own in held.values()) else Way.zero
        yield Hypothesis(Cause(Kind.constant, place, way, part=part), held)
        return
    of_forces = len(channels) > 1 and all(quantity(c) in FORCES for c in channels)
    kind, way = Kind.sign, Way.reaction if of_forces else Way.opposite
    if place == "all" and part.channels == evidence.along(channels[0][-1]):
        kind, way = Kind.frame, Way.mirrored_axis
    yield Hypothesis(Cause(kind, place, way, part=part), {c: -true[c] for c in channels})
    counted = {c: _on_turn(evidence, c, 1.0) for c in channels}
    turning = {quantity(c) for c in channels}  # what angles count modulo a turn hides their factor
    in_degrees = (180 / pi, pi / 180) if turning & {*ANGLES} and turning <= {*ANGLES, *TURNING} else ()
    for times in (factor(evidence, channels, counted), *in_degrees):
        if abs(times + 1) <= KNOWN_NUMBER:
            continue  # the opposite sign
        names = _units(times, channels)
        known = bool(names) or any(abs(times - known) <= KNOWN_NUMBER * known for known in FACTORS)
        cause = Cause(Kind.unit, place, Way.factor_of_unit if names else Way.factor, (times,), names, part)
        own = {c: _on_turn(evidence, c, times) for c in channels} if times in in_degrees else counted
        yield Hypothesis(cause, {c: times * values for c, values in own.items()}, int(not known))


def _on_turn(evidence: Evidence, channel: str, times: float) -> Samples:
    """Return a channel as it should be; an angle in the turn from which its samples are, times a factor."""
    true = evidence.true[channel]
    if quantity(channel) not in ANGLES:
        return true
    return np.asarray(true + 2 * pi * np.round((evidence.given[channel] / times - true) / (2 * pi)))


def _units(times: float, channels: Sequence[str]) -> tuple[str, ...]:
    """Return the unit that channels are in and that which they are read in, as their factor shows, or nothing."""
    si = [UNITS[quantity(c)] for c in channels]
    for way in (times, 1 / times) if times > 0 else ():
        units = [unit_near(way, own, KNOWN_NUMBER)[0] for own in si]
        if all(units) and units[0] != si[0]:
            return (units[0], si[0]) if way == times else (si[0], units[0])
    return ()


def _shifted(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield an offset of one channel, of a vector, or of one quantity of all."""
    channels, place = part.channels, part.place
    quantities = dict.fromkeys(quantity(channel) for channel in channels)
    if len(quantities) > 1 and not (len(channels) == 2 and _vectors(channels)):
        return
    off = {c: evidence.difference(c, evidence.true[c]) * evidence.scale[c] for c in channels}
    by = {q: _mean(q, [off[c] for c in channels if quantity(c) == q]) for q in quantities}
    scene = evidence.reference.scene
    rate = scene.drive.at(evidence.true["time"]).rate
    if place == "drive" and by.keys() <= {"torque", "force"} and (rate * sum(by.values()) > 0).all():
        return  # friction of the drive
    kind = Kind.drive if channels == (scene.drive_channel,) else Kind.offset
    cause = Cause(kind, place, Way.offset, tuple(by.values()), part=part)
    yield Hypothesis(cause, {c: evidence.true[c] + by[quantity(c)] for c in channels}, len(by))


def _mean(quantity: str, off: list[Samples]) -> float:
    """Return the mean of deviations; of angles, which count modulo one turn, on the circle."""
    return float(np.angle(np.mean(np.exp(1j * np.array(off)))) if quantity in ANGLES else np.mean(off))


def _vectors(channels: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return the pairs of components, or none where some channel is no component or its other one is missing."""
    pairs = [(c, c[:-1] + "y") for c in channels if c[-1] == "x"]
    return pairs if 2 * len(pairs) == len(channels) and all(y in channels for _, y in pairs) else []


def _turned(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Vectors in a body's frame, turned by a constant angle, or with their components swapped."""
    true, place, pairs = evidence.true, part.place, _vectors(part.channels)
    if not pairs:
        return
    scene, state = evidence.reference.scene, MotionVectors(evidence.reference.scene, evidence.true)
    vectors = {x: true[x] + 1j * true[y] for x, y in pairs}
    given = {x: evidence.given[x] + 1j * evidence.given[y] for x, y in pairs}

    def turned(by: Mapping[str, Vectors]) -> Channels:
        there = {x: vectors[x] * by[x] for x in vectors}
        return {x: v.real for x, v in there.items()} | {f"{x[:-1]}y": v.imag for x, v in there.items()}

    def framed(way: Way, name: str, by: Mapping[str, Vectors]) -> Hypothesis:
        return Hypothesis(Cause(Kind.frame, place, way, names=(name,), part=part), turned(by))

    for body in scene.turning:
        for sign, way in ((-1, Way.frame_of), (1, Way.frame_of_reversed)):
            yield framed(way, body, dict.fromkeys(vectors, np.exp(sign * 1j * state.angle(body))))
    if len(pairs) > 1:
        pins = {pin.channel: (pin.first, pin.second) for pin in scene.pins}
        for end, which in ((0, "first"), (-1, "last")):
            owner = {x: pins.get(stem(x), scene.owners.get(stem(x), (GROUND,)))[end] for x in vectors}
            yield framed(Way.frames_of, which, {x: np.exp(-1j * state.angle(name)) for x, name in owner.items()})
    weight = {x: evidence.scale[x] ** -2 for x in vectors}
    angle = float(np.angle(sum(complex(np.sum(weight[x] * given[x] * vectors[x].conj())) for x in vectors)))
    if abs(abs(angle) - pi) <= KNOWN_NUMBER:
        return  # the opposite sign
    by_angle = turned(dict.fromkeys(vectors, np.exp(1j * np.array(angle))))
    free = int(abs(abs(angle) - pi / 2) > KNOWN_NUMBER)  # at a right angle it may be swapped components
    yield Hypothesis(Cause(Kind.frame, place, Way.turned, (angle,), part=part), by_angle, free)
    swapped = {x: true[y] for x, y in pairs} | {y: true[x] for x, y in pairs}
    yield Hypothesis(Cause(Kind.swap, place, Way.components, part=part), swapped)


def _copied(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Another joint's, point's or body's channels in place of these, or added to them, or taken from them."""
    channels, true, place = part.channels, evidence.true, part.place
    own = {stem(channel) for channel in channels}
    if len(own) > 1:
        return
    (one,) = own
    for other, theirs in _others(evidence, part):
        at_one_pin = _pin(other) == _pin(one)
        for way, a, b in _OF_ANOTHER:
            relative = way is Way.relative and quantity(channels[0]) in TURNING
            kind = Kind.pair if at_one_pin else Kind.frame if relative else Kind.copy
            cause = Cause(kind, place, way, names=(other,), part=part)
            predicted = {c: a * true[c] + b * true[t] for c, t in theirs.items()}
            yield Hypothesis(cause, predicted, 0 if at_one_pin else CHOICE)
    if len(channels) == 1:
        for channel in (c for c in evidence.names if stem(c) == one and c != channels[0]):
            cause = Cause(Kind.copy, place, Way.copy, names=(channel,), part=part)
            yield Hypothesis(cause, {channels[0]: true[channel]}, CHOICE)


_OF_ANOTHER = ((Way.that_of, 0, 1), (Way.opposite_of, 0, -1), (Way.added, 1, 1), (Way.relative, 1, -1))


def _others(evidence: Evidence, part: Part) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield each other joint, point or body that has all channels that one has, and its own by these."""
    for other in dict.fromkeys(map(stem, evidence.names)):
        own = {c: f"{other}.{quantity(c)}" for c in part.channels}
        if other not in (part.place, "drive") and all(theirs in evidence.true for theirs in own.values()):
            yield other, own


def _swapped(evidence: Evidence) -> Iterator[Hypothesis]:
    """Two joints', points' or bodies' channels in place of each other."""
    order = [*dict.fromkeys(map(stem, evidence.names))]
    for part in evidence.parts:
        if part.place in ("all", "drive"):
            continue
        for other, theirs in _others(evidence, part):
            first = order.index(part.place) < order.index(other)
            if first and evidence.outside({*theirs, *theirs.values()}) <= EXPLAINED:
                predicted = {a: evidence.true[b] for pair in theirs.items() for a, b in (pair, pair[::-1])}
                kind = Kind.pair if _pin(part.place) == _pin(other) else Kind.swap
                yield Hypothesis(Cause(kind, part.place, Way.swapped, names=(other,)), predicted)


def _pin(name: str) -> str:
    """Return the point of a joint, of which a third body has one of its own."""
    return name.partition("/")[0]


def _terms(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Accelerations of points without, or with the opposite sign of, what a body's turning adds to them."""
    pairs = _vectors(part.channels)
    if not pairs or {quantity(c) for c in part.channels} != {"ax", "ay"}:
        return
    scene, state = evidence.reference.scene, MotionVectors(evidence.reference.scene, evidence.true)
    ways = ((Way.no_term, -1.0), (Way.term_sign, -2.0))
    for end, (term, of), (way, times) in product((0, -1), _TERMS.items(), ways):
        change: dict[str, Samples] = {}
        for x, y in pairs:
            body = scene.owners[stem(x)][end]
            first = scene.bodies[body].points[0] if body != GROUND else stem(x)
            term_there = of(*state.turning(body)[1:]) * (state.place(stem(x)) - state.place(first))
            change |= {x: term_there.real, y: term_there.imag}
        cause = Cause(Kind.term, part.place, way, names=(term,), part=part)
        yield Hypothesis(cause, with_changes(evidence, (times,), [change]))


_TERMS: dict[str, Callable[[Samples, Samples], NDArray[Any]]] = {
    "centripetal": lambda omega, _: -(omega**2) + 0j,
    "tangential": lambda _, alpha: 1j * alpha,
}


def _moments(evidence: Evidence) -> Iterator[Hypothesis]:
    """Moments of guides about another point than the slider's first."""
    scene = evidence.reference.scene
    for body in scene.bodies:
        channel, force = f"{body}.guide_moment", f"{body}.guide_force"
        if channel in evidence.names and evidence.outside([channel]) <= EXPLAINED:
            (lever,), predicted = added(evidence, [{channel: evidence.true[force]}])
            yield Hypothesis(Cause(Kind.moment, body, Way.moment, (float(lever),)), predicted, 1)
