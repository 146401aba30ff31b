"""A result of another program, judged as an engine's run is, but for what it is written at: so many decimals.

The half of the last decimal explains an error of a channel, and that of the instants what the motion does meanwhile. In
the checks of the result's own output it explains what they find in the reference, written as the result is.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from scenes import Failure, Motion, Scene
from scenes.motion import Samples

from ..engines.reference import Reference, relative_errors, sizes
from ..results.result import Result
from .checks import Check, checks
from .errors import SHOWN_GROUPS
from .measure import Measurement, assess
from .round_off import Explained, explain

MOST = 1e-2  # relative: more than that is an error, and no decimals excuse it
ALIKE = 3.0  # times what the checks find in the reference: the roundings of two motions differ by chance
SEED = 20261122


def assess_result(reference: Reference, result: Result) -> Measurement:
    """Return the judgement of a result, at its own instants, in the channels that it has.

    Args:
        reference: of the scene.
        result: of another program.
    """
    request, run = result.request, result.run
    try:
        explained = explained_by_decimals(reference, result)
        excused = partial(_excused, allowed=_found_in_reference(reference, result))
    except Failure:  # which is named when it is compared
        return replace(assess(reference, request, run), own=request)
    return replace(assess(reference, request, run, explained, excused), own=request)


def explained_by_decimals(reference: Reference, result: Result) -> Explained:
    """Return errors that round-off and decimals explain, at the instants of a result.

    Raises:
        Failure: there is no reference at one of them.
    """
    scene, request = reference.scene, result.request
    explained = explain(reference, request)
    true = reference.at(request.commanded(scene), request.times(scene))
    moved = _meanwhile(reference, result, true)
    written = {}
    for channel in explained.sensitivity:
        if channel in reference.scale:
            stem, axis = channel[:-1], channel[-1]
            both = (stem + "x", stem + "y") if axis in "xy" else (channel,)
            halves = [result.half_decimals[c] for c in both if c in result.half_decimals]
            half = np.linalg.norm(halves or [np.zeros(1)], axis=0)
            relative = half / sizes(true, channel, reference.scale[channel]) + moved.get(channel, 0.0)
            written[channel] = np.minimum(relative, MOST)
    return replace(explained, written=written)


def _off(scene: Scene, result: Result) -> tuple[Samples, Samples]:
    """Return what instants, s, and the positions of the drive there may be off as written, shape (n,)."""
    time = result.half_decimals["time"]
    return time, np.abs(scene.drive.at(result.request.times(scene)).rate) * time + result.half_decimals.get(
        scene.drive_channel, 0.0
    )


def _meanwhile(reference: Reference, result: Result, true: Motion) -> dict[str, Samples]:
    """Return how far each channel moves while the instants are off as written, relative, shape (n,)."""
    (time, position), moved = _off(reference.scene, result), dict[str, Samples]()
    for way in (1, -1) if position.any() else ():
        there = true[reference.scene.drive_channel] + way * position
        try:
            other = reference.at(there, true["time"] + way * time)
        except Failure:  # beyond the end of the drive
            continue
        for channel, error in relative_errors(other, true, reference.scale).items():
            moved[channel] = np.maximum(moved.get(channel, 0.0), error)
    return moved


def _found_in_reference(reference: Reference, result: Result) -> list[Check]:
    """Return what the checks find in the reference's own motion, each number off by as much as it may be as written."""
    scene, request = reference.scene, result.request
    true = reference.at(request.commanded(scene), request.times(scene))
    draw = np.random.default_rng(SEED)
    halves = {**result.half_decimals, scene.drive_channel: _off(scene, result)[1]}
    assert result.run.motion is not None
    off = {
        channel: true[channel] + draw.uniform(-1, 1, request.count) * halves.get(channel, 0.0)
        for channel in result.run.motion.samples
    }
    return checks(scene, Motion(off | {"time": true["time"]}), reference.stroke)


def _excused(found: list[Check], allowed: list[Check]) -> list[Check]:
    """Return what checks find, nothing where the decimals explain it."""
    most = {_of(check): min(ALIKE * check.worst, MOST) for check in allowed}
    return [replace(check, worst=0.0) if check.worst <= most.get(_of(check), 0.0) else check for check in found]


def _of(check: Check) -> tuple[str, str]:
    """Return what a check is of; those of groups are of whichever channel is worst."""
    return check.check, "" if check.check in SHOWN_GROUPS else check.of
