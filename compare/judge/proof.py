"""What is proven of a scene over its whole range, between the samples too, and the scene's limits held against that."""

from collections.abc import Iterable, Iterator, Sequence
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np

from scenes import Motion, Sampling, Scene
from scenes.model.enclosures import Enclosure, Enclosures
from scenes.model.motion import TRANSMISSION, magnitudes, quantity, unit_of

from ..mechanics.axis import axis

NARROW = 1e-3  # of the drive's range: what is called one place
MET, MISSED, OPEN = "met", "missed", "not decided"


class HeldLimit(NamedTuple):
    """A limit of the scene, SI, the extreme that it limits, and whether it is met, missed or not decided."""

    limit: float
    enclosure: Enclosure  # with infinite bounds where nothing is proven
    outcome: str
    text: str  # in one line


def asked(scene: Scene, sampling: Sampling) -> frozenset[str] | None:
    """The channels asked for and the magnitudes that these make; None where all are."""
    if sampling.channels is None:
        return None
    return sampling.channels.union(name for name, of in magnitudes(scene).items() if sampling.channels.issuperset(of))


def held(scene: Scene, sampling: Sampling, proof: Enclosures) -> Iterator[HeldLimit]:
    """Yield the scene's limits of what was asked for."""
    known, wanted = {row[:2]: row for row in proof.rows}, asked(scene, sampling)
    for name, limits in scene.limits.items():
        for extreme, limit, sign in (("least", limits.least, -1), ("most", limits.most, 1)):
            if limit is None or not (wanted is None or name in wanted):
                continue
            row = known.get((name, extreme), Enclosure(name, extreme, -inf, inf, nan, nan))
            inner, outer = sorted((sign * row.low, sign * row.high))
            outcome = MET if outer <= sign * limit else MISSED if inner > sign * limit else OPEN
            unit, size = unit_of(scene, name)
            low, high = (f"{bound / size:.7g}" for bound in (row.low, row.high))
            found = f"{low} {unit}" if low == high else f"between {low} and {high} {unit}"
            where = f" {place(scene, row[4:])}" if row in proof.rows else ""
            text = f"{name}: at {extreme} {limit / size:g} {unit} {outcome}: {found}{where}"
            yield HeldLimit(limit, row, outcome, text)


def met(scene: Scene, motion: Motion) -> Any:
    """Whether each of m machines meets all limits of the scene at its samples, shape (m,); the motion's are (m, n)."""
    within = np.ones(len(motion["time"]), np.bool_)
    for name, limit in scene.limits.items():
        own = [motion[channel] for channel in channels_of(scene, name, motion.samples)] or [np.full((1, 1), nan)]
        values = np.hypot(*own) if name in magnitudes(scene) else np.min(own, axis=0)
        within &= (limit.least is None) | (values >= (limit.least or 0.0)).all(axis=-1)
        within &= (limit.most is None) | (values <= (limit.most or 0.0)).all(axis=-1)
    return within


def channels_of(scene: Scene, name: str, known: Iterable[str]) -> Sequence[str]:
    """The channels that a channel or a magnitude is of: of the least transmission angle those that are known."""
    if name == TRANSMISSION:
        return [channel for channel in known if quantity(channel) == TRANSMISSION]
    return magnitudes(scene).get(name, (name,))


def place(scene: Scene, ends: tuple[float, float]) -> str:
    """A part of the drive's range, SI, as messages name it: where it is narrow, one place."""
    over, (low, high) = axis(scene), ends
    wide = high - low > NARROW * (scene.drive.cycle if over.channel == "time" else np.ptp(scene.drive.extent))
    shown = (f"{round(end * over.factor, 9) + 0.0:.5g}" for end in (ends if wide else [(low + high) / 2]))
    return f"{'from' if wide else 'at'} {' to '.join(shown)} {over.unit}"
