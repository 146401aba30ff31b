"""How far the drive can move, and what stops it: its way sampled, and the places between two samples by bisection."""

from collections.abc import Callable
from functools import partial
from math import ceil, inf, pi
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.drive import ConstantSpeed, Driven, Samples

from ..core.decomposition import Dyad, Guided, InnerSlide, Linkage, guides_cross, kind
from ..core.groups.group_equations import Group
from ..core.kinematics import kinematics
from ..core.placing import Kinematics

SAMPLES = 3600  # of a turn, or a driven slider's way: what changes twice between two of them is not seen
BISECTIONS = 60  # from the whole way down to the last place
# Of the largest coordinate: what does not reach by less may be in line all the way.
IN_LINE_TOL = 16 * np.finfo(float).eps
End: TypeAlias = tuple[float, str]  # a position of the drive, rad or m, and the joint of the group singular there


def motion_at(scene: Scene, linkage: Linkage, position: Samples, *, rates: bool = False) -> Kinematics:
    """The poses at positions of the drive, rad or m, and with `rates` the motion by it; NaN where none assembles."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return kinematics(scene, linkage, Driven(position, np.array(1.0), np.array(0.0)), rates=rates)


# Sampling and bisection: the edges are exact to the last place, but an interval narrower than a sample is not seen.
# `held_about` has a margin for round-off, so that a condition that is just met all the way does not flicker from sample
# to sample.
def changes(
    holds: Callable[[Samples], NDArray[np.bool_]],
    least: float,
    most: float,
    held_about: Callable[[Samples], NDArray[np.bool_]] | None = None,
) -> tuple[Samples, Samples]:
    """Find where a condition begins or ceases to hold: the last places on a way without it and with it, shape (n,).

    It is sampled by `held_about`, where that is given: the condition but for roundings.
    """
    way = np.linspace(least, most, SAMPLES + 1)
    held = (held_about or holds)(way)
    (before,) = np.nonzero(held[1:] != held[:-1])
    ends = np.stack([way[before], way[before + 1]])
    return _bisected(holds, *np.where(held[before], ends[::-1], ends))


def zeros(f: Callable[[Samples], Samples], low: Samples, high: Samples) -> Samples:
    """Find the zeros of a function, one between each two places."""
    rising = f(high) > f(low)
    before, after = _bisected(lambda x: np.equal(f(x) > 0, rising), low, high)
    return (before + after) / 2


def _bisected(
    holds: Callable[[Samples], NDArray[np.bool_]], outside: Samples, inside: Samples
) -> tuple[Samples, Samples]:
    for _ in range(BISECTIONS):
        middle = (outside + inside) / 2
        held = holds(middle)
        outside, inside = np.where(held, outside, middle), np.where(held, middle, inside)
    return outside, inside


def motion_range(scene: Scene, linkage: Linkage) -> list[tuple[End, End]]:
    """Find the intervals of one turn, or of a driven slider's way, in which the linkage assembles, by their ends.

    A slider's way may end without a singular configuration; then there is no joint. None when the linkage never
    assembles, or all the way. An interval of a crank that does not hold its start ends in the first turn.
    """
    turn, start = linkage.drive.turn, linkage.drive.law.start
    least, most = linkage.drive.law.extent if turn == inf else (start, start + turn)
    holds, nearly = (partial(_reached, scene, linkage, rounded=error) for error in (0.0, IN_LINE_TOL))
    outside, inside = changes(holds, least, most, nearly)
    if not len(inside):
        return []
    ends = [(float(x), str(joint)) for x, joint in zip(inside, unreached(scene, linkage, outside), strict=True)]
    # Edges alternate between where an interval begins and where it ends. If the first edge ends one, the interval began
    # before the way: a turn back for a crank, at the way's end for a slider.
    if inside[0] < outside[0]:  # the way begins within an interval, which begins a turn before its last edge
        ends = [(ends[-1][0] - turn, ends[-1][1]), *ends[:-1]] if turn < inf else [(least, ""), *ends]
    if len(ends) % 2:
        ends.append((most, ""))
    intervals = []
    for (a, at_a), (b, at_b) in zip(ends[::2], ends[1::2], strict=True):
        offset = 0.0 if turn == inf or a <= start <= b else turn * (ceil(b / turn) - 1)
        intervals.append(((a - offset, at_a), (b - offset, at_b)))
    return sorted(intervals)


def _reached(scene: Scene, linkage: Linkage, position: Samples, rounded: float) -> NDArray[np.bool_]:
    return np.asarray(unreached(scene, linkage, position, rounded) == "")


def unreached(scene: Scene, linkage: Linkage, position: Samples, rounded: float = 0.0) -> NDArray[np.str_]:
    """Name for each position the inner joint of the first group that does not reach, or none by an empty text.

    A dyad that is short of it by no more than `rounded` of the largest coordinate is taken to reach: in one assembly it
    may be in line all the way, as in a rhombus that is folded.
    """
    k, lost = motion_at(scene, linkage, position), rounded * extent_of(scene)
    names = ["", *k.reach]
    fails = [np.broadcast_to(~(each >= 0), position.shape) for each in (np.array(0.0), *k.reach.values())]
    first = np.argmax(fails, axis=0)
    for row, name in enumerate(names):
        if rounded and name in k.to_lock:
            first[(first == row) & (np.abs(np.broadcast_to(k.to_lock[name], position.shape)) <= lost)] = 0
    return np.asarray(np.array(names)[first])


def extent_of(scene: Scene) -> float:
    """The largest distance of a sketched point from the origin, m: roundings are of it."""
    return max(abs(complex(*place)) for place in scene.sketch.points.values())


def describe(scene: Scene, linkage: Linkage, position: float) -> str:
    """Tell in one sentence how far the drive moves, and what is in line where it stops, as it does at a position."""
    drive = linkage.drive
    body, turns, (least, most) = drive.body, drive.slide is None, drive.law.extent
    intervals = motion_range(scene, linkage)
    stops = {group.P: in_line(group) for group in linkage.groups} | {"": "the end of its way"}
    if not intervals and not unreached(scene, linkage, np.array([drive.law.start]))[0]:
        if not turns and not least <= position <= most:
            return f"the {body} slides freely all its way, from {scene.position(least)} to {scene.position(most)}"
        gap = scene.position((2 * pi if turns else most - least) / SAMPLES)
        why = stops[str(unreached(scene, linkage, np.array([position]))[0])]
        return f"the {body} {'turns' if turns else 'slides'} freely but for gaps narrower than {gap} ({why})"
    if not intervals:
        return f"the linkage cannot be assembled with the {body} at any {'angle' if turns else 'place of its way'}"

    def end(position: float, joint: str) -> str:
        return f"{scene.position(position)} ({stops[joint]})"

    limits = "drive.start and drive.end" if isinstance(drive.law, ConstantSpeed) else "the drive's law"
    ways = " and ".join(f"from {end(*first)} to {end(*last)}" for first, last in intervals)
    return f"the {body} {'turns' if turns else 'slides'} only {ways}; {limits} can limit a run"


def in_line(group: Dyad | Group) -> str:
    """Name what is in line, square or parallel where a group is singular."""
    if isinstance(group, Group):
        return f"{', '.join(group.bodies)} in a singular configuration"
    first, second = (leg.body for leg in group.legs)
    if guides_cross(group):
        guides = [leg for leg in group.legs if isinstance(leg, Guided)]
        guides += [group.guide] if isinstance(group, InnerSlide) else []
        return f"the guides of {' and '.join(guide.slider for guide in guides)} parallel"
    if isinstance(group, InnerSlide):
        return f"the pins of {first} and {second} square to the guide of {group.guide.slider}"
    return (
        f"{first} and {second} in line at {group.P}"
        if kind(group) == "RRR"
        else f"{first} square to the guide of {second}"
    )
