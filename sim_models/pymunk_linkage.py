"""A scene's bodies and joints in the coordinates in which pymunk moves them.

A pose is q = (x, y, theta) of every body's origin: its centre of mass, or for the crank its ground pivot, about which
pymunk turns it exactly. Plane vectors are complex numbers x + iy: a point with the arm a in the body's frame lies at
z + r with r = a exp(i theta), moves at z' + i omega r, and accelerates at z'' + (i alpha - omega^2) r.

Each pin, each guide and the drive is a constraint C(q) = 0 with the Jacobian J = dC/dq. There are as many as
coordinates, so det J can change its sign only where the linkage locks, that is where assembly branches meet.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene, Status
from scenes.motion import Samples
from scenes.scene import GROUND, Body

Poses: TypeAlias = NDArray[np.float64]  # (n, bodies, 3), also of rates, accelerations, and the forces dual to them
Complex: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True)
class Member:
    """A moving body: the arms of its points and of its centre of mass from its origin, m, in its own frame."""

    arms: Mapping[str, complex]
    com: complex
    mass: float  # kg
    inertia: float  # kg m^2, about the centre of mass


class Linkage:
    """The moving bodies of a scene, in file order, and the constraints between them.

    Raises:
        Failure: unsupported, a body that pymunk moves has no mass or no inertia; cannot_assemble, the sketch shows a
            triangle as a line.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.members = {body.name: _member(scene, body) for body in scene.bodies.values()}
        self.index = {name: number for number, name in enumerate([*scene.bodies, GROUND])}
        self.crank = self.index[scene.drive.body]

        self._pinned = np.array([(self.index[pin.first], self.index[pin.second]) for pin in scene.pins])
        self._pin_arms = np.array(
            [(self.arm(pin.first, pin.point), self.arm(pin.second, pin.point)) for pin in scene.pins]
        )
        guided = [(body, body.slide) for body in scene.bodies.values() if body.slide is not None]
        self._sliders = np.array([self.index[body.name] for body, _ in guided], dtype=np.intp)
        self._slider_arms = np.array([self.arm(body.name, body.points[0]) for body, _ in guided], dtype=np.complex128)
        self._through = np.array([complex(*slide.through) for _, slide in guided], dtype=np.complex128)
        self._along = np.array([complex(*slide.along) for _, slide in guided], dtype=np.complex128)

        arms = [arm for member in self.members.values() for arm in member.arms.values()]
        self.size = max(map(abs, [*arms, *self._through, *(complex(*point) for point in scene.ground.values())]))

    def arm(self, body: str, point: str) -> complex:
        """Return where a point is from its body's origin, m, in the body's frame."""
        return complex(*self.scene.ground[point]) if body == GROUND else self.members[body].arms[point]

    def gaps(self, q: Poses, crank_angle: Samples) -> Samples:
        """Return C(q), shape (n, 3 bodies), rows as in `scenes.motion.force_channels`.

        Two for each pin, x and y, m; two for each slider, off the line, m, and its angle, rad; the crank's, rad.
        """
        q = _with_ground(q)
        z, turn = q[..., 0] + 1j * q[..., 1], np.exp(1j * q[..., 2])
        ends = z[:, self._pinned] + self._pin_arms * turn[:, self._pinned]
        pins = ends[..., 1] - ends[..., 0]
        guided = z[:, self._sliders] + self._slider_arms * turn[:, self._sliders]
        offset = (np.conj(self._along) * (guided - self._through)).imag
        return np.concatenate(
            [
                np.stack([pins.real, pins.imag], axis=-1).reshape(len(q), -1),
                np.stack([offset, q[:, self._sliders, 2]], axis=-1).reshape(len(q), -1),
                (q[:, self.crank, 2] - crank_angle)[:, None],
            ],
            axis=1,
        )

    def jacobian(self, q: Poses) -> Samples:
        """Return J = dC/dq, shape (n, 3 bodies, 3 bodies)."""
        q = _with_ground(q)
        n, bodies, _ = q.shape
        turn = np.exp(1j * q[..., 2])

        number = np.arange(len(self._pinned))
        gradients = _point_gradients(self._pin_arms * turn[:, self._pinned])
        pins = np.zeros((n, len(number), bodies, 3), dtype=np.complex128)
        pins[:, number, self._pinned[:, 0]] -= gradients[:, :, 0]
        pins[:, number, self._pinned[:, 1]] += gradients[:, :, 1]

        number = np.arange(len(self._sliders))
        gradients = _point_gradients(self._slider_arms * turn[:, self._sliders])
        guides = np.zeros((n, len(number), 2, bodies, 3))
        guides[:, number, 0, self._sliders] = (np.conj(self._along)[:, None] * gradients).imag
        guides[:, number, 1, self._sliders, 2] = 1

        drive = np.zeros((n, 1, bodies, 3))
        drive[:, 0, self.crank, 2] = 1

        rows = [np.stack([pins.real, pins.imag], axis=2).reshape(n, -1, bodies, 3), guides.reshape(n, -1, bodies, 3)]
        return np.concatenate([*rows, drive], axis=1)[:, :, :-1].reshape(n, 3 * (bodies - 1), -1)


def branch(jacobian: Samples) -> Samples:
    """Return the sign of det J, shape (n,): the same all along one assembly branch."""
    sign: Samples = np.linalg.slogdet(jacobian).sign
    return sign


def _with_ground(q: Poses) -> Poses:
    """Append the ground as a body that stays at zero."""
    return np.concatenate([q, np.zeros((len(q), 1, 3))], axis=1)


def _point_gradients(r: Complex) -> Complex:
    """Return d(z + r)/d(x, y, theta) of points at the arms r, shape (..., 3)."""
    return np.stack([np.ones_like(r), np.full_like(r, 1j), 1j * r], axis=-1)


# --- bodies ----------------------------------------------------------------------------------------------------------


def _member(scene: Scene, body: Body) -> Member:
    frame = _frame(scene, body)
    mass, com, inertia = _mass_properties(body, frame)
    if body.name == scene.drive.body:
        origin = next(place for point, place in frame.items() if point in scene.ground)
    else:
        origin = com
        # pymunk's C core ends the whole process when it is given anything else.
        if not (mass > 0 and isfinite(mass)):
            raise Failure(Status.unsupported, f"pymunk cannot move a body of mass {mass:g} kg: '{body.name}'")
        if body.slide is None and not (inertia > 0 and isfinite(inertia)):
            raise Failure(
                Status.unsupported,
                f"pymunk cannot turn a body with a moment of inertia of {inertia:g} kg m^2: '{body.name}'",
            )
    return Member({point: place - origin for point, place in frame.items()}, com - origin, mass, inertia)


def _frame(scene: Scene, body: Body) -> dict[str, complex]:
    """Return the body's points in its own frame, m: as given, or by lengths a-b, a-c, b-c of a bar or triangle."""
    if body.local is not None:
        return {point: complex(*place) for point, place in body.local.items()}
    assert body.lengths is not None
    a, b, *third = body.points
    ab = body.lengths[frozenset((a, b))]
    frame = {a: 0j, b: complex(ab)}
    for c in third:
        ac, bc = body.lengths[frozenset((a, c))], body.lengths[frozenset((b, c))]
        drawn = {point: complex(*place) for point, place in [*scene.ground.items(), *scene.sketch.points.items()]}
        side = np.sign((np.conj(drawn[b] - drawn[a]) * (drawn[c] - drawn[a])).imag)
        if side == 0:
            raise Failure(
                Status.cannot_assemble, f"the sketch shows {a}, {b}, {c} of '{body.name}' in line, not which way round"
            )
        # Twice the area by Heron's formula, which stays accurate for a flat triangle.
        double_area = sqrt((ab + ac + bc) * (ab + ac - bc) * (ab - ac + bc) * (-ab + ac + bc)) / 2
        frame[c] = complex((ab**2 + ac**2 - bc**2) / (2 * ab), side * double_area / ab)
    return frame


def _mass_properties(body: Body, frame: Mapping[str, complex]) -> tuple[float, complex, float]:
    """Return mass, kg, centre of mass, m, and moment of inertia about it, kg m^2."""
    import pymunk

    places = np.array([*frame.values()])
    centroid = complex(places.mean())
    if body.mass is None:  # The drive prescribes the motion, so any masses give the same.
        return 1.0, centroid, float((np.abs(places - centroid) ** 2).mean())
    if body.com is not None and body.inertia is not None:
        return body.mass, complex(*body.com), body.inertia
    match [(float(arm.real), float(arm.imag)) for arm in places - centroid]:
        case [_]:
            inertia = 0.0
        case [a, b]:
            inertia = pymunk.moment_for_segment(body.mass, a, b, 0)
        case triangle:
            inertia = pymunk.moment_for_poly(body.mass, triangle)
    return body.mass, centroid, inertia
