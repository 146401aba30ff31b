"""How far the drive can move: where every group reaches, and what stops it at either end."""

from dataclasses import dataclass
from math import ceil, inf, pi

import numpy as np

from scenes import Scene
from scenes.drive import Driven
from scenes.motion import Samples

from .decomposition import Dyad, Guided, InnerSlide, guides_cross, inner_joint, kind
from .group_equations import Group
from .kinematics import Linkage, kinematics

SAMPLES = 3600  # a turn, or a driven slider's way: a gap or an interval narrower than this grid is missed
BISECTIONS = 50  # from one of them down to the last place


@dataclass(frozen=True)
class Interval:
    """Positions of the drive, rad or m, between which the linkage assembles, and the joint of the group singular there.

    A driven slider's way may end without a singular configuration; then there is no joint.
    """

    start: float
    end: float
    start_joint: str
    end_joint: str


def motion_range(scene: Scene, linkage: Linkage) -> list[Interval]:
    """Return the intervals of one turn, or of a driven slider's way, in which the linkage assembles.

    None when it never does, or all the way. An interval of a crank that does not hold its start ends in the first turn.
    """
    turn = 2 * pi if scene.driven_slide is None else inf
    least, most = scene.drive.extent if turn == inf else (scene.drive.start, scene.drive.start + turn)
    way = np.linspace(least, most, SAMPLES + 1)
    assembled = _unreached(scene, linkage, way) == ""
    edges = np.flatnonzero(assembled[1:] != assembled[:-1])
    if not len(edges):
        return []
    inside = np.where(assembled[edges], way[edges], way[edges + 1])
    outside = np.where(assembled[edges], way[edges + 1], way[edges])
    for _ in range(BISECTIONS):
        middle = (inside + outside) / 2
        fits = _unreached(scene, linkage, middle) == ""
        inside, outside = np.where(fits, middle, inside), np.where(fits, outside, middle)
    ends = [(float(x), str(joint)) for x, joint in zip(inside, _unreached(scene, linkage, outside), strict=True)]
    if assembled[0]:  # the way begins within an interval, which begins a turn before its last edge
        ends = [(ends[-1][0] - turn, ends[-1][1]), *ends[:-1]] if turn < inf else [(least, ""), *ends]
    if len(ends) % 2:
        ends.append((most, ""))
    found = []
    for (a, at_a), (b, at_b) in zip(ends[::2], ends[1::2], strict=True):
        off = 0.0 if turn == inf or a <= scene.drive.start <= b else turn * (ceil(b / turn) - 1)
        found.append(Interval(a - off, b - off, at_a, at_b))
    return sorted(found, key=lambda interval: interval.start)


def _unreached(scene: Scene, linkage: Linkage, position: Samples) -> np.ndarray[tuple[int], np.dtype[np.str_]]:
    """Return, for each position, the inner joint of the first group that does not reach, or an empty text."""
    with np.errstate(invalid="ignore", divide="ignore"):
        reach = kinematics(scene, linkage, Driven(position, np.array(1.0), np.array(0.0))).reach
    joints = np.array(["", *reach])
    none = np.zeros(position.shape, bool)
    fails = np.array([none, *(np.broadcast_to(~(r >= 0), position.shape) for r in reach.values())])
    first: np.ndarray[tuple[int], np.dtype[np.str_]] = joints[fails.argmax(axis=0)]
    return first


def describe(scene: Scene, linkage: Linkage, position: float) -> str:
    """Return in one sentence how far the drive moves, and what is in line where it stops, as it does at a position."""
    body, turns = scene.drive.body, scene.driven_slide is None
    intervals = motion_range(scene, linkage)
    stops = {inner_joint(group): in_line(group) for group in linkage.groups} | {"": "the end of its way"}
    if not intervals and not _unreached(scene, linkage, np.array([scene.drive.start]))[0]:
        least, most = scene.drive.extent
        if not turns and not least <= position <= most:
            return f"the {body} slides freely all its way, from {scene.position(least)} to {scene.position(most)}"
        gap = scene.position((2 * pi if turns else most - least) / SAMPLES)
        why = stops[str(_unreached(scene, linkage, np.array([position]))[0])]
        return f"the {body} {'turns' if turns else 'slides'} freely but for gaps narrower than {gap} ({why})"
    if not intervals:
        return f"the linkage cannot be assembled with the {body} at any {'angle' if turns else 'place of its way'}"

    def end(position: float, joint: str) -> str:
        return f"{scene.position(position)} ({stops[joint]})"

    ways = " and ".join(f"from {end(i.start, i.start_joint)} to {end(i.end, i.end_joint)}" for i in intervals)
    return f"the {body} {'turns' if turns else 'slides'} only {ways}; drive.start and drive.end can limit a run"


def in_line(group: Dyad | Group) -> str:
    """Return what is in line, square or parallel where a group is singular."""
    if isinstance(group, Group):
        return f"{', '.join(group.bodies)} in a singular configuration"
    one, two = (leg.body for leg in group.legs)
    if guides_cross(group):
        guides = [leg for leg in group.legs if isinstance(leg, Guided)]
        guides += [group.guide] if isinstance(group, InnerSlide) else []
        return f"the guides of {' and '.join(guide.slider for guide in guides)} parallel"
    if isinstance(group, InnerSlide):
        return f"the pins of {one} and {two} square to the guide of {group.guide.slider}"
    return f"{one} and {two} in line at {group.P}" if kind(group) == "RRR" else f"{one} square to the guide of {two}"
