"""A designer's numbers of one cycle, from its samples: of the reference with samples added, and of an engine alike.

Samples have the shape (..., n): those of one linkage (n,), of m machines (m, n). All is by the last axis.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import Any, TypeAlias

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.motion import Samples
from scenes.scene import Force, PressForce

from ...engines.axis import cycle_name
from ...engines.press_switches import quintic
from .curves import LEAST, Curve

Rows: TypeAlias = NDArray[np.intp]

NEAR = 0.01  # of the stroke: so near to its closed end the output dwells
REST = 1e-9  # of the peak speed: so slow the output stands still
NOTHING = 1e-3  # of the scale of a quantity's errors: what is less is no measure of a difference
NEWTON = 4  # steps to a quintic's zero from that of its chord: each doubles the digits
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


def at(values: NDArray[Any], row: Rows) -> NDArray[Any]:
    """Return the samples at these rows, shape (...)."""
    return np.take_along_axis(values, np.asarray(row)[..., np.newaxis], -1)[..., 0]


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


# --- a slider's stroke -----------------------------------------------------------------------------------------------


def _of_slider(scene: Scene, by_kind: Mapping[str, Curve], motion: Motion, *, exact: bool) -> Iterator[Number]:
    """Yield the stroke, its ends, for how long the slider is `NEAR` the closed one, and the quick return."""
    curve, time = by_kind["displacement"], motion["time"]
    place, closing = curve.values(motion), _closing(scene)
    closed, opened = (closing * place).argmax(axis=-1), (closing * place).argmin(axis=-1)
    stroke = np.abs(at(place, closed) - at(place, opened))
    yield Number("stroke", curve, stroke, "m", stroke)
    end = "dead point" if scene.drive.repeats else "end"
    yield Number(f"closed {end}", curve, at(place, closed), "m", stroke, closed)
    yield Number(f"open {end}", curve, at(place, opened), "m", stroke, opened)
    away = np.abs(place - at(place, closed)[..., np.newaxis]) - NEAR * stroke[..., np.newaxis]
    rates = [by_kind[kind] for kind in ("velocity", "acceleration") if exact and kind in by_kind]
    dwell = _time_below_zero(time, away, [-closing * rate.values(motion) for rate in rates])
    yield Number(f"dwell within {NEAR:.0%} of the stroke".replace("%", " %"), curve, dwell, "s", dwell, closed)
    if scene.drive.repeats and "velocity" in by_kind:
        velocity = by_kind["velocity"]
        ratio = _quick_return(time, velocity.values(motion), closing)
        if not np.isnan(ratio).all():
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


def _time_below_zero(time: Samples, values: Samples, rates: Sequence[Samples]) -> Samples:
    """Return for how long a curve is below zero, shape (...): of quintics by both rates, or of straight lines."""
    steps, below = np.diff(time), values <= 0
    share = np.where(below[..., :-1] & below[..., 1:], 1.0, 0.0)
    crossed = np.nonzero(below[..., :-1] != below[..., 1:])
    x, *derivatives = [(v[..., :-1][crossed], v[..., 1:][crossed]) for v in (values, *rates)]
    zero = x[0] / (x[0] - x[1])
    if len(derivatives) == 2:
        path = quintic(steps[crossed], x, *derivatives)
        slope = np.arange(1, len(path))[:, np.newaxis] * path[1:]
        for _ in range(NEWTON):
            zero = np.clip(zero - polyval(zero, path, tensor=False) / polyval(zero, slope, tensor=False), 0, 1)
    share[crossed] = np.where(below[..., :-1][crossed], zero, 1 - zero)
    return np.asarray(np.sum(steps * share, axis=-1))


def _quick_return(time: Samples, velocity: Samples, closing: int) -> Samples:
    """Return the time of the closing stroke over the other's, shape (...); NaN unless a cycle has one of each."""
    outwards = velocity > REST * np.abs(velocity).max(axis=-1, keepdims=True)
    turns = outwards[..., :-1] != outwards[..., 1:]
    rows = turns.argmax(axis=-1), turns.shape[-1] - 1 - turns[..., ::-1].argmax(axis=-1)
    instants = []
    for row in rows:
        (before, after), (begin, end) = ((at(v, row), at(v, row + 1)) for v in (velocity, time))
        instants.append(begin + (end - begin) * before / (before - after))
    inner = instants[1] - instants[0]  # the stroke between the turns
    outer = time[..., -1] - time[..., 0] - inner  # and the one around them
    ratio = np.where(at(outwards, rows[1]) == (closing > 0), inner / outer, outer / inner)
    return np.where(turns.sum(axis=-1) == 2, ratio, nan)
