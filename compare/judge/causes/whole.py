"""Causes that all of a result shares, as where it was computed in another frame and other units, and read as it is.

With z the places of the reference, as complex numbers, those of another frame and another unit of length are

    g = a z + b    or, mirrored,    g = a z* + b,    a = f e^(iα),

rates without b, forces by e^(iα) alone. The factor f, the angle α and the place b are fitted together; a frame that is
not turned, not shifted, or of the same unit needs fewer of them.
"""

from collections.abc import Iterator
from math import pi

import numpy as np

from scenes.motion import Samples, quantity
from scenes.scene import ConstantSpeed

from .evidence import Channels, Evidence, Hypothesis, Kind
from .parts import in_words

NEAR = 1e-4  # relative: what is fitted and is this near to nothing at all, or to a known unit, is taken for it
LENGTHS = {1e3: "millimetres", 1e2: "centimetres", 1 / 0.0254: "inches", 1 / 0.3048: "feet"}  # in place of metres
LEAST = 1e-9  # relative: less is rounding
MOMENTS = ("guide_moment", "torque")
TURNING = ("omega", "alpha", "guide_force", *MOMENTS)
RATES = {"vx": 1, "vy": 1, "omega": 1, "ax": 2, "ay": 2, "alpha": 2}  # derivatives by the time


def whole_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield other frames and units of all of a result, rates by the crank's angle, and that angle in another unit."""
    if any(quantity(channel) in ("x", "y", "vx", "vy") for channel in evidence.names):
        yield from _frame(evidence, mirrored=False)
        yield from _frame(evidence, mirrored=True)
    drive = evidence.reference.scene.drive
    if isinstance(drive, ConstantSpeed) and evidence.reference.scene.driven_slide is None:
        yield from _axis(evidence)
        for unit, size in (("radian", 1.0), ("degree", pi / 180)):
            by = {c: (size / drive.speed) ** RATES[quantity(c)] for c in evidence.names if quantity(c) in RATES}
            predicted = {c: factor * evidence.true[c] for c, factor in by.items()}
            sentence = f"all rates are by the crank's angle, per {unit}, in place of the time"
            yield Hypothesis(Kind.unit, "all", f"per {unit}", sentence, predicted)


def _axis(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield the crank's angle in another unit, where rows are by it, so that all is of other positions."""
    position = evidence.true[evidence.reference.scene.drive_channel]
    for unit, name in ((pi / 180, "degrees in place of radians"), (180 / pi, "radians in place of degrees")):
        there = evidence.reference.at(unit * position, evidence.true["time"])
        predicted = {c: there[c] for c in evidence.names if quantity(c) != "crank_angle"}
        yield Hypothesis(Kind.unit, "drive", name, f"the crank's angle, by which the rows are, is in {name}", predicted)


def _frame(evidence: Evidence, *, mirrored: bool) -> Iterator[Hypothesis]:
    """Yield the frame and unit of length that are nearest, in as few numbers as explain them."""
    a, b = _fitted(evidence, mirrored=mirrored)
    if not abs(a) > LEAST:
        return
    factor, angle = abs(a), float(np.angle(a))
    scene, size = evidence.reference.scene, evidence.reference.stroke
    known = next((f for f in (1.0, *LENGTHS) if abs(factor / f - 1) <= NEAR), factor)
    angle = 0.0 if abs(angle) <= NEAR else angle
    b = 0j if abs(b) <= NEAR * size * factor else b
    size_is_odd = known not in (1.0, *LENGTHS)
    if size_is_odd and (angle or b):
        return  # four numbers that are fitted explain much of anything
    parts = ["mirrored"] * mirrored
    parts += [f"turned by {scene.amount('angle', angle if mirrored else -angle)}"] * bool(angle)
    if b:
        origin = -b / (known * np.exp(1j * angle))
        origin = origin.conjugate() if mirrored else origin
        parts += [f"with its origin at ({scene.length(origin.real, 3)}, {scene.length(origin.imag, 3)})"]
    sentences = [f"all is in another frame, {', '.join(parts)}"] * bool(parts)
    unit = f"in {LENGTHS[known]} in place of metres" if known in LENGTHS else in_words(known, "they")[1]
    sentences += [f"all lengths are {unit}"] * (known != 1)
    if sentences:
        kind = Kind.frame if parts else Kind.unit
        freedom = bool(angle) + 2 * bool(b) + size_is_odd
        predicted = _seen(evidence, known, angle, b, mirrored=mirrored)
        yield Hypothesis(kind, "all", ", ".join(parts) or unit, " and ".join(sentences), predicted, freedom)


def _fitted(evidence: Evidence, *, mirrored: bool) -> tuple[complex, complex]:
    """Return a and b of least squares, over the places and velocities that there are."""
    left, right = np.zeros((2, 2), np.complex128), np.zeros(2, np.complex128)
    for x in evidence.names:
        y = f"{x[:-1]}y"
        if quantity(x) not in ("x", "vx") or y not in evidence.names:
            continue
        true, given = (of[x] + 1j * of[y] for of in (evidence.true, evidence.given))
        true = true.conj() if mirrored else true
        columns = np.array([true, np.full(true.shape, float(quantity(x) == "x"))]) / evidence.scale[x]
        left += columns.conj() @ columns.T
        right += columns.conj() @ (given / evidence.scale[x])
    a, b = np.linalg.lstsq(left, right, rcond=1e-12)[0]
    return complex(a), complex(b)


def _seen(evidence: Evidence, factor: float, angle: float, b: complex, *, mirrored: bool) -> Channels:
    """Return the motion as seen from another frame, in another unit of length."""
    way, turn = (-1 if mirrored else 1), np.exp(1j * angle)
    seen: dict[str, Samples] = {}
    for channel in evidence.names:
        kind, own = quantity(channel), evidence.true[channel]
        if kind == "angle" or (kind == "crank_angle" and evidence.off[channel] > LEAST):
            seen[channel] = way * own + angle
        elif kind in TURNING:
            seen[channel] = way * own * (factor if kind in MOMENTS else 1.0)
        elif kind[-1] == "x":
            vector = own + 1j * evidence.true[f"{channel[:-1]}y"]
            vector = turn * (vector.conj() if mirrored else vector)
            vector = vector if kind == "fx" else factor * vector + (b if kind == "x" else 0)
            seen |= {channel: vector.real, f"{channel[:-1]}y": vector.imag}
    return {channel: values for channel, values in seen.items() if channel in evidence.names}
