"""A motion's channels as vectors, and when press forces act.

Plane vectors are complex numbers: i v is v turned by +90 degrees, and conj(a) b = a . b + i (a x b).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.model.motion import Samples
from scenes.scene import GROUND, Body, PressForce

from .bodies import first_point, plane

Vectors = NDArray[np.complex128]
Acts: TypeAlias = NDArray[np.bool_]  # shape (m, n): by sample, whether one force acts; on a switch both may hold

PERTURBATION = 1e-6  # of a slider's range and peak speed: far above all rounding, far below the way between two samples
TURNING = 1e-3  # of the peak speed, a hair from the end: the way that is left there goes with the square of the speed


@dataclass(frozen=True)
class MotionVectors:
    """One motion of a scene; every array is of shape (n,)."""

    scene: Scene
    motion: Motion
    acting: Sequence[NDArray[np.bool_]] = ()  # whether each of the scene's press forces acts

    def vector(self, x: str, y: str) -> Vectors:
        """Two channels as one vector."""
        return self.motion[x] + 1j * self.motion[y]

    def place(self, point: str, order: int = 0) -> Vectors:
        """Where a point is, or of order 1 and 2 its velocity and acceleration."""
        if point in self.scene.ground:
            return np.full(self.motion["time"].shape, 0j if order else plane(self.scene.ground[point]))
        return self.vector(*self.scene.channels.points[point][order])

    def point(self, point: str) -> tuple[Vectors, Vectors, Vectors]:
        """Position, velocity and acceleration."""
        return self.place(point), self.place(point, 1), self.place(point, 2)

    def angle(self, body: str, order: int = 0) -> Samples:
        """The angle of a body's x axis, or of the ground's; or of order 1 and 2 its rate and acceleration."""
        turning = self.scene.channels.bodies
        return self.motion[turning[body][order]] if body in turning else np.zeros(self.motion["time"].shape)

    def turning(self, body: str) -> tuple[Samples, Samples, Samples]:
        """Angle, omega and alpha of a body or the ground."""
        return self.angle(body), self.angle(body, 1), self.angle(body, 2)

    def com(self, body: Body) -> tuple[Vectors, Vectors, Vectors]:
        """Position, velocity and acceleration of the centre of mass; of uniform bodies, the corners' mean."""
        if body.com is None:
            z, v, a = (sum(vectors) / len(body.corners) for vectors in zip(*map(self.point, body.corners), strict=True))
            return z, v, a
        z, v, a = self.point(body.points[0])
        angle, omega, alpha = self.turning(body.name)
        r = np.exp(1j * angle) * (complex(*body.com) - first_point(body))
        return z + r, v + 1j * omega * r, a + (1j * alpha - omega**2) * r

    def frame(self, name: str) -> tuple[Vectors, Vectors]:
        """The origin of a body's frame, or of the ground's, and the unit vector of its x axis."""
        x_axis = np.exp(1j * self.angle(name))
        if name == GROUND:
            return np.zeros_like(x_axis), x_axis
        body = self.scene.bodies[name]
        return self.place(body.points[0]) - x_axis * first_point(body), x_axis

    def on_guide(self, body: Body) -> Vectors:
        """Where a slider's first point is on its guide, from `through`: along it, and i times beside it, m."""
        assert body.slide is not None
        origin, x_axis = self.frame(body.slide.on)
        arm = x_axis.conjugate() * (self.place(body.points[0]) - origin)
        return np.asarray((arm - plane(body.slide.through)) * np.conj(plane(body.slide.along)))

    def along(self, body: Body) -> Vectors:
        """The unit vector along the guide of a body that slides, in the ground's frame."""
        assert body.slide is not None
        along = np.array(complex(*body.slide.along))
        return along if body.slide.on == GROUND else np.exp(1j * self.angle(body.slide.on)) * along

    def carried(self, name: str, place: Vectors) -> Vectors:
        """The velocity of that point of a body, or of the ground, which is at a place."""
        if name == GROUND:
            return np.zeros_like(place)
        z, v, _ = self.point(self.scene.bodies[name].points[0])
        return v + 1j * self.turning(name)[1] * (place - z)

    def sliding(self, body: Body) -> Samples:
        """The velocity of a slider's first point along its guide, whatever that is on."""
        assert body.slide is not None
        z, v, _ = self.point(body.points[0])
        return ((v - self.carried(body.slide.on, z)) * self.along(body).conj()).real

    def displacement(self, body: Body) -> tuple[Samples, Samples]:
        """The displacement of a slider, m, and its rate, m/s."""
        return self.on_guide(body).real, self.sliding(body)

    def stroke_end(self, load: PressForce) -> float:
        """Where the closing stroke ends, m: a sample, or a dead point between two, for which a cycle is needed."""
        body = self.scene.bodies[load.body]
        second = (self.place(body.points[0], 2) * self.along(body).conj()).real  # on the ground
        x, v, a = (load.closing * samples for samples in (*self.displacement(body), second))
        h = np.diff(self.motion["time"])
        # The displacement between two samples is the quintic through both ends' values, rates and accelerations; a dead
        # point between them is where its derivative vanishes.
        turns = np.flatnonzero((v[:-1] > 0) & (v[1:] < 0))
        inside = [_peak(quintic(h[k], *(samples[k : k + 2] for samples in (x, v, a)))) for k in turns]
        return load.closing * max([float(x.max()), *inside])

    def stroke_ends(self) -> tuple[float, ...]:
        """Where the closing stroke of every press force ends, m; a slider has one for each way of closing."""
        return tuple(map(self.stroke_end, self.scene.presses.values()))

    def pressed(self, ends: Sequence[float]) -> Self:
        """The same with the press forces acting as it shows, whose strokes end at `ends`, m."""
        presses = zip(self.scene.presses.values(), ends, strict=True)
        acting = [load.acts(*self.displacement(self.scene.bodies[load.body]), end) for load, end in presses]
        return replace(self, acting=acting)

    def acts(self, ends: Sequence[float]) -> Iterator[Acts]:
        """Yield where each press force acts at displacement and velocity, either +-PERTURBATION, shape (4, n).

        Its stroke ends at its entry of `ends`, m.
        """
        for load, end in zip(self.scene.presses.values(), ends, strict=True):
            x, v = self.displacement(self.scene.bodies[load.body])
            # At the end of a stroke x is within dx of the end while v passes zero: x goes as the square of v there, so
            # that v may be as uncertain as the root of PERTURBATION, `TURNING`.
            dx = PERTURBATION * np.ptp(x)
            dv = np.where(np.abs(end - x) <= dx, TURNING, PERTURBATION) * np.abs(v).max()
            yield np.array([load.acts(x + i * dx, v + j * dv, end) for i in (-1, 1) for j in (-1, 1)])


def quintic(h: Any, x: Any, v: Any, a: Any) -> Samples:
    """The six coefficients, shape (6, ...), over steps from 0 to 1, of length h, shape (...).

    Values x and their derivatives v and a are pairs, those at the two ends of a step, each of shape (...).
    """
    # Hermite interpolation in powers of s: the first three coefficients from the left end, the others from what value,
    # rate and acceleration still lack at s = 1.
    (x0, x1), (v0, v1), (a0, a1) = x, (h * v[0], h * v[1]), (h**2 * a[0], h**2 * a[1])
    d, e, f = x1 - x0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
    rest = 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2
    return np.array([x0, v0, a0 / 2, *rest])


def _peak(coefficients: Samples) -> float:
    """The largest value of a polynomial inside a step from 0 to 1; that at 0 where it has no extreme."""
    path = np.polynomial.Polynomial(coefficients)
    roots = path.deriv().roots()
    real = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > 0) & (roots.real < 1)]
    return float(max(path(real), default=coefficients[0]))
