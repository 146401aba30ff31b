"""The designer's numbers of a judged scene, and by how much its engines differ on each."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import nan

import numpy as np

from scenes import Motion, Request, Sampling
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples

from ...engines.registry import REFERENCE
from ...engines.runner import INSTANT_TOL
from ...mechanics.reference import SCALE_SAMPLES, Reference
from ..measure import Measurement
from .curves import curves
from .numbers import CycleNumber, numbers
from .refined import NEXT_TO_HIGHEST, refined

ZERO_TOL = 1e-6  # of what a difference is divided by: what lines between the samples cut off the work of a cycle
STRIDE = 10  # samples of the reference's cycle
MAX_TURNS = 10  # of a run, evenly spread, in which engines are compared


@dataclass(frozen=True)
class Peak:
    """One of the designer's numbers, of the reference over one cycle, SI."""

    name: str  # "largest force at P3"
    of: str  # the joint, point or body
    channel: str  # the first of those that it is taken from
    value: float  # a magnitude; of dead points the displacement along the guide; of the drive's peaks and work signed
    unit: str
    position: float  # on the axis of curves and tables, SI: rad, m, or s under a law; NaN where it has no one place
    direction: float  # rad, of a velocity, acceleration or force there; NaN where it has none
    differs: Mapping[str, float]  # by engine that returned what it takes, relative to the number, see `peaks`
    kind: str = ""  # its name without the joint and the drive's way of turning: "largest force"


def peaks(reference: Reference, sampling: Request, measurements: Sequence[Measurement]) -> list[Peak]:
    """The numbers that the channels asked for have, refined between the samples.

    An engine's difference is that of the number of its own samples from the number of the reference at the positions
    that its drive really had, so that sampling makes none; the largest of its cycles. It is relative to the number, of
    dead points to the stroke, of the drive's torque, force or work to the largest torque or force, or to what that
    would do held throughout, and to a thousandth of the scale of the quantity's errors where the number is less. None
    is below the reference's floor.
    """
    scene, wanted = reference.scene, set(sampling.wanted(reference.scene))
    everything = wanted.issuperset(reference.mechanics.units)
    quantities = curves(scene, reference.scale, reference.cycle)
    followed = [curve for curve in quantities if everything or wanted.issuperset(curve.channels)]
    if not followed:
        return []

    def solve(time: Samples) -> Motion:
        return reference.at(inputs_of(scene, time))

    late = reference.cycle.late.intersection(channel for curve in followed for channel in curve.channels)
    cycle = Motion({**reference.cycle.prompt.samples, **{channel: _lows(reference, channel) for channel in late}})
    motion = refined(scene, followed, cycle, solve, partial(_switches, reference))
    axis_channel = reference.mechanics.axis.channel
    differences = {
        m.run.engine: _differences(reference, m.run.motion)
        for m in measurements
        if m.run.motion is not None and m.comparison is not None and m.run.engine != REFERENCE
    }
    return [
        Peak(
            number.name,
            number.curve.of,
            number.curve.channels[0],
            0.0 if abs(number.value) <= ZERO_TOL * number.size else float(number.value),
            number.unit,
            *_place(number, motion, motion[axis_channel]),
            {engine: by_name[number.name] for engine, by_name in differences.items() if number.name in by_name},
            number.kind or number.name,
        )
        for number in numbers(scene, followed, motion, exact=True)
    ]


def _lows(reference: Reference, channel: str) -> Samples:
    """A channel over the reference's cycle, true where it may be least, and else by straight lines between few samples.

    Of a quantity that takes many times as long as all others every `STRIDE`-th sample is found, and then all of them on
    either side of the lowest of these. A dip narrower than two strides may be missed.
    """
    cycle, scene = reference.cycle, reference.scene
    few = Sampling(SCALE_SAMPLES // STRIDE)
    # Two passes: a coarse one over the cycle, and all samples around each of its low bottoms.
    low = reference.at(few.inputs(scene))[channel]
    values = np.interp(np.arange(SCALE_SAMPLES + 1), np.arange(0, SCALE_SAMPLES + 1, STRIDE), low)
    bottom = (low <= np.append(np.inf, low[:-1])) & (low <= np.append(low[1:], np.inf))
    lowest = np.flatnonzero(bottom & (low <= low.min() + NEXT_TO_HIGHEST * np.ptp(low)))
    around = STRIDE * lowest[:, np.newaxis] + np.arange(-STRIDE, STRIDE + 1)
    near = np.unique(np.clip(around, 0, SCALE_SAMPLES))
    values[near] = reference.at(cycle.inputs(scene, near))[channel]
    return values


def _switches(reference: Reference, motion: Motion, step: Samples) -> Samples:
    """The instants on either side of which a press force comes or goes, of samples close together."""
    close = np.diff(motion["time"]) < 1.5 * step
    changes = [np.flatnonzero(close & (act[0, 1:] != act[0, :-1])) for act in reference.acts(motion)]
    return np.asarray(motion["time"][np.concatenate([np.arange(0), *changes])])


def _place(number: CycleNumber, motion: Motion, along: Samples) -> tuple[float, float]:
    """Where on the axis a number is found, and its direction there; NaN where it has neither."""
    if number.row is None or number.row < 0:
        return nan, nan
    return float(along[number.row]), number.curve.direction(motion, int(number.row))


def _differences(reference: Reference, motion: Motion) -> dict[str, float]:
    """An engine's difference by the name of the number; NaN where one of them lacks it in a cycle."""
    scene = reference.scene
    followed = curves(scene, reference.scale, motion)
    largest: dict[str, float] = {}
    for rows in _cycles(motion["time"] / scene.cycle):
        cycle_motion = Motion({c: samples[rows] for c, samples in motion.samples.items()})
        solved = reference.at(cycle_motion.inputs(scene))
        true = reference.fitting(cycle_motion, solved, reference.acts(solved))
        theirs = {number.name: number for number in numbers(scene, followed, cycle_motion)}
        for number in numbers(scene, followed, true):
            difference = abs(float(theirs[number.name].value - number.value)) if number.name in theirs else nan
            floor = max(reference.floor.by_channel.get(channel, 0.0) for channel in number.curve.channels)
            shown = np.maximum(difference / number.size, floor) if number.size > 0 else nan
            largest[number.name] = float(np.maximum(largest.get(number.name, 0.0), shown))
    return largest


def _cycles(cycles: Samples) -> Iterator[slice]:
    """Yield the rows of whole cycles, evenly spread over those that have passed since the first row."""
    passed = cycles - cycles[0] + INSTANT_TOL
    turns = int(passed[-1])
    for turn in dict.fromkeys(np.linspace(0, turns - 1, min(turns, MAX_TURNS)).astype(int).tolist()):
        yield slice(*np.searchsorted(passed, (turn, turn + 1 + 2 * INSTANT_TOL)))
