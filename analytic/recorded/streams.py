"""Any number of positions and machines in flat memory: blocks of samples are handed to reductions and forgotten."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenes import Scene, Status
from scenes.arguments import finite_numbers, one_number, refuse, scene_of, whole_number
from scenes.model.motion import Samples

from .arithmetics.in_numpy import BLOCK, blocks
from .fast import machine_line
from .many import many_solver, told

MAX_MACHINES = 10**9  # of one reduction, which has some numbers of each


@dataclass(frozen=True)
class Grid:
    """Positions of the drive at equal steps, both ends included, that are made where they are needed, rad or m."""

    first: float
    last: float
    count: int

    def __post_init__(self) -> None:
        finite_numbers("first", one_number("first", self.first))
        finite_numbers("last", one_number("last", self.last))
        whole_number("count", self.count)

    @property
    def shape(self) -> tuple[int]:
        """Return the shape that the array of all would have."""
        return (self.count,)

    def __getitem__(self, place: slice) -> Samples:
        """Return the positions of a slice, shape (columns,)."""
        numbers = np.arange(*place.indices(self.count), dtype=np.float64)
        return self.first + numbers * ((self.last - self.first) / max(self.count - 1, 1))


class Reduction(Protocol):
    """What is kept of samples; blocks come in the order of machines, and for these in the order of positions."""

    channel: str

    def take(self, rows: slice, position: Samples, samples: Samples) -> None:
        """Take a block: some machines, positions of shape (columns,) or (rows, columns), samples (rows, columns)."""


def _channel(name: object) -> str:
    return name if isinstance(name, str) else refuse("channel", "a name, as 'P5.y'", name)


class Extremes:
    """Each machine's least and largest sample, and the drive's positions there: shape (machines,) each."""

    def __init__(self, channel: str, machines: int = 1) -> None:
        self.channel, machines = _channel(channel), whole_number("machines", machines, most=MAX_MACHINES)
        self.least, self.largest = np.full(machines, np.inf), np.full(machines, -np.inf)
        self.least_at, self.largest_at = np.full((2, machines), np.nan)

    def take(self, rows: slice, position: Samples, samples: Samples) -> None:
        """Take a block, in which what is not a number is passed over."""
        positions = np.broadcast_to(position, samples.shape)
        for sign, best, where in ((-1, self.least, self.least_at), (1, self.largest, self.largest_at)):
            column = np.where(np.isnan(samples), -np.inf, sign * samples).argmax(axis=1)[:, None]
            extreme, place = (np.take_along_axis(values, column, 1)[:, 0] for values in (samples, positions))
            better = sign * extreme > sign * best[rows]
            best[rows], where[rows] = np.where(better, (extreme, place), (best[rows], where[rows]))


class Integral:
    """Each machine's integral over the drive's position by the trapezoidal rule, shape (machines,)."""

    def __init__(self, channel: str, machines: int = 1) -> None:
        self.channel = _channel(channel)
        self.total = np.zeros(whole_number("machines", machines, most=MAX_MACHINES))
        self._last: tuple[slice, Samples, Samples] | None = None

    def take(self, rows: slice, position: Samples, samples: Samples) -> None:
        """Take a block, and the step to it from the block before."""
        positions = np.broadcast_to(position, samples.shape)
        # Blocks are cut between samples: the trapezoid from the last sample of the block before belongs to this one.
        if self._last is not None and self._last[0] == rows:
            positions = np.concatenate([self._last[1], positions], axis=1)
            samples = np.concatenate([self._last[2], samples], axis=1)
        self.total[rows] += (np.diff(positions) * (samples[:, 1:] + samples[:, :-1]) / 2).sum(axis=1)
        self._last = rows, positions[:, -1:], samples[:, -1:]


class Histogram:
    """How many samples of all machines are between edges, shape (edges - 1,)."""

    def __init__(self, channel: str, edges: ArrayLike) -> None:
        self.channel, self.edges = _channel(channel), finite_numbers("edges", edges)
        if self.edges.ndim != 1 or len(self.edges) < 2 or not (np.diff(self.edges) >= 0).all():
            refuse("edges", "two numbers or more, from the least to the largest", edges)
        self.counts: NDArray[np.intp] = np.zeros(len(self.edges) - 1, np.intp)

    def take(self, rows: slice, position: Samples, samples: Samples) -> None:  # noqa: ARG002 - wherever they are
        """Take a block, in which what is not a number is passed over."""
        self.counts += np.histogram(samples[np.isfinite(samples)], self.edges)[0]


def reduce_many(
    scene: Scene,
    changes: Mapping[str, ArrayLike],
    position: ArrayLike | Grid,
    reductions: Sequence[Reduction],
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Sequence[Status], Sequence[str]]:
    """Solve as `solve_many` does, and keep of the samples what reductions take of them.

    Args:
        scene: the mechanism; its drive has a constant speed.
        changes: as of `solve_many`; none for the one machine of the scene.
        position: as of `solve_many`, or a grid of positions.
        reductions: each takes the blocks of its channel.
        progress: called with how many samples, machines times positions, are done, and of how many.

    Returns:
        The status of each machine, and the first thing that stops it, as of `solve_many`.

    Raises:
        Failure: as of `solve_many`.
        InputError: as of `solve_many`.
    """
    several = reductions if isinstance(reductions, Sequence) else [None]
    if not all(isinstance(getattr(reduction, "channel", None), str) for reduction in several):
        refuse("reductions", "several, as [Extremes(...)]", reductions)
    positions = position if isinstance(position, Grid) else np.atleast_1d(finite_numbers("position", position))
    n, channels = positions.shape[-1], frozenset(reduction.channel for reduction in reductions)
    machines = max((np.size(values) for values in changes.values()), default=1) if isinstance(changes, Mapping) else 1
    many = many_solver(scene, changes, channels, machine_line(scene_of(scene), channels, machines * n))
    for reduction in reductions:
        kept = next((len(values) for values in vars(reduction).values() if isinstance(values, np.ndarray)), many.count)
        if isinstance(reduction, Extremes | Integral) and kept != many.count:
            refuse("reductions", f"{type(reduction).__name__}({reduction.channel!r}, {many.count})", kept)
    many = many.between(np.array([positions.first, positions.last]) if isinstance(positions, Grid) else positions)
    failed, done = dict(many.failed), 0
    for rows, columns in blocks(many.count, n, 2 * BLOCK):
        places = positions[rows, columns] if len(positions.shape) == 2 else positions[columns]
        samples = many.block(rows, places, None, failed)
        for reduction in reductions:
            reduction.take(rows, places, samples[reduction.channel])
        done += (rows.stop - rows.start) * (columns.stop - columns.start)
        if progress is not None:
            progress(done, many.count * n)
    return told(failed, many.count)
