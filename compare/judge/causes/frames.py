"""Causes that all of a result shares, as where it was computed in another frame and other units, and read as it is.

The factor f, the angle α and the place b of `compare.results.frame` are fitted together; a frame that is not turned,
not shifted, or of the same unit needs fewer of them.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from scenes.model.motion import quantity
from scenes.scene import ConstantSpeed

from ...results.frame import KNOWN, LENGTHS, Frame, seen, unit_near
from .cause import Cause, Kind, Way
from .evidence import Evidence, Hypothesis
from .parts import Part

KNOWN_FRAME = 1e-4  # relative: what is fitted and is this near to nothing at all, or to a known unit, is taken for it
LEAST = 1e-9  # relative: less is rounding
RATES = {"vx": 1, "vy": 1, "omega": 1, "ax": 2, "ay": 2, "alpha": 2}  # derivatives by the time
ANGLES = (("deg", "rad"), ("rad", "deg"))


def frame_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield other frames and units of all of a result, rates by the crank's angle, and that angle in another unit."""
    if any(quantity(channel) in ("x", "y", "vx", "vy") for channel in evidence.names):
        yield from _frame(evidence, mirrored=False)
        yield from _frame(evidence, mirrored=True)
    scene = evidence.reference.scene
    if not isinstance(scene.drive, ConstantSpeed) or scene.driven_slide is not None:
        return
    for unit, name in (("rad", "radian"), ("deg", "degree")):
        rates = {
            c: (KNOWN["rad"][unit] / scene.drive.speed) ** order
            for c in evidence.names
            if (order := RATES.get(quantity(c)))
        }
        cause = Cause(Kind.unit, "all", Way.by_angle, names=(name,))
        yield Hypothesis(cause, {c: factor * evidence.true[c] for c, factor in rates.items()})
    position = evidence.true[scene.drive_channel]
    for unit, other in ANGLES:
        size = KNOWN["rad"][unit] / KNOWN["rad"][other]
        there = evidence.reference.at(size * position, evidence.true["time"])
        cause = Cause(Kind.unit, "drive", Way.axis_unit, names=(unit, other))
        yield Hypothesis(cause, {c: there[c] for c in evidence.names if c != scene.drive_channel})


def _frame(evidence: Evidence, *, mirrored: bool) -> Iterator[Hypothesis]:
    """Yield the frame and unit of length that are nearest, in as few numbers as explain them."""
    a, b = _fitted(evidence, mirrored=mirrored)
    if not abs(a) > LEAST:
        return
    unit, _ = unit_near(abs(a), "m", KNOWN_FRAME)
    factor = 1 / LENGTHS[unit] if unit else abs(a)
    angle = float(np.angle(a))
    angle = 0.0 if abs(angle) <= KNOWN_FRAME else angle
    b = 0j if abs(b) <= KNOWN_FRAME * evidence.reference.stroke * factor else b
    if not unit and (angle or b):
        return  # four numbers that are fitted explain much of anything
    causes = []
    if mirrored or angle or b:
        origin = -b / (factor * np.exp(1j * angle))
        origin = origin.conjugate() if mirrored else origin
        amounts = (float(mirrored), angle if mirrored else -angle, origin.real, origin.imag)
        causes.append(Cause(Kind.frame, "all", Way.frame, amounts))
    if unit != "m":
        all_lengths = Part("all lengths", evidence.names, many=True)
        way = Way.lengths_unit if unit else Way.lengths_factor
        causes.append(Cause(Kind.unit, "all", way, (factor,), (unit, "m"), all_lengths))
    if causes:
        other = seen(Frame(angle, b, mirrored, factor), {c: evidence.true[c] for c in evidence.names})
        drive = evidence.reference.scene.drive_channel
        predicted = {c: own for c, own in other.items() if c != drive or evidence.off[drive] > LEAST}
        freedom = bool(angle) + 2 * bool(b) + (not unit)
        yield Hypothesis(replace(causes[0], besides=tuple(causes[1:])), predicted, freedom)


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
