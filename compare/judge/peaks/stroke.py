"""A slider's stroke over one cycle: its ends, for how long it is near the closed one, and the quick return."""

from collections.abc import Mapping
from functools import cached_property
from math import nan
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.model.motion import Samples
from scenes.scene import Load, PressForce, Slide, TableForce

from ...mechanics.motion_vectors import quintic
from ...mechanics.scales import chord
from .curves import CycleCurve, Values

RowNumbers: TypeAlias = NDArray[np.intp]

DWELLING = 0.01  # of the stroke: so near to its closed end the output dwells
REST = 1e-9  # of the peak speed: so slow the output stands still
NEWTON = 4  # steps to a quintic's zero from that of its chord: each doubles the digits


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
        self._away = np.asarray(way - DWELLING * self.length[..., np.newaxis])  # m, from where it is near that end

    @cached_property
    def ends(self) -> Ends:
        """Where it comes near the closed end or leaves it."""
        near = self._away <= 0
        step = np.nonzero(near[..., :-1] != near[..., 1:])
        kinds = [kind for kind in ("velocity", "acceleration") if self.exact and kind in self.by_kind]
        rates = [-self.closing * self.by_kind[kind].values(self.motion) for kind in kinds]
        x, *derivatives = [(v[..., :-1][step], v[..., 1:][step]) for v in (self._away, *rates)]
        time = np.diff(self.motion["time"])[step]
        path = quintic(time, x, *derivatives) if len(derivatives) == 2 else np.array([x[0], x[1] - x[0]])
        slope = np.arange(1, len(path))[:, np.newaxis] * path[1:]
        share = x[0] / (x[0] - x[1])
        for _ in range(NEWTON):
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
        outwards = velocity > REST * np.abs(velocity).max(axis=-1, keepdims=True)
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
        if isinstance(load, PressForce):
            return load.closing
        push = _push(load, slide)
        if push != 0:
            return -1 if push > 0 else 1
    return -1 if slide.along[1] >= 0 else 1


def _push(load: Load, slide: Slide) -> Any:
    """The largest force of a load along a guide on the ground, N."""
    largest = max(load.table.values, key=abs) if load.table is not None else getattr(load, "force", 0.0)
    if isinstance(load, TableForce):
        return np.dot(load.direction, slide.along) * largest
    return largest if np.ndim(largest) == 0 else np.dot(largest, slide.along)


def at(values: NDArray[Any], row: RowNumbers) -> NDArray[Any]:
    """The samples at these rows, shape (...)."""
    return np.take_along_axis(values, np.expand_dims(row, -1), -1)[..., 0]


def chords(places: Values) -> Values:
    """The vector between the two of some positions that are furthest apart, shape (...)."""
    return np.apply_along_axis(chord, -1, places)
