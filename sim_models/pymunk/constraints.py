"""A scene's joints as constraints between the coordinates in which pymunk moves the bodies.

A pose is q = (x, y, theta) of every body's origin. Plane vectors are complex numbers x + iy: a point with the arm a in
the body's frame lies at z + r with r = a exp(i theta), moves at z' + i omega r, and accelerates at
z'' + (i alpha - omega^2) r.

Each pin, each guide and the drive is a constraint C(q) = 0 with the Jacobian J = dC/dq. There are as many as
coordinates, so det J can change its sign only in a singular configuration, where assembly branches meet.
"""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.model.motion import Samples
from scenes.scene import GROUND

from .bodies import rigid
from .masses import Masses

PoseArray: TypeAlias = NDArray[np.float64]  # (n, bodies, 3), also of rates, accelerations, and the forces dual to them
ComplexArray: TypeAlias = NDArray[np.complex128]
PlaneVector: TypeAlias = Any  # a complex number, or an array of them of shape (n,)


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
        self.driven, self._base = self.index[drive.body], self.index[drive.on]
        self.gravity = complex(*(scene.gravity or (0.0, 0.0)))

        ends = [(body, pin.point) for pin in scene.pins for body in (pin.first, pin.second)]
        self._pinned = np.array([self.index[body] for body, _ in ends], np.intp).reshape(-1, 2)
        self._pin_arms = np.array([self.arm(*end) for end in ends], np.complex128).reshape(-1, 2)
        self.slides = slides = scene.slides
        self._sliders = np.array([self.index[name] for name in slides], np.intp)
        self._carriers = np.array([self.index[slide.on] for slide in slides.values()], np.intp)
        self._slider_arms = np.array([self.first_arm(name) for name in slides], np.complex128)
        self._through = np.array([self.through(name) for name in slides], np.complex128)
        self._along = np.array([complex(*slide.along) for slide in slides.values()], np.complex128)
        arms = [arm for body in self.members.values() for arm in body.points.values()]
        places = [*arms, *self._through, *(complex(*point) for point in scene.ground.values())]
        self.size = max(map(abs, places)) or self._way()
        if drive.slide is not None:  # a point on its guide so far back that the body's first never gets there
            drawn = drive.in_range(scene.sketch.drive)
            self.back = min(*drive.law.extent, drawn) - self.size  # its displacement, m
            self.back_end = self.through(drive.body) + self.back * complex(*drive.slide.along)

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
        q = with_ground(q)
        if self.drive.slide is None:
            return q[:, self.driven, 2] - q[:, self._base, 2]
        if self.drive.on == GROUND:
            z, turn = planes(q)
            return np.asarray(self.displacement(self.drive.body, z.T, turn.T))
        return np.asarray(self.back + np.abs(self._bar(q)))

    def _bar(self, q: PoseArray) -> ComplexArray:
        """The vector from a point far back on the driven body's guide to its first point, shape (n,)."""
        z, turn = planes(q)
        first = z[:, self.driven] + self.first_arm(self.drive.body) * turn[:, self.driven]
        return np.asarray(first - z[:, self._base] - self.back_end * turn[:, self._base])

    def gaps(self, q: PoseArray, position: Samples) -> Samples:
        """Return C(q), shape (n, 3 bodies), rows as channels of `Role.force`; `position` is the drive's.

        Two for each pin, x and y, m; two for each slider, off the line, m, and its angle, rad; the drive's, rad or m.
        """
        drive = self.drive_position(q) - position
        q = with_ground(q)
        z, turn = planes(q)
        ends = z[:, self._pinned] + self._pin_arms * turn[:, self._pinned]
        pins = ends[..., 1] - ends[..., 0]
        from_carrier = z[:, self._sliders] + self._slider_arms * turn[:, self._sliders] - z[:, self._carriers]
        offset = (
            np.conj(self._along * turn[:, self._carriers]) * from_carrier - np.conj(self._along) * self._through
        ).imag
        angle = q[:, self._sliders, 2] - q[:, self._carriers, 2]
        pairs = np.stack([pins.real, pins.imag], axis=-1), np.stack([offset, angle], axis=-1)
        return np.concatenate([*(pair.reshape(len(q), -1) for pair in pairs), drive[:, None]], axis=1)

    def jacobian(self, q: PoseArray) -> Samples:
        """Return J = dC/dq, shape (n, 3 bodies, 3 bodies)."""
        q = with_ground(q)
        n, bodies, _ = q.shape
        turn = planes(q)[1]

        # Rows in the order of `gaps`: a complex gradient of each pin, whose real and imaginary parts are the rows of x
        # and y; offset and angle of each guide; the drive. Columns are (x, y, theta) of every body and at last the
        # ground, whose columns are cut off.
        number = np.arange(len(self._pinned))
        gradients = _point_gradients(self._pin_arms * turn[:, self._pinned])
        pins = np.zeros((n, len(number), bodies, 3), dtype=np.complex128)
        pins[:, number, self._pinned[:, 0]] -= gradients[:, :, 0]
        pins[:, number, self._pinned[:, 1]] += gradients[:, :, 1]

        number, slid = np.arange(len(self._sliders)), self.slide_gradients(q)
        guides = np.zeros((n, len(number), 2, bodies, 3))
        guides[:, :, 0] = slid.imag
        guides[:, number, 1, self._sliders, 2] = 1
        guides[:, number, 1, self._carriers, 2] = -1

        drive = np.zeros((n, 1, bodies, 3))
        if self.drive.slide is None:
            drive[:, 0, self._base, 2] = -1
            drive[:, 0, self.driven, 2] = 1
        elif self.drive.on != GROUND:
            # The gradient of a length is the unit vector along it, dotted with the gradients of both ends.
            bar = self._bar(q)
            back = np.conj(bar / np.abs(bar))[:, None]
            first, end = self.first_arm(self.drive.body), self.back_end
            drive[:, 0, self.driven] = (back * _point_gradients(first * turn[:, self.driven])).real
            drive[:, 0, self._base] = -(back * _point_gradients(end * turn[:, self._base])).real
        else:
            drive[:, 0] = slid[:, [*self.slides].index(self.drive.body)].real

        rows = [np.stack([pins.real, pins.imag], axis=2).reshape(n, -1, bodies, 3), guides.reshape(n, -1, bodies, 3)]
        return np.concatenate([*rows, drive], axis=1)[:, :, :-1].reshape(n, 3 * (bodies - 1), -1)

    def slide_gradients(self, q: PoseArray) -> ComplexArray:
        """The gradients of displacements plus i offsets, (n, sliders, bodies, 3), the last body being the ground."""
        z, turn = planes(q)
        number, arms = np.arange(len(self._sliders)), self._slider_arms * turn[:, self._sliders]
        from_carrier = z[:, self._sliders] + arms - z[:, self._carriers]
        along = np.conj(self._along * turn[:, self._carriers])[..., None]
        gradients = np.zeros((len(q), len(number), *q.shape[1:]), np.complex128)
        gradients[:, number, self._sliders] = along * _point_gradients(arms)
        gradients[:, number, self._carriers] = -along * _point_gradients(from_carrier)
        return gradients

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


def with_ground(q: PoseArray) -> PoseArray:
    """Append the ground as a body that stays at zero."""
    return np.concatenate([q, np.zeros((*q.shape[:-2], 1, 3))], axis=-2)


def planes(q: PoseArray) -> tuple[ComplexArray, ComplexArray]:
    """The places of the origins and exp(i theta), of the shape of q but its last axis."""
    return q[..., 0] + 1j * q[..., 1], np.exp(1j * q[..., 2])


def _point_gradients(r: ComplexArray) -> ComplexArray:
    """Return d(z + r)/d(x, y, theta) of points at the arms r, shape (..., 3)."""
    gradients = np.empty((*r.shape, 3), dtype=np.complex128)
    gradients[..., 0], gradients[..., 1], gradients[..., 2] = 1, 1j, 1j * r
    return gradients
