"""The ends of the press forces' strokes: as far against the force as the drive's way takes the slider."""

import numpy as np
from scipy.optimize import minimize_scalar

from scenes.motion import Samples
from scenes.scene import PressForce

from .poses import Poses


def stroke_ends(poses: Poses, start: Samples) -> list[float]:
    """Return by load the displacement where a press force's stroke ends, m; zero for other loads.

    It follows the linkage once through its way, whether or not there is a press force.

    Raises:
        Failure: the linkage locks, or two branches meet.
    """
    scene, linkage = poses.scene, poses.linkage
    begin = scene.drive.start
    known = {begin: start}
    for end in scene.drive.extent:
        known |= poses.way(start, begin, end)
    order = sorted(known)
    ends = []
    for load in scene.loads:
        if not isinstance(load, PressForce):
            ends.append(0.0)
            continue
        column = linkage.coordinates.index(f"{load.body}.s")
        best = max(range(len(order)), key=lambda row: load.closing * known[order[row]][column])
        at = order[best]

        def opens(position: float, at: float = at, column: int = column, closing: int = load.closing) -> float:
            *_, (_, x) = poses.way(known[at], at, position)
            return float(-closing * x[column])

        bounds = order[max(best - 1, 0)], order[min(best + 1, len(order) - 1)]
        found = minimize_scalar(opens, bounds=bounds, method="bounded", options={"xatol": 1e-9 * np.ptp(bounds)})
        ends.append(load.closing * linkage.size * max(load.closing * known[at][column], -float(found.fun)))
    return ends
