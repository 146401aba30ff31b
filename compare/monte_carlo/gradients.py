"""How the designer's numbers change with the numbers of the scene, from the exact derivatives of the channels.

Where a quantity is largest or least its place does not matter to the first order: the number changes as the quantity
does there, at the same position of the drive. The ends of the dwell move as the equation that they solve asks.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from scenes import Motion, numbers_in
from scenes.motion import Samples

from ..engines import registry
from ..engines.reference import Reference
from ..judge.peaks.curves import Curve, Values, curves
from ..judge.peaks.numbers import Number
from ..judge.peaks.stroke import NEAR, Stroke
from .guide import by_guide
from .machines import SPEED, Machines


class Term(NamedTuple):
    """A part of how a number changes: by the change of a quantity at an instant, times a weight."""

    curve: Curve
    time: float
    weight: complex  # of a vector's change: the part along it


def gradients(reference: Reference, nominal: Machines, paths: Sequence[str]) -> Samples:
    """Return the derivatives of the k numbers by p numbers of the scene file, shape (p, k), SI per unit of the file.

    Args:
        reference: of the linkage as drawn.
        nominal: that linkage as the only one of its machines.
        paths: of the numbers in the file.
    """
    scene, motion = reference.scene, Motion({name: values[0] for name, values in nominal.motion.samples.items()})
    found = curves(scene, reference.scale, motion)
    terms = [[*_terms(reference, number, motion, {curve.kind: curve for curve in found})] for number in nominal.numbers]
    time = np.unique([term.time for own in terms for term in own])
    wanted = frozenset(channel for curve in found for channel in curve.channels)
    position = scene.drive.at(time).position
    by = registry.derivatives(scene, paths, position, time, wanted)
    there = registry.reference(scene)(position, time)
    by_curve = {
        curve: _change(curve, by) + np.array([by_guide(scene, path, curve, there) for path in paths])
        for curve in {term.curve for own in terms for term in own}
    }
    result = np.zeros((len(paths), len(terms)))
    for number, own in enumerate(terms):
        for curve, instant, weight in own:
            result[:, number] += (np.conj(weight) * by_curve[curve][:, np.searchsorted(time, instant)]).real
    if SPEED in paths:  # a dwell is a time: at the same positions it goes with one over the speed
        (speed,) = numbers_in(scene.file, [SPEED])
        dwells = [float(n.value[0]) if n.name.startswith("dwell") else 0.0 for n in nominal.numbers]
        result[paths.index(SPEED)] -= np.array(dwells) / speed
    return result


def _change(curve: Curve, by: Mapping[str, Samples]) -> Values:
    """Return how a quantity changes, shape (p, n): it is linear in its channels, but for a constant."""
    if curve.kind == "guide_force":  # which is taken as a vector that turns with the guide
        return by[curve.channels[0]]
    nothing = {name: np.zeros_like(values) for name, values in by.items()}
    return curve.values(Motion(by)) - curve.values(Motion(nothing))


def _terms(reference: Reference, number: Number, motion: Motion, by_kind: Mapping[str, Curve]) -> Iterator[Term]:
    curve, time = number.curve, motion["time"]
    if curve.kind == "path":
        yield from _of_path(curve, motion)
    elif curve.kind == "displacement":
        yield from _of_stroke(number, Stroke(reference.scene, motion, by_kind, exact=True), time)
    else:
        assert number.row is not None
        row = int(number.row[0])
        value = (motion[curve.channels[0]] if curve.kind == "guide_force" else curve.values(motion))[row]
        yield Term(curve, float(time[row]), value / (abs(value) or 1.0))


def _of_path(curve: Curve, motion: Motion) -> Iterator[Term]:
    """Yield the parts of the diagonal of the box around a path."""
    place, time = curve.values(motion), motion["time"]
    width, height = np.ptp(place.real), np.ptp(place.imag)
    for along, size, direction in ((place.real, width, 1.0), (place.imag, height, 1j)):
        for row, sign in ((along.argmax(), 1), (along.argmin(), -1)):
            yield Term(curve, float(time[row]), sign * direction * size / np.hypot(width, height))


def _of_stroke(number: Number, way: Stroke, time: Samples) -> Iterator[Term]:
    """Yield the parts of a slider's stroke, its ends and its dwell."""
    curve, closing = number.curve, way.closing
    closed, opened = float(time[way.closed]), float(time[way.opened])
    if number.name == "stroke":
        yield Term(curve, closed, closing)
        yield Term(curve, opened, -closing)
    elif not number.name.startswith("dwell"):
        yield Term(curve, closed if number.name.startswith("closed") else opened, 1.0)
    else:
        (step,), share, _, speeds = way.ends
        for instant, speed in zip(time[step] + share * np.diff(time)[step], speeds, strict=True):
            yield Term(curve, float(instant), closing / speed)
            yield Term(curve, closed, -closing * (1 - NEAR) / speed)
            yield Term(curve, opened, -closing * NEAR / speed)
