"""A designer's numbers of one cycle, from its samples: of the reference with samples added, and of an engine alike.

Samples have the shape (..., n): those of one linkage (n,), of m machines (m, n). All is by the last axis.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from scenes import Motion, Scene
from scenes.motion import Samples

from ...engines.axis import cycle_name
from .curves import LEAST, Curve
from .stroke import NEAR, Rows, Stroke, at

NOTHING = 1e-3  # of the scale of a quantity's errors: what is less is no measure of a difference
ROUNDING = 1e-9  # of that scale: what is less is found nowhere
LARGEST = {
    "velocity": "peak speed",
    "acceleration": "peak acceleration",
    "reaction": "largest force at {}",
    "guide_force": "largest guide force at {}",
    "guide_moment": "largest guide moment at {}",
}  # by kind of curve
SMALLEST = {"transmission": "least transmission angle", "to_lock": "distance to a singular pose"}


@dataclass(frozen=True)
class Number:
    """One number of a cycle, and the sample where it is found, if it has one place; all of shape (...)."""

    name: str
    curve: Curve
    value: Samples
    unit: str
    size: Samples  # what a difference of it is divided by
    row: Rows | None = None  # -1 where the number is rounding


def numbers(scene: Scene, found: Sequence[Curve], motion: Motion, *, exact: bool = False) -> Iterator[Number]:
    """Yield the numbers of one cycle, in the order of the tables.

    Args:
        scene: the linkage.
        found: the quantities to take them from.
        motion: samples of shape (..., n) in the order of the time, from one end of the cycle to the other.
        exact: whether the rates are those of the positions, so that these are known between the samples too; without,
            an engine's wrong rate is in no number of its positions.
    """
    by_kind = {curve.kind: curve for curve in found}
    if "displacement" in by_kind:
        yield from _of_slider(scene, by_kind, motion, exact=exact)
    if "path" in by_kind:
        place = by_kind["path"].values(motion)
        stroke = np.hypot(np.ptp(place.real, axis=-1), np.ptp(place.imag, axis=-1))
        yield Number("stroke", by_kind["path"], stroke, "m", stroke)
    for curve in found:
        if curve.kind in LARGEST:
            yield _largest(LARGEST[curve.kind].format(curve.of), curve, motion)
    if "effort" in by_kind:
        yield from _of_drive(scene, by_kind["effort"], motion)
    for kind in LEAST:
        least = {curve: curve.values(motion) for curve in found if curve.kind == kind}
        if least:
            curve = min(least, key=lambda curve: float(least[curve].min()))  # of all machines
            value, row = (
                np.min([values.min(axis=-1) for values in least.values()], axis=0),
                least[curve].argmin(axis=-1),
            )
            yield Number(SMALLEST[kind], curve, value, curve.unit, np.maximum(value, NOTHING * curve.scale), row)


def _largest(name: str, curve: Curve, motion: Motion) -> Number:
    sizes = np.abs(curve.values(motion))
    row = sizes.argmax(axis=-1)
    value = at(sizes, row)
    there = np.where(value > ROUNDING * curve.scale, row, -1)
    return Number(name, curve, value, curve.unit, np.maximum(value, NOTHING * curve.scale), there)


def _of_drive(scene: Scene, curve: Curve, motion: Motion) -> Iterator[Number]:
    """Yield the drive's peak and mean torque or force, and its work."""
    effort = "torque" if scene.driven_slide is None else "force"
    values, time, position = curve.values(motion), motion["time"], motion[scene.drive_channel]
    peak = _largest(f"peak drive {effort}", curve, motion)
    yield peak
    cycle = time[..., -1:] - time[..., :1]
    yield _sum(f"mean drive {effort}", curve, values / cycle, time, curve.unit, peak.size)
    way = np.abs(np.diff(position)).sum(axis=-1)
    yield _sum(f"work a {cycle_name(scene)}", curve, values, position, "J", peak.size * way)


def _sum(name: str, curve: Curve, values: Samples, over: Samples, unit: str, size: Samples) -> Number:
    """Return an integral, by the trapezoidal rule."""
    value = np.sum((values[..., :-1] + values[..., 1:]) / 2 * np.diff(over), axis=-1)
    return Number(name, curve, value, unit, size)


def _of_slider(scene: Scene, by_kind: Mapping[str, Curve], motion: Motion, *, exact: bool) -> Iterator[Number]:
    """Yield the stroke, its ends, for how long the slider is near the closed one, and the quick return."""
    curve, way = by_kind["displacement"], Stroke(scene, motion, by_kind, exact)
    yield Number("stroke", curve, way.length, "m", way.length)
    end = "dead point" if scene.drive.repeats else "end"
    yield Number(f"closed {end}", curve, at(way.place, way.closed), "m", way.length, way.closed)
    yield Number(f"open {end}", curve, at(way.place, way.opened), "m", way.length, way.opened)
    dwell = way.dwell
    yield Number(f"dwell within {NEAR:.0%} of the stroke".replace("%", " %"), curve, dwell, "s", dwell, way.closed)
    if scene.drive.repeats and "velocity" in by_kind:
        ratio = way.quick_return
        if not np.isnan(ratio).all():
            yield Number("quick return", by_kind["velocity"], ratio, "", ratio)
