"""Canaries: copies of the motions just judged, each wrong on purpose, that the comparison has to notice.

Each takes the way of a real run: completeness, checks, comparison, verdict, gates, and what stops a CI run. One that
comes through is a fault of the comparison itself, and named.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import cycle

import numpy as np

from scenes import Status
from scenes.channels import Role
from scenes.fields import put

from ...engines import registry
from ..agreement import Judgement
from . import noticed
from . import spoilt_motion as spoilt

MIN_DISTANCE = 0.1  # of the scale: components that are nearer, as where no force acts, are not worth swapping


def canaries(judgement: Judgement) -> list[str]:
    """The faults that are let through, a line each; none where no run is ok or the reference is in doubt."""
    runs = [m.run for m in judgement.measurements if m.run.status is Status.ok and m.run.motion and not m.foreign]
    ok = [run for run in runs if run.engine in registry.OWN]  # one of fewer channels lacks what is broken
    if not ok or judgement.reference.floor.doubt:
        return []
    copies = [noticed.Thinned(judgement.reference, judgement.sampling, run, judgement.explained) for run in ok]
    compared = copies[-1], ("an error in one channel or another", noticed.each_channel_is_seen)  # the least accurate
    return [
        f"the comparison itself: it lets through {copy.run.engine} with {wrong}"
        for copy, (wrong, sees) in (*zip(cycle(copies), _canaries(copies[0]), strict=False), compared)  # in turn
        if not sees(copy)
    ]


def _canaries(first: noticed.Thinned) -> Iterator[tuple[str, noticed.Noticed]]:
    """Yield what is wrong with each copy, in words, and whether that is noticed; of the channels that there are."""
    scene, count, scale = first.scene, first.sampling.count, first.reference.scale
    drive = scene.channels.drive.position
    channels = first.excess(1.0).keys() - {drive}
    sizes = {c: float(np.abs(samples).max()) / scale[c] for c, samples in first.motion.samples.items() if c in channels}
    largest = max(sizes, key=sizes.__getitem__)

    opposite = partial(spoilt.scaled, names=[largest], factor=-1)
    yield f"{largest} of the opposite sign", partial(noticed.refused_if_moved, opposite)
    vectors = [scene.channels[name].components for name in sizes if scene.channels[name].axis == "x"]
    both = [(x, y) for x, y in vectors if y in sizes]
    apart = [(x, y) for x, y in both if np.abs(first.motion[x] - first.motion[y]).max() > MIN_DISTANCE * scale[x]]
    for x, y in apart[-1:]:
        yield f"{x} and {y} swapped", partial(noticed.refused, partial(spoilt.swapped, first=[x], second=[y]))
    every, late = {*channels, drive}, partial(spoilt.taken, rows=[0, *range(count - 1)])
    yield "all late by a sample", partial(noticed.refused, partial(late, names=every))
    yield "all but the drive late by a sample", partial(noticed.refused_if_moved, partial(late, names=channels))
    yield "a drive that lags", _lagging
    if scene.has_masses and first.complete:
        yield "another mass", _another_mass

    row = 1 + int(np.abs(np.diff(first.true[drive])).argmax())
    frozen = [*range(row), row - 1, *range(row + 1, count)]
    if first.complete:
        yield "a row repeated", partial(noticed.incomplete, partial(spoilt.taken, rows=frozen, names=every))
    for value in (np.nan, np.inf):
        no_number = partial(spoilt.at_row, name=largest, row=count // 3, value=value)
        yield f"{value} in {largest}", partial(noticed.incomplete, no_number)
    channel_removed = partial(spoilt.without, names={largest})
    yield f"{largest} missing", partial(noticed.incomplete, channel_removed)
    yield f"{largest} declared unsupported", partial(noticed.incomplete, partial(channel_removed, reason="a canary"))
    yield "a row too few", partial(noticed.incomplete, partial(spoilt.taken, rows=range(count - 1)))
    yield "no motion", noticed.stops_without_a_motion

    if first.complete:
        yield "all channels too large, by one check or another", partial(noticed.each_check_alone, 1)
        yield "all channels too small, by one check or another", partial(noticed.each_check_alone, -1)


def _lagging(copy: noticed.Thinned) -> bool:
    """Whether it is noticed that the drive lags by a little more than it may, and nothing else."""
    lag = float(copy.amounts(noticed.CLEAR_ERROR)[copy.drive].max())
    return noticed.refused(partial(spoilt.shifted, amounts={copy.drive: -lag}), copy)


def _another_mass(copy: noticed.Thinned) -> bool:
    """Whether the forces of a body's further mass are noticed, an excess in the channel that it moves most."""
    scene, forces = copy.scene, copy.scene.channels.names(Role.force, Role.friction)
    body = max(scene.bodies.values(), key=lambda body: (body.name not in scene.driven, body.mass or 0.0))
    heavier = put(scene, {("bodies", body.name): replace(body.weighed, mass=(body.mass or 0.0) + 1.0)})
    inputs = copy.motion.inputs(scene)
    right, wrong = (registry.reference(variant, frozenset(forces))(inputs) for variant in (scene, heavier))
    amounts = copy.amounts()
    most = max(float((np.abs(wrong[c] - right[c]) / amounts[c]).max()) for c in forces)
    if not most > 0:  # it moves evenly: no force depends on its mass
        return True
    moved = {c: (wrong[c] - right[c]) / most for c in forces}
    return noticed.refused(partial(spoilt.shifted, amounts=moved), copy)
