"""Where loads and springs attack: whether their bodies and points are there."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ..bodies import GROUND
from ..errors import nearest

if TYPE_CHECKING:
    from ..scene import Scene


def problems_of_attack(scene: "Scene", place: str, place_at: str, body: str, point: str, *others: str) -> Iterator[str]:
    """Yield that there is no such body, which may be one of the others too, or that it has no such point."""
    known = (*others, *scene.bodies)
    if body not in known:
        yield f"{place}: no body '{body}'{nearest(body, known)}"
    points = scene.ground if body == GROUND else scene.bodies[body].points
    if point not in points:
        yield f"{place_at}: '{body}' has no point '{point}'{nearest(point, points)}"
