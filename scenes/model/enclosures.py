"""What a model proves: enclosures of extremes over the whole range of the drive, and all assemblies at a position."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from .motion import Motion


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
    """What is proven over the cycles of a run.

    Where something goes on from cycle to cycle, as a table over the time, each cycle is looked at, up to a number of
    them; what does not is the same in every cycle.
    """

    rows: Sequence[Enclosure]  # none where the linkage is not shown to assemble all the way
    open_at: tuple[float, float] | None  # the first part of the range where that is not shown
    cycles: int | None = None  # from the start, of which forces are known; None where each cycle is like the first
    turns: int = 1  # cycles of the run
    why: str = ""  # what is open there, or why some of the extremes have no bound, in words


@dataclass(frozen=True)
class MotionRange:
    """How far a linkage goes that cannot run, and how it gets there."""

    motion: Motion  # poses of points and bodies, SI, from where it stops back over the way that it goes
    joint: str  # by which it stops there: of a pin its point, of a slide its slider; empty where none is known
    ways: Sequence[tuple[float, float]]  # between which positions of the drive, rad or m, it goes
    meets: bool = False  # whether that joint closes beyond it too, where another assembly meets this one


@dataclass(frozen=True)
class Assembly:
    """One way to put the bodies together at a position of the drive."""

    motion: Motion  # of one sample: where the points are, and the bodies' angles
    meant: bool  # whether it is the one that the sketch picks
    off_sketch: float  # m, how far the sketched points are from it, the root of the mean square
    circuit: int | None  # by number: those of one can be reached without taking it apart; None where that is not known
    meets: Sequence[tuple[float, str]]  # positions of the drive, rad or m, where it meets another, and at which joint


@dataclass(frozen=True)
class Assemblies:
    """All ways to put the bodies together at a position of the drive, the nearest to the sketch first."""

    position: float  # rad or m
    found: Sequence[Assembly]
    complete: bool  # whether it is proven that none is missed


class SketchFit(NamedTuple):
    """Where the drive is when the sketch fits a linkage best."""

    position: float  # rad or m
    there: Mapping[str, complex]  # where the linkage has each sketched point then, m
    here: Mapping[str, complex]  # the same where the sketch has the drive; NaN of what does not assemble there
