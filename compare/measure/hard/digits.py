"""How many digits the reference loses, and how many it may: what doubles cost against what the linkage itself does.

A scene's numbers are doubles, each as if off by half a unit in the last place, eps / 2. The condition of the problem is
by how much more than its inputs an output changes, both relative, the worst that all inputs off by one unit can do
together:

    condition = max over channels and positions of  sum over inputs of  |change of the channel| / (its peak STEP)   (1)

found by arbitrary precision, input after input a STEP off. Reference and truth are compared by the same measure,

    digits lost = log10(largest error / (eps peak))  <=  log10(condition) + 1,                                      (2)

so that a formula which loses one digit more than its problem is seen, and the condition is no excuse for it.

How both go with kappa, the condition of the position's Jacobian J alone, is in docs/theory.md, under round-off limits.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import groupby
from math import log10

import numpy as np

from scenes import Failure, Motion, Positions, Request, Sampling, Scene, Status
from scenes.channels import TO_LOCK
from scenes.fields import put
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed

from ...engines import registry
from ...engines.runner import run
from ...judge.peaks.peaks import peaks
from ...mechanics.mechanics import EPS, SHOWN_GROUPS, inputs
from ...mechanics.reference import Reference, on_switch
from ...mechanics.scales import magnitude, relative_errors

STEP = 2.0**-40  # 1e-12, of an input: the changes keep four digits as doubles, and are small down to 1e-10 from lock
ZERO_TOL = 1e-20  # of what its errors are divided by: what 50 digits leave of a channel that is zero by symmetry
EQUALLY = 12  # positions over a cycle, besides those about the nearest lock
AROUND = np.geomspace(1e-6, 3e-2, 8)  # of a cycle: on either side of it, on the scale of any distance from 1e-11


def digits_lost(reference: Reference) -> dict[str, dict[str, float]]:
    """By channel group how many digits the reference has `lost`, and how many are `allowed` by the problem's condition.

    Where the speed is constant this is at equally spaced positions, at the one nearest to a lock, and close around it;
    the switches of press forces, where forces jump and have no condition, are left out. Failure where one of the two
    models does not solve the scene.
    """
    scene, mechanics = reference.scene, reference.mechanics
    request: Request = Sampling(EQUALLY)
    if isinstance(scene.drive.law, ConstantSpeed):
        # Positions rather than instants: the drive stands exactly where it is asked to, so that no round-off of a law's
        # evaluation is counted with that of the linkage.
        request = Positions(tuple(positions(scene, nearest_lock(reference)).tolist()))
    true = _certified(scene, request)
    # Errors are relative to the channel's own peak; a channel that is zero by symmetry has only the noise of 50 digits
    # for a peak and is measured by its scale.
    peak = {c: float(magnitude(true, scene.channels[c]).max()) for c in mechanics.units}
    size = {c: value if value > ZERO_TOL * reference.scale[c] else reference.scale[c] for c, value in peak.items()}
    decided = np.setdiff1d(np.arange(len(true["time"])), on_switch(reference.acts(true)))
    there = reference.at(true.inputs(scene))
    errors = relative_errors(scene.channels, there, true, size)
    changes = _changes(scene, request, true, size)
    digits = {}
    for group in SHOWN_GROUPS:
        if mine := [channel for channel in errors if mechanics.groups[channel] == group]:
            worst = float(np.max([errors[channel][decided] for channel in mine], initial=0.0))
            condition = max(1.0, *(float(changes[channel][decided].max(initial=0.0)) for channel in mine))
            lost = log10(max(worst / EPS, 1.0))  # none below one unit in the last place
            digits[group] = {"lost": lost, "allowed": log10(condition) + 1}
    return digits


def nearest_lock(reference: Reference) -> float:
    """The drive's position, rad or m, with a group nearest to a lock at a length; the first one without a lock."""
    scene, found = reference.scene, peaks(reference, Sampling(EQUALLY), [])
    of_lock = (peak.position for peak in found if scene.channels[peak.channel].quantity == TO_LOCK)
    return next(of_lock, scene.drive.law.extent[0])


def positions(scene: Scene, middle: float) -> Samples:
    """Return positions over a cycle, and one more with those close around it, rad or m, as the drive comes by."""
    least, most = scene.drive.law.extent
    distances = (most - least) * AROUND
    close = np.array([*(middle - distances), middle, *(middle + distances)])
    if not scene.periodic:
        close = close[(close >= least) & (close <= most)]
    all_ = np.unique([*np.linspace(least, most, EQUALLY + 1), *close])
    return all_ if scene.drive.law.start == least else all_[::-1]


def _certified(scene: Scene, request: Request) -> Motion:
    """Every channel as arbitrary precision has it."""
    done = run(registry.ORACLE, scene, request)
    if done.motion is None or done.status is not Status.ok:
        raise Failure(done.status, done.reason)
    return done.motion


def _changes(scene: Scene, request: Request, true: Motion, size: Mapping[str, float]) -> dict[str, Samples]:
    """The sum of (1) by channel, shape (n,)."""
    problems = [(other, request) for other in inputs_off(scene)]
    if isinstance(request, Positions):  # the drive off everywhere: of 1 rad for a crank, however many turns it counts
        step = STEP * (1.0 if scene.drive.slide is None else float(np.abs(scene.drive.law.extent).max()))
        problems.append((scene, replace(request, positions=tuple(x + step for x in request.positions))))
    total = {channel: np.zeros(true["time"].shape) for channel in size if channel != "time"}
    for problem in problems:
        for channel, change in relative_errors(scene.channels, _certified(*problem), true, size).items():
            total[channel] += change / STEP
    return total


def inputs_off(scene: Scene) -> Iterator[Scene]:
    """The scene with one input after the other a STEP off.

    A vector is off along itself and across itself, by its own length: formulas round it as a whole; a unit vector is
    off across itself alone.
    """
    for path, together in groupby(
        inputs(scene), lambda number: number.at[:-1] if isinstance(number.at[-1], int) else number.at
    ):
        first, *others = numbers = [*together]
        if any(number.value for number in numbers):
            if first.quantity.dimension != "direction":
                yield put(scene, {number.at: number.value * (1 + STEP) for number in numbers})
            if others and (path[0], path[-1]) != ("loads", "forces"):  # of a table
                x, y = numbers
                # Across the vector: turned by STEP rad, at the same length to the first order.
                yield put(scene, {x.at: x.value - STEP * y.value, y.at: y.value + STEP * x.value})
