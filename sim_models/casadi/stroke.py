"""The ends of the press forces' strokes: as far against the force as the drive's way takes the slider."""

import numpy as np

from scenes.motion import Samples
from scenes.scene import PressForce

from .linkage import table
from .poses import Poses

PARTS = 180  # of a turn or a travel; a slider does not turn round twice within one
ITERATIONS = 6  # of Newton's method for a dead point between two positions; each squares the error


def stroke_ends(poses: Poses, start: Samples) -> Samples:
    """Return by load the displacement where a press force's stroke ends, m; zero for other loads, shape (loads,)."""
    loads = poses.scene.loads
    presses = {(load.body, load.closing): load for load in loads if isinstance(load, PressForce)}
    ends = {stroke: load.closing * _furthest(poses, start, load) for stroke, load in presses.items()}
    return np.array([ends[load.body, load.closing] if isinstance(load, PressForce) else 0.0 for load in loads])


def _furthest(poses: Poses, start: Samples, load: PressForce) -> float:
    """Return the largest displacement in the closing direction over the drive's whole extent, m."""
    least, most = poses.scene.drive.extent
    begin, step = poses.scene.drive.start, poses.largest_step * 36 / PARTS
    slider = poses.linkage.slider(load.body)
    furthest = -np.inf
    for end in (least, most):
        positions = np.linspace(begin, end, int(np.ceil(abs(end - begin) / step)) + 1)
        x = poses.through(start, begin, positions)

        def moved(x: Samples) -> Samples:
            """Return displacement and its derivatives by the drive's position, in the closing direction."""
            return load.closing * table(slider, x, *poses.tangent(x))

        distance, rate, _ = moved(x)
        furthest = max(furthest, distance.max())
        ahead = np.sign(end - begin)
        for row in np.flatnonzero((ahead * rate[:-1] > 0) & (ahead * rate[1:] < 0)):
            at, pose = positions[row], x[:, row : row + 1]
            for _ in range(ITERATIONS):
                distance, rate, bend = moved(pose)[:, 0]
                to = np.clip(at - rate / bend, *np.sort(positions[row : row + 2]))
                pose, at = poses.through(pose[:, 0], at, np.array([to])), to
            furthest = max(furthest, moved(pose)[0, 0])
    return float(furthest)
