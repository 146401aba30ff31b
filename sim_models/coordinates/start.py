"""The pose at the drive's start: every body laid on the sketch, the gaps closed, the drive moved to its start."""

from math import remainder, tau
from typing import NamedTuple

import numpy as np

from scenes import Failure, Scene, Status
from scenes.motion import Samples
from scenes.scene import GROUND

from .poses import ClosedPose, PathFollower, Step, Stuck
from .stroke import stroke_ends
from .system import Frame, System

CLOSING = 12  # steps in which the sketch's gaps are closed
ALL_ROUND = tau - 1e-6  # rad: the way of a crank that turns fully, and may go to its start by the shorter side
SCENES = 4  # whose equations are kept by an engine: a scene run with several settings is prepared once


class Start(NamedTuple):
    """What all runs of a scene begin with."""

    poses: PathFollower
    pose: ClosedPose  # at the drive's start
    ends: Samples  # of the press forces' strokes, m, by load


def begun(system: System, step: Step | None = None) -> Start:
    """Return the start of a linkage, whose poses are found by Newton's method or a step of its own.

    Raises:
        Failure: `unsupported`, constraints repeat each other; `cannot_assemble` or `not_converged`, no pose on the
            sketch's branch; `timed_out`.
    """
    poses = PathFollower(system, step)
    pose = start(poses)
    return Start(poses, pose, stroke_ends(poses, pose))


def start(poses: PathFollower) -> ClosedPose:
    """Return the pose at the drive's start.

    Raises:
        Failure: as of `begun`.
    """
    scene, system = poses.scene, poses.system
    drawn = _drawn(scene)
    x = system.placed(on_sketch(system, drawn))
    if len(x) != system.rows:
        reason = f"{len(x)} coordinates and {system.rows} constraints: the reactions are not determined"
        raise Failure(Status.unsupported, reason)
    pose = poses.pose(x)
    gaps = system.gaps(pose.x)
    try:
        for share in np.linspace(0, 1, CLOSING + 1)[1:]:
            pose = poses.follow(pose, gaps + share * (poses.goal(drawn) - gaps))
    except Stuck as stuck:
        raise _apart(poses, stuck.pose, drawn) from None
    if poses.repeated(pose, drawn):
        raise _apart(poses, pose, drawn)
    return next(poses.through(pose, drawn, [scene.drive.start]))


def on_sketch(system: System, position: float) -> dict[str, Frame]:
    """Return every body where it fits the sketch best by least squares, with the drive at a position, rad or m."""
    scene, frames = system.scene, {GROUND: Frame(0j, 0.0)}
    drawn = {name: complex(*at) for name, at in (*scene.ground.items(), *scene.sketch.points.items())}
    own, seen = dict[str, Samples](), dict[str, Samples]()
    for name, body in system.bodies.items():
        shown = [point for point in body.points if point in drawn]
        own[name] = np.array([complex(*body.points[point]) for point in shown], complex)
        seen[name] = np.array([drawn[point] for point in shown], complex)
    for name in system.bodies:
        group, angle = scene.aligned[name], 0.0
        if scene.drive.body in group and scene.driven_slide is None:
            angle = position
        elif GROUND not in group:
            fits = (np.vdot(own[n] - own[n].mean(), seen[n]) for n in sorted(group) if len(own[n]))
            angle = float(np.angle(sum(fits)))
        # A body without a sketched point has guides alone, which are met from anywhere.
        origin = complex((seen[name] - np.exp(1j * angle) * own[name]).mean()) if len(own[name]) else 0j
        frames[name] = Frame(origin, angle)
    return frames


def _drawn(scene: Scene) -> float:
    """Return the drive's position in the sketch; of a crank's that counted by whole turns nearest to its way."""
    if scene.driven_slide is not None:
        return scene.sketch.drive
    near = scene.drive.start if np.ptp(scene.drive.extent) > ALL_ROUND else float(np.mean(scene.drive.extent))
    return near + remainder(scene.sketch.drive - near, tau)


def _apart(poses: PathFollower, pose: ClosedPose, position: float) -> Failure:
    """Return why the sketch's gaps cannot be closed."""
    where, count = poses.scene.where(position), poses.repeated(pose, position)
    if count:
        reason = f"{count} constraints repeat others at {where}: the reactions are not determined"
        return Failure(Status.unsupported, reason)
    reason = f"the bodies do not fit together where the sketch shows them, {where}{poses.misfit(pose, position)}"
    return Failure(Status.cannot_assemble, reason)
