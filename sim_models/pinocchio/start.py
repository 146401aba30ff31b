"""The pose at the drive's start: the tree laid on the sketch, its loops closed, the drive moved to its start."""

from functools import lru_cache
from math import remainder, tau

import numpy as np

from scenes import Failure, Scene, Status
from scenes.motion import Samples
from scenes.scene import GROUND

from .closures import Closures
from .poses import Pose, Poses, Stuck
from .stroke import stroke_ends
from .tree import Tree

CLOSING = 12  # steps in which the sketch's gaps are closed
ALL_ROUND = tau - 1e-6  # rad: the way of a crank that turns fully, and may go to its start by the shorter side
SCENES = 4  # whose trees are kept


@lru_cache(SCENES)
def begun(scene: Scene) -> tuple[Poses, Pose, Samples]:
    """Return a scene's poses, that at the drive's start, and the ends of the press forces' strokes, m.

    Raises:
        Failure: as of `engine.build`.
    """
    poses = Poses(Closures(Tree(scene)))
    pose = start(poses)
    return poses, pose, stroke_ends(poses, pose)


def start(poses: Poses) -> Pose:
    """Return the pose at the drive's start.

    Raises:
        Failure: as of `engine.build`.
    """
    scene, closures = poses.scene, poses.closures
    if len(closures.row_units) != len(closures.units):
        counts = f"{len(closures.units)} joint coordinates and {len(closures.row_units)} constraints"
        raise Failure(Status.unsupported, f"{counts}: the reactions are not determined")
    drawn = _drawn(scene)
    pose = poses.pose(sketched(closures.tree, drawn))
    gaps = closures.gaps(pose.q)
    try:
        for share in np.linspace(0, 1, CLOSING + 1)[1:]:
            pose = poses.follow(pose, gaps + share * (poses.goal(drawn) - gaps))
    except Stuck as stuck:
        raise _apart(poses, stuck.pose, drawn) from None
    return next(poses.through(pose, drawn, [scene.drive.start]))


def sketched(tree: Tree, position: float) -> Samples:
    """Return the joint coordinates that fit the sketch, with the drive at a position, rad or m."""
    scene = tree.scene
    drawn = {name: complex(*at) for name, at in (*scene.ground.items(), *scene.sketch.points.items())}
    angle, origin = {GROUND: 0.0}, {GROUND: 0j}
    for name in scene.bodies:
        group = sorted(scene.aligned[name] - {GROUND})
        if GROUND in scene.aligned[name]:
            angle[name] = 0.0
        elif scene.drive.body in group and scene.driven_slide is None:
            angle[name] = position
        else:
            angle[name] = _fitted(tree, group, drawn)
        shown = [point for point in scene.bodies[name].points if point in drawn]
        if shown:
            turn = np.exp(1j * angle[name])
            origin[name] = complex(np.mean([drawn[point] - turn * tree.local(name, point) for point in shown]))
    q = np.zeros(len(tree.joints))
    for column, joint in enumerate(tree.joints):
        if joint.turns:
            q[column] = angle[joint.child] - angle[joint.parent]
        elif joint.child in origin and joint.parent in origin:
            turn = np.exp(1j * angle[joint.parent])
            way = origin[joint.child] + turn * joint.anchor - origin[joint.parent] - turn * joint.at
            q[column] = (np.conj(turn * joint.along) * way).real
    return q


def _fitted(tree: Tree, group: list[str], drawn: dict[str, complex]) -> float:
    """Return the angle of bodies that turn together: of m in drawn = place + m local, by least squares."""
    shown = [
        (row, drawn[p], tree.local(n, p)) for row, n in enumerate(group) for p in tree.bodies[n].points if p in drawn
    ]
    A, b = np.zeros((len(shown), len(group) + 1), complex), np.zeros(len(shown), complex)
    for equation, (row, at, local) in enumerate(shown):
        A[equation, row], A[equation, -1], b[equation] = 1, local, at
    return float(np.angle(np.linalg.lstsq(A, b)[0][-1]))


def _drawn(scene: Scene) -> float:
    """Return the drive's position in the sketch; of a crank's that counted by whole turns nearest to its way."""
    if scene.driven_slide is not None:
        return scene.sketch.drive
    near = scene.drive.start if np.ptp(scene.drive.extent) > ALL_ROUND else float(np.mean(scene.drive.extent))
    return near + remainder(scene.sketch.drive - near, tau)


def _apart(poses: Poses, pose: Pose, position: float) -> Failure:
    """Return why the sketch's gaps cannot be closed."""
    where, count = poses.scene.where(position), len(pose.q) - int(np.linalg.matrix_rank(pose.J))
    if count and poses.assembles(pose, position):
        reason = f"{count} constraints repeat others at {where}: the reactions are not determined"
        return Failure(Status.unsupported, reason)
    reason = f"the loops cannot be closed as the sketch shows them, {where}{poses.misfit(pose, position)}"
    return Failure(Status.cannot_assemble, reason)
