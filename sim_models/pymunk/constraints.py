"""A scene's joints as constraints between the coordinates in which pymunk moves the bodies.

A pose is q = (x, y, theta) of every body's origin. Plane vectors are complex numbers x + iy: a point with the arm a in
the body's frame lies at z + r with r = a exp(i theta), moves at z' + i omega r, and accelerates at
z'' + (i alpha - omega^2) r.

Each pin, each guide and the drive is a constraint C(q) = 0 with the Jacobian J = dC/dq. There are as many as
coordinates, so det J can change its sign only in a singular configuration, where assembly branches meet.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isinf
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.groups import Group, groups
from scenes.motion import Samples
from scenes.scene import GROUND

from .bodies import PymunkBody, rigid
from .masses import Inertia, Inertias

Poses: TypeAlias = NDArray[np.float64]  # (n, bodies, 3), also of rates, accelerations, and the forces dual to them
Complex: TypeAlias = NDArray[np.complex128]
Plane: TypeAlias = Any  # a complex number, or an array of them of shape (n,)

Masses: TypeAlias = Callable[[Scene, Mapping[str, PymunkBody]], Inertias]

BLOCK = 2**20  # numbers of Jacobians that are in memory at a time


@dataclass(frozen=True)
class MovingBody:
    """A moving body: the arms of its points and of its centre of mass from its origin, m, in its own frame."""

    arms: Mapping[str, complex]
    com: complex
    mass: float  # kg, the true one
    inertia: float  # kg m^2, the true one, about the centre of mass
    moved: Inertia  # pymunk's

    @property
    def prescribed(self) -> bool:
        """Whether the drive prescribes its motion."""
        return isinf(self.moved.mass)


class LinkageConstraints:
    """The moving bodies of a scene, in file order, and the constraints between them; `masses` are pymunk's.

    Raises:
        Failure: unsupported, a body that pymunk moves has no mass or no inertia; cannot_assemble, a body's lengths do
            not close, or the sketch shows three of its points in line.
    """

    def __init__(self, scene: Scene, masses: Masses) -> None:
        self.scene = scene
        rigids = {body.name: rigid(scene, body) for body in scene.bodies.values()}
        inertias = masses(scene, rigids)
        self.members = {name: _moving_body(body, inertias[name]) for name, body in rigids.items()}
        self.index = {name: number for number, name in enumerate([*scene.bodies, GROUND])}
        self.driven = self.index[scene.drive.body]

        pins = [((pin.first, pin.second), pin.point) for pin in scene.pins]
        self._pinned = np.array([[self.index[body] for body in pair] for pair, _ in pins], np.intp).reshape(-1, 2)
        arms = [[self.arm(body, point) for body in pair] for pair, point in pins]
        self._pin_arms = np.array(arms, np.complex128).reshape(-1, 2)
        self.slides = {body.name: body.slide for body in scene.bodies.values() if body.slide is not None}
        self._sliders = np.array([self.index[name] for name in self.slides], dtype=np.intp)
        self._carriers = np.array([self.index[slide.on] for slide in self.slides.values()], dtype=np.intp)
        self._slider_arms = np.array([self.first_arm(name) for name in self.slides], dtype=np.complex128)
        self._through = np.array([self.through(name) for name in self.slides], dtype=np.complex128)
        self._along = np.array([complex(*slide.along) for slide in self.slides.values()], dtype=np.complex128)

        ends = [arm for body in self.members.values() for arm in body.arms.values()]
        self.size = max(map(abs, [*ends, *self._through, *(complex(*point) for point in scene.ground.values())]))

    def arm(self, body: str, point: str) -> complex:
        """Return where a point is from its body's origin, m, in the body's frame."""
        return complex(*self.scene.ground[point]) if body == GROUND else self.members[body].arms[point]

    def first_arm(self, body: str) -> complex:
        """Return where a body's first point, which its guide holds, is from its origin, m, in the body's frame."""
        return self.arm(body, self.scene.bodies[body].points[0])

    def through(self, slider: str) -> complex:
        """Return where a point of a slider's guide is from the origin of what it slides on, m, in that one's frame."""
        slide = self.slides[slider]
        return complex(*slide.through) - (0 if slide.on == GROUND else self.members[slide.on].moved.origin)

    def displacement(self, slider: str, z: Plane, turn: Plane) -> Any:
        """Return how far a body that slides on the ground is along its guide, m, by its z and its exp(i theta)."""
        along = complex(*self.slides[slider].along)
        return (along.conjugate() * (z + self.first_arm(slider) * turn - self.through(slider))).real

    def drive_position(self, q: Poses) -> Samples:
        """Return where the driven body really is, shape (n,): rad of a crank, m of a slider."""
        if self.scene.driven_slide is None:
            return q[:, self.driven, 2]
        z, turn = planes(q[:, self.driven])
        return np.asarray(self.displacement(self.scene.drive.body, z, turn))

    def gaps(self, q: Poses, position: Samples) -> Samples:
        """Return C(q), shape (n, 3 bodies), rows as in `scenes.motion.force_channels`; `position` is the drive's.

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
        return np.concatenate(
            [
                np.stack([pins.real, pins.imag], axis=-1).reshape(len(q), -1),
                np.stack([offset, angle], axis=-1).reshape(len(q), -1),
                drive[:, None],
            ],
            axis=1,
        )

    def jacobian(self, q: Poses) -> Samples:
        """Return J = dC/dq, shape (n, 3 bodies, 3 bodies)."""
        q = with_ground(q)
        n, bodies, _ = q.shape
        z, turn = planes(q)

        number = np.arange(len(self._pinned))
        gradients = _point_gradients(self._pin_arms * turn[:, self._pinned])
        pins = np.zeros((n, len(number), bodies, 3), dtype=np.complex128)
        pins[:, number, self._pinned[:, 0]] -= gradients[:, :, 0]
        pins[:, number, self._pinned[:, 1]] += gradients[:, :, 1]

        number = np.arange(len(self._sliders))
        arms = self._slider_arms * turn[:, self._sliders]
        along = np.conj(self._along * turn[:, self._carriers])[..., None]
        guides = np.zeros((n, len(number), 2, bodies, 3))
        from_carrier = z[:, self._sliders] + arms - z[:, self._carriers]
        guides[:, number, 0, self._sliders] = (along * _point_gradients(arms)).imag
        guides[:, number, 0, self._carriers] = -(along * _point_gradients(from_carrier)).imag
        guides[:, number, 1, self._sliders, 2] = 1
        guides[:, number, 1, self._carriers, 2] = -1

        drive = np.zeros((n, 1, bodies, 3))
        if self.scene.driven_slide is None:
            drive[:, 0, self.driven, 2] = 1
        else:
            own = [*self.slides].index(self.scene.drive.body)
            drive[:, 0, self.driven] = (along * _point_gradients(arms))[:, own].real

        rows = [np.stack([pins.real, pins.imag], axis=2).reshape(n, -1, bodies, 3), guides.reshape(n, -1, bodies, 3)]
        return np.concatenate([*rows, drive], axis=1)[:, :, :-1].reshape(n, 3 * (bodies - 1), -1)

    def branch(self, q: Poses) -> Samples:
        """Return the sign of det J, shape (n,), times one that is the same for all poses: constant along a branch."""
        J, signs = self.jacobian(q), np.ones(len(q))
        for rows, columns, _ in self._groups:
            signs = signs * determinant_sign(J[:, np.array(rows)[:, None], np.array(columns)])
        return signs

    @cached_property
    def _groups(self) -> Sequence[Group]:
        somewhere = np.random.default_rng(0).normal(size=(1, len(self.members), 3))  # where no entry vanishes by chance
        return groups([np.flatnonzero(row).tolist() for row in self.jacobian(somewhere)[0]])


def solved(J: Samples, wanted: Samples) -> Poses:
    """Return x in J x = wanted, shape (n, bodies, 3), of J (n, 3 bodies, 3 bodies); NaN where J is singular."""
    try:
        found = np.linalg.solve(J, wanted[..., None])
    except np.linalg.LinAlgError:  # of any of them
        singular = determinant_sign(J) == 0
        found = np.full((*wanted.shape, 1), np.nan)
        found[~singular] = np.linalg.solve(J[~singular], wanted[~singular][..., None])
    return np.reshape(found, (len(J), -1, 3))


def blocks(q: Poses) -> Iterator[slice]:
    """Yield the rows of all poses in turn, of which the Jacobians fit in memory."""
    rows = max(BLOCK // (3 * q.shape[1]) ** 2, 1)
    yield from (slice(first, first + rows) for first in range(0, len(q), rows))


def _moving_body(body: PymunkBody, moved: Inertia) -> MovingBody:
    arms = {point: place - moved.origin for point, place in body.points.items()}
    return MovingBody(arms, body.com - moved.origin, body.mass, body.inertia, moved)


def determinant_sign(jacobian: Samples) -> Samples:
    """Return the sign of det J, shape (n,)."""
    sign: Samples = np.linalg.slogdet(jacobian).sign
    return sign


def with_ground(q: Poses) -> Poses:
    """Append the ground as a body that stays at zero."""
    return np.concatenate([q, np.zeros((*q.shape[:-2], 1, 3))], axis=-2)


def planes(q: Poses) -> tuple[Complex, Complex]:
    """Return the places of the origins and exp(i theta), of the shape of q but its last axis."""
    return q[..., 0] + 1j * q[..., 1], np.exp(1j * q[..., 2])


def _point_gradients(r: Complex) -> Complex:
    """Return d(z + r)/d(x, y, theta) of points at the arms r, shape (..., 3)."""
    gradients = np.empty((*r.shape, 3), dtype=np.complex128)
    gradients[..., 0], gradients[..., 1], gradients[..., 2] = 1, 1j, 1j * r
    return gradients
