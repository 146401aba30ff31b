"""A proposed mapping as TOML, and the units that it may name."""

from collections.abc import Iterator, Sequence
from json import dumps
from typing import NamedTuple

import numpy as np

from scenes import Scene
from scenes.channels import Channels
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples

from .frame import KNOWN, LENGTHS, OF_ANGLES
from .moving_axes import ByLink

SAME_ZERO_TOL = 2e-3  # relative: places of one origin
SURE_TOL = 1e-3  # of a column: what its channel leaves at most
NOISE_TOL = 1e-6  # of a column: what is left of it by rounding is less, and shows nothing
MIN_RATIO_OF_READINGS = 10  # of what is left by readings that a column tells apart
NO_ROWS = np.zeros(0)


class Axis(NamedTuple):
    """A column that may be the time, or the crank's angle, in a unit."""

    channel: str
    column: str
    unit: str
    time: Samples  # s, but for the lag
    lag: float = 0.0  # s
    left: Samples = NO_ROWS  # of each column's square, by the channels at these instants


class Pair(NamedTuple):
    """A column and the channel that it may be."""

    channel: str
    column: int
    left: float  # of the column
    unit: str
    sign: int
    zero: float  # of the column, in its unit
    second: float = 1.0  # what the next best channel leaves of it


def as_toml(
    scene: Scene,
    axis: Axis,
    names: Sequence[str],
    pairs: Sequence[Pair],
    frame: tuple[float, bool],
    by_link: Sequence[ByLink],
    *,
    alone: bool,
) -> Iterator[str]:
    """Yield the lines of a mapping, each with a remark on how sure it is.

    The rows are by `axis`, and can be of no other instants if `alone`; its frame is turned, rad, and mirrored or not.
    """
    turn, mirrored = frame
    yield "# Proposed from the columns alone; every line is to be confirmed."
    if not alone:
        yield "# Unsure throughout: at other instants, or in another frame, the channels fit these columns as well."
    origin = _origin(scene.channels, pairs)
    shift = complex(*(-o for o in origin)) if origin else 0j
    shift = (shift.conjugate() if mirrored else shift) * np.exp(1j * turn)
    if turn or mirrored or shift:
        place = f"origin = [{shift.real:.9g}, {shift.imag:.9g}], angle = {turn:.9g}"
        yield f"frame = {{ {place}, mirrored = {str(mirrored).lower()} }}"
    yield "[columns]"
    if axis.channel == "time":
        yield _line("time", axis.column, axis.unit, 1, -axis.lag / KNOWN["s"][axis.unit], "s")
    else:  # which the frame turns too
        zero = (turn - axis.lag * float(inputs_of(scene, 0.0).driven().rate)) / OF_ANGLES[axis.unit]
        yield _line(axis.channel, axis.column, axis.unit, -1 if mirrored else 1, zero, "rad")
    sure = {  # in a known unit, and far better than by the next best channel
        pair.channel
        for pair in pairs
        if alone
        and pair.unit
        and pair.left <= SURE_TOL
        and MIN_RATIO_OF_READINGS * max(pair.left, NOISE_TOL) <= pair.second
    }
    for pair in sorted(pairs, key=lambda pair: scene.channels.names().index(pair.channel)):
        channel = scene.channels[pair.channel]
        free = origin and channel.axis and channel.order == 0
        whole = not turn or {*(channel.components or (channel.name,))} <= sure
        is_sure = pair.channel in sure and whole  # a frame that is turned mixes both components
        remark = f"{'sure' if is_sure else 'unsure'}: leaves {pair.left:.0e}, the next best channel {pair.second:.0e}"
        remark += "" if pair.unit else "; its unit is unknown"
        line = _line(pair.channel, names[pair.column], pair.unit, pair.sign, 0.0 if free else pair.zero, channel.unit)
        yield f"{line}  # {remark}"
    for each in by_link:
        vectors = f"{', '.join(each.vector)} by the axes of {each.body}"
        yield f"# No mapping reads {names[each.column]}: it is of {vectors}, not the ground's; leaves {each.left:.0e}"
    left_over = {*range(len(names))} - {pair.column for pair in pairs} - {each.column for each in by_link}
    if left_over:
        yield f"# Fits no channel: {', '.join(names[k] for k in sorted(left_over))}"


def _line(channel: str, column: str, unit: str, sign: int, zero: float, si: str) -> str:
    more = [f"unit = {dumps(unit)}"] * bool(unit and unit != si) + [f"sign = {sign}"] * (sign < 0)
    more += [f"zero = {zero:.9g}"] * bool(zero)
    name = dumps(column, ensure_ascii=False)
    return f"{dumps(channel)} = " + (f"{{ {', '.join([f'column = {name}', *more])} }}" if more else name)


def _origin(channels: Channels, pairs: Sequence[Pair]) -> tuple[float, float] | None:
    """Return the zeros that all places have in common, m, or None where they have not."""
    zeros: dict[str, list[float]] = {"x": [], "y": []}
    for pair in pairs:
        channel = channels[pair.channel]
        if channel.axis and channel.order == 0:
            zeros[channel.axis].append(pair.sign * pair.zero * LENGTHS.get(pair.unit, 1.0))
    if not all(zeros.values()) or any(
        np.ptp(values) > SAME_ZERO_TOL * max(1e-3, np.abs(values).max()) for values in zeros.values()
    ):
        return None
    return float(np.median(zeros["x"])), float(np.median(zeros["y"]))
