"""A designer's numbers of one cycle, from its samples: of the reference with samples added, and of an engine alike."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import nan

import numpy as np

from scenes import Motion, Scene
from scenes.motion import Samples
from scenes.scene import Force, PressForce

from ...engines.axis import cycle_name
from .curves import LEAST, Curve

NEAR = 0.01  # of the stroke: so near to its closed end the output dwells
REST = 1e-9  # of the peak speed: so slow the output stands still
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
    """One number of a cycle, and the sample where it is found, if it has one place."""

    name: str
    curve: Curve
    value: float
    unit: str
    size: float  # what a difference of it is divided by
    row: int | None = None


def numbers(scene: Scene, found: Sequence[Curve], motion: Motion) -> Iterator[Number]:
    """Yield the numbers of one cycle, in the order of the tables.

    Args:
        scene: the linkage.
        found: the quantities to take them from.
        motion: samples in the order of the time, from one end of the cycle to the other.
    """
    by_kind = {curve.kind: curve for curve in found}
    if "displacement" in by_kind:
        yield from _of_slider(scene, by_kind["displacement"], by_kind.get("velocity"), motion)
    if "path" in by_kind:
        place = by_kind["path"].values(motion)
        stroke = float(np.hypot(np.ptp(place.real), np.ptp(place.imag)))
        yield Number("stroke", by_kind["path"], stroke, "m", stroke)
    for curve in found:
        if curve.kind in LARGEST:
            yield _largest(LARGEST[curve.kind].format(curve.of), curve, motion)
    if "effort" in by_kind:
        yield from _of_drive(scene, by_kind["effort"], motion)
    for kind in LEAST:
        least = {curve: curve.values(motion) for curve in found if curve.kind == kind}
        if least:
            curve = min(least, key=lambda curve: float(least[curve].min()))
            value, row = float(least[curve].min()), int(least[curve].argmin())
            yield Number(SMALLEST[kind], curve, value, curve.unit, max(value, NOTHING * curve.scale), row)


def _largest(name: str, curve: Curve, motion: Motion) -> Number:
    sizes = np.abs(curve.values(motion))
    row = int(sizes.argmax())
    value = float(sizes[row])
    there = row if value > ROUNDING * curve.scale else None
    return Number(name, curve, value, curve.unit, max(value, NOTHING * curve.scale), there)


def _of_drive(scene: Scene, curve: Curve, motion: Motion) -> Iterator[Number]:
    """Yield the drive's peak and mean torque or force, and its work."""
    effort = "torque" if scene.driven_slide is None else "force"
    values, time, position = curve.values(motion), motion["time"], motion[scene.drive_channel]
    peak = _largest(f"peak drive {effort}", curve, motion)
    yield peak
    cycle = float(time[-1] - time[0])
    yield _sum(f"mean drive {effort}", curve, values / cycle, time, curve.unit, peak.size)
    way = float(np.abs(np.diff(position)).sum())
    yield _sum(f"work a {cycle_name(scene)}", curve, values, position, "J", peak.size * way)


def _sum(name: str, curve: Curve, values: Samples, over: Samples, unit: str, size: float) -> Number:
    """Return an integral, by the trapezoidal rule."""
    value = float(np.sum((values[:-1] + values[1:]) / 2 * np.diff(over)))
    return Number(name, curve, value, unit, size)


# --- a slider's stroke -----------------------------------------------------------------------------------------------


def _of_slider(scene: Scene, curve: Curve, velocity: Curve | None, motion: Motion) -> Iterator[Number]:
    """Yield the stroke, its ends, for how long the slider is `NEAR` the closed one, and the quick return."""
    time, place = motion["time"], curve.values(motion)
    closing = _closing(scene)
    closed, opened = int((closing * place).argmax()), int((closing * place).argmin())
    stroke = abs(float(place[closed] - place[opened]))
    yield Number("stroke", curve, stroke, "m", stroke)
    end = "dead point" if scene.drive.repeats else "end"
    yield Number(f"closed {end}", curve, float(place[closed]), "m", stroke, closed)
    yield Number(f"open {end}", curve, float(place[opened]), "m", stroke, opened)
    dwell = _time_below_zero(time, np.abs(place - place[closed]) - NEAR * stroke)
    yield Number(f"dwell within {NEAR:.0%} of the stroke".replace("%", " %"), curve, dwell, "s", dwell, closed)
    if scene.drive.repeats and velocity is not None:
        ratio = _quick_return(time, velocity.values(motion), closing)
        if ratio == ratio:
            yield Number("quick return", velocity, ratio, "", ratio)


def _closing(scene: Scene) -> int:
    """Return the sign of the slider's velocity while it closes: against its first load, or else downwards."""
    guided = scene.guided(scene.output)
    assert guided is not None
    name, slide = guided
    for load in scene.loads:
        if load.body != name:
            continue
        if isinstance(load, PressForce):
            return load.closing
        push = np.dot(load.force, slide.along) if isinstance(load, Force) else max(load.forces, key=abs)
        if push != 0:
            return -1 if push > 0 else 1
    return -1 if slide.along[1] >= 0 else 1


def _time_below_zero(time: Samples, values: Samples) -> float:
    """Return for how long a curve of straight lines through the samples is below zero."""
    low, high = np.minimum(values[:-1], values[1:]), np.maximum(values[:-1], values[1:])
    share = np.divide(-low, high - low, out=np.where(low <= 0, 1.0, 0.0), where=high > low)
    return float(np.sum(np.diff(time) * np.clip(share, 0, 1)))


def _quick_return(time: Samples, velocity: Samples, closing: int) -> float:
    """Return the time of the closing stroke over that of the return; NaN unless a cycle has one of each."""
    outwards = velocity > REST * np.abs(velocity).max()
    (turns,) = np.nonzero(outwards[:-1] != outwards[1:])
    if len(turns) != 2:
        return nan
    before, after = velocity[turns], velocity[turns + 1]
    first, second = time[turns] + (time[turns + 1] - time[turns]) * before / (before - after)
    inner = second - first  # the stroke between the turns
    outer = time[-1] - time[0] - inner  # and the one around them
    return float(inner / outer if outwards[turns[1]] == (closing > 0) else outer / inner)
