"""What is demanded of the numbers of a scene, or of many machines: their signs and sizes, and how they relate."""

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np

from ..bodies import LINE, Body
from ..demand import Demand, of_size
from ..fields import walk
from ..outline import meetings, places
from ..scene import ConstantSpeed, DrawnBody, Scene

FLAT = 1e-9  # of the square of an outline's size: the area of one whose corners are on one line, but for rounding


def unmet_by_numbers(scene: Scene) -> Iterator[Demand]:
    """Yield which numbers are of another sign than may be, or of a size that not all models can take."""
    for number in walk(scene):
        value, quantity = number.value, number.quantity
        if quantity.dimension == "direction":
            continue  # of which the length matters, see below
        unit, size = scene.all_units[quantity.dimension]
        displaced = number.at == ("sketch", "drive") and scene.drive.slide is not None
        place = "sketch.displacement" if displaced else number.path
        if not _all(fits := quantity.has_sign(value)):
            yield Demand(f"{place}: expected {quantity.sign}, found {{:g}}", fits, (value / size,))
        if not _all(fits := quantity.fits(value)):
            span = f"{quantity.smallest / size:.2g} to {quantity.largest / size:.2g} {unit}"
            yield Demand(f"{place}: expected a size from {span}, found {{:g}}", fits, (value / size,))


def _all(fits: Any) -> bool:
    return fits if isinstance(fits, bool) else bool(np.all(fits))  # the one is much faster


def unmet_together(scene: Scene) -> Iterator[Demand]:
    """Yield which numbers do not go together."""
    return (demand for demand in _together(scene) if not _all(demand.fits))


def _together(scene: Scene) -> Iterator[Demand]:
    length, m = scene.units["length"]
    for body in scene.bodies.values():
        place = f"bodies.{body.name}"
        if body.slide is not None:
            yield of_size(f"{place}.slides.along: expected a direction of a size", body.slide.drawn)
        for a, b, c in _triangles(body):
            text = "the triangle cannot close, expected its longest side to be shorter than the other two together"
            sides = f"found {{:.6g}} {length} against {{:.6g}} {length}"
            yield Demand(f"{place}.lengths: {text}, {sides}", c < a + b, (c / m, (a + b) / m))
        bar = isinstance(body, DrawnBody) and not body.outline
        if isinstance(body, DrawnBody):
            yield from _of_drawn(body)
        # A body was classified as a bar or a plate by the drawing. Machines that vary it keep the class, because one
        # set of formulas solves them all; so those whose own points are of the other class are refused.
        uniform = body.mass is not None and (body.com is None or bar) and len(body.points) > 2
        for height in body.heights if uniform else ():
            if np.ndim(height):  # of many machines: whether their points are on one line, as those of the drawing
                where = f"points that are {'' if len(body.corners) == 2 else 'not '}on one line, as drawn"
                text = f"{place}: expected {where}, or 'com' and 'inertia', found {{:g}}"
                yield Demand(text, (height <= LINE) == (len(body.corners) == 2), (height,))
    yield from _of_drive(scene)
    for place, element in scene.listed:
        yield from element.demands(scene, place)


def _of_drawn(body: DrawnBody) -> Iterator[Demand]:
    place = f"bodies.{body.name}"
    if body.outline:
        at = places(body.outline)
        least = FLAT * (abs(at - at[0]) ** 2).max(axis=0) * body.thickness * body.density
        yield Demand(f"{place}.outline: expected an area, found corners on one line", body.mass > least, ())
        for one, other, where in meetings(at):
            expected = "expected sides that meet only at the corner between them, the last one back to the first"
            sides = f"{one} to {one + 1} and {other} to {(other + 1) % len(at)}"
            yield Demand(f"{place}.outline: {expected}, found {sides} that meet", ~where, ())
    yield of_size(f"{place}: expected numbers that give a mass", body.mass, " kg")


def _of_drive(scene: Scene) -> Iterator[Demand]:
    law = scene.drive.law
    if isinstance(law, ConstantSpeed) and law.end is not None:
        unit, size = scene.all_units["position"]
        numbers = law.start / size, law.end / size
        for way, sign, other in (("above", "negative", law.speed < 0), ("below", "positive", law.speed > 0)):
            ends = f"{{:.12g}} {unit}, found {{:.12g}} {unit}"
            text = f"drive.end: expected a position {way} 'start', {ends}; or make speed {sign}"
            yield Demand(text, np.logical_or(other, law.cycle > 0), numbers)


def _triangles(body: Body) -> Iterator[Any]:
    """Yield the sides of each triangle that a body's lengths give, from the shortest to the longest."""
    for point in body.points[2:] if body.lengths is not None else ():
        pairs = [frozenset(pair) for pair in combinations((*body.bases[point], point), 2)]
        if body.lengths is not None and all(pair in body.lengths for pair in pairs):
            yield np.sort(np.stack(np.broadcast_arrays(*(body.lengths[pair] for pair in pairs))), axis=0)
