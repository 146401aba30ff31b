"""Whether a run that its engine called a success was one. An engine that is wrong must not look right.

Checks of an engine's own output come first and need no reference; the comparison with the reference comes last.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from scenes import Scene, Status

from ..engines.runner import Run
from .checks import Check
from .errors import Comparison

OPEN = 1e-2  # of the stroke, or of the drive's turn or travel: a pin that gapes this far is no pin
WORTHLESS = 0.1  # of the scale or peak: no better than a guess. What is coarse but of use stays well below
ELSEWHERE = 5e-2  # of the stroke: with closed pins and the drive in place, only another assembly is so far off


class Limit(NamedTuple):
    """The most that a check may find, and what a run is called that exceeds it."""

    most: float
    status: Status
    sentence: str


POOR = Status.not_converged
LIMITS = {
    "drive": Limit(OPEN, Status.diverged, "{of} is off where the drive asks it to be by {worst} of a {relative_to}"),
    "closure": Limit(OPEN, Status.diverged, "the joints of {of} are open by {worst} of the {relative_to}"),
    "branch": Limit(0.0, Status.wrong_branch, "with all joints closed, the {of} flips to another branch"),
    "estimate": Limit(WORTHLESS, POOR, "by its own poses {of} is off by {worst} of the {relative_to}"),
    "Newton": Limit(WORTHLESS, POOR, "forces and m a of {of} are out of balance by {worst} of the {relative_to}"),
    "Euler": Limit(WORTHLESS, POOR, "moments and I alpha of {of} are out of balance by {worst} of {relative_to}"),
    "power": Limit(WORTHLESS, POOR, "the power of the {of} is out of balance by {worst} of the {relative_to}"),
}


def judged(run: Run, checks: list[Check]) -> Run:
    """Return the run, its status corrected where its own output contradicts it."""
    if run.status is not Status.ok:
        return run
    for name, limit in LIMITS.items():
        broken = [check for check in checks if check.check == name and not check.worst <= limit.most]
        if broken:
            found = broken[int(np.argmax([check.worst for check in broken]))]
            reason = limit.sentence.format(of=found.of, worst=f"{found.worst:.1%}", relative_to=found.relative_to)
            return replace(run, status=limit.status, reason=f"{reason} at {found.where}", found_by="checks")
    return run


def compared(run: Run, scene: Scene, checks: list[Check], comparison: Comparison) -> Run:
    """Return the run, its status corrected where the reference contradicts it."""
    if run.status is not Status.ok:
        return run
    closed = "with all joints closed, " if any(check.check == "closure" for check in checks) else ""
    for point in scene.moving_points:
        both = (f"{point}.x", f"{point}.y")
        places = [comparison.actual[channel] for channel in both if channel in comparison.actual]
        far = np.max(places, axis=0, initial=0.0)
        if not far.max() <= ELSEWHERE:
            first = scene.where(float(comparison.position[(~(far <= ELSEWHERE)).argmax()]))
            where = f"{far.max():.1%} of the stroke away from the reference, first at {first}"
            return replace(run, status=Status.wrong_branch, reason=f"{closed}{point} is {where}", found_by="reference")
    return run
