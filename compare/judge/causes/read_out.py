"""Causes in what is read from a right motion: signs, factors, frames, terms, and channels of something else."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from math import pi

import numpy as np

from scenes.channels import Channel, Role
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND

from ...mechanics.motion_vectors import MotionVectors, Vectors
from ...results.frame import unit_near
from .cause import Cause, Kind, Part, parts
from .evidence import MAX_REST_TRIED, MIN_ROWS, RIGHT_SAMPLE_TOL, Channels, Evidence, Hypothesis

KNOWN_NUMBER_TOL = 5e-3  # relative: a fitted number that is this near to a known one is taken for it
FACTORS = (0.0, 2.0, 0.5, 2 * pi, 0.5 / pi)  # besides those of units
PRICE_OF_CHOICE = 2  # numbers that one of many other channels counts for


def read_out_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what a wrong read-out would have given, for all channels that hold nearly all of the deviation."""
    for part, causes in product(evidence.parts, (_scaled, _shifted, _turned, _copied, _terms)):
        yield from causes(evidence, part)
    yield from _swapped(evidence)
    yield from _moments(evidence)


def in_some_rows(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield what acts in the rows from the first to the last that are off, and in no others; where these are few."""
    # A fault that is there in some rows alone leaves all others right to rounding. The rows between the first and the
    # last that are off are explained by themselves; the price has one number more, for the choice of the rows.
    bad = np.flatnonzero(evidence.by_row >= RIGHT_SAMPLE_TOL * evidence.by_row.max())
    kept = np.arange(bad[0], bad[-1] + 1)
    if not MIN_ROWS <= len(kept) < len(evidence.rows):
        return
    wrong = evidence.at(kept)
    ends = tuple(float(wrong.true[evidence.drive][row]) for row in (0, -1))
    for cause, explained, freedom in read_out_causes(wrong):
        predicted = {c: evidence.true[c].copy() for c in explained}
        for channel, values in explained.items():
            predicted[channel][kept] = values
        yield Hypothesis(replace(cause, rows=ends), predicted, freedom + 1)


def _scaled(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    channels, true = part.channels, evidence.true
    rows = [evidence.channels[c] for c in channels]
    if all(np.ptp(evidence.motion[c]) == 0 < np.ptp(true[c]) for c in channels):
        held = {c: evidence.given[c] for c in channels}
        text = "{part} {is} constant" if any(samples.any() for samples in held.values()) else "{part} {is} zero"
        yield Hypothesis(part.cause(Kind.constant, text), held)
        return
    kind, text = Kind.sign, "{part} {has} the opposite sign"
    if len(channels) > 1 and all(row.is_force for row in rows):
        text += ", as on the other body"
    along = tuple(c for c in evidence.names if evidence.channels[c].axis == rows[0].axis != "")
    if part.place == "all" and channels == along:
        kind, text = Kind.frame, "{part} points the other way"
    yield Hypothesis(part.cause(kind, text), {c: -true[c] for c in channels})
    counted = {c: _on_turn(evidence, c, 1.0) for c in channels}
    turning = any(row.is_angle for row in rows) and all(row.is_angle or row.kind == "body" for row in rows)
    in_degrees = (180 / pi, pi / 180) if turning else ()  # what angles count modulo a turn hides their factor
    for times in (1 + float(evidence.added([counted])[0][0]), *in_degrees):
        if abs(times + 1) <= KNOWN_NUMBER_TOL:
            continue  # the opposite sign
        names = _units(times, [row.unit for row in rows])
        known = bool(names) or any(abs(times - known) <= KNOWN_NUMBER_TOL * known for known in FACTORS)
        text = "{part} {is} {times}" + ", {one} in place of {two}" * bool(names)
        values_of = {c: _on_turn(evidence, c, times) for c in channels} if times in in_degrees else counted
        predicted = {c: times * values for c, values in values_of.items()}
        yield Hypothesis(part.cause(Kind.unit, text, times, names=names), predicted, int(not known))


def _on_turn(evidence: Evidence, channel: str, times: float) -> Samples:
    """Return a channel as it should be; an angle in the turn from which its samples are, times a factor."""
    true = evidence.true[channel]
    if not evidence.channels[channel].is_angle:
        return true
    return np.asarray(true + 2 * pi * np.round((evidence.given[channel] / times - true) / (2 * pi)))


def _units(times: float, si: Sequence[str]) -> tuple[str, ...]:
    """Return the unit that channels of these in SI are in and that which they are read in, by their factor, if any."""
    for way in (times, 1 / times) if times > 0 else ():
        units = [unit_near(way, unit, KNOWN_NUMBER_TOL) for unit in si]
        if all(units) and units[0] != si[0]:
            return (units[0], si[0]) if way == times else (si[0], units[0])
    return ()


def _shifted(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Yield an offset of one channel, of a vector, or of one quantity of all."""
    channels = part.channels
    rows = [evidence.channels[channel] for channel in channels]
    quantities = dict.fromkeys(row.measured for row in rows)
    if len(quantities) > 1 and not (len(channels) == 2 and _vectors(rows)):
        return
    deviation = {c: evidence.deviation[c] * evidence.scale[c] for c in channels}
    shifts = {}
    for q in quantities:  # of angles, which count modulo one turn, on the circle
        alike = [row for row in rows if row.measured == q]
        samples = np.array([deviation[row.name] for row in alike])
        shifts[q] = float(np.angle(np.mean(np.exp(1j * samples))) if alike[0].is_angle else np.mean(samples))
    rate = inputs_of(evidence.scene, evidence.true["time"]).driven().rate
    of_effort = all(row.role is Role.force and row.kind == "drive" for row in rows)
    if of_effort and (rate * sum(shifts.values()) > 0).all():
        return  # friction of the drive
    kind = Kind.drive if channels == (evidence.drive,) else Kind.offset
    cause = part.cause(kind, "{part} {is} off by a constant, {numbers}", *shifts.values())
    yield Hypothesis(cause, {row.name: evidence.true[row.name] + shifts[row.measured] for row in rows}, len(shifts))


def _vectors(rows: Sequence[Channel]) -> list[tuple[str, str]]:
    """Return the pairs of components, or none where some channel is no component or its other one is missing."""
    pairs, names = [(x, y) for row in rows if row.axis == "x" for x, y in (row.components,)], {row.name for row in rows}
    return pairs if 2 * len(pairs) == len(rows) and all(y in names for _, y in pairs) else []


def _turned(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Vectors in a body's frame, turned by a constant angle, or with their components swapped."""
    true, pairs = evidence.true, _vectors([evidence.channels[c] for c in part.channels])
    if not pairs:
        return
    scene, state = evidence.scene, MotionVectors(evidence.scene, true)
    vectors, given = ({x: samples[x] + 1j * samples[y] for x, y in pairs} for samples in (true, evidence.given))

    def turned(rotations: Mapping[str, Vectors]) -> Channels:
        there = {x: vectors[x] * rotations[x] for x in vectors}
        return {x: v.real for x, v in there.items()} | {y: there[x].imag for x, y in pairs}

    in_frame = "{part} {is} in the frame of {one}"
    for body, (sign, text) in product(scene.turning, ((-1, in_frame), (1, f"{in_frame}, turned the wrong way"))):
        rotation = np.exp(sign * 1j * state.angle(body))
        yield Hypothesis(part.cause(Kind.frame, text, names=(body,)), turned(dict.fromkeys(vectors, rotation)))
    pins = {pin.channel: (pin.first, pin.second) for pin in scene.pins}
    for end, position in ((0, "first"), (-1, "last")) if len(pairs) > 1 else ():
        places = {x: evidence.channels[x].subject for x in vectors}
        owner = {x: pins.get(place, scene.owners.get(place, (GROUND,)))[end] for x, place in places.items()}
        cause = part.cause(Kind.frame, "{part} {is} in the frames of the {one} bodies at the joints", names=(position,))
        yield Hypothesis(cause, turned({x: np.exp(-1j * state.angle(name)) for x, name in owner.items()}))
    # With vectors as complex numbers, the angle that turns the right ones nearest to the given ones, by least squares,
    # is that of the sum of given times conjugate right ones (the orthogonal Procrustes problem in the plane).
    weight = {x: evidence.scale[x] ** -2 for x in vectors}
    angle = float(np.angle(sum(complex(np.sum(weight[x] * given[x] * vectors[x].conj())) for x in vectors)))
    if abs(abs(angle) - pi) <= KNOWN_NUMBER_TOL:
        return  # the opposite sign
    by_angle = turned(dict.fromkeys(vectors, np.exp(1j * np.array(angle))))
    free = int(abs(abs(angle) - pi / 2) > KNOWN_NUMBER_TOL)  # at a right angle it may be swapped components
    yield Hypothesis(part.cause(Kind.frame, "{part} {is} turned by {angle}", angle), by_angle, free)
    swapped = {x: true[y] for x, y in pairs} | {y: true[x] for x, y in pairs}
    yield Hypothesis(part.cause(Kind.swap, "{part} {has} {its} components swapped"), swapped)


def _copied(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Another joint's, point's or body's channels in place of these, or added to them, or taken from them."""
    channels, true = part.channels, evidence.true
    if len({evidence.channels[c].owner for c in channels}) > 1:
        return
    ways = (
        ("{part} {is} that of {one}", 0, 1),
        ("{part} {is} the opposite of that of {one}", 0, -1),
        ("{part} {has} added to it that of {one}", 1, 1),
        ("{part} {is} relative to that of {one}", 1, -1),
    )
    for (other, theirs, at_one_pin), (text, a, b) in product(_others(evidence, part), ways):
        relative = (a, b) == (1, -1) and evidence.channels[channels[0]].kind == "body"
        kind = Kind.pair if at_one_pin else Kind.frame if relative else Kind.copy
        predicted = {c: a * true[c] + b * true[t] for c, t in theirs.items()}
        yield Hypothesis(part.cause(kind, text, names=(other,)), predicted, 0 if at_one_pin else PRICE_OF_CHOICE)
    others = (c for c in evidence.names if evidence.channels[c].owner == part.place and c != channels[0])
    for channel in others if len(channels) == 1 else ():
        cause = part.cause(Kind.copy, "{part} is a copy of {one}", names=(channel,))
        yield Hypothesis(cause, {channels[0]: true[channel]}, PRICE_OF_CHOICE)


def _others(evidence: Evidence, part: Part) -> Iterator[tuple[str, dict[str, str], bool]]:
    """Yield each other joint, point or body that has all channels of one, its own by these, and whether at one pin."""
    rows = [evidence.channels[c] for c in part.channels]
    for other in dict.fromkeys(evidence.channels[c].owner for c in evidence.names):
        found = [evidence.channels.find(row.kind, other, row.quantity) for row in rows]
        theirs = [row for row in found if row is not None and row.name in evidence.true]
        if other not in (part.place, "drive") and len(theirs) == len(rows):
            at_one_pin = rows[0].kind == "pin" and rows[0].point == theirs[0].point
            yield other, {c: row.name for c, row in zip(part.channels, theirs, strict=True)}, at_one_pin


def _swapped(evidence: Evidence) -> Iterator[Hypothesis]:
    """Two joints', points' or bodies' channels in place of each other."""
    order = [*dict.fromkeys(evidence.channels[c].owner for c in evidence.names)]
    for part in parts(evidence.channels, evidence.names):
        for other, theirs, at_one_pin in _others(evidence, part) if part.place not in ("all", "drive") else ():
            first = order.index(part.place) < order.index(other)
            if first and evidence.outside({*theirs, *theirs.values()}) <= MAX_REST_TRIED:
                predicted = {a: evidence.true[b] for pair in theirs.items() for a, b in (pair, pair[::-1])}
                kind = Kind.pair if at_one_pin else Kind.swap
                yield Hypothesis(Cause(kind, part.place, "{place} and {one} are swapped", names=(other,)), predicted)


def _terms(evidence: Evidence, part: Part) -> Iterator[Hypothesis]:
    """Accelerations of points without, or with the opposite sign of, what a body's turning adds to them."""
    rows = [evidence.channels[c] for c in part.channels]
    pairs = _vectors(rows)
    if not pairs or not all(row.kind == "point" and row.order == 2 for row in rows):
        return
    scene, state = evidence.scene, MotionVectors(evidence.scene, evidence.true)
    ways = {-1.0: "{part} {is} without {its} {one} term", -2.0: "{part} {has} the opposite sign of {its} {one} term"}
    for end, term, (times, text) in product((0, -1), ("centripetal", "tangential"), ways.items()):
        change: dict[str, Samples] = {}
        for x, y in pairs:
            point = evidence.channels[x].subject
            body, place = scene.owners[point][end], state.place(point)
            # The acceleration of a point P of a body is a_0 + (i alpha - omega^2) (P - P_0), with complex numbers: the
            # tangential and the centripetal term. A read-out that forgets one lacks it once; one that has its sign
            # wrong lacks it twice.
            arm = place - state.place(scene.bodies[body].points[0]) if body != GROUND else 0j * place
            _, omega, alpha = state.turning(body)
            there = (-(omega**2) if term == "centripetal" else 1j * alpha) * arm
            change |= {x: there.real, y: there.imag}
        yield Hypothesis(part.cause(Kind.term, text, names=(term,)), evidence.changed((times,), [change]))


def _moments(evidence: Evidence) -> Iterator[Hypothesis]:
    """Moments of guides about another point than the slider's first."""
    text = "{place}'s guide moment is about another point, {length} away"
    for slider, (force, moment) in evidence.channels.guides.items():
        if moment in evidence.names and evidence.outside([moment]) <= MAX_REST_TRIED:
            yield evidence.with_amounts(Cause(Kind.moment, slider, text), {moment: evidence.true[force]})
