"""The ends of the closing strokes, within which the press forces act."""

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise

from scenes import Scene
from scenes.scene import PressForce

from .constraints import LinkageConstraints, PoseArray, planes
from .masses import fictitious_masses
from .start import SCENES, DrivePlace, begun, move, rates, way

HALVINGS = 25  # of a continuation step with a dead point in it; leaves round-off of the displacement there


@lru_cache(SCENES)
def stroke_ends(scene: Scene) -> Sequence[float]:
    """Where the closing strokes of the press forces end, m; once a scene, since its whole way is searched.

    Raises:
        Failure: cannot_assemble somewhere on the way, with the drive's position.
    """
    drive = scene.drive
    presses = [load for load in scene.loads if isinstance(load, PressForce)]
    if not presses:
        return []
    linkage, q = begun(scene, fictitious_masses)  # whatever the masses, the way is the same
    paths = [[(drive.start, q), *way(linkage, q, drive.start, end)] for end in drive.extent]
    strokes = {(load.body, load.closing): load for load in presses}
    ends = {s: load.closing * max(_furthest(linkage, load, path) for path in paths) for s, load in strokes.items()}
    return [ends[load.body, load.closing] for load in presses]


def _furthest(linkage: LinkageConstraints, load: PressForce, path: Sequence[DrivePlace]) -> float:
    """The slider's largest displacement in its closing direction, m; between places it has a dead point."""
    i, along = linkage.index[load.body], linkage.slides[load.body].along

    def closing(q: PoseArray) -> float:
        z, turn = planes(q[0, i])
        return load.closing * float(linkage.displacement(load.body, z, turn))

    def opens(q: PoseArray, forward: float) -> bool:
        return load.closing * float(rates(linkage, q, forward)[0, i, :2] @ along) < 0

    furthest = max(range(len(path)), key=lambda number: closing(path[number][1]))
    largest = closing(path[furthest][1])
    for (here, q), (there, after) in pairwise(path[max(furthest - 1, 0) : furthest + 2]):
        half = (there - here) / 2
        if opens(after, half) and not opens(q, half):
            for _ in range(HALVINGS):
                middle = move(linkage, q, here, here + half)
                if not opens(middle, half):
                    here, q = here + half, middle
                half /= 2
            largest = max(largest, closing(q))
    return largest
