"""A designer's numbers of one cycle, from its samples: of the reference with samples added, and of an engine alike.

Samples have the shape (..., n): those of one linkage (n,), of m machines (m, n). All is by the last axis.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from scenes import Motion, Scene
from scenes.model.motion import Samples, quantity

from ...mechanics.axis import cycle_name
from .curves import CycleCurve
from .stroke import DWELLING, RowNumbers, Stroke, at, chords

NOTHING = 1e-3  # of the scale of a quantity's errors: what is less is no measure of a difference
ROUNDING = 1e-9  # of that scale: what is less is found nowhere
AT_JOINTS = {"reaction": "largest force", "guide_force": "largest guide force", "guide_moment": "largest guide moment"}
LARGEST = {"velocity": "peak speed", "acceleration": "peak acceleration", **AT_JOINTS}  # by kind of curve
SMALLEST = {"transmission": "least transmission angle", "to_lock": "distance to a singular pose"}
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
            size, there = np.maximum(value, NOTHING * curve.scale), np.where(value > ROUNDING * curve.scale, row, -1)
            yield CycleNumber(name, curve, value, curve.unit, size, there, kind)
    if "effort" in by_kind:
        yield from _of_drive(scene, by_kind["effort"], motion)
    for kind, name in SMALLEST.items():
        least = {curve: curve.values(motion) for curve in followed if curve.kind == kind}
        if least:
            curve = min(least, key=lambda curve: float(least[curve].min()))  # of all machines
            value = np.min([values.min(axis=-1) for values in least.values()], axis=0)
            size = np.maximum(value, NOTHING * curve.scale)
            yield CycleNumber(name, curve, value, curve.unit, size, least[curve].argmin(axis=-1))


def _of_drive(scene: Scene, curve: CycleCurve, motion: Motion) -> Iterator[CycleNumber]:
    """Yield the drive's largest torque or force with its motion and against it, their RMS value, power and work."""
    effort = quantity(scene.effort_channel)
    values, time, position = curve.values(motion), motion["time"], motion[scene.drive_channel]
    rate = scene.drive.at(time).rate
    with_motion = np.abs(values) * np.sign(np.where(rate == 0, 1.0, values * rate))  # what holds still drives
    size = np.maximum(np.abs(values).max(axis=-1), NOTHING * curve.scale)
    for name, height in (("driving", with_motion), ("braking", -with_motion)):
        row = height.argmax(axis=-1)
        acts = at(height, row) > ROUNDING * curve.scale
        value = np.where(acts, at(values, row), 0.0)
        yield CycleNumber(f"peak {name} {effort}", curve, value, curve.unit, size, np.where(acts, row, -1))
    mean_square = _sum(values**2, time) / (time[..., -1] - time[..., 0])
    yield CycleNumber(f"RMS drive {effort}", curve, np.sqrt(mean_square), curve.unit, size)
    power, fastest = values * rate, np.abs(rate).max(axis=-1)
    most = np.maximum(np.abs(power).max(axis=-1), NOTHING * curve.scale * fastest)
    for name, height in (("driving", power), ("braking", -power)):
        row = height.argmax(axis=-1)
        acts = at(height, row) > ROUNDING * curve.scale * fastest
        value = np.where(acts, at(power, row), 0.0)
        yield CycleNumber(f"peak {name} power", curve, value, "W", most, np.where(acts, row, -1))
    way = np.abs(np.diff(position)).sum(axis=-1)
    yield CycleNumber(f"work a {cycle_name(scene)}", curve, _sum(values, position), "J", size * way)


def _sum(values: Samples, over: Samples) -> Samples:
    """An integral, by the trapezoidal rule."""
    return np.asarray(np.sum((values[..., :-1] + values[..., 1:]) / 2 * np.diff(over), axis=-1))


def _of_slider(
    scene: Scene, by_kind: Mapping[str, CycleCurve], motion: Motion, *, exact: bool
) -> Iterator[CycleNumber]:
    """Yield the stroke, its ends, for how long the slider is near the closed one, and the quick return."""
    curve, way = by_kind["displacement"], Stroke(scene, motion, by_kind, exact=exact)
    yield CycleNumber(STROKE, curve, way.length, "m", way.length, kind=STROKE)
    end, dwell = "dead point" if scene.drive.periodic else "end", way.dwell
    yield CycleNumber(f"closed {end}", curve, at(way.place, way.closed), "m", way.length, way.closed, CLOSED)
    yield CycleNumber(f"open {end}", curve, at(way.place, way.opened), "m", way.length, way.opened, OPEN)
    near = f"dwell within {100 * DWELLING:.0f} % of the stroke"
    yield CycleNumber(near, curve, dwell, "s", dwell, way.closed, DWELL)
    if scene.drive.periodic and "velocity" in by_kind and not np.isnan(ratio := way.quick_return).all():
        yield CycleNumber("quick return", by_kind["velocity"], ratio, "", ratio)
