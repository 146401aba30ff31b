"""A proposed mapping as TOML, and the units that it may name."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from json import dumps
from math import pi

import numpy as np

from scenes import Scene
from scenes.motion import UNITS, Samples, channels, quantity

NEAR = 2e-3  # relative: places of one origin
SURE = 1e-3  # of a column: what its channel leaves at most, and ten times less than any other
LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
ANGLES = {"rad": 1.0, "deg": pi / 180}
FORCES = {"N": 1.0, "kN": 1e3, "lbf": 4.4482216152605}
KNOWN = {
    "m": LENGTHS,
    "m/s": {f"{name}/s": size for name, size in LENGTHS.items()},
    "m/s^2": {f"{name}/s^2": size for name, size in LENGTHS.items()},
    "rad": ANGLES,
    "rad/s": {"rad/s": 1.0, "deg/s": pi / 180, "rpm": pi / 30},
    "rad/s^2": {"rad/s^2": 1.0, "deg/s^2": pi / 180},
    "N": FORCES,
    "N*m": {f"{f}*{m}": a * b for (f, a), (m, b) in product(FORCES.items(), [*LENGTHS.items()][:2])},
    "s": {"s": 1.0, "ms": 1e-3},
}


@dataclass(frozen=True)
class Axis:
    """A column that may be the time, or the crank's angle, in a unit."""

    channel: str
    column: str
    unit: str
    time: Samples  # s, but for a lag


@dataclass(frozen=True)
class Pair:
    """A column and the channel that it may be."""

    channel: str
    column: int
    left: float  # of the column
    unit: str
    sign: int
    zero: float  # of the column, in its unit


def as_toml(
    scene: Scene,
    axis: Axis,
    lag: float,
    names: Sequence[str],
    pairs: Sequence[Pair],
    seconds: Mapping[int, float],
    frame: tuple[float, bool],
) -> Iterator[str]:
    """Yield the lines of a mapping, each with a remark on how sure it is.

    Args:
        scene: the linkage.
        axis: what the rows are by.
        lag: at which the table begins, s.
        names: of the columns.
        pairs: of columns and channels.
        seconds: by column what the next best channel leaves of it.
        frame: the angle of the table's, rad, and whether it is mirrored.
    """
    turn, mirrored = frame
    yield "# Proposed from the columns alone; every line is to be confirmed."
    origin = _origin(pairs)
    at = complex(*(-o for o in origin)) if origin else 0j
    at = (at.conjugate() if mirrored else at) * np.exp(1j * turn)
    if turn or mirrored or at:
        place = f"origin = [{at.real:.9g}, {at.imag:.9g}], angle = {turn:.9g}"
        yield f"frame = {{ {place}, mirrored = {str(mirrored).lower()} }}"
    yield "[columns]"
    zero = (
        -lag / KNOWN["s"].get(axis.unit, 1.0)
        if axis.channel == "time"
        else lag * scene.drive.at(0.0).rate / -ANGLES[axis.unit]
    )
    yield _line(axis.channel, axis.column, axis.unit, 1, float(zero), "s" if axis.channel == "time" else "rad")
    for pair in sorted(pairs, key=lambda pair: channels(scene).index(pair.channel)):
        kind = quantity(pair.channel)
        free = (origin and kind in ("x", "y")) or kind == "angle"
        sure = pair.left <= SURE and pair.unit and 10 * pair.left <= seconds[pair.column]
        remark = (
            f"{'sure' if sure else 'unsure'}: leaves {pair.left:.0e}, the next best channel {seconds[pair.column]:.0e}"
        )
        remark += "" if pair.unit else "; its unit is unknown"
        line = _line(pair.channel, names[pair.column], pair.unit, pair.sign, 0.0 if free else pair.zero, UNITS[kind])
        yield f"{line}  # {remark}"
    left_over = {*range(len(names))} - {pair.column for pair in pairs}
    if left_over:
        yield f"# Fits no channel: {', '.join(names[k] for k in sorted(left_over))}"


def _line(channel: str, column: str, unit: str, sign: int, zero: float, si: str) -> str:
    """Return a line of the mapping."""
    more = [f"unit = {dumps(unit)}"] * bool(unit and unit != si) + [f"sign = {sign}"] * (sign < 0)
    more += [f"zero = {zero:.9g}"] * bool(zero)
    name = dumps(column, ensure_ascii=False)
    return f"{dumps(channel)} = " + (f"{{ {', '.join([f'column = {name}', *more])} }}" if more else name)


def _origin(pairs: Sequence[Pair]) -> tuple[float, float] | None:
    """Return the zeros that all places have in common, m, or None where they have not."""
    zeros = {q: [p.sign * p.zero * LENGTHS.get(p.unit, 1.0) for p in pairs if quantity(p.channel) == q] for q in "xy"}
    if not all(zeros.values()) or any(np.ptp(own) > NEAR * max(1e-3, np.abs(own).max()) for own in zeros.values()):
        return None
    return float(np.median(zeros["x"])), float(np.median(zeros["y"]))
