"""The designer's numbers of many machines, solved at once and reduced to these at once."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene, Status
from scenes.drive import ConstantSpeed, Drive
from scenes.motion import Samples

from ..engines import registry
from ..engines.press_switches import press_forces
from ..engines.reference import Reference
from ..judge.peaks.curves import Curve, curves
from ..judge.peaks.numbers import Number, numbers
from ..judge.peaks.refined import refined
from ..judge.peaks.stroke import Rows
from .guide import with_guide

SAMPLES = 360  # of a cycle, before extremes are refined: enough to know which of several peaks is the highest
SPEED = "drive.speed"


@dataclass(frozen=True)
class Machines:
    """Some machines over one cycle."""

    status: list[Status]  # of all m
    reason: list[str]  # why one does not run
    motion: Motion  # of the k that run, with samples added where something is largest or least, shape (k, n)
    numbers: Sequence[Number]  # of these, each of shape (k,); none where none runs

    @property
    def running(self) -> Rows:
        """Which machines run, shape (k,)."""
        return np.flatnonzero([status is Status.ok for status in self.status])


def machines(reference: Reference, changes: Mapping[str, Samples]) -> Machines:
    """Solve one cycle of each machine, and take the numbers from it that are largest or least somewhere.

    Args:
        reference: of the linkage as drawn.
        changes: by path the numbers of m machines, each of shape (m,), in the units of the file.
    """
    scene = reference.scene

    def found(rows: Rows) -> list[Curve]:
        return curves(with_guide(scene, _rows(changes, rows)), reference.scale, reference.cycle)

    count = len(next(iter(changes.values())))
    wanted = frozenset(channel for curve in found(np.arange(count)) for channel in curve.channels)
    ended = Machines([Status.ok] * count, [""] * count, Motion({}), ())

    def solved(rows: Rows, time: Samples) -> Motion:
        own = _rows(changes, rows)
        many = registry.solve_many(scene, own, _drive(scene, own).at(time).position, time, wanted)
        for row, status, reason in zip(rows, many.status, many.reason, strict=True):
            ended.status[row], ended.reason[row] = status, reason
        return Motion({name: np.broadcast_to(values, time.shape) for name, values in many.samples.items()})

    duration = np.broadcast_to(np.asarray(_drive(scene, changes).cycle), (count, 1))
    cycle = solved(np.arange(count), np.arange(SAMPLES + 1) / SAMPLES * duration)
    rows = ended.running
    if not rows.size:
        return ended
    switches = _no_switches if press_forces(scene) else None
    repeats = scene.drive.repeats
    first = Motion(_rows(cycle.samples, rows))
    motion = refined(found(rows), first, partial(solved, rows), repeats=repeats, switches=switches)
    motion = Motion(_rows(motion.samples, np.isin(rows, ended.running)))  # one may lock between two samples
    taken = [number for number in numbers(scene, found(ended.running), motion, exact=True) if placed(number)]
    return replace(ended, motion=motion, numbers=taken)


def placed(number: Number) -> bool:
    """Return whether a number is found at one place of the cycle, or between two; others are sums over it."""
    return number.row is not None or number.name == "stroke"


def _rows(values: Mapping[str, Samples], rows: NDArray[Any]) -> dict[str, Samples]:
    return {name: samples[rows] for name, samples in values.items()}


def _drive(scene: Scene, changes: Mapping[str, Samples]) -> Drive:
    """Return the drive of m machines, whose speeds are of shape (m, 1) where they differ."""
    if SPEED not in changes or not isinstance(scene.drive, ConstantSpeed):
        return scene.drive
    speeds: Any = changes[SPEED][:, np.newaxis] * scene.units["speed"][1]
    return replace(scene.drive, speed=speeds)


def _no_switches(motion: Motion, _: Samples) -> Samples:
    return np.zeros((*motion["time"].shape[:-1], 0))
