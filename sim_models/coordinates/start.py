"""The pose at the drive's start: every body laid on the sketch, the gaps closed, the drive moved to its start."""

from collections.abc import Callable
from functools import cache, lru_cache, partial
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from scenes import Failure, Scene, Status
from scenes.model.motion import Samples
from scenes.scene import GROUND, PressForce

from .bodies import MovingBody
from .poses import PathFollower
from .system import ClosedPose, System

CLOSING = 12  # steps in which the sketch's gaps are closed
ACCURACY = 1e-9  # of the drive's position, rad or of its travel; a stroke's displacement stands still at its end
SCENES = 4  # whose equations are kept by an engine: a scene run with several settings is prepared once


@lru_cache(SCENES)
def begun(
    kind: Callable[[Scene], System], scene: Scene, whole_way: bool
) -> tuple[Any, PathFollower, ClosedPose, Samples]:
    """Return what all runs of a scene begin with; Failure where constraints repeat others, or no pose is on the branch.

    Those are its constraints, of that kind; its poses, and that at the drive's start; and the ends of press forces'
    strokes, m. Where asked, the whole way of the drive is followed too.
    """
    system = kind(scene)
    poses, drawn = PathFollower(system), scene.sketched_drive
    x = system.placed(on_sketch(system, drawn))
    pose, gaps = poses.pose(x), system.gaps(x)
    apart = partial(_apart, poses, drawn)
    for share in np.linspace(0, 1, CLOSING + 1)[1:]:
        pose = poses.follow(pose, gaps + share * (poses.goal(drawn) - gaps), apart)
    if poses.repeated(pose, drawn):
        raise apart(pose)
    drive = scene.drive
    pose = next(poses.through(pose, drawn, [drive.start]))
    for end in drive.extent if whole_way else ():
        _ = [*poses.through(pose, drive.start, [end])]
    return system, poses, pose, stroke_ends(poses, pose)


def on_sketch(system: System, position: float) -> dict[str, MovingBody]:
    """Return every body where it fits the sketch best by least squares, with the drive at a position, rad or m."""
    scene, frames = system.scene, {GROUND: MovingBody()}
    own, seen = dict[str, Samples](), dict[str, Samples]()
    for name, body in system.bodies.items():
        shown = [point for point in body.points if point in scene.drawn]
        own[name] = np.array([body.points[point] for point in shown], complex)
        seen[name] = np.array([scene.drawn[point] for point in shown], complex)
    for name in system.bodies:
        group, angle = scene.aligned[name], 0.0
        if scene.drive.body in group and scene.driven_slide is None:
            angle = position
        elif GROUND not in group:
            fits = (np.vdot(own[n] - own[n].mean(), seen[n]) for n in sorted(group) if len(own[n]))
            angle = float(np.angle(sum(fits)))
        # A body without a sketched point has guides alone, which are met from anywhere.
        origin = complex((seen[name] - np.exp(1j * angle) * own[name]).mean()) if len(own[name]) else 0j
        frames[name] = MovingBody(origin, angle, np.exp(1j * angle))
    return frames


def _apart(poses: PathFollower, position: float, pose: ClosedPose) -> Failure:
    """Return why the sketch's gaps cannot be closed."""
    where, count = poses.scene.where(position), poses.repeated(pose, position)
    if count:
        reason = f"{count} constraints repeat others at {where}: the reactions are not determined"
        return Failure(Status.unsupported, reason)
    reason = f"the bodies do not fit together where the sketch shows them, {where}{poses.misfit(pose, position)}"
    return Failure(Status.cannot_assemble, reason)


def stroke_ends(poses: PathFollower, start: ClosedPose) -> Samples:
    """Return by load the displacement where a press force's stroke ends, m; zero for other loads, shape (loads,)."""
    end = cache(partial(_end, poses, start))
    return np.array([end(one.body, one.closing) if isinstance(one, PressForce) else 0.0 for one in poses.scene.loads])


def _end(poses: PathFollower, start: ClosedPose, body: str, closing: int) -> float:
    """Return the furthest displacement in the closing direction: at the best of many positions, or between two."""
    begin, step = poses.scene.drive.start, poses.largest_step / 4

    def closed(pose: ClosedPose) -> float:
        return closing * float(poses.system.slid(poses.system.moved(pose.x), body)[0].real)

    known = {begin: start}
    for end in poses.scene.drive.extent:
        positions = np.linspace(begin, end, int(np.ceil(abs(end - begin) / step)) + 1)[1:].tolist()
        known |= zip(positions, poses.through(start, begin, positions), strict=True)
    best = max(known, key=lambda position: closed(known[position]))
    near, pose = [pair for pair in pairwise(sorted(known)) if best in pair], known[best]
    low, high = near[0][0], near[-1][1]
    refined = minimize_scalar(
        lambda position: -closed(next(poses.through(pose, best, [position]))),
        bounds=(low, high),
        method="bounded",
        options={"xatol": ACCURACY * (high - low)},
    )
    return closing * max(closed(pose), -float(refined.fun))
