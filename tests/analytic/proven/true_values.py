"""Boxes of a scene's range drawn at random, and what the true values in them have to lie between."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

import analytic
from analytic.proven.boxes import Boxes
from scenes import Motion, Sampling, Scene
from scenes.channels import named
from scenes.drive import ConstantSpeed
from scenes.model.motion import Positions, Samples
from tests.agreement import exact

WIDTHS = (-6.0, -1.0)  # powers of ten of the range, between which boxes are as wide
HAIR = 1e-8  # of a cycle: so close to a boundary of a law's pieces 50 digits take an instant as on it
HALF_A_PLACE = 2.0**-53  # of a value: what rounding 50 digits to a double makes it off
BY_50_DIGITS = 1e-20  # of a unit's peak: to which 50 digits are proven
# Of a unit's peak: the core's own round-off, see `tests.agreement`; and of a law's position, at which 50 digits are.
BY_DOUBLES = 1e-13
ALL_ZERO = 1e-10  # SI, a peak below which a unit's channels are all zero, and what is found of them is round-off


@dataclass(frozen=True)
class Places:
    """Places of a scene's range and a box around each, shape (n,) each."""

    scene: Scene
    at: Samples  # rad or m, or s under a law
    low: Samples
    high: Samples
    request: Sampling | None  # that has the instants of a law

    @classmethod
    def drawn(cls, scene: Scene, chance: np.random.Generator, count: int) -> "Places":
        """So many, none of them over two pieces of a law."""
        edges, request, least = _edges(scene), None, 0.0
        if isinstance(scene.drive.law, ConstantSpeed):
            at = np.sort(chance.uniform(edges[0], edges[-1], count))
            at = at if scene.drive.law.speed > 0 else at[::-1]
        else:
            request = Sampling(samples=count)
            at = request.times(scene)
            beside = np.abs(at[:, np.newaxis] - edges).min(axis=1)
            at, least = np.where(beside > HAIR * scene.cycle, at, np.nan), HAIR * scene.cycle
        own = np.clip(np.searchsorted(edges, np.nan_to_num(at), side="right"), 1, len(edges) - 1)
        width = np.ptp(edges) * 10.0 ** chance.uniform(*WIDTHS, len(at))
        share = chance.uniform(0, 1, len(at))
        low = np.maximum(at - share * width - least, edges[own - 1])
        return cls(scene, at, low, np.minimum(at + (1 - share) * width + least, edges[own]), request)

    @cached_property
    def known(self) -> NDArray[np.intp]:
        """Which of them have a box."""
        return np.flatnonzero(np.isfinite(self.at))

    @property
    def by_50_digits(self) -> Motion:
        """The true values."""
        return exact(self.scene, self.request or Positions(tuple(self.at.tolist())))

    @property
    def by_the_core(self) -> Motion:
        """Nearly the true values."""
        if self.request is None:
            return analytic.solve(self.scene, self.at)
        time = self.request.times(self.scene)
        return analytic.solve(self.scene, self.scene.drive.law.at(time).position, time)


def _edges(scene: Scene) -> Samples:
    law = scene.drive.law
    if isinstance(law, ConstantSpeed):
        return np.array(law.extent)
    return np.array([*(piece.begin for piece in law.pieces), law.cycle])


def with_magnitudes(scene: Scene, motion: Motion) -> Mapping[str, Samples]:
    """The samples of a motion, and of the magnitudes that are the lengths of two of them."""
    pairs = {name: of for name, of in scene.channels.magnitudes.items() if motion.samples.keys() >= {*of}}
    return {**motion.samples, **{name: np.hypot(motion[x], motion[y]) for name, (x, y) in pairs.items()}}


def escapes(places: Places, motion: Motion, slack: float) -> Iterator[tuple[str, float, float]]:
    """Yield each value outside the enclosure of its box: its name, where, and how far it is beyond, of the peak.

    Args:
        places: with their boxes.
        motion: the values there.
        slack: what the values are off, of their unit's peak, besides half a unit in the last place.
    """
    boxes = Boxes(places.scene, None, {})
    models, own = boxes(places.low[places.known], places.high[places.known])
    at, low, high = (of[places.known][own] for of in (places.at, places.low, places.high))
    middle = (low + high) / 2
    s = np.clip((at - middle) / np.maximum(high - middle, middle - low), -1, 1)
    samples = with_magnitudes(places.scene, motion)
    peaks: dict[str, float] = {}
    for name, values in samples.items():
        unit = named(name).unit
        peaks[unit] = max(peaks.get(unit, 0.0), float(np.abs(values[places.known]).max()))
    for row, name in enumerate(boxes.names):
        if name not in samples:
            continue
        c, rest = models.c[:, row], models.rest[row]
        values = samples[name][places.known][own]
        apart = values - (c[0] + s * (c[1] + s * c[2]))
        if named(name).name == "angle":  # it counts modulo one turn
            apart = np.remainder(apart + np.pi, 2 * np.pi) - np.pi
        peak = max(peaks[named(name).unit], ALL_ZERO)
        # That s is a double, and the parabola's sum: some roundings of its terms.
        off = 8 * HALF_A_PLACE * np.abs(c).sum(axis=0) + 2 * HALF_A_PLACE * np.abs(values) + slack * peak
        beyond = np.abs(apart) - rest - off
        least = np.full(len(places.known), np.inf)  # of the copies of a box, one holds it
        np.fmin.at(least, own, np.where(np.isnan(rest), -np.inf, beyond))
        for box in np.flatnonzero(~(least <= 0)):
            yield name, float(places.at[places.known][box]), float(least[box] / peak)


def share_known(places: Places) -> float:
    """Of how many values something is known."""
    models, _ = Boxes(places.scene, None, {})(places.low[places.known], places.high[places.known])
    return float(np.isfinite(models.rest).mean())


def turn(scene: Scene, count: int = 90) -> Samples:
    """The ends of as many equal parts of the range."""
    edges = _edges(scene)
    return np.linspace(edges[0], edges[-1], count + 1)


def motion_at(scene: Scene, way: Samples) -> Motion:
    """The core's motion at positions, or at instants under a law."""
    if isinstance(scene.drive.law, ConstantSpeed):
        return analytic.solve(scene, way)
    return analytic.solve(scene, scene.drive.law.at(way).position, way)


def peaks(samples: Mapping[str, Samples]) -> dict[str, float]:
    """The largest size of each unit."""
    found: dict[str, float] = {}
    for name, values in samples.items():
        unit = named(name).unit
        found[unit] = max(found.get(unit, 0.0), float(np.abs(values).max()))
    return found
