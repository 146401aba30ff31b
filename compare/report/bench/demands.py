"""What a scene file demands of the numbers that a reader changes, which the core's formulas do not ask for.

They are sums above zero, of numbers times 1 or -1; and triangles that are flat or not, as those drawn, by their sides,
each a length or two points' coordinates: a uniform body does not become a plate where it was drawn as a bar.
"""

from collections.abc import Iterator, Mapping
from fnmatch import fnmatch
from itertools import combinations, pairwise
from typing import Any, TypeAlias

from scenes import Scene
from scenes.bodies import Body

Signs: TypeAlias = Mapping[str, int]  # by path, 1 or -1
Sides: TypeAlias = list[list[str]]


def demands(scene: Scene, places: Mapping[str, int]) -> Iterator[Mapping[str, Any]]:
    """Yield what is wrong where a demand is not met, with the places of its numbers among all of the page."""
    for text, signs in _sums(scene):
        if signs.keys() <= places.keys():
            yield {"text": text, "terms": [[places[path], sign] for path, sign in signs.items()]}
    for body in scene.bodies.values():
        flat = len(body.corners) == 2
        text = f"{body.name} has a mass as a {'bar' if flat else 'plate'}, and needs 'com' and 'inertia'"
        for sides in _triangles(body):
            if all(path in places for side in sides for path in side):
                yield {"text": text, "flat": flat, "sides": [[places[path] for path in side] for side in sides]}


def _sums(scene: Scene) -> Iterator[tuple[str, Signs]]:
    for body in scene.bodies.values():
        for point, bases in body.bases.items():
            sides = [_length(body, *pair) for pair in combinations((*bases, point), 2) if len(bases) == 2]
            text = f"the triangle of {', '.join((*bases, point))} cannot close"
            yield from ((text, {one: -1 if one == longest else 1 for one in sides}) for longest in sides)
    for place, _ in scene.elements:
        rows = [path for path in scene.numbers if fnmatch(path, f"{place}.table.*.0")]
        yield from ((f"the rows of {place}.table are out of order", {a: -1, b: 1}) for a, b in pairwise(rows))


def _triangles(body: Body) -> Iterator[Sides]:
    """Yield those of two corners and another point of a uniform body, by the paths of their sides."""
    if body.mass is not None and body.com is None and len(body.points) > 2:
        p, q, *_ = body.corners
        for r in (point for point in body.points if point not in (p, q)):
            pairs = (p, q), (q, r), (r, p)
            yield [_coordinates(body, *ends) if body.lengths is None else [_length(body, *ends)] for ends in pairs]


def _length(body: Body, one: str, other: str) -> str:
    return f"bodies.{body.name}.lengths.{'-'.join(sorted((one, other)))}"


def _coordinates(body: Body, *points: str) -> list[str]:
    return [f"bodies.{body.name}.points.{point}.{q}" for point in points for q in range(2)]
