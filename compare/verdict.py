"""Whether a run that its engine called a success was one. An engine that is wrong must not look right."""

from dataclasses import replace

import numpy as np

from scenes import Scene, Status

from .checks import Check
from .errors import Comparison
from .runner import Run

OPEN = 1e-2  # of the stroke: a pin that gapes this far is no pin
ELSEWHERE = 5e-2  # of the stroke: with closed pins and the same crank angle, only another assembly is this far away


def judged(run: Run, scene: Scene, checks: list[Check], comparison: Comparison) -> Run:
    """Return the run, its status corrected where its own joints or the reference contradict it."""
    gap = max((check for check in checks if check.check == "closure"), key=lambda check: check.worst)
    if not gap.worst <= OPEN:
        where = f"{gap.worst:.1%} of the stroke at crank angle {gap.at_deg:.4g} deg"
        return replace(run, status=Status.diverged, reason=f"the joints of {gap.of} are open by {where}")
    for point in scene.moving_points:
        far = np.maximum(comparison.actual[f"{point}.x"], comparison.actual[f"{point}.y"])
        if not far.max() <= ELSEWHERE:
            degrees = np.degrees(comparison.crank_angle[(far > ELSEWHERE).argmax()])
            where = f"{far.max():.1%} of the stroke away from the reference, first at crank angle {degrees:.4g} deg"
            return replace(run, status=Status.wrong_branch, reason=f"with all joints closed, {point} is {where}")
    return run
