"""A designer's numbers of one cycle, from its samples: of the reference with samples added, and of an engine alike.

Among them are those of a slider's stroke: its ends, for how long it is near the closed one, and the quick return.

Samples have the shape (..., n): those of one linkage (n,), of m machines (m, n). All is by the last axis.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import nan
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.model.motion import Samples

from ...mechanics.axis import cycle_name
from ...mechanics.motion_vectors import quintic
from ...mechanics.scales import chord
from .curves import CycleCurve, Values, driving

RowNumbers: TypeAlias = NDArray[np.intp]

MIN_SIZE = 1e-3  # of the scale of a quantity's errors: what is less is no measure of a difference
ROUND_OFF_TOL = 1e-9  # of that scale: what is less is found nowhere
AT_JOINTS = {"reaction": "largest force", "guide_force": "largest guide force", "guide_moment": "largest guide moment"}
LARGEST = {"velocity": "peak speed", "acceleration": "peak acceleration", **AT_JOINTS}  # by kind of curve
SMALLEST = {"transmission": "least transmission angle", "to_lock": "distance to a singular pose"}
DWELL_TOL = 0.01  # of the stroke: so near to its closed end the output dwells
REST_TOL = 1e-9  # of the peak speed: so slow the output stands still
NEWTON_STEPS = 4  # steps to a quintic's zero from that of its chord: each doubles the digits
STROKE, CLOSED, OPEN, DWELL = "stroke", "closed", "open", "dwell"  # kinds of an output's numbers


@dataclass(frozen=True)
class CycleNumber:
    """One number of a cycle, and the sample where it is found, if it has one place; all of shape (...)."""

    name: str
    curve: CycleCurve
    value: Samples
    unit: str
    size: Samples  # what a difference of it is divided by
    row: RowNumbers | None = None  # -1 where the number is rounding
    kind: str = ""  # what it is at every joint and of every drive; its name if empty


def numbers(
    scene: Scene, followed: Sequence[CycleCurve], motion: Motion, *, exact: bool = False
) -> Iterator[CycleNumber]:
    """Yield the numbers of one cycle, in the order of the tables.

    Samples are in the order of the time, from one end of the cycle to the other. Where the rates are exactly those of
    the positions, these are known between the samples too; without, an engine's wrong rate is in no number of its
    positions.
    """
    by_kind = {curve.kind: curve for curve in followed}
    if "displacement" in by_kind:
        yield from _of_slider(scene, by_kind, motion, exact=exact)
    if "path" in by_kind:
        stroke = np.abs(chords(by_kind["path"].values(motion)))
        yield CycleNumber(STROKE, by_kind["path"], stroke, "m", stroke, kind=STROKE)
    for curve in followed:
        if kind := LARGEST.get(curve.kind):
            sizes = np.abs(curve.values(motion))
            row = sizes.argmax(axis=-1)
            value = at(sizes, row)
            name = f"{kind} at {curve.of}" if curve.kind in AT_JOINTS else kind
            size, there = (
                np.maximum(value, MIN_SIZE * curve.scale),
                np.where(value > ROUND_OFF_TOL * curve.scale, row, -1),
            )
            yield CycleNumber(name, curve, value, curve.unit, size, there, kind)
    if "effort" in by_kind:
        yield from _of_drive(scene, by_kind["effort"], motion)
    for kind, name in SMALLEST.items():
        least = {curve: curve.values(motion) for curve in followed if curve.kind == kind}
        if least:
            curve = min(least, key=lambda curve: float(least[curve].min()))  # of all machines
            value = np.min([values.min(axis=-1) for values in least.values()], axis=0)
            size = np.maximum(value, MIN_SIZE * curve.scale)
            yield CycleNumber(name, curve, value, curve.unit, size, least[curve].argmin(axis=-1))


def _of_drive(scene: Scene, curve: CycleCurve, motion: Motion) -> Iterator[CycleNumber]:
    """Yield the drive's largest torque or force with its motion and against it, their RMS value, power and work."""
    effort = scene.channels[scene.channels.drive.effort].quantity
    values, time, position = curve.values(motion), motion["time"], motion[scene.channels.drive.position]
    with_motion, power, rate = driving(scene, values, motion)
    size = np.maximum(np.abs(values).max(axis=-1), MIN_SIZE * curve.scale)
    for name, height in (("driving", with_motion), ("braking", -with_motion)):
        row = height.argmax(axis=-1)
        acts = at(height, row) > ROUND_OFF_TOL * curve.scale
        value = np.where(acts, at(values, row), 0.0)
        yield CycleNumber(f"peak {name} {effort}", curve, value, curve.unit, size, np.where(acts, row, -1))
    # The trapezoidal rule over samples that need not be equally spaced: refined cycles have more of them at extremes.
    mean_square = _sum(values**2, time) / (time[..., -1] - time[..., 0])
    yield CycleNumber(f"RMS drive {effort}", curve, np.sqrt(mean_square), curve.unit, size)
    fastest = np.abs(rate).max(axis=-1)
    most = np.maximum(np.abs(power).max(axis=-1), MIN_SIZE * curve.scale * fastest)
    for name, height in (("driving", power), ("braking", -power)):
        row = height.argmax(axis=-1)
        acts = at(height, row) > ROUND_OFF_TOL * curve.scale * fastest
        value = np.where(acts, at(power, row), 0.0)
        yield CycleNumber(f"peak {name} power", curve, value, "W", most, np.where(acts, row, -1))
    way = np.abs(np.diff(position)).sum(axis=-1)
    yield CycleNumber(f"work a {cycle_name(scene)}", curve, _sum(values, position), "J", size * way)


def _sum(values: Samples, along: Samples) -> Samples:
    """An integral, by the trapezoidal rule."""
    return np.asarray(np.sum((values[..., :-1] + values[..., 1:]) / 2 * np.diff(along), axis=-1))


def _of_slider(
    scene: Scene, by_kind: Mapping[str, CycleCurve], motion: Motion, *, exact: bool
) -> Iterator[CycleNumber]:
    """Yield the stroke, its ends, for how long the slider is near the closed one, and the quick return."""
    curve, way = by_kind["displacement"], Stroke(scene, motion, by_kind, exact=exact)
    yield CycleNumber(STROKE, curve, way.length, "m", way.length, kind=STROKE)
    end, dwell = "dead point" if scene.periodic else "end", way.dwell
    yield CycleNumber(f"closed {end}", curve, at(way.place, way.closed), "m", way.length, way.closed, CLOSED)
    yield CycleNumber(f"open {end}", curve, at(way.place, way.opened), "m", way.length, way.opened, OPEN)
    near = f"dwell within {100 * DWELL_TOL:.0f} % of the stroke"
    yield CycleNumber(near, curve, dwell, "s", dwell, way.closed, DWELL)
    if scene.periodic and "velocity" in by_kind and not np.isnan(ratio := way.quick_return).all():
        yield CycleNumber("quick return", by_kind["velocity"], ratio, "", ratio)


class Ends(NamedTuple):
    """Where a slider comes near its closed end or leaves it, of all machines one after the other."""

    step: tuple[NDArray[np.intp], ...]  # between which samples, as `np.nonzero` has it
    share: Samples  # of that step, from 0 to 1
    leaves: NDArray[np.bool_]
    speed: Samples  # m/s, there


class Stroke:
    """The way of a slider; samples of shape (..., n) in the order of the time, from one end of the cycle to the other.

    Its positions between the samples are by straight lines, or by quintics where the rates are exactly theirs.
    """

    def __init__(self, scene: Scene, motion: Motion, by_kind: Mapping[str, CycleCurve], *, exact: bool) -> None:
        self.scene, self.motion, self.by_kind, self.exact = scene, motion, by_kind, exact
        self.place = by_kind["displacement"].values(motion)  # m, along the guide
        self.closing = _closing(scene)
        self.closed = np.asarray((self.closing * self.place).argmax(axis=-1))  # where the closing stroke ends
        self.opened = np.asarray((self.closing * self.place).argmin(axis=-1))  # where the return ends
        end = at(self.place, self.closed)
        self.length = np.asarray(np.abs(end - at(self.place, self.opened)))  # the stroke, m, shape (...)
        way = np.abs(self.place - end[..., np.newaxis])
        self._away = np.asarray(way - DWELL_TOL * self.length[..., np.newaxis])  # m, from where it is near that end

    @cached_property
    def ends(self) -> Ends:
        """Where it comes near the closed end or leaves it."""
        near = self._away <= 0
        step = np.nonzero(near[..., :-1] != near[..., 1:])
        kinds = [kind for kind in ("velocity", "acceleration") if self.exact and kind in self.by_kind]
        rates = [-self.closing * self.by_kind[kind].values(self.motion) for kind in kinds]
        x, *derivatives = [(v[..., :-1][step], v[..., 1:][step]) for v in (self._away, *rates)]
        time = np.diff(self.motion["time"])[step]
        # The instant at which the slider is DWELL_TOL of the stroke off its closed end: Newton's method on the quintic
        # between two samples, or on a line where the rates are not exactly those of the positions, from the zero of the
        # chord.
        path = quintic(time, x, *derivatives) if len(derivatives) == 2 else np.array([x[0], x[1] - x[0]])
        slope = np.arange(1, len(path))[:, np.newaxis] * path[1:]
        share = x[0] / (x[0] - x[1])
        for _ in range(NEWTON_STEPS):
            share = np.clip(share - polyval(share, path, tensor=False) / polyval(share, slope, tensor=False), 0, 1)
        with np.errstate(invalid="ignore", divide="ignore"):  # between two samples at one instant
            speed = np.abs(polyval(share, slope, tensor=False)) / time
        return Ends(step, share, near[..., :-1][step], speed)

    @property
    def dwell(self) -> Samples:
        """For how long it is near the closed end, s, shape (...)."""
        near = self._away <= 0
        shares = np.where(near[..., :-1] & near[..., 1:], 1.0, 0.0)
        shares[self.ends.step] = np.where(self.ends.leaves, self.ends.share, 1 - self.ends.share)
        return np.asarray(np.sum(np.diff(self.motion["time"]) * shares, axis=-1))

    @property
    @np.errstate(invalid="ignore", divide="ignore")  # where it never turns
    def quick_return(self) -> Samples:
        """The time of the closing stroke over the other's, shape (...); NaN unless a cycle has one of each."""
        velocity, time = self.by_kind["velocity"].values(self.motion), self.motion["time"]
        outwards = velocity > REST_TOL * np.abs(velocity).max(axis=-1, keepdims=True)
        # Both turns of a cycle by linear interpolation of the velocity; the two strokes are the time between them and
        # the rest of the cycle.
        turns = outwards[..., :-1] != outwards[..., 1:]
        rows = turns.argmax(axis=-1), turns.shape[-1] - 1 - turns[..., ::-1].argmax(axis=-1)
        instants = []
        for row in rows:
            (before, after), (begin, end) = ((at(v, row), at(v, row + 1)) for v in (velocity, time))
            instants.append(begin + (end - begin) * before / (before - after))
        inner = instants[1] - instants[0]  # the stroke between the turns
        outer = time[..., -1] - time[..., 0] - inner  # and the one around them
        ratio = np.where(at(outwards, rows[1]) == (self.closing > 0), inner / outer, outer / inner)
        return np.where(turns.sum(axis=-1) == 2, ratio, nan)


def _closing(scene: Scene) -> int:
    """The sign of the output's velocity while it closes: against its first load, or else downwards."""
    guided = scene.guided(scene.output)
    assert guided is not None
    name, slide = guided
    for load in (load for load in scene.loads if load.body == name):
        push = load.largest_along(slide)
        if push != 0:
            return -1 if push > 0 else 1
    return -1 if slide.along[1] >= 0 else 1


def at(values: NDArray[Any], row: RowNumbers) -> NDArray[Any]:
    """The samples at these rows, shape (...)."""
    return np.take_along_axis(values, np.expand_dims(row, -1), -1)[..., 0]


def chords(places: Values) -> Values:
    """The vector between the two of some positions that are furthest apart, shape (...)."""
    return np.apply_along_axis(chord, -1, places)
