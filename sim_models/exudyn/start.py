"""Where a system starts: assembled from the scene's sketch, on the branch that the sketch shows."""

from cmath import phase
from functools import lru_cache
from math import pi, remainder, sqrt, tau
from typing import Any

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
    drawing = _Drawing(system, position)
    pose = []
    for name, own in drawing.own.items():
        angle = drawing.angle(name)
        com = (drawing.drawn[name] - np.exp(1j * angle) * own).mean() if len(own) else 0j
        pose += [com.real, com.imag, angle]
    return np.array(pose)


class _Drawing:
    """The sketched points of every body, along its own axes and as drawn, and how bodies are turned by them."""

    def __init__(self, system: ExudynSystem, position: float) -> None:
        self.system, self.scene, self.position = system, system.scene, position
        self.own, self.drawn = {}, {}
        places = self.scene.drawn
        for name, body in system.bodies.items():
            known = [point for point in body.points if point in places]
            self.own[name] = np.array([body.points[point] for point in known])
            self.drawn[name] = np.array([places[point] for point in known])

    def angle(self, name: str) -> Any:
        """The angle of a body; of two that the drive turns against each other, one may follow from the other's."""
        scene, shown = self.scene, self._shown(name)
        base, crank = scene.drive_on, scene.drive.body
        if base != GROUND and scene.driven_slide is None:
            on = self._shown(base)
            on = self._shown(crank) - self.position if on is None else on
            if name in scene.aligned[base]:
                return on
            if name in scene.aligned[crank]:
                turns = on + self.position
                return turns if shown is None else turns + remainder(shown - turns, tau)
        return shown

    def _shown(self, name: str) -> Any:
        """The angle of a body as it and those parallel to it are drawn; None where they do not show it."""
        scene, group = self.scene, sorted(self.scene.aligned[name])
        if GROUND in group:
            return 0.0
        if scene.drive_on == GROUND and scene.drive.body in group:
            return self.position
        # argmin over the angle of sum |drawn - mean - e^{i angle} (own - mean)|^2, over all bodies of this angle
        pairs = [(own - own.mean(), drawn - drawn.mean()) for own, drawn in map(self._of, group) if len(own) > 1]
        on_guides = [n for n in group if n in scene.slides and len(self.own[n]) and len(self.own[scene.slides[n].on])]
        pairs = pairs or [self._along_guide(slider) for slider in on_guides]
        return phase(sum(np.vdot(*pair) for pair in pairs)) if pairs else None

    def _of(self, name: str) -> tuple[Array, Array]:
        return self.own[name], self.drawn[name]

    def _along_guide(self, slider: str) -> tuple[complex, complex]:
        """The way from a point of what has a guide to one of its slider, m: in their frame, and as drawn."""
        system, on, along = self.system, self.scene.slides[slider].on, self.system.along(slider)
        drawn = self.drawn[slider][0] - self.drawn[on][0]
        own = system.through(slider) + self.own[slider][0] - system.lever(slider) - self.own[on][0]
        if slider == self.scene.drive.body:
            return own + along * self.position, drawn
        off = (along.conjugate() * own).imag
        return along * complex(sqrt(max(abs(drawn) ** 2 - off**2, 0.0)), off), drawn  # the slider is pushed out


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
