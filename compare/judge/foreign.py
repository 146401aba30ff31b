"""A result of another program, judged as an engine's run is, but for what it is written at: so many decimals.

The half of the last decimal explains an error of a channel, and that of the instants what the motion does meanwhile. In
the checks of the result's own output it explains what they find in the reference, written as the result is.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from scenes import Failure, Motion, Scene, Status
from scenes.motion import Samples, channels

from ..engines.reference import Reference, relative_errors, sizes
from .checks import Check, checks
from .errors import SHOWN_GROUPS, worst_of
from .measure import Measurement, assess
from .round_off import Explained, explain
from .verdict import BALANCES, share

if TYPE_CHECKING:
    from ..results.result import Result

MOST = 1e-2  # relative: more than that is an error, and no decimals excuse it
ALIKE = 3.0  # times what the checks find in the reference: the roundings of two motions differ by chance
SEED = 20261122


def assess_result(reference: Reference, result: "Result") -> Measurement:
    """Return the judgement of a result, at its own instants, in the channels that it has.

    It is held against a reference that is in doubt too.

    Args:
        reference: of the scene.
        result: of another program.
    """
    result = _with_drive_in_place(reference.scene, result)
    request, run = result.request, result.run
    try:
        explained = explained_by_decimals(reference, result)
        true = reference.at(request.commanded(reference.scene), request.times(reference.scene))
        allowed = _found_in_reference(reference, result, true)
    except Failure:  # which is named when it is compared
        return replace(assess(reference, request, run), own=request)
    held = replace(reference, floor=replace(reference.floor, doubt=""))  # with few channels nothing else is a check
    found = assess(held, request, run, explained, lambda own: _excused(_found(reference, own, true), allowed))
    if found.run.status is Status.wrong_branch and not any(check.check == "closure" for check in found.checks):
        found = replace(found, run=replace(found.run, status=Status.inaccurate))  # its units or frame may be others
    if reference.floor.doubt and found.run.found_by == "reference":
        found = replace(found, run=replace(found.run, reason=f"{found.run.reason}; the reference itself is in doubt"))
    return replace(found, own=request)


def coarse(measured: Measurement) -> list[str]:
    """Return a sentence where decimals excuse more than the result promises, so that ok is no more than that.

    Or where it is not ok, and they would have to excuse more than they may.
    """
    run, errors = measured.run, [row for row in measured.errors if row.group != "drive"]  # which is an input
    if not errors or run.settings is None:
        return []
    ok = run.status is Status.ok
    worst = worst_of(errors, "explained" if ok else "unexplained")
    if ok and worst.explained > run.settings.promise:
        unnoticed = f"may be off by {share(worst.explained)} unnoticed"
        return [f"{run.engine}: {worst.channel} {unnoticed}, by its decimals or next to a singular configuration"]
    if not ok and worst.explained >= MOST:
        coarsely = "is written too coarsely: its decimals are of more than the 1 % that they may excuse"
        return [f"{run.engine}: {worst.channel} {coarsely}"]
    return []


def _with_drive_in_place(scene: Scene, result: "Result") -> "Result":
    """Return the result with its drive where the time has it, but for what the drive's own decimals do not explain.

    These excuse no other channel: all are held against the reference at the result's instants.
    """
    drive, motion = scene.drive_channel, result.run.motion
    if motion is None or drive not in result.half_decimals:
        return result
    asked = result.request.commanded(scene)
    off = motion[drive] - asked
    scale = 1.0 if scene.driven_slide is None else float(np.ptp(scene.drive.extent))
    left = np.sign(off) * np.maximum(np.abs(off) - np.minimum(result.half_decimals[drive], MOST * scale), 0.0)
    placed = replace(result.run, motion=Motion({**motion.samples, drive: asked + left}))
    halves = {channel: half for channel, half in result.half_decimals.items() if channel != drive}
    return replace(result, run=placed, half_decimals=halves)


def explained_by_decimals(reference: Reference, result: "Result") -> Explained:
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


def _off(scene: Scene, result: "Result") -> tuple[Samples, Samples]:
    """Return what instants, s, and the positions of the drive there may be off as written, shape (n,)."""
    time = result.half_decimals["time"]
    return time, np.abs(scene.drive.at(result.request.times(scene)).rate) * time


def _meanwhile(reference: Reference, result: "Result", true: Motion) -> dict[str, Samples]:
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


def _found(reference: Reference, motion: Motion, true: Motion) -> list[Check]:
    """Return what the checks find; decimals may put a press's slider on the other side of a switch than in `true`."""
    complete = motion.samples.keys() >= set(channels(reference.scene))
    may = reference.acts(motion, true) if complete else None
    return checks(reference.scene, motion, reference.travel, may, reference.stroke_ends)


def _found_in_reference(reference: Reference, result: "Result", true: Motion) -> list[Check]:
    """Return what the checks find in the reference's own motion, each number off by as much as it may be as written."""
    scene, request = reference.scene, result.request
    draw = np.random.default_rng(SEED)
    halves = {**result.half_decimals, scene.drive_channel: _off(scene, result)[1]}
    assert result.run.motion is not None
    off = {
        channel: true[channel] + draw.uniform(-1, 1, request.count) * halves.get(channel, 0.0)
        for channel in result.run.motion.samples
    }
    return _found(reference, Motion(off | {"time": true["time"]}), true)


def _excused(found: list[Check], allowed: list[Check]) -> list[Check]:
    """Return what checks find, nothing where the decimals explain it.

    A balance adds up many channels, each of which is held against the reference by itself: it has no other limit.
    """
    most = {_of(each): min(ALIKE * each.worst, np.inf if each.check in BALANCES else MOST) for each in allowed}
    return [replace(check, worst=0.0) if check.worst <= most.get(_of(check), 0.0) else check for check in found]


def _of(check: Check) -> tuple[str, str]:
    """Return what a check is of; those of groups are of whichever channel is worst."""
    return check.check, "" if check.check in SHOWN_GROUPS else check.of
