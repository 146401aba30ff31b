"""What a model proves between the samples: enclosures of extremes over the whole range of the drive."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple


class Enclosure(NamedTuple):
    """The least or the most that a channel, or a magnitude, ever is, SI: between `low` and `high`."""

    channel: str
    extreme: str  # least or most
    low: float
    high: float
    position_low: float  # of the drive, rad or m, or the instant, s, under a motion law: where it is, or first is
    position_high: float


@dataclass(frozen=True)
class Enclosures:
    """What is proven over one cycle of the drive."""

    rows: Sequence[Enclosure]  # none where the linkage is not shown to assemble all the way
    open_at: tuple[float, float] | None  # the first part of the range where that is not shown
