"""Causes in the numbers of a scene, masses, lengths, guides, loads, springs, gravity, by how the core moves with them.

To the first order another number moves all channels along a column of their derivatives. The fewest columns that
explain the deviation are chosen, by the best subsets of one, of two, and so on. What was chosen is then solved for as
it is, by Gauss and Newton on the motions of scenes with such numbers, since a length that is off by some per cent is no
small one near a dead point.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.channels import Role
from scenes.model.motion import Samples

from ...engines import registry
from .cause import Cause, Kind
from .evidence import CAUSE_TOL, Channels, Evidence, Hypothesis, least_squares, price, summed, thinned
from .scene_numbers import LENGTH, Direction, Numbers, numbers_of_causes, standing_alone

SLOPE_STEP = 1e-6  # of the linkage's size, rad, or a share: what a number is varied by, for a slope
MAX_WIDENED = 16  # groups of numbers, that are tried with every further one
MAX_SOLVED = 2  # groups of numbers by each of two measures, that are solved for as they are
MAX_GROUPS = 4  # that are off at once
MAX_RATIO_OF_RESIDUALS = 0.25  # with and without one more group, at which that is accepted
ROUNDS = 8
MAX_SLOPE_NUMBERS = 1.2e7  # of all slopes: of five bodies all rows of a usual run, of sixty some forty

Slopes = Mapping[str, Channels]  # by path in the file the change of each channel, SI


def number_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield other numbers of the scene: those that explain most alone, then the fewest that explain it together."""
    both = evidence.scene, standing_alone(evidence.scene)
    groups = [*numbers_of_causes(evidence.reference)]
    slopes = [_slopes(evidence, paths, [g for g in groups if g.alone == (paths is both[1])]) for paths in both]
    ways = [[_along(slopes[group.alone], direction) for direction in group.directions] for group in groups]
    if evidence.of_forces:
        yield from _swapped(evidence, slopes)
    yield from _varying(evidence, groups, ways)
    before = np.inf
    for subsets in _nearest(evidence, ways):
        prices = [np.inf]
        for subset in subsets:
            for other in _solved(evidence, both, [groups[n] for n in subset], [ways[n] for n in subset]):
                yield other
                prices.append(price(evidence.left(other.predicted), other.freedom))
        if not CAUSE_TOL < min(prices) <= MAX_RATIO_OF_RESIDUALS * before:
            return
        before = min(prices)


def affordable(evidence: Evidence) -> Evidence:
    """Return the evidence at so many rows that all slopes are found in seconds."""
    return thinned(evidence, int(MAX_SLOPE_NUMBERS / (len(evidence.scene.numbers) * len(evidence.names))))


def _slopes(evidence: Evidence, scene: Scene, groups: Iterable[Numbers]) -> Slopes:
    """Return how the channels change with each number of some groups; nothing where there is no motion.

    Every number that is off by a hair makes a machine of its own; all are solved at once.
    """
    paths = [*dict.fromkeys(path for group in groups for direction in group.directions for path in direction)]
    channels = frozenset(evidence.names).difference(scene.channels.names(Role.input))
    if not (paths and channels):
        return {}
    numbers = [scene.numbers[path] for path in paths]
    value, unit = np.array([(number.value, scene.size(number)) for number in numbers]).T
    typical = [
        evidence.reference.mechanics.size if number.quantity.dimension == "length" else 1.0 for number in numbers
    ]
    hair = SLOPE_STEP * np.where(value != 0, np.abs(value), typical)
    machines = np.vstack([value + np.diag(hair), value])  # of the last one no number is off
    solve = registry.many(scene, dict(zip(paths, (machines / unit).T, strict=True)), channels)
    position, time = (np.tile(evidence.true[c], (len(machines), 1)) for c in (scene.channels.drive.position, "time"))
    motions = solve(position, time).samples
    return {path: {c: (motions[c][k] - motions[c][-1]) / hair[k] for c in channels} for k, path in enumerate(paths)}


def _along(slopes: Slopes, direction: Direction) -> Channels:
    return summed(direction.values(), (slopes.get(path, {}) for path in direction), defaultdict(float))


def _nearest(evidence: Evidence, ways: Sequence[Sequence[Channels]]) -> Iterator[list[tuple[int, ...]]]:
    """Yield the groups that leave least alone, then the pairs, and so on: each of the best ones with every other."""
    deviation, nothing = np.array([*evidence.deviation.values()]), np.zeros(len(evidence.rows))
    ends = np.cumsum([0, *(len(group) for group in ways)])
    weighted = [[change.get(c, nothing) / evidence.scale[c] for c in evidence.names] for way in ways for change in way]
    columns = np.array(weighted)
    by_group = np.split(columns, ends[1:-1])
    known = [k for k, column in enumerate(by_group) if np.isfinite(column).all() and column.any()]
    columns[~np.isfinite(columns)] = 0.0
    size = np.linalg.norm(deviation, axis=0)
    # Least of the whole, or of every row as if it were as large: next to a dead point few rows have nearly all of the
    # deviation, and go least along their slopes. All least squares are those of one triangle, R of Q R.
    wholes = (
        np.array([*columns, deviation]) * factor
        for factor in (1.0, 1 / (size + np.median(size) + CAUSE_TOL * size.max()))
    )
    triangles = [np.linalg.qr(whole.reshape(len(whole), -1).T)[1] for whole in wholes]
    best: list[list[tuple[float, tuple[int, ...]]]] = [[(0.0, ())], [(0.0, ())]]  # by price
    for _ in range(MAX_GROUPS):
        for number, triangle in enumerate(triangles):
            # Beam search: of the subsets of k groups only the best `MAX_WIDENED` are widened by each further group. All
            # subsets of four among a hundred groups would be four million fits.
            wider = {
                tuple(sorted({*subset, k}))
                for _, subset in best[number][:MAX_WIDENED]
                for k in known
                if k not in subset
            }
            best[number] = sorted((_left(triangle, ends, subset), subset) for subset in wider)
        yield [*dict.fromkeys(subset for ranking in best for _, subset in ranking[:MAX_SOLVED])]


def _left(triangle: NDArray[np.float64], ends: NDArray[np.intp], subset: Sequence[int]) -> float:
    """Return the price of some groups of columns, by what they leave over."""
    indices = np.concatenate([np.arange(ends[k], ends[k + 1]) for k in subset])
    # With A = Q R and orthonormal Q, distances among columns of A are those among columns of R, which has as many rows
    # as there are columns instead of one for each sample and channel. The deviation is the last column.
    rest = triangle[:, -1] - triangle[:, indices] @ least_squares(triangle[:, indices], triangle[:, -1])
    return price(float(np.linalg.norm(rest)), len(indices))


def _solved(
    evidence: Evidence, both: tuple[Scene, Scene], groups: Sequence[Numbers], ways: Sequence[Sequence[Channels]]
) -> Iterator[Hypothesis]:
    """Yield numbers that are off by what explains most, and the motion then; and the same without each of them."""
    if len(groups) == 1 and groups[0].linear and not evidence.scene.friction:
        x, predicted = evidence.added(ways[0])
        yield from _named(groups, [x], predicted)
        return
    scene = both[any(group.alone for group in groups)]
    directions = [direction for group in groups for direction in group.directions]
    if any(path not in scene.numbers for direction in directions for path in direction):
        return  # of a body's drawing, where it stands by itself
    now = {path: scene.numbers[path].value for direction in directions for path in direction}

    def step(direction: Direction) -> float:
        is_length = scene.numbers[next(iter(direction))].quantity.dimension == "length"
        return SLOPE_STEP * (
            evidence.reference.mechanics.size / max(map(abs, direction.values())) if is_length else 1.0
        )

    def predict(x: Samples) -> Channels:
        return evidence.solved(scene.with_numbers(summed(x.tolist(), directions, now)))

    x, predicted = evidence.fitted(predict, [*map(step, directions)], ROUNDS)
    counts = [len(group.directions) for group in groups]
    amounts = np.split(x, np.cumsum(counts)[:-1])
    yield from _named(groups, amounts, predicted)
    # A group beside the right ones may have been fitted to rounding alone: the same numbers without each of them are
    # hypotheses too, and are cheaper by what they leave out.
    for kept in combinations(range(len(groups)), len(groups) - 1) if len(groups) > 1 else ():
        rest = x * np.repeat([number in kept for number in range(len(groups))], counts)
        yield from _named([groups[k] for k in kept], [amounts[k] for k in kept], predict(rest))


def _named(groups: Sequence[Numbers], amounts: Sequence[Samples], predicted: Channels) -> Iterator[Hypothesis]:
    """Yield the cause that groups of numbers are, off by some amounts, if there can be such a one."""
    measured = [group.measured(amount) for group, amount in zip(groups, amounts, strict=True)]
    if predicted and all(np.isfinite(cause.amounts).all() for cause in measured):
        yield Hypothesis(replace(measured[0], besides=tuple(measured[1:])), predicted, sum(map(len, amounts)))


def _swapped(evidence: Evidence, slopes: Sequence[Slopes]) -> Iterator[Hypothesis]:
    """Yield the masses of two bodies in place of each other: all forces are linear in them."""
    bodies = evidence.scene.bodies
    masses = {name: body.mass for name, body in bodies.items() if body.mass}
    for first, second in combinations(masses, 2):
        more = masses[second] - masses[first]
        changes = [slopes[bodies[name].inertia is not None].get(f"bodies.{name}.mass", {}) for name in (first, second)]
        cause = Cause(Kind.mass, first, "the masses of {place} and {one} are swapped", names=(second,))
        yield Hypothesis(cause, evidence.changed((more, -more), changes))


def _varying(evidence: Evidence, groups: Sequence[Numbers], ways: Sequence[Sequence[Channels]]) -> Iterator[Hypothesis]:
    """Yield lengths that vary over the turn, by a sine of one amount."""
    turn = 2 * np.pi * evidence.true["time"] / evidence.scene.cycle
    waves = (np.ones_like(turn), np.cos(turn), np.sin(turn))
    for group, (change, *_) in zip(groups, ways, strict=True):
        if group.cause.text == LENGTH:
            cause = replace(group.cause, text="{place}'s length {one} varies by {wave} over the turn")
            yield evidence.with_amounts(cause, *({c: rates * wave for c, rates in change.items()} for wave in waves))
