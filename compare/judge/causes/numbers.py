"""Causes in the numbers of a scene, masses, lengths, guides, loads, springs, gravity, by the core's derivatives.

To the first order another number moves all channels along a column of the exact derivatives. The fewest columns that
explain the deviation are chosen, by the best subsets of one, of two, and so on. What was chosen is then solved for as
it is, by Gauss and Newton on the motions of scenes with such numbers, since a length that is off by some per cent is no
small one near a dead point.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene
from scenes.model.motion import Samples

from ...engines import registry
from .cause import Cause, Kind, Way
from .evidence import EXACT, Channels, Evidence, Hypothesis, added, fitted, least_squares, price, thinned, with_changes
from .scene_numbers import HAIR, Direction, Numbers, numbers_of_causes, standing_alone

WIDE = 16  # groups of numbers, that are tried with every further one
CLOSER = 2  # groups of numbers by each of two measures, that are solved for as they are
MOST = 4  # groups that are off at once
HELPS = 0.25  # of what is left over without it, that a further group leaves at most
ROUNDS = 8
FEW = 100  # numbers, of which derivatives take no second
WORK = 1.2e7  # numbers that all slopes are: of five bodies all rows of a usual run, of sixty some forty

Ranking = list[tuple[float, tuple[int, ...]]]  # prices of groups, by their numbers
Slopes = Mapping[str, Channels]  # by path in the file the change of each channel, SI


def number_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield other numbers of the scene: those that explain most alone, then the fewest that explain it together."""
    scene = evidence.reference.scene
    both = scene, standing_alone(scene)
    groups = [*numbers_of_causes(evidence.reference)]
    slopes = [_slopes(evidence, of, [g for g in groups if g.alone == (of is both[1])]) for of in both]
    ways = [[_along(slopes[group.alone], direction) for direction in group.directions] for group in groups]
    if evidence.of_forces:
        yield from _swapped(evidence, slopes[0])
    yield from _varying(evidence, groups, ways)
    before = np.inf
    for subsets in _nearest(evidence, ways):
        prices = [np.inf]
        for subset in subsets:
            for other in _solved(evidence, both, [groups[n] for n in subset], [ways[n] for n in subset]):
                yield other
                prices.append(price(evidence.left(other.predicted), other.freedom))
        if not EXACT < min(prices) <= HELPS * before:
            return
        before = min(prices)


def affordable(evidence: Evidence) -> Evidence:
    """Return the evidence at so many rows that all slopes are found in seconds: of few bodies all of them."""
    count = len(evidence.reference.scene.numbers)
    return thinned(evidence, int(WORK / (count * len(evidence.names))))


def _slopes(evidence: Evidence, scene: Scene, groups: Iterable[Numbers]) -> Slopes:
    """Return how the channels change with each number of some groups; nothing where there is no motion."""
    paths = [*dict.fromkeys(path for group in groups for direction in group.directions for path in direction)]
    channels = frozenset(evidence.names) - {scene.drive_channel}
    if not (paths and channels):
        return {}
    position, time = evidence.true[scene.drive_channel], evidence.true["time"]
    size = np.array([scene.size(scene.numbers[path]) for path in paths])
    if len(paths) <= FEW:
        by = registry.derivatives(scene, paths, position, time, channels)
    else:
        by = _differences(evidence, scene, dict(zip(paths, size, strict=True)), channels)
    in_si = {c: own / size[:, np.newaxis] for c, own in by.items()}
    return {path: {c: own[k] for c, own in in_si.items()} for k, path in enumerate(paths)}


def _differences(
    evidence: Evidence, scene: Scene, sizes: Mapping[str, float], channels: frozenset[str]
) -> Mapping[str, Samples]:
    """Return slopes in place of derivatives, by machines that have one number each that is another, but for the last.

    Of hundreds of numbers the derivatives are code that takes a minute to make.
    """
    own = {path: scene.numbers[path] for path in sizes}
    typical = {
        path: evidence.reference.mechanics.size if n.quantity.dimension == "length" else 1.0 for path, n in own.items()
    }
    hairs = {path: HAIR * (abs(n.value) or typical[path]) / sizes[path] for path, n in own.items()}
    others = {path: np.full(len(own) + 1, n.value / sizes[path]) for path, n in own.items()}
    for number, path in enumerate(own):
        others[path][number] += hairs[path]
    position, time = (np.tile(evidence.true[c], (len(own) + 1, 1)) for c in (scene.drive_channel, "time"))
    motions = registry.many(scene, others, channels)(position, time).samples
    hair = np.array([*hairs.values()])[:, np.newaxis]
    return {c: (motions[c][:-1] - motions[c][-1]) / hair for c in channels}


def _along(slopes: Slopes, direction: Direction) -> Channels:
    change: dict[str, Samples] = {}
    for path, weight in direction.items():
        for channel, slope in slopes.get(path, {}).items():
            change[channel] = change.get(channel, 0.0) + weight * slope
    return change


def _nearest(evidence: Evidence, ways: Sequence[Sequence[Channels]]) -> Iterator[list[tuple[int, ...]]]:
    """Yield the groups that leave least alone, then the pairs, and so on: each of the best ones with every other.

    They leave least of the whole, or of every row as if it were as large: next to a dead point few rows have nearly
    all of the deviation, and go least along their slopes. All least squares are those of one triangle, R of Q R.
    """
    off = np.array([evidence.difference(c, evidence.true[c]) for c in evidence.names])
    size = np.linalg.norm(off, axis=0)
    ends = np.cumsum([0, *(len(group) for group in ways)])
    columns = np.array([_weighted(evidence, change) for group in ways for change in group])
    known = [
        k
        for k in range(len(ways))
        if np.isfinite(columns[ends[k] : ends[k + 1]]).all() and columns[ends[k] : ends[k + 1]].any()
    ]
    columns[~np.isfinite(columns)] = 0.0
    best: list[Ranking] = [[(0.0, ())], [(0.0, ())]]
    triangles = []
    for weight in (np.ones_like(size), 1 / (size + np.median(size) + EXACT * size.max())):
        whole = np.array([*columns, off]) * weight
        triangles.append(np.linalg.qr(whole.reshape(len(whole), -1).T)[1])
    for _ in range(MOST):
        for number, triangle in enumerate(triangles):
            wider = {tuple(sorted({*subset, k})) for _, subset in best[number][:WIDE] for k in known if k not in subset}
            best[number] = sorted((_left(triangle, ends, subset), subset) for subset in wider)
        yield [*dict.fromkeys(subset for own in best for _, subset in own[:CLOSER])]


def _left(triangle: NDArray[np.float64], ends: NDArray[np.intp], subset: Sequence[int]) -> float:
    """Return the price of some groups of columns, by what they leave over."""
    own = np.concatenate([np.arange(ends[k], ends[k + 1]) for k in subset])
    rest = triangle[:, -1] - triangle[:, own] @ least_squares(triangle[:, own], triangle[:, -1])
    return price(float(np.linalg.norm(rest)), len(own))


def _weighted(evidence: Evidence, change: Channels) -> NDArray[np.float64]:
    nothing = np.zeros(len(evidence.rows))
    return np.array([change.get(c, nothing) / evidence.scale[c] for c in evidence.names])


def _solved(
    evidence: Evidence, both: tuple[Scene, Scene], groups: Sequence[Numbers], ways: Sequence[Sequence[Channels]]
) -> Iterator[Hypothesis]:
    """Yield numbers that are off by what explains most, and the motion then; and the same without each of them."""
    starts = np.cumsum([0, *(len(group.directions) for group in groups)])
    if len(groups) == 1 and groups[0].linear:
        x, predicted = added(evidence, ways[0])
        yield from _named(groups, [x], predicted)
        return
    directions = [direction for group in groups for direction in group.directions]
    scene = both[any(group.alone for group in groups)]
    steps = np.repeat([group.step for group in groups], np.diff(starts))

    def predict(x: Samples) -> Channels:
        return solved(evidence, with_amounts(scene, directions, x))

    x, predicted = fitted(evidence, predict, steps, ROUNDS)
    yield from _named(groups, np.split(x, starts[1:-1]), predicted)
    for number in range(len(groups)) if len(groups) > 1 else ():
        less = x.copy()
        less[starts[number] : starts[number + 1]] = 0.0
        rest = [own for k, own in enumerate(np.split(x, starts[1:-1])) if k != number]
        yield from _named([group for k, group in enumerate(groups) if k != number], rest, predict(less))


def _named(groups: Sequence[Numbers], amounts: Sequence[Samples], predicted: Channels) -> Iterator[Hypothesis]:
    """Yield the cause that groups of numbers are, off by some amounts, if there can be such a one."""
    causes = [group.cause(own) for group, own in zip(groups, amounts, strict=True)]
    known = [cause for cause in causes if cause is not None]
    if predicted and len(known) == len(groups):
        yield Hypothesis(replace(known[0], besides=tuple(known[1:])), predicted, sum(map(len, amounts)))


def with_amounts(scene: Scene, directions: Iterable[Direction], amounts: Iterable[float]) -> Scene:
    """Return a scene with its numbers changed by amounts along directions."""
    numbers: dict[str, float] = {}
    for direction, amount in zip(directions, amounts, strict=True):
        for path, weight in direction.items():
            numbers[path] = numbers.get(path, scene.numbers[path].value) + float(amount) * weight
    return scene.with_numbers(numbers)


def solved(evidence: Evidence, scene: Scene) -> Channels:
    """Return the channels of another scene with the drive where it is; nothing where there is no motion."""
    try:
        with np.errstate(all="ignore"):
            motion = registry.reference(scene)(evidence.true[scene.drive_channel], evidence.true["time"])
    except Failure:
        return {}
    return {channel: motion[channel] for channel in evidence.names}


def _swapped(evidence: Evidence, slopes: Slopes) -> Iterator[Hypothesis]:
    """Yield the masses of two bodies in place of each other: all forces are linear in them."""
    masses = {name: body.mass for name, body in evidence.reference.scene.bodies.items() if body.mass}
    for one, two in combinations(masses, 2):
        more = masses[two] - masses[one]
        changes = [slopes.get(f"bodies.{name}.mass", {}) for name in (one, two)]
        cause = Cause(Kind.mass, one, Way.masses_swapped, names=(two,))
        yield Hypothesis(cause, with_changes(evidence, (more, -more), changes))


def _varying(evidence: Evidence, groups: Sequence[Numbers], ways: Sequence[Sequence[Channels]]) -> Iterator[Hypothesis]:
    """Yield lengths that vary over the turn, by a sine of one amount."""
    turn = 2 * np.pi * evidence.true["time"] / evidence.reference.scene.drive.cycle
    courses = (np.ones_like(turn), np.cos(turn), np.sin(turn))
    for group, (change, *_) in zip(groups, ways, strict=True):
        if group.way is Way.length:
            x, predicted = added(evidence, [{c: by * course for c, by in change.items()} for course in courses])
            amount = float(np.hypot(*x[1:]))
            yield Hypothesis(Cause(group.kind, group.place, Way.varying, (amount,), group.names), predicted, len(x))
