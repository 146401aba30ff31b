"""The machines that a workshop makes of one drawing: drawn from its variations, solved at once, reduced to numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.special import ndtri

from scenes import Motion, Scene, Status, numbers_in
from scenes.file.changes import numbers_of
from scenes.model.motion import Samples
from scenes.scene import ForceTable

from ...engines import registry
from ...judge.peaks.curves import curves
from ...judge.peaks.numbers import STROKE, CycleNumber, numbers
from ...judge.peaks.refined import beyond, jumps, refined
from ...judge.peaks.stroke import RowNumbers
from ...mechanics.reference import Reference

BITS = 30  # of the draws, before they become numbers
SAMPLES = 180  # of a cycle, before extremes are refined: enough to know which of several peaks is the highest


@dataclass(frozen=True)
class SolvedMachines:
    """Some machines over one cycle."""

    status: Sequence[Status]  # of all m
    reason: Sequence[str]  # why one does not run
    running: RowNumbers  # which run, shape (k,)
    motion: Motion  # of the k that run, with samples added where something is largest or least, shape (k, n)
    numbers: Sequence[CycleNumber]  # of these, each of shape (k,); none where none runs


def draws(scene: Scene, seed: int, first: int, count: int) -> Mapping[str, Samples]:
    """The numbers of machines from the `first` on, of 0, 1 and so on, by path, shape (count,), in units of the file.

    A machine is the same whatever others are asked for: the points are those of a scrambled Sobol sequence, which fill
    the space of the variations more evenly than independent ones.
    """
    from scipy.stats.qmc import Sobol  # which takes longer than all else that is imported

    sequence = Sobol(len(scene.variations), scramble=True, bits=BITS, rng=seed)
    if first:
        sequence.fast_forward(first)
    asked = 1 << max(count - 1, 0).bit_length()  # the next power of two, by which the sequence is to be asked
    shares = sequence.random(asked)[:count] + 2.0 ** -(BITS + 1)  # the middle of its last place: no 0
    drawn = {}
    nominal = numbers_in(scene.file, [variation.path for variation in scene.variations])
    for variation, number, share in zip(scene.variations, nominal, shares.T, strict=True):
        of_deviations = ndtri(share) if variation.distribution == "normal" else (2 * share - 1) * 3**0.5
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
    tables = [scene.bodies[load.body].points[0] for load in scene.loads if isinstance(load, ForceTable)]
    wanted = [channel for curve in quantities for channel in curve.channels]
    solve = registry.many(scene, changes, frozenset([*wanted, *(f"{p}.{axis}" for p in tables for axis in "xy")]))
    status, reason = [Status.ok] * count, [""] * count

    def solved(time: Samples) -> Motion:
        answer = solve(np.broadcast_to(many.drive.at(time).position, time.shape), time)
        for machine, (ended, why) in enumerate(zip(answer.status, answer.reason, strict=True)):
            if status[machine] is Status.ok:
                status[machine], reason[machine] = ended, why
        return Motion(answer.samples)

    time = np.arange(samples + 1) / samples * np.broadcast_to(many.drive.cycle, (count, 1))
    switches = _no_switches if jumps(scene) else None
    with np.errstate(invalid="ignore"):  # of machines that do not run
        motion = refined(
            quantities,
            solved(time),
            solved,
            repeats=scene.drive.repeats,
            bends=partial(beyond, many),
            switches=switches,
        )
    rows = np.flatnonzero([ended is Status.ok for ended in status])
    if not rows.size:
        return SolvedMachines(status, reason, rows, Motion({}), ())
    motion = Motion({name: values[rows] for name, values in motion.samples.items()})
    many = scene.with_numbers(numbers_of(scene, {path: values[rows] for path, values in changes.items()}))
    quantities = curves(many, scale, motion)
    found = numbers(scene, quantities, motion, exact=True)
    placed = [n for n in found if n.row is not None or n.kind == STROKE]  # at one place, or between two; no sums
    return SolvedMachines(status, reason, rows, motion, placed)


def _no_switches(motion: Motion, _: Samples) -> Samples:
    return np.zeros((*motion["time"].shape[:-1], 0))
