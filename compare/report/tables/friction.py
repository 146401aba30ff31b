"""What friction does in the reference's motion: losses by joint, efficiency, where it jams, where it locks itself."""

from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from scenes import Failure, Motion, Sampling, Scene
from scenes.channels import POWER
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed

from ...engines import registry
from ...mechanics.axis import axis, cycle_name, grouped
from ...mechanics.elements import drive_power, of_element, power_of
from ...mechanics.friction import contraction, rate
from ...mechanics.motion_vectors import MotionVectors
from ...mechanics.scales import resting
from ...study import Study
from ..numbers import percent, short, units, written
from . import TableRows

MAX_FACTOR = 100.0  # on the coefficients: what does not jam there is not said to jam
HALVINGS = 13  # of their range, on a logarithmic scale: to three digits
CYCLE = Sampling(360)
ZERO_WORK_TOL = 1e-9  # of a work in either sense: the net work of a load that gives back what it takes
MAX_RANGES = 3  # of positions that are named


def losses(scene: Scene, motion: Motion) -> dict[str, Samples]:
    """The power, W, that each joint's friction takes, by joint, each of shape (n,)."""
    state = MotionVectors(scene, motion)
    return {
        friction.joint(scene): -motion[friction.channel(scene)] * rate(state, friction) for friction in scene.friction
    }


def by_joint(study: Study) -> TableRows:
    """Yield the work that each joint's friction takes in a cycle, its mean power, and its share of all."""
    (per_joule, joule), (per_watt, watt) = (units(study.reference)[si] for si in "JW")
    cycle, duration = study.reference.cycle, study.scene.cycle
    works = {joint: _work(cycle, power) for joint, power in losses(study.scene, cycle).items()}
    whole = sum(works.values())
    for joint, work in sorted(works.items(), key=lambda row: -row[1]):
        taken = {f"work lost a {cycle_name(study.scene)} [{joule}]": per_joule * work}
        taken |= {f"mean power [{watt}]": per_watt * work / duration}
        yield {"joint": joint, **taken, "share": percent(work / whole) if whole else None}


def sentences(study: Study) -> Iterator[str]:
    """Yield what friction does, a sentence each."""
    scene, cycle, named = study.scene, study.reference.cycle, units(study.reference)
    yield from _efficiency(study)
    channel = scene.channels.drive.effort
    both = (float(np.abs(values).max()) for values in (cycle[channel], frictionless(scene, cycle)))
    largest, free = (written(value, scene.channels[channel].unit, named) for value in both)
    effort = f"the drive's largest {scene.channels[channel].quantity} is {largest}, without friction {free}"
    yield f"At {grouped(len(cycle['time']))} positions {effort}."
    yield _jam(scene)
    if scene.steady:
        yield _locking(study)
    bound = float(contraction(study.reference.mechanics, study.motion).max())
    proven = "less than 1, so no other forces are possible" if bound < 1 else "not below 1, so others are not ruled out"
    yield f"The contraction factor of the joint forces by their own friction is at most {short(bound)}: {proven}."
    if count := int(resting(MotionVectors(scene, study.motion)).sum()):
        rest = "there its friction is unknown, and no engine is judged by its forces"
        yield f"At {count} of {study.sampling.count} samples a joint is at rest, or turns round: {rest}."


def _efficiency(study: Study) -> Iterator[str]:
    """Yield what of the drive's work the loads take in a cycle, and while they take power."""
    scene, cycle, name = study.scene, study.reference.cycle, cycle_name(study.scene)
    state, work = MotionVectors(scene, cycle), partial(written, si="J", shown=units(study.reference))
    # The work of a load is the integral of its power over the cycle. Efficiency is what the loads take of what the
    # drive gives; it means nothing where the loads give work on balance, or where the drive brakes on balance, hence
    # the cases.
    power, pressed = drive_power(state), state.pressed(study.reference.stroke_ends)
    pushes = (push for load in scene.loads for push in of_element(pressed, load))
    taken = -sum((power_of(pressed, push) for push in pushes), np.zeros_like(power))  # of all loads
    drive, net, lost = _work(cycle, power), _work(cycle, taken), -_work(cycle, cycle[POWER])
    none = abs(net) <= ZERO_WORK_TOL * _work(cycle, np.abs(taken))
    if none and abs(drive - lost) <= ZERO_WORK_TOL * _work(cycle, np.abs(power)):
        yield f"The loads take no net work: all of the drive's work, {work(drive)}, is lost to friction."
    elif none or net < 0 or drive <= 0:
        gives = "take no net work" if none else f"{'give' if net < 0 else 'take'} {work(abs(net))}"
        yield f"In a {name} the loads {gives}, the drive gives {work(drive)}; {work(lost)} are lost to friction."
    else:
        reaches = f"{percent(net / drive)} of the drive's work, {work(drive)}, reaches the loads"
        yield f"{reaches}; {work(lost)} are lost to friction."
    stroke = taken > 0
    if stroke.any() and (none or (taken < 0).any()):
        load, given = (_work(cycle, np.where(stroke, values, 0.0)) for values in (taken, power))
        of_it = "the rest is from moving masses, weights and springs"
        if given > load:
            of_it = f"{percent(load / given)} of it reaches the loads"
        yield f"While the loads take power, {work(load)}, the drive gives {work(given)}: {of_it}."


def frictionless(scene: Scene, motion: Motion) -> Samples:
    """The drive's torque, N m, or force, N, without friction, at the samples of a motion."""
    free, channel = replace(scene, friction=()), scene.channels.drive.effort
    return registry.reference(free, frozenset((channel,)))(motion.inputs(free))[channel]


def _work(motion: Motion, power: Samples) -> float:
    return float(((power[1:] + power[:-1]) / 2 * np.diff(motion["time"])).sum())


def _jam(scene: Scene) -> str:
    def jams(factor: float) -> bool:
        scaled = (replace(friction, coefficient=factor * friction.coefficient) for friction in scene.friction)
        harder = replace(scene, friction=tuple(scaled))
        try:
            registry.motion(harder, CYCLE, frozenset((scene.channels.drive.effort,)))
        except Failure:
            return True
        return False

    if not jams(MAX_FACTOR):
        return f"It does not jam with {MAX_FACTOR:g} times its coefficients of friction."
    # Bisection over a geometric series of factors, 13 runs instead of 8193, for three digits of the factor. It takes
    # for granted that what jams jams with more friction too; the first factor is known to move, the last one to jam.
    factors = np.geomspace(1.0, MAX_FACTOR, 2**HALVINGS + 1)
    most = factors[bisect_left(factors, True, 1, len(factors) - 1, key=jams) - 1]
    more = "with more it jams, or its forces are not determined"
    return f"It moves with up to {most:.3g} times its coefficients of friction; {more}."


def _locking(study: Study) -> str:
    """Where in a cycle the loads would drive it back without friction, and do not with it."""
    scene, cycle, law = study.scene, study.reference.cycle, study.scene.drive.law
    assert isinstance(law, ConstantSpeed)
    # A linkage locks itself where the loads alone would drive it back if there were no friction, but do not against
    # friction. It is solved on the way back through the same positions, with friction and without: where the drive has
    # to be held back without friction (its power is negative) and has to push with it (zero or more), it is
    # self-locking.
    backwards = replace(law, speed=-law.speed)
    if law.end is not None:
        backwards = replace(backwards, start=law.end, end=law.start)

    def needs(variant: Scene) -> Samples:
        """The drive's power on the way back through the same positions."""
        back = variant.with_law(backwards)
        there = registry.reference(back)(cycle.inputs(back))
        return drive_power(MotionVectors(back, there))

    try:
        driven, held = needs(replace(scene, friction=())) < 0, needs(scene) >= 0
    except Failure as failure:
        return f"Driven back at the same speed, it does not move on everywhere: {failure.reason.partition(':')[0]}."
    share, locked = percent(float(driven.mean())), driven & held
    would = f"Driven back, without friction the loads would push the drive at {share} of the positions"
    if not locked.any():
        return f"{would}; with it they do so too: it is nowhere self-locking."
    edges = np.flatnonzero(np.diff([False, *locked, False])).reshape(-1, 2)
    along, places = axis(scene), cycle[axis(scene).channel]
    longest = sorted(sorted(edges.tolist(), key=lambda edge: edge[0] - edge[1])[:MAX_RANGES])
    ranges = [along.text(places[first], places[last - 1]) for first, last in longest]
    more = " and others" if len(edges) > MAX_RANGES else ""
    where = f"{along.quantity} {', '.join(ranges)}{more}"
    return f"{would}; at {percent(float(locked.mean()))} it is self-locking, friction holds them: {where}."
