"""How far the crank can turn: where every group reaches, and what stops it at either end."""

from dataclasses import dataclass
from math import degrees, pi

import numpy as np

from scenes import Scene
from scenes.motion import Samples

from .decomposition import RRP, RRR, Decomposition
from .kinematics import kinematics

SAMPLES = 3600  # a turn: a gap or an interval narrower than this grid is missed
BISECTIONS = 50  # from 2 pi / SAMPLES down to the last place


@dataclass(frozen=True)
class Interval:
    """Crank angles between which the linkage assembles, rad, and the inner pin that locks at either end."""

    start: float
    end: float
    start_lock: str
    end_lock: str


def motion_range(scene: Scene, linkage: Decomposition) -> list[Interval]:
    """Return the intervals of one turn in which the linkage assembles; none when it never does or always does."""
    turn = scene.drive.start + np.linspace(0, 2 * pi, SAMPLES + 1)
    assembled = _locked_pin(scene, linkage, turn) == ""
    edges = np.flatnonzero(assembled[1:] != assembled[:-1])
    if not len(edges):
        return []
    inside = np.where(assembled[edges], turn[edges], turn[edges + 1])
    outside = np.where(assembled[edges], turn[edges + 1], turn[edges])
    for _ in range(BISECTIONS):
        middle = (inside + outside) / 2
        fits = _locked_pin(scene, linkage, middle) == ""
        inside, outside = np.where(fits, middle, inside), np.where(fits, outside, middle)
    locks = _locked_pin(scene, linkage, outside)
    # An edge that opens an interval is closed by the next; the last one closes round the turn.
    opening = [i for i in range(len(edges)) if not assembled[edges[i]]]
    return [
        Interval(
            float(inside[i]),
            float(inside[(i + 1) % len(edges)]) + (2 * pi if i + 1 == len(edges) else 0.0),
            str(locks[i]),
            str(locks[(i + 1) % len(edges)]),
        )
        for i in opening
    ]


def _locked_pin(scene: Scene, linkage: Decomposition, angle: Samples) -> np.ndarray[tuple[int], np.dtype[np.str_]]:
    """Return, for each angle, the inner pin of the first group that does not reach, or an empty text."""
    with np.errstate(invalid="ignore", divide="ignore"):
        reach = kinematics(scene, linkage, angle).reach
    pins = np.array(["", *reach])
    fails = np.array([~(r >= 0) for r in reach.values()])
    return pins[np.where(fails.any(axis=0), fails.argmax(axis=0) + 1, 0)]


def describe(scene: Scene, linkage: Decomposition) -> str:
    """Return in one sentence how far the crank turns, and what is in line where it stops."""
    intervals = motion_range(scene, linkage)
    if not intervals:
        return f"the linkage cannot be assembled with the {scene.drive.body} at any angle"
    said = [
        f"from {degrees(i.start):.4f} deg ({_lock(linkage, i.start_lock)}) to {degrees(i.end):.4f} deg"
        f" ({_lock(linkage, i.end_lock)})"
        for i in intervals
    ]
    return f"the {scene.drive.body} turns only " + " and ".join(said)


def _lock(linkage: Decomposition, pin: str) -> str:
    group = {group.P: group for group in linkage.groups}[pin]
    if isinstance(group, RRR):
        return f"{group.body_1} and {group.body_2} in line at {pin}"
    if isinstance(group, RRP):
        return f"{group.bar} square to the guide of {group.slider}"
    return f"{', '.join(group.bodies)} locked"
