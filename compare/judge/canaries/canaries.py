"""Canaries: copies of the motions just judged, each wrong on purpose, that the comparison has to notice.

Each takes the way of a real run: completeness, checks, comparison, verdict, gates, and what stops a CI run. One that
comes through is a fault of the comparison itself, and named.
"""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import cycle

import numpy as np

from scenes import Motion, Status
from scenes.model.motion import force_channels
from scenes.numbers import put

from ...engines import registry
from ..agreement import Judgement
from . import spoilt_motion as spoilt
from .thinned import (
    CLEAR,
    Noticed,
    Thinned,
    each_channel_is_seen,
    each_check_alone,
    incomplete,
    refused,
    refused_if_moved,
    stops_without_a_motion,
    thinned,
)

APART = 0.1  # of the scale: components that are nearer, as where no force acts, are not worth swapping


def canaries(judgement: Judgement) -> list[str]:
    """Return the faults that are let through, a line each; none where no run is ok or the reference is in doubt.

    Args:
        judgement: the runs just judged, of which the engines' ok ones are broken in turn.

    Returns:
        One sentence for each broken copy that the comparison takes for a good one.
    """
    ok = [
        m.run
        for m in judgement.measurements
        if m.run.status is Status.ok and m.run.motion is not None and not m.foreign
    ]
    ok = [run for run in ok if registry.ENTRIES[run.engine].everything]  # one of fewer channels lacks what is broken
    if not ok or judgement.reference.floor.doubt:
        return []
    copies = [thinned(judgement.reference, judgement.sampling, run, judgement.explained) for run in ok]
    compared = (copies[-1], ("an error in one channel or another", each_channel_is_seen))  # the least accurate, at best
    return [
        f"the comparison itself: it lets through {copy.run.engine} with {wrong}"
        for copy, (wrong, noticed) in (*zip(cycle(copies), _canaries(copies[0]), strict=False), compared)
        if not noticed(copy)
    ]


def _canaries(first: Thinned) -> Iterator[tuple[str, Noticed]]:
    """Yield what is wrong with each copy, in words, and whether that is noticed; of the channels that there are."""
    scene, count = first.scene, first.sampling.count
    drive = scene.drive_channel
    channels = {channel for channel in first.excess(1.0) if channel != drive}
    sizes = {
        c: float(np.abs(first.motion[c]).max()) / first.reference.scale[c]
        for c in first.motion.samples
        if c in channels
    }
    largest = max(sizes, key=sizes.__getitem__)

    yield f"{largest} of the opposite sign", refused_if_moved(partial(spoilt.scaled, names=[largest], factor=-1))
    vectors = [(c, f"{c[:-1]}y") for c in sizes if c.endswith("x") and f"{c[:-1]}y" in sizes]
    apart = [np.abs(first.motion[x] - first.motion[y]).max() / first.reference.scale[x] for x, y in vectors]
    for x, y in [vector for vector, share in zip(vectors, apart, strict=True) if share > APART][-1:]:
        yield f"{x} and {y} swapped", refused(partial(spoilt.swapped, first=[x], second=[y]))
    late = [0, *range(count - 1)]
    yield "all late by a sample", refused(partial(spoilt.taken, rows=late, names={*channels, drive}))
    yield "all but the drive late by a sample", refused_if_moved(partial(spoilt.taken, rows=late, names=channels))
    yield "a drive that lags", lambda copy: refused(_lagging(copy))(copy)
    if scene.has_masses and first.complete:
        yield "another mass", _another_mass

    row = 1 + int(np.abs(np.diff(first.true[drive])).argmax())
    frozen = [*range(row), row - 1, *range(row + 1, count)]
    if first.complete:
        yield "a row repeated", incomplete(partial(spoilt.taken, rows=frozen, names={*channels, drive}))
    for value in (np.nan, np.inf):
        yield f"{value} in {largest}", incomplete(partial(spoilt.at_row, name=largest, row=count // 3, value=value))
    yield f"{largest} missing", incomplete(partial(spoilt.without, names={largest}))
    yield f"{largest} declared unsupported", incomplete(partial(spoilt.without, names={largest}, reason="a canary"))
    yield "a row too few", incomplete(partial(spoilt.taken, rows=range(count - 1)))
    yield "no motion", stops_without_a_motion

    if first.complete:
        yield "all channels too large, by one check or another", each_check_alone(1)
        yield "all channels too small, by one check or another", each_check_alone(-1)


def _lagging(copy: Thinned) -> Callable[[Motion], Motion]:
    """Return a change that lets the drive lag by a little more than it may, and nothing else."""
    drive = copy.scene.drive_channel
    return partial(spoilt.shifted, by={drive: -float(copy.amounts(CLEAR)[drive].max())})


def _another_mass(copy: Thinned) -> bool:
    """Return whether the forces of a body's further mass are noticed, an excess in the channel that it moves most."""
    scene, forces = copy.scene, force_channels(copy.scene)
    heaviest = max(scene.bodies.values(), key=lambda body: (body.name != scene.drive.body, body.mass or 0.0)).name
    heavier = put(scene, {("bodies", heaviest, "mass"): (scene.bodies[heaviest].mass or 0.0) + 1.0})
    position, time = copy.motion[scene.drive_channel], copy.motion["time"]
    right, wrong = (registry.reference(of, frozenset(forces))(position, time) for of in (scene, heavier))
    amounts = copy.amounts()
    most = max(float((np.abs(wrong[c] - right[c]) / amounts[c]).max()) for c in forces)
    if not most > 0:  # it moves evenly: no force depends on its mass
        return True
    return refused(lambda motion: spoilt.moved(motion, right, wrong, forces, 1 / most))(copy)
