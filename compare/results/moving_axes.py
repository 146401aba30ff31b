"""What a proposed mapping leaves alone: channels that stand still, and vectors by the axes of links.

A channel moves where it is more than the round-off of the linkage's own sizes: its largest place, force or rate, and
what these make of each other where all channels of a unit stand still. A column is a vector by a link's axes where the
plane of both components, turned back by the link's angle, holds the column far better than any channel does.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenes.channels import Channels
from scenes.model.motion import Samples

from .frame import vectors

ROUND_OFF_TOL = 1e-11  # of the linkage's sizes: what is less moves only by round-off
FLAT_TOL = 1e-9  # of a vector: a component that is less gives no direction


class ByLink(NamedTuple):
    """A column that is a component of a vector by the axes of a link."""

    column: int
    vector: tuple[str, str]  # its components
    body: str
    left: float  # of the column


def moving(channels: Channels, true: Mapping[str, Samples]) -> dict[str, Samples]:
    """Return the channels that move by more than round-off."""
    largest: dict[str, float] = {"rad": 1.0}
    for channel, values in true.items():
        unit = channels[channel].unit
        largest[unit] = max(largest.get(unit, 0.0), float(np.abs(values).max()))
    length = largest.get("m", 0.0)
    for unit, size in (("N*m", largest.get("N", 0.0) * length), *_rates(largest, length)):
        largest[unit] = max(largest.get(unit, 0.0), size)
    return {c: values for c, values in true.items() if np.ptp(values) > ROUND_OFF_TOL * largest[channels[c].unit]}


def _rates(largest: Mapping[str, float], length: float) -> Iterator[tuple[str, float]]:
    for each in ("/s", "/s^2") if length else ():
        places, angles = largest.get(f"m{each}", 0.0), largest.get(f"rad{each}", 0.0)
        yield f"m{each}", angles * length
        yield f"rad{each}", places / length


# One minus the squared multiple correlation of each column with the rows of `base`: the share of its variance that no
# linear combination explains. An orthonormal basis from QR, as normal equations would square the condition; rows that
# depend on others, or stand still, drop out by their diagonal of R.
def left_by(base: NDArray[np.float64], columns: NDArray[np.float64]) -> Samples:
    """Return the share of each column's square that is left by the line, or the plane, nearest to it."""
    centred = columns - columns.mean(axis=1, keepdims=True)
    whole = (centred**2).sum(axis=1)
    first = base[np.argsort(-np.ptp(base, axis=1))]  # what stays comes last, as it gives no direction
    q, r = np.linalg.qr((first - first.mean(axis=1, keepdims=True)).T)
    q = q[:, np.abs(np.diag(r)) > FLAT_TOL * np.abs(base).max()]
    share: Samples = 1 - ((centred @ q) ** 2).sum(axis=1) / np.where(whole > 0, whole, np.inf)
    return np.clip(np.where(whole > 0, share, 1.0), 0.0, 1.0)


def by_links(
    channels: Channels, true: Mapping[str, Samples], columns: NDArray[np.float64], known: Sequence[float]
) -> list[ByLink]:
    """Return the columns that a vector by a link's axes explains better than `known`; places are left out."""
    angles = {channels[c].subject: values for c, values in true.items() if channels[c].modulo_turn}
    best: dict[int, ByLink] = {}
    for x, y in vectors(channels, true):
        if channels[x].order == 0 or not {x, y} <= true.keys():
            continue
        for body, angle in angles.items():
            vector = (true[x] + 1j * true[y]) * np.exp(-1j * angle)
            left = np.sqrt(left_by(np.array([vector.real, vector.imag]), columns))
            for k in np.flatnonzero(left < [best[k].left if k in best else known[k] for k in range(len(columns))]):
                best[int(k)] = ByLink(int(k), (x, y), body, float(left[k]))
    return [best[k] for k in sorted(best)]
