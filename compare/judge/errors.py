"""How far an engine is from the reference, channel by channel.

The reference is evaluated at the engine's own instants, both at the position of the drive that the engine really had
and at the one commanded: the difference between the two errors is the drive's, not the linkage's. The engine is never
interpolated.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenes import Inputs, Motion, Rows, Scene
from scenes.model.motion import Samples

from ..engines.registry import REFERENCE
from ..engines.runner import INSTANT_TOL
from ..mechanics.mechanics import SHOWN_GROUPS
from ..mechanics.reference import Reference
from ..mechanics.round_off import Explained

TOGGLE_WINDOW = 0.02  # of the peak of |dx/dq|, q the drive's position, below which the output nearly stands still


class ChannelError(NamedTuple):
    """The errors of an engine in one channel, relative; none is below the reference's floor."""

    engine: str
    channel: str
    group: str
    max: float
    unexplained: float  # the largest where it is above what doubles explain, if that is known
    rms: float
    last_turn_max: float
    toggle_max: float  # where the output nearly stands still
    commanded_max: float  # against the position asked for
    commanded_rms: float
    explained: float  # the largest that doubles explain
    max_at: float
    max_at_unit: str
    floor: float
    scale: float
    unit: str


@dataclass(frozen=True)
class Comparison:
    """One engine's errors: relative, by channel, each of shape (n,)."""

    actual: Mapping[str, Samples]  # against the reference at the drive's position that the engine had; but the drive
    commanded: Mapping[str, Samples]  # against the reference at the position asked for
    position: Samples  # of the drive, rad or m, commanded
    axis: Samples  # where the samples are on the axis of tables and curves
    toggle: NDArray[np.bool_]  # where the output nearly stands still
    last_turn: NDArray[np.bool_]


def compare(reference: Reference, sampling: Rows, motion: Motion) -> Comparison:
    """One engine's motion against the reference at its own instants; a `Failure` where its drive has no reference."""
    scene = reference.scene
    commanded, position = reference.at(sampling.inputs(scene)), scene.channels.drive.position
    slope = _slope(reference, commanded)
    actual = reference.at(motion.inputs(scene))
    # Errors twice, at the commanded and at the actual position of the drive: their difference is what the drive's lag
    # does. On a press force's switch both have the same choice.
    may = reference.acts(commanded, actual)  # a drive that lags must not decide on which side of a switch it is
    by_command, errors = (reference.errors(motion, true, may) for true in (commanded, actual))
    return Comparison(
        errors | {position: by_command[position]},
        by_command,
        commanded[position],
        reference.mechanics.axis.of(commanded),
        slope < TOGGLE_WINDOW * slope.max(),
        commanded["time"] >= commanded["time"][-1] - (1 + INSTANT_TOL) * scene.cycle,
    )


def _slope(reference: Reference, motion: Motion) -> Samples:
    """|dx/dq| of the output point over the drive's position q, but for a constant factor: its speed at a steady one."""
    scene = reference.scene
    if not scene.steady:  # a law's rests are no toggles
        position, solve = motion[scene.channels.drive.position], reference.steadily
        motion = solve(Inputs(motion["time"], (position[:, np.newaxis], np.ones(1), np.zeros(1))))
    return np.hypot(*(motion[name] for name in scene.channels.points[scene.output].velocity))


def shown_groups(scene: Scene) -> tuple[str, ...]:
    """The groups that a scene has channels of, in the order of the tables; the drive has a torque or a force."""
    known = {scene.channels[name].group for name in scene.channels.names()}
    return tuple(group for group in SHOWN_GROUPS if group in known)


def group_floors(reference: Reference) -> dict[str, float]:
    """The reference's floor by channel group: the largest of its channels."""
    floors: dict[str, float] = {}
    for channel, floor in reference.floor.by_channel.items():
        group = reference.mechanics.groups[channel]
        floors[group] = max(floors.get(group, 0.0), floor)
    return floors


def error_table(
    engine: str, comparison: Comparison, reference: Reference, explained: Explained | None = None
) -> Iterator[ChannelError]:
    """Yield a row a channel; no error is shown below the reference's floor, or for the reference without one."""
    known = comparison.actual if explained is None else explained.left_over(comparison.actual)
    least = np.nan if engine == REFERENCE else 0.0  # where there is no floor: the reference agrees with itself
    last_turn, toggle = comparison.last_turn, np.flatnonzero(comparison.toggle)
    mechanics, named = reference.mechanics, [*comparison.actual]
    floors = np.array([reference.floor.by_channel.get(channel, np.nan) for channel in named])
    worst = {channel: int(error.argmax()) for channel, error in comparison.actual.items()}
    figures = {
        "max": [error[worst[channel]] for channel, error in comparison.actual.items()],
        "unexplained": [_largest(known[channel]) for channel in named],
        "rms": [*map(_rms, comparison.actual.values())],
        "last_turn_max": [_largest(error[last_turn]) for error in comparison.actual.values()],
        "toggle_max": [_largest(error[toggle]) if toggle.size else np.nan for error in comparison.actual.values()],
        "commanded_max": [_largest(comparison.commanded[channel]) for channel in named],
        "commanded_rms": [_rms(comparison.commanded[channel]) for channel in named],
    }
    # The floor is applied to all figures at once, shape (figures, channels); the reference's own row without a floor
    # has NaN.
    shown = np.maximum([*figures.values()], np.where(floors >= 0, floors, least)).T.tolist()
    for channel, floor, row in zip(named, floors.tolist(), shown, strict=True):
        yield ChannelError(
            engine=engine,
            channel=channel,
            group=mechanics.groups[channel],
            **dict(zip(figures, row, strict=True)),
            explained=np.nan if explained is None else explained.largest_errors[channel],
            max_at=float(comparison.axis[worst[channel]]),
            max_at_unit=mechanics.axis.unit,
            floor=floor,
            scale=reference.scale[channel],
            unit=mechanics.units[channel],
        )


def worst_of(rows: Sequence[ChannelError], figure: str = "max") -> ChannelError:
    """The row with the largest of a figure; a NaN counts as the largest."""
    return rows[int(np.argmax([getattr(row, figure) for row in rows]))]


def by_group(rows: Iterable[ChannelError]) -> dict[str, list[ChannelError]]:
    """Rows by their channel groups."""
    groups: dict[str, list[ChannelError]] = {}
    for row in rows:
        groups.setdefault(row.group, []).append(row)
    return groups


def _largest(error: Samples) -> float:
    return float(error[error.argmax()])  # a NaN is the largest; a tenth of the time that `max` takes


def _rms(error: Samples) -> float:
    return sqrt(error @ error / len(error))
