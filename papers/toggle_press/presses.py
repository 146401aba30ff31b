"""The toggle press and the crank press over a turn of their cranks, seen from the slider's lowest point."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import tau

import numpy as np

from compare.engines import registry
from scenes import Sampling, load
from scenes.model.motion import Samples

from .kinematics import LENGTHS

TURN = Sampling(3600)
STEP = tau / TURN.samples
PATHS = (
    "bodies.crank.points.P2.0",
    "bodies.rocker.lengths.O-P3",
    "bodies.toggle.lengths.P2-P3",
    "bodies.toggle.lengths.P3-P4",
    "bodies.toggle.lengths.P2-P4",
    "bodies.rod.lengths.P4-P5",
)  # of the toggle press's lengths in its scene file
ROUNDING = 0.5  # mm: they are printed without decimals
PART = 0.01  # by which one length of a member of the family is longer or shorter
DWELLING = 0.01  # of the stroke: so near to its lowest point the slider dwells


@dataclass(frozen=True)
class Side:
    """One side of the lowest point, up to the highest; shape (n,)."""

    angle: Samples  # of the crank from where the slider is lowest, rad, increasing from zero
    height: Samples  # m, increasing from zero
    rate: Samples  # magnitude of the height's rate by the crank's angle, m/rad

    def at(self, height: float) -> tuple[float, float]:
        """Return angle, rad, and rate, m/rad, at a height, m."""
        return float(np.interp(height, self.height, self.angle)), float(np.interp(height, self.height, self.rate))


@dataclass(frozen=True)
class Press:
    """A press by the angle of its crank, counter-clockwise: before and after its slider is lowest."""

    before: Side
    after: Side

    @property
    def stroke(self) -> float:
        """The stroke, m."""
        return float(self.after.height[-1])

    @property
    def dwell(self) -> float:
        """Return for what part of a turn the slider is near its lowest point."""
        near = DWELLING * self.stroke
        return (self.before.at(near)[0] + self.after.at(near)[0]) / tau

    @property
    def closing(self) -> Mapping[str, Side]:
        """The side on which the slider closes, by the direction in which the crank turns if they differ."""
        if abs(self.after.angle[-1] - self.before.angle[-1]) < STEP / 2:
            return {"": self.after}
        return {"clockwise": self.after, "counter-clockwise": self.before}


def press(name: str, changes: Mapping[str, float] | None = None) -> Press:
    """One turn of a press by the reference; Failure where it cannot be assembled over the whole turn."""
    scene = load(name, changes or {})
    y, vy = f"{scene.output}.y", f"{scene.output}.vy"
    solve = registry.reference(scene, frozenset((y, vy)))
    coarse = solve(TURN.commanded(scene), TURN.times(scene))
    near = 1 + int(coarse[y][1:-1].argmin())
    curvature = np.diff(coarse[vy][near - 1 : near + 2]).mean()
    lowest = coarse["crank_angle"][near] - coarse[vy][near] / curvature * STEP
    motion = solve(lowest + STEP * np.arange(TURN.samples), TURN.times(scene)[:-1])
    height, rate = motion[y] - motion[y][0], np.abs(motion[vy]) / scene.drive.peak_rate
    highest = int(height.argmax())
    after, before = np.arange(highest + 1), -np.arange(TURN.samples - highest + 1)
    return Press(*(Side(STEP * np.abs(rows), height[rows], rate[rows]) for rows in (before, after)))


def rounded() -> list[Press]:
    """The toggle press as printed, and with its lengths at the ends of their rounding, in all combinations."""
    ends = product(*((length - ROUNDING, length + ROUNDING) for length in LENGTHS))
    return [press("toggle_press", dict(zip(PATHS, lengths, strict=True))) for lengths in (LENGTHS, *ends)]


def family() -> Iterator[tuple[str, Press]]:
    """The toggle press with one length after the other changed, and what was changed."""
    for path, length, digit in zip(PATHS, LENGTHS, "₀₁₂₃₄₅", strict=True):
        for part in (1 - PART, 1 + PART):
            yield f"l{digit} = {part * length:g} mm", press("toggle_press", {path: part * length})
