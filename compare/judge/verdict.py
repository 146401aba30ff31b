"""Whether a run that its engine called a success was one: every quantity within what its settings promise.

Checks of an engine's own output come first and need no reference; the comparison with the reference comes last.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import ceil, floor, log10
from typing import NamedTuple

import numpy as np

from scenes import Scene, Settings, Status
from scenes.channels import Role
from scenes.model.motion import Samples

from ..engines.runner import Run
from ..mechanics.mechanics import SHOWN_GROUPS
from .checks import Check
from .errors import Comparison

MIN_SHARE = 1e-6  # less is given in digits, not in per cent
MAX_GAP = 1e-2  # of the travel of its points: a pin that gapes this far is no pin
MAX_ERROR = 0.1  # of the scale or magnitude: what is so far off belongs to another motion
BRANCH_TOL = 5e-2  # of its travel: with closed pins and the drive in place, only another assembly is so far off
MAX_SUM = 10.0  # times the promise: to what errors within it add up over the joints of a body
BALANCES = {
    "Newton": "forces and m a of {of} are out of balance by {worst} of the {relative_to}",
    "Euler": "moments and I alpha of {of} are out of balance by {worst} of the {relative_to}",
    "power": "the power of the {of} is out of balance by {worst} of the {relative_to}",
}
ESTIMATED = "by its own poses {of} is off by {worst} of the {relative_to}"


class CheckLimit(NamedTuple):
    """The most that a check may find, and what a run is called that exceeds it."""

    check: str
    most: float
    status: Status
    sentence: str


def limits(settings: Settings) -> Iterator[CheckLimit]:
    """Yield what runs at these settings are held to, the worst first."""
    promise, drive = settings.promise, settings.drive_promise
    text = "{of} deviates from the commanded position by {worst} of a {relative_to}"
    yield CheckLimit("drive", drive, Status.inconsistent, text)
    yield CheckLimit("closure", MAX_GAP, Status.diverged, "the joints of {of} are open by {worst} of the {relative_to}")
    yield CheckLimit("branch", 0.0, Status.wrong_branch, "with all joints closed, the {of} flips to another branch")
    yield from (
        CheckLimit(check, MAX_SUM * promise, Status.inconsistent, sentence) for check, sentence in BALANCES.items()
    )
    yield from (CheckLimit(group, MAX_ERROR, Status.inconsistent, ESTIMATED) for group in SHOWN_GROUPS)
    promised = f"; at most {promise:g} is promised,"
    yield from (CheckLimit(group, promise, Status.inaccurate, ESTIMATED + promised) for group in SHOWN_GROUPS)
    opened = "the joints of {of} are open by {worst} of the {relative_to}" + promised
    yield CheckLimit("closure", promise, Status.inaccurate, opened)


def judged(run: Run, checks: Sequence[Check]) -> Run:
    """The run, its status corrected where its own output contradicts it, or is further off than promised."""
    if run.status is not Status.ok:
        return run
    # The first limit that any check breaks names the run, worst status first; of several checks the worst violation is
    # shown.
    for limit in limits(run.settings or Settings("")):
        broken = [check for check in checks if check.check == limit.check and not check.worst <= limit.most]
        if broken:
            worst = broken[int(np.argmax([check.worst for check in broken]))]
            reason = limit.sentence.format(of=worst.of, worst=share(worst.worst), relative_to=worst.relative_to)
            return replace(run, status=limit.status, reason=f"{reason} at {worst.where}", found_by="checks")
    return run


def compared(run: Run, scene: Scene, comparison: Comparison, unexplained: Mapping[str, Samples]) -> Run:
    """The run, its status corrected where the reference contradicts it.

    Unexplained are the errors at the positions commanded, by channel, zero where round-off explains them; shape (n,).
    """
    if run.status is not Status.ok:
        return run
    for point, names in scene.channels.points.items():
        # With closed joints and the drive in place a point can only be so far off in another assembly. The first such
        # sample is named.
        places = [comparison.actual[channel] for channel in names.place if channel in comparison.actual]
        far = np.max(places, axis=0, initial=0.0)
        if not far.max() <= BRANCH_TOL:
            first = scene.where(float(comparison.position[(~(far <= BRANCH_TOL)).argmax()]))
            reason = f"{point} is {share(far.max())} of its travel away from the reference, first at {first}"
            return replace(run, status=Status.wrong_branch, reason=reason, found_by="reference")
    inputs = scene.channels.names(Role.input)
    worst = {channel: float(error.max()) for channel, error in unexplained.items() if channel not in inputs}
    channel = max(worst, key=lambda name: np.inf if np.isnan(worst[name]) else worst[name], default="")
    promise = (run.settings or Settings("")).promise
    if channel and not worst[channel] <= promise:
        where = scene.where(float(comparison.position[unexplained[channel].argmax()]))
        reason = f"{channel} is off the reference by {share(worst[channel])} of the larger of its scale and magnitude"
        reason += f"; at most {promise:g} is promised, at {where}"
        return replace(run, status=Status.inaccurate, reason=reason, found_by="reference")
    return run


def doubted_core(run: Run, doubt: str) -> Run:
    """The core's own run, which is not ok where there is a doubt about it."""
    status = Status.inaccurate if run.status is Status.ok else run.status
    return replace(run, status=status, reason=doubt, found_by="reference")


def share(worst: float) -> str:
    """A relative error as text."""
    return f"{worst:.1%}" if worst >= 1e-2 else f"{worst:.1e}"


def within(size: float) -> str:
    """A relative error as a bound: `0.0004 %`, rounded up, or `9 digits`."""
    if size < MIN_SHARE:
        return f"{digits(size)} digits"
    last = 10.0 ** floor(log10(100 * size))
    return f"{plainly(ceil(100 * size / last) * last, 1)} %"


def sized(size: float) -> str:
    """A relative error as a size: `3.1 %`, or between two bounds."""
    if size < MIN_SHARE:
        return "less than 0.0001 %"
    return f"{plainly(100 * size, 2)} %" if size < 10 else "more than 1000 %"


def digits(size: float) -> int:
    """How many digits a relative error leaves, 15 at most."""
    return min(floor(-log10(size)), 15) if size > 0 else 15


def plainly(number: float, digits: int = 3) -> str:
    """A number to so many digits, without a power of ten."""
    return np.format_float_positional(number, digits, unique=False, fractional=False, trim="-")
