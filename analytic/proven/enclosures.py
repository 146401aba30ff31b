"""What is proven of a scene over its whole range: that it assembles, and bounds of every channel's extremes.

Boxes that may hold an extreme are divided until it is known closely enough. In a box a row is c_0 + c_1 s + c_2 s^2 and
a rest of at most r (`taylor_models`): its largest value there is that of the parabola, to r. The largest of these less
r is attained somewhere, and a box whose largest value and r are below it holds no extreme. All boxes of a level go
through the line at once.
"""

from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from itertools import pairwise, product
from numbers import Integral
from typing import Any, TypeAlias

import numpy as np

from scenes import Scene
from scenes.arguments import finite_numbers, known_names, one_number, refuse, scene_of
from scenes.drive import ConstantSpeed
from scenes.model.enclosures import Enclosure, Enclosures
from scenes.model.motion import Samples

from .boxes import FIRST_BOXES, Boxes, Numbers, cut
from .branches import MIN_BOX
from .cycles import over_cycles
from .levels import Level, joined
from .reasons import GROW, why_open, why_unbounded

AT_ONCE = 256  # boxes, which take about as long as a single one
MIN_PARTS, MAX_PARTS = 4, 64  # parts of a box
FLAT_TOL = 1e-9  # of the largest value of a row's kind: what changes by less is zero, or the same, but for round-off
FLAT_ACCURACY = 1e-6  # of that value: how closely such a row is known, whose boxes all hold its extremes
ONE_PLACE_TOL = 1e-3  # of the way: an extreme that may be in places as near as that is in one that has them all
DECIDED = 8  # rests of a single position, as most are: what doubles can decide

Span: TypeAlias = tuple[float, float]


def enclose(
    scene: Scene,
    names: AbstractSet[str] | None = None,
    accuracy: float = 1e-6,
    off: Mapping[str, float] | None = None,
    turns: int = 1,
) -> Enclosures:
    """Prove what the extremes of channels and magnitudes are over all positions of a run, between samples too.

    Angles go on over whole turns, from -pi to pi at the drive's start.

    Args:
        scene: the mechanism.
        names: channels, and the magnitudes `P.force`, `P.speed`, `P.acceleration` and `transmission`; None for all.
        accuracy: how far the bounds may be apart, of what the channel changes by; as far as doubles can decide.
        off: by how much numbers of the scene may be off either way, SI, by path in the file: the extremes are then
            those of all machines within that, and the bounds are apart by what a linear model of the numbers leaves.
        turns: cycles of the drive that the run has; more than one only of a drive that is periodic.

    Raises:
        Failure: as of `solver`.
        InputError: no scene, no such name, an accuracy that is no number above zero, or turns that are no whole number
            that the drive makes.
    """
    numbers = scene_of(scene).numbers
    if off is not None and not isinstance(off, Mapping):
        refuse("off", "numbers by path, as {'bodies.rod.mass': 0.1}", off)
    known_names("off", off or {}, numbers)
    off = {path: float(finite_numbers(f"off: {path}", one_number(path, value))) for path, value in (off or {}).items()}
    if not finite_numbers("accuracy", one_number("accuracy", accuracy)) > 0:
        refuse("accuracy", "a number above zero", accuracy)
    if isinstance(turns, bool) or not isinstance(turns, Integral) or turns < 1 or (turns > 1 and not scene.periodic):
        refuse("turns", "a whole number from 1" if scene.periodic else "1 of a drive that runs once", turns)
    boxes = Boxes(scene, names, off)
    boxes.core.check_hull(np.array(boxes.law.extent))
    found = over_cycles(boxes, turns, lambda some: _extremes(some, accuracy))
    if boxes.grows and GROW in found.why:
        found = over_cycles(Boxes(scene, names, off, chain=True), turns, lambda some: _extremes(some, accuracy))
    return found


def departures(scene: Scene, edges: Samples, names: AbstractSet[str] | None = None) -> Mapping[str, Samples]:
    """How far channels and magnitudes may leave the straight line between neighbouring places, SI.

    Args:
        scene: the mechanism.
        edges: positions of the drive, rad or m, or instants, s, under a motion law; shape (n + 1,), increasing.
        names: as of `enclose`.

    Returns:
        By name, shape (n,); NaN where nothing is known.

    Raises:
        Failure: as of `solver`.
        InputError: no scene, no such name, or places that are none, or do not increase.
    """
    edges = finite_numbers("edges", edges)
    if edges.ndim != 1 or not (np.diff(edges) > 0).all() or not edges[1:].size:
        refuse("edges", "two places or more, increasing", edges)
    boxes = Boxes(scene_of(scene), names, {})
    law = boxes.law
    if law.periodic and not isinstance(law, ConstantSpeed):
        boxes = boxes.over(int(edges[0] // law.cycle), int(edges[-1] // law.cycle) + 1)
    positions = edges if isinstance(law, ConstantSpeed) else law.at(np.union1d(edges, boxes.edges)).position
    boxes.core.check_hull(positions)
    ends = np.union1d(edges, boxes.edges[(boxes.edges > edges[0]) & (boxes.edges < edges[-1])])
    models, box = boxes(ends[:-1], ends[1:])
    low, high = models.range
    # In one box the chord through the values at s = -1 and 1 is c0 + c2 + c1 s. The curve is off it by |c2| (1 - s^2)
    # at most, and by the rest twice: once of the curve, once of the chord's ends. Over several boxes all that is known
    # is the range.
    first = np.searchsorted(ends[box], edges[:-1])  # of the models between two places
    apart = np.maximum.reduceat(high, first, axis=1) - np.minimum.reduceat(low, first, axis=1)
    single = np.diff(np.append(first, len(box))) == 1  # without a jump between them, and within one piece of a law
    departure = np.where(single, (np.abs(models.c[2]) + 2 * models.rest)[:, first], apart)
    return dict(zip(boxes.names, departure, strict=False))  # the conditions come last


def _extremes(boxes: Boxes, accuracy: float) -> Enclosures:
    """Enclose the extremes of all that boxes have, and find where one of their conditions may not hold.

    An extreme is between bounds, infinite where nothing is known and else as near to each other as `accuracy`, of the
    row's range, asks for and doubles can decide; it is on the first part of the way that is known to hold it, or else
    that may. Conditions are to be positive; what is open is the first part of the way where one may not be.
    """
    low, high = boxes.divided(FIRST_BOXES)
    way, rows = high.max() - low.min(), len(boxes.names)
    # Boxes of no width have no truncation error: their rests are round-off alone. No bound can be tighter than that.
    rest = boxes(low, low)[0].rest[:rows]
    # NumPy's median loads the package of masked arrays.
    rounding = DECIDED * np.sort(np.where(np.isnan(rest), 0.0, rest), axis=-1)[:, rest.shape[-1] // 2]
    attained = np.full(2 * rows, -np.inf)
    done: list[Level] = []
    while True:
        level, attained = Level.of(boxes, low, high, attained)
        size = np.reshape(attained, (2, rows))
        near = np.maximum(boxes.arms * _tolerance(size / boxes.arms, boxes.kinds, accuracy), rounding)
        wanted, box = level.wanted(np.ravel(size + near)), level.own
        divisible = ~level.fails & (level.high - level.low > MIN_BOX * way)
        # All boxes that are wanted; if these are too many, only those that decide on assembly; at last none, and the
        # bounds stay as wide as they are.
        for some in (wanted, level.doubtful, np.False_):  # of too many, those alone where it may not assemble
            divided = np.zeros(len(low), np.bool_)
            divided[box[some & divisible]] = True  # with all that is assumed of a box
            if MIN_PARTS * divided.sum() <= boxes.most:
                break
        done.append(level.kept(~divided[box], attained))
        low, high = low[divided], high[divided]
        if not len(low):
            for number, level in enumerate(done):
                done[number] = level.kept(np.ones(len(level.low), np.bool_), attained)
            del level
            every = joined(done)
            done.clear()  # of what takes most of the memory there is no second copy for long
            return _enclosed(boxes, every, attained, way)
        low, high = cut(low, high, int(np.clip(AT_ONCE // len(low), MIN_PARTS, MAX_PARTS)))


def _tolerance(attained: Samples, kinds: Numbers, accuracy: float) -> Samples:
    """How far bounds may be apart, given what is attained with either sign, shape (2, rows); 0 of nothing."""
    size = np.zeros(kinds.max(initial=0) + 1)
    np.maximum.at(size, kinds, np.where(np.isfinite(attained), np.abs(attained), 0.0).max(axis=0))
    # Rows are there with either sign, so that the sum of what both attain is the range of the values. A range of
    # nothing but round-off is measured by the largest value of its kind of quantity instead: a relative accuracy of
    # zero cannot be met.
    span = attained.sum(axis=0)
    flat = max(accuracy, FLAT_ACCURACY) * size[kinds]
    return np.where(np.isfinite(span), np.where(span > FLAT_TOL * size[kinds], accuracy * span, flat), 0.0)


def _enclosed(boxes: Boxes, every: Level, attained: Samples, way: float) -> Enclosures:
    """The extremes by boxes with all the way."""
    unsure = every.doubtful & ~every.fails
    several = (unsure, MIN_BOX * way), (every.fails, -np.inf)  # of those that fail the first box alone
    spans = (_first(every.low[some], every.high[some], some[some], gap) for some, gap in several)
    open_at = min((span for span in spans if span), default=None)
    if open_at is not None:
        return Enclosures((), open_at, why=why_open(boxes, every, open_at[0], MIN_BOX * way))
    most = attained.copy()
    np.maximum.at(most, every.row, every.most)
    begins, ends, holds = every.places(attained, most)
    edges = pairwise(np.searchsorted(every.row, np.arange(len(attained) + 1)))
    parts = [_first(begins[a:b], ends[a:b], holds[a:b], ONE_PLACE_TOL * way) or (np.nan, np.nan) for a, b in edges]
    shape = 2, len(boxes.names)
    most, attained = np.reshape(most, shape), np.reshape(attained, shape)
    places = np.reshape(parts, (*shape, 2)).transpose(2, 0, 1)
    bounds = np.array([[-most[0], attained[1]], [-attained[0], most[1]], *places])  # shape (4, 2, rows)
    extreme = zip(product(boxes.names, ("least", "most")), bounds.T.reshape(-1, 4).tolist(), strict=True)
    found = [Enclosure(*row, *bound) for row, bound in extreme]
    return Enclosures(found, None, why=why_unbounded(every, MIN_BOX * way))


def _first(begins: Samples, ends: Samples, holds: Any, apart: float) -> Span | None:
    """The first interval of the joined parts of the way in which one part holds the condition; None without parts."""
    if not len(begins):
        return None
    # Union of intervals: a new part begins where an interval's begin is beyond the furthest end so far by more than
    # `apart`.
    order = np.argsort(begins)
    begins, reach = begins[order], np.maximum.accumulate(ends[order])
    starts = np.flatnonzero(np.append(True, begins[1:] > reach[:-1] + apart))
    first = int(np.logical_or.reduceat(holds[order], starts).argmax())
    return float(begins[starts[first]]), float(reach[np.append(starts, len(order))[first + 1] - 1])
