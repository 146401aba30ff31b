"""Whether a run that its engine called a success was one. An engine that is wrong must not look right."""

from dataclasses import replace

import numpy as np

from scenes import Scene, Status

from .checks import Check
from .errors import Comparison
from .runner import Run

OPEN = 1e-2  # of the stroke: a pin that gapes this far is no pin
ELSEWHERE = 5e-2  # of the stroke: with closed pins and the drive where it says, only another assembly is this far away


def judged(run: Run, scene: Scene, checks: list[Check], comparison: Comparison) -> Run:
    """Return the run, its status corrected where its own joints or the reference contradict it."""
    gap = max((check for check in checks if check.check == "closure"), key=lambda check: check.worst, default=None)
    if gap is not None and not gap.worst <= OPEN:
        where = f"{gap.worst:.1%} of the stroke at {gap.where}"
        return replace(run, status=Status.diverged, reason=f"the joints of {gap.of} are open by {where}")
    closed = "with all joints closed, " if scene.asked is None else ""
    for point in scene.moving_points:
        both = (f"{point}.x", f"{point}.y")
        places = [comparison.actual[channel] for channel in both if channel in comparison.actual]
        far = np.max(places, axis=0, initial=0.0)
        if not far.max() <= ELSEWHERE:
            first = scene.where(float(comparison.position[(far > ELSEWHERE).argmax()]))
            where = f"{far.max():.1%} of the stroke away from the reference, first at {first}"
            return replace(run, status=Status.wrong_branch, reason=f"{closed}{point} is {where}")
    return run
