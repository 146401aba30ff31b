"""The pose at the drive's start: every body laid on the sketch, the gaps closed, the drive moved to its start."""

from functools import lru_cache
from math import remainder, tau

import numpy as np

from scenes import Failure, Scene, Status
from scenes.motion import Samples
from scenes.scene import GROUND

from .linkage import Linkage, table
from .poses import Poses, Stuck
from .stroke import stroke_ends

CLOSING = 12  # steps in which the sketch's gaps are closed
ALL_ROUND = tau - 1e-6  # rad: the way of a crank that turns fully, and may go to its start by the shorter side
SCENES = 4  # whose equations are kept; a scene that is run with several settings is differentiated once


@lru_cache(SCENES)
def begun(scene: Scene) -> tuple[Poses, Samples, Samples]:
    """Return a scene's equations, its pose at the drive's start and the ends of the press forces' strokes, m.

    Raises:
        Failure: as of `engine.build`.
    """
    poses = Poses(Linkage(scene))
    x = start(poses)
    return poses, x, stroke_ends(poses, x)


def start(poses: Poses) -> Samples:
    """Return the pose at the drive's start, shape (3 bodies,).

    Raises:
        Failure: as of `engine.build`.
    """
    scene, linkage = poses.scene, poses.linkage
    if poses.rows != len(linkage.units):
        reason = f"{len(linkage.units)} coordinates and {poses.rows} constraints: the reactions are not determined"
        raise Failure(Status.unsupported, reason)
    drawn = _drawn(scene)
    x = sketched(linkage, drawn)
    gaps = table(linkage.gaps, x)
    goal = poses.goals(np.array([drawn]))
    try:
        x = poses.follow(x, gaps + (goal - gaps) * np.linspace(0, 1, CLOSING + 1)[1:])[:, -1]
    except Stuck as stuck:
        raise _apart(poses, stuck.x, drawn) from None
    return poses.through(x, drawn, np.array([scene.drive.start]))[:, -1]


def sketched(linkage: Linkage, position: float) -> Samples:
    """Return every body where it fits the sketch best by least squares, with the drive at a position; open joints."""
    scene = linkage.scene
    drawn = {name: complex(*at) for name, at in (*scene.ground.items(), *scene.sketch.points.items())}
    own, seen = dict[str, Samples](), dict[str, Samples]()
    for name, body in linkage.bodies.items():
        shown = [point for point in body.points if point in drawn]
        own[name] = np.array([complex(*np.array(body.points[point], float).ravel()) for point in shown], complex)
        seen[name] = np.array([drawn[point] for point in shown], complex)
    x = np.zeros((len(own), 3))
    for row, name in zip(x, own, strict=True):
        group = scene.aligned[name]
        if scene.drive.body in group and scene.driven_slide is None:
            row[2] = position
        elif GROUND not in group:
            fits = (np.vdot(own[n] - own[n].mean(), seen[n]) for n in sorted(group) if len(own[n]))
            row[2] = np.angle(sum(fits))
        # A body without a sketched point has guides alone, which are met from anywhere.
        at = (seen[name] - np.exp(1j * row[2]) * own[name]).mean() if len(own[name]) else 0j
        row[:2] = at.real / linkage.size, at.imag / linkage.size
    return x.ravel()


def _drawn(scene: Scene) -> float:
    """Return the drive's position in the sketch; of a crank's that counted by whole turns nearest to its way."""
    if scene.driven_slide is not None:
        return scene.sketch.drive
    near = scene.drive.start if np.ptp(scene.drive.extent) > ALL_ROUND else float(np.mean(scene.drive.extent))
    return near + remainder(scene.sketch.drive - near, tau)


def _apart(poses: Poses, x: Samples, position: float) -> Failure:
    """Return why the sketch's gaps cannot be closed."""
    where = poses.scene.where(position)
    rank = np.linalg.matrix_rank(table(poses.linkage.jacobian, x))
    if rank < poses.rows and poses.assembles(x, position):
        reason = f"{poses.rows - rank} constraints repeat others at {where}: the reactions are not determined"
        return Failure(Status.unsupported, reason)
    reason = f"the bodies do not fit together where the sketch shows them, {where}{poses.misfit(x, position)}"
    return Failure(Status.cannot_assemble, reason)
