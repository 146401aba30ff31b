"""What an engine's own output must satisfy, with no reference: closed joints, balanced power, Newton and Euler.

Plane vectors are complex numbers: i v is v turned by +90 degrees, and conj(a) b = a . b + i (a x b).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.motion import Samples
from scenes.scene import Body

Vectors = NDArray[np.complex128]


@dataclass(frozen=True)
class Check:
    """The worst violation over the whole run."""

    check: str
    of: str  # the body, or the whole mechanism
    worst: float  # relative
    at_deg: float  # crank angle
    relative_to: str


def checks(scene: Scene, motion: Motion, stroke: float) -> list[Check]:
    """Return every check that the motion has the channels for; `stroke` in m is what lengths are relative to."""
    state = _State(scene, motion)
    found = [
        _worst("closure", body.name, state.gaps(body) / stroke, motion, "stroke") for body in scene.bodies.values()
    ]
    if scene.has_masses and not motion.unsupported:
        found += _newton_euler(scene, state, stroke)
        found.append(_power(scene, state))
    return found


def _worst(check: str, of: str, violation: Samples, motion: Motion, relative_to: str) -> Check:
    at = int(violation.argmax())
    return Check(check, of, float(violation[at]), float(np.degrees(motion["crank_angle"][at])), relative_to)


@dataclass(frozen=True)
class _State:
    """A motion's channels as vectors."""

    scene: Scene
    motion: Motion

    def vector(self, stem: str, x: str, y: str) -> Vectors:
        return self.motion[f"{stem}{x}"] + 1j * self.motion[f"{stem}{y}"]

    def point(self, point: str) -> tuple[Vectors, Vectors, Vectors]:
        """Return position, velocity and acceleration."""
        if point in self.scene.ground:
            still = np.zeros(self.motion["time"].shape, complex)
            return still + complex(*self.scene.ground[point]), still, still
        return tuple(self.vector(f"{point}.", *pair) for pair in (("x", "y"), ("vx", "vy"), ("ax", "ay")))  # type: ignore[return-value]

    def turning(self, body: Body) -> tuple[Samples, Samples, Samples]:
        """Return angle, omega and alpha."""
        if body.slide is not None:
            still = np.zeros(self.motion["time"].shape)
            return still, still, still
        return self.motion[f"{body.name}.angle"], self.motion[f"{body.name}.omega"], self.motion[f"{body.name}.alpha"]

    def com(self, body: Body) -> tuple[Vectors, Vectors, Vectors]:
        """Return position, velocity and acceleration of the centre of mass; of uniform bodies, the corners' mean."""
        if body.com is None:
            z, v, a = (sum(vectors) / len(body.points) for vectors in zip(*map(self.point, body.points), strict=True))
            return z, v, a
        z, v, a = self.point(body.points[0])
        angle, omega, alpha = self.turning(body)
        origin = body.local[body.points[0]] if body.local is not None else (0.0, 0.0)
        r = np.exp(1j * angle) * (complex(*body.com) - complex(*origin))
        return z + r, v + 1j * omega * r, a + (1j * alpha - omega**2) * r

    def gaps(self, body: Body) -> Samples:
        """Return by how much the body's points miss their distances and its slide, shape (n,), m.

        A point belongs to every body that names it, so a pin that is open shows as a wrong distance in one of them.
        """
        gap = np.zeros(self.motion["time"].shape)
        for (p, q), length in _distances(body).items():
            gap = np.maximum(gap, np.abs(np.abs(self.point(p)[0] - self.point(q)[0]) - length))
        if body.slide is not None:
            along, through = complex(*body.slide.along), complex(*body.slide.through)
            gap = np.maximum(gap, np.abs(((self.point(body.points[0])[0] - through) * along.conjugate()).imag))
        return gap

    def forces(self, body: Body) -> Iterator[tuple[Vectors, Vectors]]:
        """Yield every force on the body with its point of attack."""
        for pin in self.scene.pins:
            if body.name in (pin.first, pin.second):
                force = self.vector(f"{pin.channel}.", "fx", "fy")
                yield (force if body.name == pin.second else -force), self.point(pin.point)[0]
        for load in self.scene.loads:
            if load.body == body.name:
                yield np.full(self.motion["time"].shape, complex(*load.force)), self.point(load.at)[0]
        if self.scene.gravity is not None:
            com = self.com(body)[0]
            yield np.full(com.shape, (body.mass or 0.0) * complex(*self.scene.gravity)), com
        if body.slide is not None:
            normal = np.array(1j * complex(*body.slide.along))
            yield self.motion[f"{body.name}.guide_force"] * normal, self.point(body.points[0])[0]

    def couples(self, body: Body) -> Samples:
        """Return the pure moments on the body, N m."""
        couple = np.zeros(self.motion["time"].shape)
        if body.slide is not None:
            couple = couple + self.motion[f"{body.name}.guide_moment"]
        if body.name == self.scene.drive.body:
            couple = couple + self.motion["drive.torque"]
        return couple


def _distances(body: Body) -> dict[tuple[str, str], float]:
    """Return the distance of every two points of a body, m."""
    if body.local is not None:
        return {(p, q): abs(complex(*body.local[p]) - complex(*body.local[q])) for p, q in combinations(body.points, 2)}
    assert body.lengths is not None
    return {(p, q): body.lengths[frozenset((p, q))] for p, q in combinations(body.points, 2)}


def _inertia(body: Body) -> float:
    """Return the inertia about the com, kg m^2: as given, or of a point, a uniform bar or a triangular plate."""
    if body.inertia is not None:
        return body.inertia
    return (body.mass or 0.0) * sum(d**2 for d in _distances(body).values()) / {1: 1, 2: 12, 3: 36}[len(body.points)]


def _newton_euler(scene: Scene, state: _State, stroke: float) -> Iterator[Check]:
    """Yield, body by body, what its reactions and loads leave over of m a and of I alpha about the centre of mass."""
    for body in scene.bodies.values():
        com, _, acceleration = state.com(body)
        force = -(body.mass or 0.0) * acceleration
        moment = state.couples(body) - _inertia(body) * state.turning(body)[2]
        peak = 0.0
        for push, at in state.forces(body):
            force = force + push
            moment = moment + ((at - com).conjugate() * push).imag
            peak = max(peak, float(np.abs(push).max()))
        peak = peak or 1.0  # a body that nothing pushes: the leftover itself, in N
        yield _worst("Newton", body.name, np.abs(force) / peak, state.motion, "peak force on the body")
        yield _worst("Euler", body.name, np.abs(moment) / (peak * stroke), state.motion, "peak force times stroke")


def _power(scene: Scene, state: _State) -> Check:
    """Compare the power of the drive, the loads and gravity with the rate of kinetic energy."""
    omega = state.turning(scene.bodies[scene.drive.body])[1]
    terms = [state.motion["drive.torque"] * omega]
    for load in scene.loads:
        terms.append((state.point(load.at)[1] * complex(*load.force).conjugate()).real)
    for body in scene.bodies.values():
        _, v, a = state.com(body)
        if scene.gravity is not None:
            terms.append((v * complex(*scene.gravity).conjugate()).real * (body.mass or 0.0))
        _, omega, alpha = state.turning(body)
        terms.append(-(body.mass or 0.0) * (v * a.conjugate()).real - _inertia(body) * omega * alpha)
    peak = max(float(np.abs(term).max()) for term in terms) or 1.0
    return _worst("power", "mechanism", np.abs(sum(terms)) / peak, state.motion, "peak of the largest power")
