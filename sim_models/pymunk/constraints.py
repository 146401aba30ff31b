"""A scene's joints as constraints between the coordinates in which pymunk moves the bodies.

A pose is q = (x, y, theta) of every body's origin. Plane vectors are complex numbers x + iy: a point with the arm a in
the body's frame lies at z + r with r = a exp(i theta), moves at z' + i omega r, and accelerates at
z'' + (i alpha - omega^2) r.

Each pin, each guide and the drive is a constraint C(q) = 0 with the Jacobian J = dC/dq. There are as many as
coordinates, so det J can change its sign only in a singular configuration, where assembly branches meet.
"""

from itertools import groupby
from typing import Any

import numpy as np

from scenes import Scene
from scenes.joints import Guide
from scenes.model.motion import Samples
from scenes.scene import GROUND

from .bodies import rigid
from .joints import RULES, PymunkGuides
from .masses import Masses
from .planes import ComplexArray, PoseArray, with_ground


class LinkageConstraints:
    """The moving bodies of a scene, in file order, and the constraints between them.

    `moved` has pymunk's masses, and the origins from which `members` have their points and centres of mass; their own
    masses are the true ones. It raises the Failure of `rigid` and of the masses.
    """

    def __init__(self, scene: Scene, masses: Masses) -> None:
        self.scene = scene
        rigids = {body.name: rigid(scene, body) for body in scene.bodies.values()}
        self.moved = masses(scene, rigids)
        self.members = {name: body.about(self.moved[name].origin) for name, body in rigids.items()}
        self.index = {name: number for number, name in enumerate([*scene.bodies, GROUND])}
        self.drive = drive = scene.drive
        self.gravity = complex(*(scene.gravity or (0.0, 0.0)))

        self.slides = scene.slides
        through = [self.through(name) for name in self.slides]
        arms = [arm for body in self.members.values() for arm in body.points.values()]
        places = [*arms, *through, *(complex(*point) for point in scene.ground.values())]
        self.size = max(map(abs, places)) or self._way()
        if drive.slide is not None:  # a point on its guide so far back that the body's first never gets there
            drawn = drive.in_range(scene.sketch.drive)
            self.back = min(*drive.law.extent, drawn) - self.size  # its displacement, m
            self.back_end = self.through(drive.body) + self.back * complex(*drive.slide.along)
        # Those of a type that follow each other together, in the order of the force channels; the drive is the last.
        self._joints = [RULES[kind](self, [*joints]) for kind, joints in groupby(scene.joints, type)]

    def _way(self) -> float:
        """How large a linkage counts whose points are all at the origin: as its drive's way, m."""
        return self.drive.unit

    def arm(self, body: str, point: str) -> complex:
        """Where a point is from its body's origin, m, in the body's frame."""
        return complex(*self.scene.ground[point]) if body == GROUND else self.members[body].points[point]

    def first_arm(self, body: str) -> complex:
        """Where a body's first point, which its guide holds, is from its origin, m, in the body's frame."""
        return self.arm(body, self.scene.bodies[body].points[0])

    def through(self, slider: str) -> complex:
        """Where a point of a slider's guide is from the origin of what it slides on, m, in that one's frame."""
        slide = self.slides[slider]
        return complex(*slide.through) - (0 if slide.on == GROUND else self.moved[slide.on].origin)

    def displacement(self, slider: str, z: Any, turn: Any) -> Any:
        """How far a body is along its guide, m, by z and exp(i theta) of the bodies and the ground by their number."""
        slide, i = self.slides[slider], self.index[slider]
        carrier = self.index[slide.on]
        from_carrier = (z[i] + self.first_arm(slider) * turn[i] - z[carrier]) * turn[carrier].conjugate()
        return (complex(*slide.along).conjugate() * (from_carrier - self.through(slider))).real

    def drive_position(self, q: PoseArray) -> Samples:
        """Where the driven body really is, shape (n,): rad of a crank, m of a slider."""
        return np.asarray(self._joints[-1].values(with_ground(q))[:, -1, 0])

    def gaps(self, q: PoseArray, position: Samples) -> Samples:
        """Return C(q), shape (n, 3 bodies), rows as channels of `Role.force`; `position` is the drive's.

        Two for each pin, x and y, m; two for each slider, off the line, m, and its angle, rad; the drive's, rad or m.
        """
        q = with_ground(q)
        values = np.concatenate([joints.values(q).reshape(len(q), -1) for joints in self._joints], axis=1)
        values[:, -1] -= position
        return values

    def jacobian(self, q: PoseArray) -> Samples:
        """Return J = dC/dq, shape (n, 3 bodies, 3 bodies)."""
        q = with_ground(q)
        n, bodies, _ = q.shape
        rows = [joints.gradients(q).reshape(n, -1, bodies, 3) for joints in self._joints]
        return np.concatenate(rows, axis=1)[:, :, :-1].reshape(n, 3 * (bodies - 1), -1)

    def slide_gradients(self, q: PoseArray) -> ComplexArray:
        """The gradients of displacements plus i offsets, (n, sliders, bodies, 3), the last body being the ground."""
        return PymunkGuides(self, [Guide(name, slide) for name, slide in self.slides.items()]).slid(q)

    def branch(self, q: PoseArray) -> Samples:
        """The sign of det J, shape (n,): constant along a branch."""
        return determinant_sign(self.jacobian(q))


def solved(J: Samples, wanted: Samples) -> PoseArray:
    """Solve J x = wanted, shape (n, bodies, 3), of J (n, 3 bodies, 3 bodies); NaN where J is singular."""
    try:
        x = np.linalg.solve(J, wanted[..., None])
    except np.linalg.LinAlgError:  # of any of them
        regular, x = determinant_sign(J) != 0, np.full((*wanted.shape, 1), np.nan)
        x[regular] = np.linalg.solve(J[regular], wanted[regular][..., None])
    return np.reshape(x, (len(J), -1, 3))


def determinant_sign(jacobian: Samples) -> Samples:
    """The sign of det J, shape (n,)."""
    return np.asarray(np.linalg.slogdet(jacobian).sign)
