"""The ends of the press forces' strokes: as far against the force as the drive's way takes the slider."""

from itertools import pairwise

import numpy as np
from scipy.optimize import minimize_scalar

from scenes.motion import Samples
from scenes.scene import PressForce

from .poses import ClosedPose, PathFollower

ACCURACY = 1e-9  # of the drive's position, rad or of its travel; the displacement stands still there


def stroke_ends(poses: PathFollower, start: ClosedPose) -> Samples:
    """Return by load the displacement where a press force's stroke ends, m; zero for other loads, shape (loads,)."""
    loads = poses.scene.loads
    presses = {(load.body, load.closing): load for load in loads if isinstance(load, PressForce)}
    ends = {stroke: _end(poses, start, load) for stroke, load in presses.items()}
    return np.array([ends[load.body, load.closing] if isinstance(load, PressForce) else 0.0 for load in loads])


def _end(poses: PathFollower, start: ClosedPose, load: PressForce) -> float:
    """Return the furthest displacement in the closing direction: at the best of many positions, or between two."""
    begin, step = poses.scene.drive.start, poses.largest_step / 4

    def closed(pose: ClosedPose) -> float:
        return load.closing * poses.system.displacement(pose.x, load.body)

    known = {begin: (closed(start), start)}
    for end in poses.scene.drive.extent:
        positions = np.linspace(begin, end, int(np.ceil(abs(end - begin) / step)) + 1)[1:].tolist()
        for position, pose in zip(positions, poses.through(start, begin, positions), strict=True):
            known[position] = closed(pose), pose
    best = max(known, key=lambda position: known[position][0])
    furthest, pose = known[best]
    near = [pair for pair in pairwise(sorted(known)) if best in pair]
    low, high = near[0][0], near[-1][1]
    refined = minimize_scalar(
        lambda position: -closed(next(poses.through(pose, best, [position]))),
        bounds=(low, high),
        method="bounded",
        options={"xatol": ACCURACY * (high - low)},
    )
    return load.closing * max(furthest, -float(refined.fun))
