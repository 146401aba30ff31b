"""Where the drive would be if the sketch were a pose of the linkage: a sketch is often of another position.

The sum of squares over the sketched points is sampled over the drive's way, and its least value looked at closer and
closer between its neighbours; one that is narrower than a sample may be missed. A larger group is followed from where
the sketch closes it, which is tried at parts of the way in turn.
"""

from math import pi

import numpy as np

from scenes import Failure, Scene
from scenes.arguments import scene_of
from scenes.fields import put
from scenes.model.enclosures import SketchFit
from scenes.model.motion import Samples

from ..core.decomposition import Linkage, decompose
from ..core.dyads import Vectors
from ..core.kinematics import followed
from .motion_range import motion_at

SAMPLES = 720  # of the drive's way
PARTS = 18  # of the way, where a larger group is tried
POINTS, ROUNDS = 17, 6  # of each look closer: 8 times closer, to 1e-8 of the way


def sketch_fit(scene: Scene) -> SketchFit | None:
    """Find the position of the drive where the sketch fits best, in the assembly that the sides of its points pick.

    Returns:
        None where no position is found at which the linkage assembles.
    """
    start = scene_of(scene).sketch.drive
    least, most = (start - pi, start + pi) if scene.drive.slide is None else scene.drive.law.extent
    way = np.linspace(min(least, start), max(most, start), SAMPLES + 1)
    if (linkage := _closed(scene, way[:: SAMPLES // PARTS])) is None:
        return None
    for _ in range(ROUNDS):
        places = _places(scene, linkage, way)
        # A sum of squares by the drive's position alone may have several minima: it is sampled all over the way before
        # it is looked at closer.
        apart = sum(np.abs(places[point] - complex(*xy)) ** 2 for point, xy in scene.sketch.points.items())
        if np.isnan(apart).all():
            return None
        best = int(np.nanargmin(apart))
        position = way[best]
        way = np.linspace(way[max(best - 1, 0)], way[min(best + 1, len(way) - 1)], POINTS)
    both = _places(scene, linkage, np.array([position, start]))
    there, here = ({point: complex(place[row]) for point, place in both.items()} for row in (0, 1))
    return SketchFit(float(position), there, here)


def _closed(scene: Scene, positions: Samples) -> Linkage | None:
    """The linkage with its larger groups followed from the sketch, as it is or as if it were at a position."""
    for position in (scene.sketch.drive, *positions.tolist()):
        shown = put(scene, {("sketch", "drive"): position})
        try:
            return followed(shown, decompose(shown))
        except Failure:
            continue
    return None


def _places(scene: Scene, linkage: Linkage, positions: Samples) -> dict[str, Vectors]:
    """Where the linkage has each sketched point, m, shape (n,); NaN where it does not assemble."""
    z = motion_at(scene, linkage, positions).z
    return {point: np.broadcast_to(z[point], positions.shape) for point in scene.sketch.points}
