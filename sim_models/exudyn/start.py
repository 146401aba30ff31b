"""Where a system starts: assembled from the scene's sketch, on the branch that the sketch shows."""

from cmath import phase
from functools import lru_cache
from math import pi, remainder, tau

import numpy as np

from scenes import Failure, Scene, Status
from scenes.scene import GROUND

from .bodies import sketched
from .misfit import misfit
from .poses import Configuration, PoseSolver
from .stroke import Switches, press_switches
from .system import Array, ExudynSystem, engine

SCENES = 4  # whose starts are kept; one that is run has up to two
WHOLE_TURN = tau - 1e-6  # rad; the ends of a turn are rounded


@lru_cache(SCENES)
def begun(scene: Scene, *, si: bool = False) -> tuple[Configuration, Switches]:
    """Return the state at the drive's start, and when the press loads switch; both once a scene and system of units.

    Raises:
        Failure: as `start` and `press_switches`.
    """
    poses = PoseSolver(scene, si=si)
    at_start = start(poses)
    return at_start, press_switches(poses, at_start)


def start(poses: PoseSolver) -> Configuration:
    """Return the state at the drive's start.

    Raises:
        Failure: the constraints leave a freedom or repeat each other; no pose is found near the sketch; or none from
            there to the start.
    """
    system = poses.system
    drawn = _sketched_position(system)
    rough = _rough(system, drawn)
    assembled = _assembled(poses, rough, drawn)
    _check_freedoms(system, assembled)
    sketch = poses.state(assembled, np.array(drawn))
    _check_branch(poses, rough, sketch)
    return poses.follow(sketch, system.scene.drive.start)


def _sketched_position(system: ExudynSystem) -> float:
    """Return the drive's position in the sketch, a crank's angle counted so that the way to the start is clear."""
    scene = system.scene
    drawn, begin = scene.sketch.drive, scene.drive.start
    if scene.driven_slide is not None:
        return drawn
    low, high = scene.drive.extent
    # A crank that turns fully may go either way; another only within its range, to and fro as it may go there.
    near = begin if high - low >= WHOLE_TURN else (low + high) / 2
    return near - remainder(near - drawn, tau)


def _rough(system: ExudynSystem, position: float) -> Array:
    """Return every body laid on the sketch as well as a rigid body can be, shape (3 bodies,).

    A body without a sketched point has only slides, on which Newton's method finds it from anywhere.
    """
    scene, places = system.scene, sketched(system.scene)
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


def _assembled(poses: PoseSolver, rough: Array, position: float) -> Array:
    """Return a pose that meets the constraints."""
    found = poses.nearest(rough, position)
    if found is not None:
        return found
    where, open_by = poses.system.scene.where(position), misfit(poses.system, poses.equations, rough, [position])
    raise Failure(
        Status.cannot_assemble, f"the bodies do not fit together where the sketch shows them, {where}{open_by}"
    )


def _check_freedoms(system: ExudynSystem, q: Array) -> None:
    """Refuse a system in which Exudyn counts a degree of freedom or a redundant constraint with the drive held."""
    system.state.SetODE2Coordinates(q, engine().ConfigurationType.Initial)
    counts = system.mbs.ComputeSystemDegreeOfFreedom()
    free, redundant = int(counts["degreeOfFreedom"]), int(counts["redundantConstraints"])
    if free or redundant:
        raise Failure(
            Status.unsupported,
            f"with the drive held, Exudyn counts {free} degrees of freedom and {redundant} redundant constraints;"
            " every reaction is determined with 0 and 0 only",
        )


def _check_branch(poses: PoseSolver, rough: Array, state: Configuration) -> None:
    """Refuse a pose that Newton's method found on another branch than the sketch's."""
    turned = np.abs(state.q - rough)[2::3].max()
    if turned > pi / 2 or poses.branch(poses.equations.jacobian(rough)) != state.branch:
        raise Failure(
            Status.wrong_branch,
            f"the sketch, {poses.system.scene.where(float(state.position))}, is too rough to decide"
            " between two ways of assembling the bodies",
        )
