"""The likely cause of a disagreement: the simplest that explains nearly all of it, or none."""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from math import remainder, tau

import numpy as np

from scenes import Failure, Motion, Rows, Status
from scenes.channels import TO_LOCK

from ..engines.registry import REFERENCE
from ..mechanics.reference import Reference
from .causes.cause import UNKNOWN, Cause, Kind
from .causes.evidence import CAUSE_TOL, MAX_REST, Evidence, Hypothesis, away_from_switches, evidence, price
from .causes.forces import force_causes, late_loads
from .causes.numbers import affordable, number_causes
from .causes.read_out import in_some_rows, read_out_causes
from .causes.samples import course_causes, incomplete, irregular, sample_causes
from .causes.whole import drive_causes, frame_causes, strayed
from .causes.words import words
from .errors import worst_of
from .measure import Measurement

ROUND_OFF_TOL = 1e-11  # relative, a sample
MIN_ROWS = 4  # of which a course can be judged
MAX_RATIO_OF_OTHERS = 0.1  # of an error: others that have less do not share its cause
MAX_RATIO_OF_TIES, TIE_TOL = 1.1, 1e-3  # ratio of residuals, and share of the deviation: causes within either are tied
COARSE = "its settings are too coarse: of its error {one}"
SINGULAR_TOL = 1e-3  # of the largest length: so near to a singular configuration engines may take the other assembly
WINDOW = 1 / 24  # of the drive's way about it
ASTRAY_TOL = 0.01  # of the largest error: what is less is no sign of that
LEFT = {Status.wrong_branch, Status.inconsistent, Status.inaccurate, Status.diverged}
MAX_PLACES = 3  # bodies, joints and points: of more, what is wrong in the scene is in several


def cause(reference: Reference, sampling: Rows, motion: Motion) -> Cause:
    """Return the likely cause of the distance of a motion from what it should be."""
    if missing := incomplete(reference, sampling, motion):
        return missing
    if sampling.count < MIN_ROWS:
        return UNKNOWN
    try:
        return likeliest(evidence(reference, sampling, motion))
    except Failure:  # there is no reference at one of its rows
        return UNKNOWN


# Every cause predicts a motion, and is measured by what that leaves over of the deviation (`evidence`). Its price is
# this rest, raised by a part of itself for each number that was fitted: of causes that explain alike the one with the
# fewest numbers is the cheapest. Rests below the least of all, which is what the engine is off besides, count as
# equal. Costly searches, of the drive and of the scene's numbers, are left out where a plain cause of one place is
# found in a large scene. Where no cause explains enough none is named: see `likeliest`.
def ranked(evidence: Evidence) -> list[tuple[float, float, Hypothesis]]:
    """Return causes with their price, the least first, and what they leave over."""
    elsewhere = away_from_switches(evidence)
    known: list[tuple[float, Hypothesis]] = []

    def try_all(seen: Evidence, *causes: Callable[[Evidence], Iterator[Hypothesis]]) -> None:
        known.extend((seen.left(hypothesis.predicted), hypothesis) for each in causes for hypothesis in each(seen))

    try_all(evidence, sample_causes, read_out_causes, frame_causes, course_causes)
    try_all(elsewhere, force_causes)
    try_all(evidence, late_loads)
    # Costly ones are tried where no plain one explains what one body or joint has.
    many = len({evidence.channels[name].owner for name in evidence.names}) > MAX_PLACES
    if not (many and any(left <= TIE_TOL and hypothesis.cause.place != "all" for left, hypothesis in known)):
        try_all(evidence, drive_causes)
        try_all(affordable(elsewhere), number_causes)
    if not any(left <= CAUSE_TOL for left, _ in known):
        try_all(evidence, in_some_rows)
    least = min((left for left, _ in known), default=0.0)  # what the engine is off besides
    floor = min(max(least, TIE_TOL), CAUSE_TOL)
    return sorted(
        ((price(max(left, floor), hypothesis.freedom), left, hypothesis) for left, hypothesis in known),
        key=lambda entry: entry[:2],
    )


def likeliest(evidence: Evidence) -> Cause:
    """Return the cheapest cause that explains nearly all; where none does, noise, or a drive that is not in its place.

    Others that leave no more, with a number more at most, are named with it. A deviation of rounding has no cause.
    """
    if not evidence.total > len(evidence.rows) * ROUND_OFF_TOL**2:
        return UNKNOWN
    causes = ranked(evidence)
    if not (causes and causes[0][0] <= MAX_REST):
        return irregular(evidence) or strayed(evidence) or UNKNOWN
    _, left, best = causes[0]
    close = [
        hypothesis.cause
        for _, rest, hypothesis in causes
        if rest <= MAX_RATIO_OF_TIES * left + TIE_TOL and hypothesis.freedom <= best.freedom + 1
    ]
    close = [candidate for candidate in close if len(candidate.besides) <= len(best.cause.besides)]
    text, channels = best.cause.text, {*best.cause.part.channels}
    close = [
        candidate for candidate in close if not (candidate.text == text and channels < {*candidate.part.channels})
    ]  # it, of more channels
    alike = {(candidate.kind, candidate.place): candidate for candidate in reversed(close)}
    others = tuple(candidate for key, candidate in alike.items() if key != (best.cause.kind, best.cause.place))
    return replace(best.cause, left=left, others=others)


def sentences(reference: Reference, measurements: Sequence[Measurement], off: Collection[str] = ()) -> dict[str, str]:
    """Return a line for each engine whose cause is known; where the core is in doubt, for it alone.

    Engines that are ok, or returned no motion, have none; but those in `off` have one, which are ok and miss a
    tolerance. The reference is that after all engines have been heard.
    """
    if doubt := reference.floor.doubt:
        return {REFERENCE: f"{REFERENCE}: {doubt}"}
    failed = [m for m in measurements if m.run.status is not Status.ok or m.run.engine in off]
    alone = len(failed) == 1 and len(measurements) > 2 and _alone(failed[0], measurements)
    lines = {}
    for m in failed:
        if m.run.motion is None:
            continue
        coarse = Cause(Kind.solver, "all", COARSE, names=(m.finer,))  # others leave hardly any of the error
        given = replace(m.asked, channels=frozenset(m.run.motion.samples))  # all but what was refused as missing
        asked = m.asked if m.run.status is Status.unsupported else given
        if singular := near_singular(reference, m):
            lines[m.run.engine] = f"{m.run.engine}: {singular}{', the others agree' * alone}"
            continue
        found = coarse if m.finer else cause(reference, asked, m.run.motion)
        if found != UNKNOWN:
            lines[m.run.engine] = f"{m.run.engine}: {words(reference.scene, found)}{', the others agree' * alone}"
    return lines


def near_singular(reference: Reference, failed: Measurement) -> str:
    """Where an engine goes astray at a nearly singular configuration, and how far that is from one; or nothing.

    Its largest error by sample first exceeds `ASTRAY_TOL` of what it ever is within `WINDOW` of the place that is
    nearest to a singular configuration. No finer settings help there, as they would were they too coarse: a
    length that is off by that distance makes another linkage of it.
    """
    channels = reference.scene.channels
    # Distance to the nearest singular configuration over the cycle, by length; the engine must leave its branch within
    # a window about that place, and have no excuse in its settings.
    locks = {name: v for name, v in reference.cycle.samples.items() if channels[name].quantity == TO_LOCK}
    if failed.comparison is None or not locks or failed.run.status not in LEFT:
        return ""
    scene, least = reference.scene, {name: float(np.nanmin(values)) for name, values in locks.items()}
    joint = min(least, key=lambda name: least[name])
    if not least[joint] <= SINGULAR_TOL * reference.mechanics.size:
        return ""
    position = reference.cycle[scene.channels.drive.position]
    there = float(position[int(np.nanargmin(locks[joint]))])
    errors = np.max([*failed.comparison.actual.values()], axis=0)
    first = float(failed.comparison.position[int((~(errors <= ASTRAY_TOL * np.nanmax(errors))).argmax())])
    (drive,) = scene.drives
    distance = first - there if drive.slide is not None else remainder(first - there, tau)
    if not abs(distance) <= WINDOW * float(np.ptp(position)):
        return ""
    how = "takes another assembly from there" if failed.run.status is Status.wrong_branch else "is off from there"
    return (
        f"the linkage is {scene.length(least[joint])} from a singular configuration at {scene.where(there)}; it {how}"
    )


def _alone(failed: Measurement, measurements: Sequence[Measurement]) -> bool:
    """Return whether all others are far nearer to the reference in the channel in which one is off the most."""
    others = [m for m in measurements if m is not failed and m.run.engine != REFERENCE]
    if not failed.errors:
        return False
    worst = worst_of(failed.errors)
    theirs = [[row.max for row in m.errors if row.channel == worst.channel] for m in others]
    return all(errors and max(errors) <= MAX_RATIO_OF_OTHERS * worst.max for errors in theirs)
