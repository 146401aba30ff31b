"""Where a system starts: assembled from the scene's sketch, on the branch that the sketch shows."""

from cmath import phase
from collections.abc import Mapping
from functools import lru_cache
from math import pi, sqrt
from typing import TypeAlias

import numpy as np

from scenes import Failure, Scene, Status
from scenes.scene import GROUND

from .elements import PressSwitches
from .loads import press_switches
from .poses import Configuration, PoseSolver
from .system import Array, ExudynSystem, exudyn

MAX_SCENES = 4  # whose starts are kept; one that is run has up to two

Sketched: TypeAlias = Mapping[str, tuple[Array, Array]]  # by body its sketched points: along its own axes, and as drawn


@lru_cache(MAX_SCENES)
def begun(scene: Scene, *, si: bool = False) -> tuple[Configuration, PressSwitches]:
    """The state at the drive's start, and when the press loads switch; both once a scene and system of units."""
    poses = PoseSolver(scene, si=si)
    at_start = start(poses)
    return at_start, press_switches(poses, at_start)


def start(poses: PoseSolver) -> Configuration:
    """Assemble the system where the sketch shows it, and move it to the drive's start."""
    system, drawn = poses.system, poses.system.prescribed.in_range(poses.system.scene.sketch.drive)
    where, rough = system.scene.where(drawn), _rough(system, drawn)
    # The sketch decides between assemblies only if its own pose is on the side of the one found: a body that turned by
    # more than a right angle, or a Jacobian whose determinant changed its sign on the way, may as well belong to the
    # other.
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
    return poses.follow(sketch, system.prescribed.law.start)


def _rough(system: ExudynSystem, position: float) -> Array:
    """Lay every body on the sketch as well as a rigid body can be, shape (3 bodies,)."""
    places, sketched, pose = system.scene.drawn, {}, []
    for name, body in system.bodies.items():
        known = [point for point in body.points if point in places]
        sketched[name] = np.array([body.points[p] for p in known]), np.array([places[p] for p in known])
    angles = _angles(system, sketched, position)
    for name, (in_body, drawn) in sketched.items():
        angle = angles[system.scene.aligned[name]]
        com = (
            (drawn - np.exp(1j * angle) * in_body).mean() if len(in_body) else 0j
        )  # only on slides: found from anywhere
        pose += [com.real, com.imag, angle]
    return np.array(pose)


def _angles(system: ExudynSystem, sketched: Sketched, position: float) -> dict[frozenset[str], float]:
    """The angles of bodies that slides keep parallel: as drawn, but a crank is turned from what it is driven on."""
    scene = system.scene
    ground, base, crank = (scene.aligned[name] for name in (GROUND, system.prescribed.on, system.prescribed.body))
    # A crank's angle is what the drive asks for, whatever the sketch shows of it. If its carrier's angle is not shown,
    # it follows from the crank's.
    fits = {group: _fit(system, sketched, group, position) for group in {*scene.aligned.values()} - {ground}}
    angles = {group: phase(fit) for group, fit in fits.items()} | {ground: 0.0}
    if system.prescribed.slide is None:
        if base != ground and not fits[base]:
            angles[base] = angles[crank] - position
        angles[crank] = angles[base] + position
    return angles


def _fit(system: ExudynSystem, sketched: Sketched, group: frozenset[str], position: float) -> complex:
    """A number with the angle of parallel bodies as they are drawn; zero where that does not show it."""
    # argmin over the angle of sum |drawn - mean - e^{i angle} (own - mean)|^2, over all bodies of this angle
    points = [sketched[name] for name in sorted(group)]
    pairs = [(in_body - in_body.mean(), drawn - drawn.mean()) for in_body, drawn in points if len(in_body) > 1]
    guides = [(system.scene.slides[name].on, name) for name in sorted(group & system.scene.slides.keys())]
    if not pairs:
        guides = [ends for ends in guides if all(len(sketched[name][0]) for name in ends)]
        pairs = [_along_guide(system, sketched, *ends, position) for ends in guides]
    return complex(sum(np.vdot(*pair) for pair in pairs))


def _along_guide(
    system: ExudynSystem, sketched: Sketched, carrier: str, slider: str, position: float
) -> tuple[complex, complex]:
    """The way from a point of what has a guide to one of its slider, m: in their frame, and as drawn."""
    (first, begin), (last, end) = sketched[carrier], sketched[slider]
    along, in_carrier = system.along(slider), system.through(slider) + last[0] - system.lever(slider) - first[0]
    drawn, across = end[0] - begin[0], (along.conjugate() * in_carrier).imag
    if slider == system.prescribed.body:
        return in_carrier + along * position, drawn
    return along * complex(sqrt(max(abs(drawn) ** 2 - across**2, 0.0)), across), drawn  # the slider is pushed out


def _check_freedoms(system: ExudynSystem, q: Array) -> None:
    """Refuse a system in which Exudyn counts a degree of freedom or a redundant constraint with the drive held."""
    system.state.SetODE2Coordinates(q, exudyn.ConfigurationType.Initial)
    counts = system.mbs.ComputeSystemDegreeOfFreedom()
    free, redundant = int(counts["degreeOfFreedom"]), int(counts["redundantConstraints"])
    if free or redundant:
        counted = f"{free} degrees of freedom and {redundant} redundant constraints"
        reason = f"with the drive held, Exudyn counts {counted}; every reaction is determined with 0 and 0 only"
        raise Failure(Status.unsupported, reason)
