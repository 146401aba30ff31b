"""The machines that a workshop makes of one drawing: drawn from its variations, solved at once, reduced to numbers.

Beside them a linear model: how the numbers change with those of the scene, from the exact derivatives of the channels.

Where a quantity is largest or least its place does not matter to the first order: the number changes as the quantity
does there, at the same position of the drive. The ends of the dwell move as the equation that they solve asks. Where a
press force comes or goes just there the place does matter, and the linear model is off, as the machines then show.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any, TypeAlias

import numpy as np

from scenes import Motion, Scene, Status, numbers_in
from scenes.file.changes import numbers_of
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples

from ...engines import registry
from ...judge.peaks.curves import CycleCurve, Values, curves
from ...judge.peaks.numbers import DWELL, DWELL_TOL, STROKE, CycleNumber, RowNumbers, Stroke, chords, numbers
from ...judge.peaks.refined import needed, refined
from ...judge.proof import channels_of, met
from ...mechanics.reference import SCALE_SAMPLES, Reference
from .sobol import points

QUANTILE = NormalDist().inv_cdf
SAMPLES = 180  # of a cycle, before extremes are refined: enough to know which of several peaks is the highest
SPEED = "drive.speed"
QUANTITIES = {"displacement": "", "velocity": "v", "acceleration": "a"}  # of channels, by kind of curve
# A part of how a number changes: by the change of a quantity at an instant, times a weight; of a vector's along that.
Term: TypeAlias = tuple[CycleCurve, float, complex]


@dataclass(frozen=True)
class SolvedMachines:
    """Some machines over one cycle."""

    status: Sequence[Status]  # of all m
    reason: Sequence[str]  # why one does not run
    running: RowNumbers  # which run, shape (k,)
    motion: Motion  # of the k that run, with samples added where something is largest or least, shape (k, n)
    numbers: Sequence[CycleNumber]  # of these, each of shape (k,); none where none runs
    met: Any = 0  # which of them meet all limits of the scene, shape (k,)


def draws(scene: Scene, seed: int, first: int, count: int) -> Mapping[str, Samples]:
    """The numbers of machines from the `first` on, of 0, 1 and so on, by path, shape (count,), in units of the file.

    A machine is the same whatever others are asked for.
    """
    shares = points(len(scene.variations), seed, first, count)
    drawn = {}
    nominal = numbers_in(scene, [variation.path for variation in scene.variations])
    for variation, number, share in zip(scene.variations, nominal, shares.T, strict=True):
        normal = variation.distribution == "normal"
        # Inverse transform sampling of quasi-random shares. The uniform distribution of the same standard deviation d
        # spans +-d sqrt(3).
        of_deviations = np.array([*map(QUANTILE, share)]) if normal else (2 * share - 1) * 3**0.5
        drawn[variation.path] = number + variation.deviation * of_deviations
    return drawn


def machines(reference: Reference, changes: Mapping[str, Samples], samples: int = SAMPLES) -> SolvedMachines:
    """Solve one cycle of each of m machines, and take the numbers from it that are largest or least somewhere.

    `changes` are by path the numbers of the file that differ, each of shape (m,); `samples` are those before extremes
    are refined.
    """
    scene, scale, count = reference.scene, reference.scale, len(next(iter(changes.values())))
    many = scene.with_numbers(numbers_of(scene, changes))
    quantities = curves(many, scale, reference.cycle)
    wanted = [channel for curve in quantities for channel in curve.channels]
    wanted += [channel for name in scene.limits for channel in channels_of(scene, name, wanted)]
    solve = registry.many(scene, changes, frozenset([*wanted, *needed(scene)]))
    status, reason = [Status.ok] * count, [""] * count

    def solved(time: Samples) -> Motion:
        answer = solve(inputs_of(many, time).driven().position, time)
        for machine, (ended, why) in enumerate(zip(answer.status, answer.reason, strict=True)):
            if status[machine] is Status.ok:
                status[machine], reason[machine] = ended, why
        return Motion(answer.samples)

    # Shape (machines, samples): each machine has its own cycle where the drive's speed varies.
    time = np.arange(samples + 1) / samples * np.broadcast_to(many.cycle, (count, 1))
    with np.errstate(invalid="ignore"):  # of machines that do not run
        motion = refined(many, quantities, solved(time), solved, bare=True)
    rows = np.flatnonzero([ended is Status.ok for ended in status])
    if not rows.size:
        return SolvedMachines(status, reason, rows, Motion({}), ())
    if rows.size < count:
        motion = Motion({name: values[rows] for name, values in motion.samples.items()})
        many = scene.with_numbers(numbers_of(scene, {path: values[rows] for path, values in changes.items()}))
        quantities = curves(many, scale, motion)
    found = numbers(scene, quantities, motion, exact=True)
    of_one = [n for n in found if n.unit != "W"]  # a power is a product of two
    placed = [n for n in of_one if n.row is not None or n.kind == STROKE]  # at one place, or between two; no sums
    return SolvedMachines(status, reason, rows, motion, placed, met(scene, motion))


def as_drawn(reference: Reference, paths: Sequence[str]) -> SolvedMachines:
    """The linkage as drawn as the only one of its machines, its extremes placed as accurately as they can be."""
    drawn = np.reshape(numbers_in(reference.scene, paths), (-1, 1))
    return machines(reference, dict(zip(paths, drawn, strict=True)), SCALE_SAMPLES)


# First-order sensitivity of extremes (envelope theorem): d max f / dp is the partial derivative of f at the place of
# the maximum. A number is a sum of terms, quantity at an instant times a weight; the exact derivatives of channels by p
# numbers at all these instants are found in one call. It fails, as a linear model does, where a peak jumps to another
# place or a press force switches just there; `Spread.unexplained` shows that.
def gradients(reference: Reference, nominal: SolvedMachines, paths: Sequence[str]) -> Samples:
    """The derivatives of the k numbers by p numbers of the scene file, shape (p, k), SI per unit of the file."""
    scene, motion = reference.scene, Motion({name: values[0] for name, values in nominal.motion.samples.items()})
    quantities = curves(scene, reference.scale, motion)
    terms = [[*_terms(scene, number, motion, quantities)] for number in nominal.numbers]
    time = np.unique([instant for parts in terms for _, instant, _ in parts])
    wanted = frozenset(channel for curve in quantities for channel in curve.channels)
    inputs = inputs_of(scene, time)
    position = inputs.driven().position
    rates = {**registry.derivatives(scene, paths, position, time, wanted)}
    if left := wanted - rates.keys():  # how far larger groups are from a singular pose
        rates |= _by_differences(scene, paths, position, time, left)
    there = registry.reference(scene)(inputs)
    by_curve = {
        curve: _change(curve, rates) + np.array([_by_guide(scene, path, curve, there) for path in paths])
        for curve in {curve for parts in terms for curve, *_ in parts}
    }
    result = np.zeros((len(paths), len(terms)))
    for number, parts in enumerate(terms):
        for curve, instant, weight in parts:
            result[:, number] += (np.conj(weight) * by_curve[curve][:, np.searchsorted(time, instant)]).real
    if SPEED in paths:  # a dwell is a time: at the same positions it goes with one over the speed
        (speed,) = numbers_in(scene, [SPEED])
        dwells = [float(n.value[0]) if n.kind == DWELL else 0.0 for n in nominal.numbers]
        result[paths.index(SPEED)] -= np.array(dwells) / speed
    return result


def _by_differences(
    scene: Scene, paths: Sequence[str], position: Samples, time: Samples, channels: frozenset[str]
) -> Mapping[str, Samples]:
    """The derivatives of channels that have no exact ones, shape (p, n): differences over twice a deviation."""
    size = {variation.path: variation.deviation for variation in scene.variations}
    # Central differences; the step is the standard deviation rather than one of best accuracy, because the channel is
    # itself found by iteration and has few digits, and the slope over that range is what the linear model needs.
    step = np.array([size[path] for path in paths])  # as large as what they are for: such channels have few digits
    apart = np.concatenate([np.diag(step), -np.diag(step)])
    changes = dict(zip(paths, np.transpose(numbers_in(scene, paths) + apart), strict=True))
    there = registry.many(scene, changes, channels)(position, time)
    return {c: np.subtract(*np.split(there.samples[c], 2)) / (2 * step[:, np.newaxis]) for c in channels}


def _change(curve: CycleCurve, rates: Mapping[str, Samples]) -> Values:
    """How a quantity changes with its channels, in which it is linear, shape (p, n)."""
    if curve.kind == "guide_force":  # which is taken as a vector that turns with the guide
        return rates[curve.channels[0]]
    return np.asarray(np.sum([part * rates[channel] for channel, part in curve.parts.items()], axis=0))


def _terms(scene: Scene, number: CycleNumber, motion: Motion, quantities: Sequence[CycleCurve]) -> Iterator[Term]:
    """Yield the parts of a number of the linkage as drawn, which is the only one of its machines."""
    time = motion["time"]
    (curve,) = (curve for curve in quantities if (curve.kind, curve.of) == (number.curve.kind, number.curve.of))
    if curve.kind == "path":  # the largest distance between two places
        place = curve.values(motion)
        # The distance of two places grows with the movement of either end along the line that joins them.
        longest = chords(place)
        along = (longest.conj() * place).real
        for end, sign in ((along.argmax(), 1), (along.argmin(), -1)):
            yield curve, float(time[end]), complex(sign * longest / np.abs(longest))
    elif number.kind in (STROKE, DWELL):
        yield from _of_stroke(number.kind, curve, Stroke(scene, motion, {c.kind: c for c in quantities}, exact=True))
    elif number.row is not None and (row := int(number.row[0])) >= 0:  # else it is rounding
        value = (motion[curve.channels[0]] if curve.kind == "guide_force" else curve.values(motion))[row]
        yield curve, float(time[row]), value / number.value[0] if number.value[0] else 1.0


def _of_stroke(kind: str, curve: CycleCurve, way: Stroke) -> Iterator[Term]:
    """Yield the parts of a slider's stroke, or of its dwell."""
    closing, time = way.closing, way.motion["time"]
    closed, opened = float(time[way.closed]), float(time[way.opened])
    if kind == STROKE:
        yield curve, closed, closing
        yield curve, opened, -closing
    else:
        # The dwell's ends solve s(t) = closed - DWELL_TOL stroke. Differentiated by a number p: dt/dp = -(ds/dp -
        # d(limit)/dp) / s', with the limit moving as both dead points do.
        (step,), share, _, speeds = way.ends
        for instant, speed in zip(time[step] + share * np.diff(time)[step], speeds, strict=True):
            yield curve, float(instant), closing / speed
            yield curve, closed, -closing * (1 - DWELL_TOL) / speed
            yield curve, opened, -closing * DWELL_TOL / speed


def _by_guide(scene: Scene, path: str, curve: CycleCurve, motion: Motion) -> Samples:
    """Change of a curve by a number of the output's guide, its point's motion unchanged, shape (n,); else 0."""
    nothing, guided = np.zeros(motion["time"].shape), scene.guided(scene.output)
    if guided is None or curve.kind not in QUANTITIES or not path.startswith(f"bodies.{guided[0]}.slides."):
        return nothing
    _, slide = guided
    *_, key, axis = path.split(".")
    through, along, unit = np.array(slide.through), np.array(slide.along), np.eye(2)[int(axis)]
    place = curve.kind == "displacement"
    if key == "through":
        return nothing - place * float(along @ unit) * scene.units["length"][1]
    x, y = (motion[f"{curve.of}.{QUANTITIES[curve.kind]}{axis}"] for axis in "xy")
    # d(along) for a unit change of one of its components before normalisation: the part across the direction, over the
    # length as drawn.
    turn = (unit - along * (along @ unit)) / slide.drawn
    return np.asarray(turn[0] * (x - place * through[0]) + turn[1] * (y - place * through[1]))
