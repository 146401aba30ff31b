"""More samples where a quantity is largest or least, and where a press force comes or goes; of many machines at once.

An extreme is where the parabola through three samples has its own. Three samples there, closer together, give the next
parabola, and each time the place is known to about the square of what it was. Where a press force comes or goes nothing
is a parabola: there so many samples are taken that one of them is near whatever happens.
"""

from collections.abc import Callable, Iterator, Sequence
from math import pi

import numpy as np

from scenes import Failure, Motion, Scene
from scenes.elements.tables import LoadCurve
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import MotionLaw, SegmentedLaw

from ...mechanics.elements import argument
from ...mechanics.motion_vectors import MotionVectors
from ..checks import closed_by
from .curves import LEAST_MATTERS, CycleCurve, Values, driving
from .numbers import at, chords

FINE, ROUNDS = 10, 3  # parts of a step, time and again: by parabolas an extreme is then known to all digits
ROUNDS_TO_JUMP = 5  # where press forces act: to 1e-5 of the cycle's own steps
NEXT_TO_HIGHEST = 0.01  # of a quantity's range: how far below its largest sample that next to its highest peak may be
MAX_STEPS_AHEAD = 4  # of three samples: how far a parabola is followed


def _beyond(scene: Scene, motion: Motion) -> Iterator[Samples]:
    """Yield what is zero where forces bend, (..., n): how far each table of a load is beyond each of its entries.

    So is the rate of a law where its drive turns round: what drove until then brakes.
    """
    if not scene.steady:
        yield inputs_of(scene, motion["time"]).driven().rate
    for name, table in _tables(scene):
        along = argument(MotionVectors(scene, motion), name, table)
        half_turn = pi / (table.arguments[-1] - table.arguments[0])  # of a sine that is zero once a period
        for level in (along - entry for entry in table.arguments):
            yield np.sin(half_turn * level) if table.periodic else level


def needed(scene: Scene) -> Iterator[str]:
    """Yield the channels that `refined` needs, besides the time and the drive's."""
    for name in (name for name, table in _tables(scene) if table.over == "displacement"):
        yield from closed_by(scene, scene.bodies[name])


def _tables(scene: Scene) -> list[tuple[str, LoadCurve]]:
    return [(load.body, load.table) for load in scene.loads if load.table is not None]


def refined(
    scene: Scene,
    followed: Sequence[CycleCurve],
    cycle: Motion,
    solve: Callable[[Samples], Motion],
    switches: Callable[[Motion, Samples], Samples] | None = None,
    *,
    bare: bool = False,
) -> Motion:
    """A cycle with samples added, in the order of the time, as far as the linkage closes there.

    It comes in samples of shape (..., n) at equal steps of the time, from zero, both ends included; `solve` has others,
    at instants, s, of shape (..., k). Where another cycle follows, an extreme may be on both sides of the end. At the
    entries of tables a sample is added: an extreme may be a corner. Or where forces may jump, `switches` are the
    instants near which press forces come or go, of a motion in the order of the time, where its samples are not
    further apart than a step, s; None where that is not followed. Where neither press forces nor friction may jump,
    `bare` leaves out the samples on either side of the last places, which are for lines between samples.
    """
    repeats, by_parts = scene.periodic, any(isinstance(drive.law, MotionLaw | SegmentedLaw) for drive in scene.drives)
    jump = by_parts or bool(scene.presses)  # whether forces may jump, or bend at any place, within the cycle
    end, step = cycle["time"][..., -1:], cycle["time"][..., 1:2]
    side = FINE if jump else 1  # samples on either side of a place
    bare = bare and not jump and not scene.friction
    # Extremes by successive parabolas: each round takes samples at a tenth of the last spacing around the vertices
    # found, of all quantities and machines in one call of `solve`. The distance to the extreme falls to about its
    # square in a round. Where forces jump there is no parabola; a fan of samples on either side closes in instead.
    high = heights(scene, followed, cycle)
    rows = [height.argmax(axis=-1) if jump else _top(height, repeats=repeats) for height in high]
    near = np.stack(rows, axis=-1) * step
    corners = [] if jump else [(n, _zeros(level) * step) for n, level in enumerate(_beyond(scene, cycle))]
    levels = [n for n, places in corners for _ in range(places.shape[-1])]
    near = np.concatenate([near, *(places for _, places in corners)], axis=-1)
    motion, parts = cycle, [cycle]
    for left in reversed(range(ROUNDS_TO_JUMP if jump else ROUNDS)):
        if jump and switches:
            near = np.concatenate([near, switches(in_order([motion]), step)], axis=-1)
        step = step / FINE
        near = near if repeats else np.clip(near, side * step, end - side * step)
        places = np.zeros(1) if bare and not left else np.arange(-side, side + 1)
        around = near[..., np.newaxis] + step[..., np.newaxis] * places
        time = around.reshape(*near.shape[:-1], -1)
        try:
            motion = solve(time % end if repeats else np.clip(time, 0.0, end))
        except Failure:
            break
        parts = [*parts, motion] if jump else [cycle, motion]  # the last samples are nearest to an extreme
        if not left:
            break
        near = _vertex(around[..., : len(rows), :], _near_own(scene, followed, motion, around.shape))
        if levels:
            values = [level.reshape(around.shape) for level in _beyond(scene, motion)]
            passed = [values[n][..., k, :] for k, n in enumerate(levels, len(rows))]
            corners_at = around[..., len(rows) :, 1] - step * _newton(np.stack(passed, axis=-2))
            near = np.concatenate([near, corners_at], axis=-1)
        if followed[0].kind == "path":  # whose two ends depend on each other
            ends = followed[0].values(motion).reshape(around.shape)[..., :2, side - 1 : side + 2]
            near[..., :2] = around[..., :2, side] + step * _to_longest(ends)
    return in_order(parts)


def heights(scene: Scene, followed: Sequence[CycleCurve], motion: Motion) -> Iterator[Samples]:
    """Yield what is largest at each place that is looked for, each of shape (..., n)."""
    for curve in followed:
        values = curve.values(motion)
        if curve.kind in ("displacement", "effort"):
            yield from (values, -values)
            if curve.kind == "effort" and not scene.steady:
                with_motion, power, _ = driving(scene, values, motion)
                yield from (with_motion, -with_motion, power, -power)
        elif curve.kind == "path":
            along = (chords(values)[..., np.newaxis].conj() * values).real
            yield from (along, -along)
        else:
            yield -np.abs(values) if curve.kind in LEAST_MATTERS else np.abs(values)


def _near_own(scene: Scene, followed: Sequence[CycleCurve], motion: Motion, shape: tuple[int, ...]) -> Samples:
    """What is largest at each place, by the samples near it, shape (..., k, j); the motion's are of `shape`, flat.

    Places follow each other as `heights` has them. Of a path all samples matter, as its chord is theirs.
    """
    found: list[Samples] = []
    for curve in followed:
        first = len(found)
        most = 2 if curve.kind in ("path", "displacement") else 6 if curve.kind == "effort" else 1  # places of a curve
        rows = slice(first * shape[-1], (first + most) * shape[-1])
        part = motion if curve.kind == "path" else Motion({c: motion[c][..., rows] for c in ("time", *curve.channels)})
        near = (height.reshape(*shape[:-2], -1, shape[-1]) for height in heights(scene, [curve], part))
        found += [height[..., k, :] for k, height in enumerate(near)]
    return np.stack(found, axis=-2)


def _to_longest(ends: Values) -> Samples:
    """How many steps further two places are furthest apart, shape (..., 2), by samples around both, (..., 2, 3)."""
    # Newton's method for the maximum of |z1(t1) - z2(t2)|^2 over both instants, with z1 and z2 parabolas through their
    # samples. Gradient and Hessian are halved; a Hessian that is not negative definite belongs to no maximum.
    before, z, after = np.moveaxis(ends, -1, 0)
    (v1, v2), (a1, a2) = (np.moveaxis(x, -1, 0) for x in ((after - before) / 2, after - 2 * z + before))
    d = z[..., 0] - z[..., 1]
    g1, g2, H12 = ((first.conj() * second).real for first, second in ((d, v1), (-d, v2), (-v1, v2)))
    H11, H22 = np.abs(v1) ** 2 + (d.conj() * a1).real, np.abs(v2) ** 2 - (d.conj() * a2).real
    det = H11 * H22 - H12**2  # of the square of the distance between two parabolas: one step of Newton's
    det = np.where((H11 < 0) & (det > 0), det, np.inf)  # no maximum: they stay
    steps = np.stack([H12 * g2 - H22 * g1, H12 * g1 - H11 * g2], axis=-1) / det[..., np.newaxis]
    return np.clip(steps, -FINE, FINE)


def in_order(parts: Sequence[Motion]) -> Motion:
    """Several motions of the same channels as one, in the order of the time."""
    joined = {c: np.concatenate([part[c] for part in parts], axis=-1) for c in parts[0].samples}
    order = np.argsort(joined["time"], axis=-1, kind="stable")
    order += order.shape[-1] * np.arange(order.size // order.shape[-1]).reshape(*order.shape[:-1], 1)  # of all samples
    return Motion({c: np.take(values, order) for c, values in joined.items()})


def _top(height: Samples, *, repeats: bool) -> Samples:
    """Where parabolas through three samples each have their highest vertex, in steps, shape (...)."""
    n = height.shape[-1]
    largest, least = height.max(axis=-1, keepdims=True), height.min(axis=-1, keepdims=True)
    high = height >= largest - NEXT_TO_HIGHEST * (largest - least)
    high[..., :-1] &= height[..., :-1] >= height[..., 1:]
    high[..., 1:] &= height[..., 1:] >= height[..., :-1]
    machine, row = np.nonzero(high.reshape(-1, n))
    samples = height.reshape(-1, n)
    middle = row % (n - 1) if repeats else np.clip(row, 1, n - 2)
    sides = ((middle - 1) % (n - 1), middle + 1) if repeats else (middle - 1, middle + 1)
    before, here, after = (samples[machine, column] for column in (sides[0], middle, sides[1]))
    # Vertices of all local maxima near the highest sample: the highest sample and the highest vertex need not belong to
    # the same peak.
    slope, bend = (after - before) / 2, after - 2 * here + before
    way = np.clip(-slope / np.where(bend < 0, bend, -np.inf), -1, 1)
    places = np.zeros(len(samples))
    upwards = np.argsort(here + way * (slope + way / 2 * bend))  # so that the highest of a machine is the last
    places[machine[upwards]] = (middle + way)[upwards]
    return places.reshape(height.shape[:-1])


def _zeros(level: Samples) -> Samples:
    """Where lines from sample to sample pass zero, in steps, shape (..., k): of fewer than k such places any others."""
    passes = level[..., 1:] * level[..., :-1] < 0
    row = np.argsort(~passes, axis=-1, kind="stable")[..., : int(passes.sum(axis=-1).max(initial=0))]
    before, after = (np.take_along_axis(level, row + k, -1) for k in (0, 1))
    return np.asarray(row + before / np.where(before == after, np.inf, before - after))


def _newton(level: Samples) -> Samples:
    """How many steps before the middle one of three samples there is zero, shape (...), one step at most."""
    slope = (level[..., 2] - level[..., 0]) / 2
    return np.clip(level[..., 1] / np.where(slope == 0, np.inf, slope), -1, 1)


def _vertex(time: Samples, height: Samples) -> Samples:
    """Where the parabola through three samples has its vertex, shape (...); of others the highest sample."""
    highest = at(time, height.argmax(axis=-1))
    if time.shape[-1] != 3:
        return highest
    (t0, t1, t2), (y0, y1, y2) = np.moveaxis(time, -1, 0), np.moveaxis(height, -1, 0)
    # Newton's divided differences: the samples need not be equally spaced.
    slope = (y1 - y0) / (t1 - t0)
    bend = ((y2 - y1) / (t2 - t1) - slope) / (t2 - t0)
    vertex = (t0 + t1) / 2 - slope / (2 * np.where(bend < 0, bend, np.nan))
    reach = MAX_STEPS_AHEAD * (t2 - t1)
    return np.where(bend < 0, np.clip(vertex, t0 - reach, t2 + reach), highest)
