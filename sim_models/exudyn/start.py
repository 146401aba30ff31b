"""Where a system starts: assembled from the scene's sketch, on the branch that the sketch shows."""

from cmath import phase
from functools import lru_cache
from math import pi

import numpy as np

from scenes import Failure, Scene, Status
from scenes.scene import GROUND

from .loads import PressSwitches, press_switches
from .poses import Configuration, PoseSolver
from .system import Array, ExudynSystem, exudyn

SCENES = 4  # whose starts are kept; one that is run has up to two


@lru_cache(SCENES)
def begun(scene: Scene, *, si: bool = False) -> tuple[Configuration, PressSwitches]:
    """The state at the drive's start, and when the press loads switch; both once a scene and system of units."""
    poses = PoseSolver(scene, si=si)
    at_start = start(poses)
    return at_start, press_switches(poses, at_start)


def start(poses: PoseSolver) -> Configuration:
    """Assemble the system where the sketch shows it, and move it to the drive's start."""
    system, drawn = poses.system, poses.system.scene.sketched_drive
    where, rough = system.scene.where(drawn), _rough(system, drawn)
    assembled = poses.nearest(rough, drawn)
    if assembled is None:
        reason = f"the bodies do not fit together where the sketch shows them, {where}"
        raise Failure(Status.cannot_assemble, reason + poses.equations.misfit(rough, [drawn]))
    _check_freedoms(system, assembled)
    sketch = poses.state(assembled, np.array(drawn))
    turned = np.abs(assembled - rough)[2::3].max()
    if turned > pi / 2 or poses.branch(poses.equations.jacobian(rough)) != sketch.branch:
        reason = f"the sketch, {where}, is too rough to decide between two ways of assembling the bodies"
        raise Failure(Status.wrong_branch, reason)
    return poses.follow(sketch, system.scene.drive.start)


def _rough(system: ExudynSystem, position: float) -> Array:
    """Lay every body on the sketch as well as a rigid body can be, shape (3 bodies,).

    A body without a sketched point has only slides, on which Newton's method finds it from anywhere.
    """
    scene, places = system.scene, system.scene.drawn
    own, drawn = {}, {}
    for name, body in system.bodies.items():
        known = [point for point in body.points if point in places]
        own[name] = np.array([body.points[point] for point in known])
        drawn[name] = np.array([places[point] for point in known])

    def turned(name: str) -> float:
        if GROUND in scene.aligned[name]:
            return 0.0
        if scene.drive.body in scene.aligned[name]:
            return position
        # argmin over the angle of sum |drawn - mean - e^{i angle} (own - mean)|^2, over all bodies of this angle
        shown = [other for other in scene.aligned[name] if len(own[other]) > 1]
        return phase(sum(np.vdot(own[n] - own[n].mean(), drawn[n] - drawn[n].mean()) for n in sorted(shown)))

    pose = []
    for name in system.bodies:
        angle = turned(name)
        com = (drawn[name] - np.exp(1j * angle) * own[name]).mean() if len(own[name]) else 0j
        pose += [com.real, com.imag, angle]
    return np.array(pose)


def _check_freedoms(system: ExudynSystem, q: Array) -> None:
    """Refuse a system in which Exudyn counts a degree of freedom or a redundant constraint with the drive held."""
    system.state.SetODE2Coordinates(q, exudyn.ConfigurationType.Initial)
    counts = system.mbs.ComputeSystemDegreeOfFreedom()
    free, redundant = int(counts["degreeOfFreedom"]), int(counts["redundantConstraints"])
    if free or redundant:
        raise Failure(
            Status.unsupported,
            f"with the drive held, Exudyn counts {free} degrees of freedom and {redundant} redundant constraints;"
            " every reaction is determined with 0 and 0 only",
        )
