"""Frames and units in which another program may have its numbers, and how this project's channels are seen from there.

With z the places of this project, as complex numbers, those of another frame and another unit of length are

    g = a z + b    or, mirrored,    g = a z* + b,    a = f e^(iα),

rates without b, forces by e^(iα) alone; what turns has the opposite sign where the frame is mirrored.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from math import pi
from typing import NamedTuple

import numpy as np

from scenes.channels import Channels, Role
from scenes.model.motion import Samples

LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254, "ft": 0.3048}
OF_ANGLES = {"rad": 1.0, "deg": pi / 180}
FORCES = {"N": 1.0, "kN": 1e3, "lbf": 4.4482216152605, "kgf": 9.80665}
KNOWN = {
    "m": LENGTHS,
    "m/s": {f"{name}/s": size for name, size in LENGTHS.items()},
    "m/s^2": {f"{name}/s^2": size for name, size in LENGTHS.items()},
    "rad": OF_ANGLES,
    "rad/s": {"rad/s": 1.0, "deg/s": pi / 180, "rpm": pi / 30},
    "rad/s^2": {"rad/s^2": 1.0, "deg/s^2": pi / 180},
    "N": FORCES,
    "W": {"W": 1.0, "kW": 1e3},
    "N*m": {f"{f}*{m}": a * b for (f, a), (m, b) in product(FORCES.items(), [*LENGTHS.items()][:2])},
    "s": {"s": 1.0, "ms": 1e-3},
}


class Frame(NamedTuple):
    """Another frame: how far its places are turned, rad, and shifted, after the mirroring and the unit of length."""

    angle: float = 0.0
    origin: complex = 0j  # what a place at zero reads
    mirrored: bool = False
    factor: float = 1.0
    relative: bool = False  # whether the drive's angle is between two bodies, which turn alike


def seen(channels: Channels, frame: Frame, samples: Mapping[str, Samples]) -> dict[str, Samples]:
    """Return channels as seen from another frame; a component without its other one is that of a vector along it."""
    way, turn, other = -1 if frame.mirrored else 1, np.exp(1j * frame.angle), dict(samples)
    for name, values in samples.items():
        channel = channels[name]
        is_moment = channel.role is Role.force and channel.unit == "N*m"
        if channel.is_angle:
            other[name] = way * values + (0.0 if frame.relative and channel.role is Role.input else frame.angle)
        elif is_moment or channel.kind == "body" or (channel.role is Role.force and channel.kind == "guide"):
            other[name] = way * values * (frame.factor if is_moment else 1.0)  # its sign is that of a turning
    for x, y in vectors(channels, samples):
        zero = 0 * samples[x if x in samples else y]
        # x - iy is the mirrored vector, x + iy the vector itself: `way` is the sign of y.
        vector = turn * (samples.get(x, zero) + way * 1j * samples.get(y, zero))
        if not channels[x].is_force:
            vector = frame.factor * vector + (frame.origin if channels[x].order == 0 else 0)
        other |= {c: part for c, part in ((x, vector.real), (y, vector.imag)) if c in samples}
    return other


def vectors(channels: Channels, names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the two components of each vector of which there is one at least."""
    rows = (channels[name] for name in names)
    yield from dict.fromkeys((x, y) for row in rows if row.axis for x, y in (row.components,))


def unit_near(factor: float, si: str, hair: float) -> str:
    """Return the known unit whose numbers are so many times those in SI, within a hair; empty where there is none."""
    near = {unit: abs(1 / (abs(factor) * size) - 1) if factor else np.inf for unit, size in KNOWN[si].items()}
    unit = min(near, key=near.__getitem__)
    return unit if near[unit] <= hair else ""
