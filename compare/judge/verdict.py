"""Whether a run that its engine called a success was one: every quantity within what its settings promise.

Checks of an engine's own output come first and need no reference; the comparison with the reference comes last.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from scenes import Scene, Settings, Status
from scenes.motion import Samples

from ..engines.runner import Run
from .checks import Check
from .errors import SHOWN_GROUPS, Comparison

OPEN = 1e-2  # of the travel of its points: a pin that gapes this far is no pin
WORTHLESS = 0.1  # of the scale or magnitude: what is so far off belongs to another motion
ELSEWHERE = 5e-2  # of its travel: with closed pins and the drive in place, only another assembly is so far off
SUM = 10.0  # times the promise: to what errors within it add up over the joints of a body
BALANCES = {
    "Newton": "forces and m a of {of} are out of balance by {worst} of the {relative_to}",
    "Euler": "moments and I alpha of {of} are out of balance by {worst} of the {relative_to}",
    "power": "the power of the {of} is out of balance by {worst} of the {relative_to}",
}
ESTIMATED = "by its own poses {of} is off by {worst} of the {relative_to}"


class Limit(NamedTuple):
    """The most that a check may find, and what a run is called that exceeds it."""

    check: str
    most: float
    status: Status
    sentence: str


def limits(settings: Settings) -> Iterator[Limit]:
    """Yield what runs at these settings are held to, the worst first."""
    promise, drive = settings.promise, settings.drive_promise
    off = "{of} is off where the drive asks it to be by {worst} of a {relative_to}"
    yield Limit("drive", drive, Status.inconsistent, off)
    yield Limit("closure", OPEN, Status.diverged, "the joints of {of} are open by {worst} of the {relative_to}")
    yield Limit("branch", 0.0, Status.wrong_branch, "with all joints closed, the {of} flips to another branch")
    yield from (Limit(check, SUM * promise, Status.inconsistent, sentence) for check, sentence in BALANCES.items())
    yield from (Limit(group, WORTHLESS, Status.inconsistent, ESTIMATED) for group in SHOWN_GROUPS)
    promised = f"; at most {promise:g} is promised,"
    yield from (Limit(group, promise, Status.inaccurate, ESTIMATED + promised) for group in SHOWN_GROUPS)
    opened = "the joints of {of} are open by {worst} of the {relative_to}" + promised
    yield Limit("closure", promise, Status.inaccurate, opened)


def judged(run: Run, checks: Sequence[Check]) -> Run:
    """Return the run, its status corrected where its own output contradicts it, or is further off than promised."""
    if run.status is not Status.ok:
        return run
    for limit in limits(run.settings or Settings("")):
        broken = [check for check in checks if check.check == limit.check and not check.worst <= limit.most]
        if broken:
            found = broken[int(np.argmax([check.worst for check in broken]))]
            reason = limit.sentence.format(of=found.of, worst=share(found.worst), relative_to=found.relative_to)
            return replace(run, status=limit.status, reason=f"{reason} at {found.where}", found_by="checks")
    return run


def compared(run: Run, scene: Scene, comparison: Comparison, unexplained: Mapping[str, Samples]) -> Run:
    """Return the run, its status corrected where the reference contradicts it.

    Args:
        run: the run, as its own output lets one judge it.
        scene: the linkage.
        comparison: its errors.
        unexplained: those at the positions commanded, by channel, zero where round-off explains them; shape (n,).
    """
    if run.status is not Status.ok:
        return run
    for point in scene.moving_points:
        both = (f"{point}.x", f"{point}.y")
        places = [comparison.actual[channel] for channel in both if channel in comparison.actual]
        far = np.max(places, axis=0, initial=0.0)
        if not far.max() <= ELSEWHERE:
            first = scene.where(float(comparison.position[(~(far <= ELSEWHERE)).argmax()]))
            reason = f"{point} is {share(far.max())} of its travel away from the reference, first at {first}"
            return replace(run, status=Status.wrong_branch, reason=reason, found_by="reference")
    worst = {channel: float(error.max()) for channel, error in unexplained.items() if channel != scene.drive_channel}
    channel = max(worst, key=lambda name: np.inf if np.isnan(worst[name]) else worst[name], default="")
    promise = (run.settings or Settings("")).promise
    if channel and not worst[channel] <= promise:
        where = scene.where(float(comparison.position[unexplained[channel].argmax()]))
        reason = f"{channel} is off the reference by {share(worst[channel])} of the larger of its scale and magnitude"
        reason += f"; at most {promise:g} is promised, at {where}"
        return replace(run, status=Status.inaccurate, reason=reason, found_by="reference")
    return run


def share(worst: float) -> str:
    """Return a relative error as text."""
    return f"{worst:.1%}" if worst >= 1e-2 else f"{worst:.1e}"
