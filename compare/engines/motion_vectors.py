"""A motion's channels as vectors, and the forces of its scene on each body at that motion.

Plane vectors are complex numbers: i v is v turned by +90 degrees, and conj(a) b = a . b + i (a x b).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.motion import Samples
from scenes.scene import GROUND, Body, ForceTable, Load, PressForce, Slide

Vectors = NDArray[np.complex128]


class AppliedForce(NamedTuple):
    """A force, where it attacks, and how fast that point of the body moves; shape (n,), N, m, m/s."""

    force: Vectors
    at: Vectors
    velocity: Vectors
    name: str


@dataclass(frozen=True)
class MotionVectors:
    """One motion of a scene; every array is of shape (n,)."""

    scene: Scene
    motion: Motion
    acting: Sequence[NDArray[np.bool_]] = ()  # whether each of the scene's press forces acts

    def vector(self, stem: str, x: str, y: str) -> Vectors:
        """Return two channels as one vector."""
        return self.motion[f"{stem}{x}"] + 1j * self.motion[f"{stem}{y}"]

    def place(self, point: str) -> Vectors:
        """Return where a point is."""
        if point in self.scene.ground:
            return np.full(self.motion["time"].shape, complex(*self.scene.ground[point]))
        return self.vector(f"{point}.", "x", "y")

    def point(self, point: str) -> tuple[Vectors, Vectors, Vectors]:
        """Return position, velocity and acceleration."""
        if point in self.scene.ground:
            still = np.zeros(self.motion["time"].shape, complex)
            return self.place(point), still, still
        return self.place(point), self.vector(f"{point}.", "vx", "vy"), self.vector(f"{point}.", "ax", "ay")

    def angle(self, body: str) -> Samples:
        """Return the angle of a body's x axis, or of the ground's."""
        if body not in self.scene.turning:
            return np.zeros(self.motion["time"].shape)
        return self.motion[f"{body}.angle"]

    def turning(self, body: str) -> tuple[Samples, Samples, Samples]:
        """Return angle, omega and alpha of a body or the ground."""
        if body not in self.scene.turning:
            still = np.zeros(self.motion["time"].shape)
            return still, still, still
        return self.angle(body), self.motion[f"{body}.omega"], self.motion[f"{body}.alpha"]

    def com(self, body: Body) -> tuple[Vectors, Vectors, Vectors]:
        """Return position, velocity and acceleration of the centre of mass; of uniform bodies, the corners' mean."""
        if body.com is None:
            z, v, a = (sum(vectors) / len(body.corners) for vectors in zip(*map(self.point, body.corners), strict=True))
            return z, v, a
        z, v, a = self.point(body.points[0])
        angle, omega, alpha = self.turning(body.name)
        r = np.exp(1j * angle) * (complex(*body.com) - first_point(body))
        return z + r, v + 1j * omega * r, a + (1j * alpha - omega**2) * r

    def frame(self, name: str) -> tuple[Vectors, Vectors]:
        """Return the origin of a body's frame, or of the ground's, and the unit vector of its x axis."""
        x_axis = np.exp(1j * self.angle(name))
        if name == GROUND:
            return np.zeros_like(x_axis), x_axis
        body = self.scene.bodies[name]
        return self.place(body.points[0]) - x_axis * first_point(body), x_axis

    def on_guide(self, body: Body) -> Vectors:
        """Return where a slider's first point is on its guide, from `through`: along it, and i times beside it, m."""
        assert body.slide is not None
        origin, x_axis = self.frame(body.slide.on)
        own = x_axis.conjugate() * (self.place(body.points[0]) - origin)
        return (own - complex(*body.slide.through)) * complex(*body.slide.along).conjugate()

    def displacement(self, body: Body) -> tuple[Samples, Samples, Samples]:
        """Return the displacement of a body that slides on the ground, and its first two derivatives by the time."""
        assert body.slide is not None
        along, through = complex(*body.slide.along), complex(*body.slide.through)
        z, v, a = self.point(body.points[0])
        return ((z - through) * along.conjugate()).real, (v * along.conjugate()).real, (a * along.conjugate()).real

    def applied(self, body: Body) -> Iterator[AppliedForce]:
        """Yield what acts on a body from without: loads, springs, gravity."""
        acting = iter(self.acting)
        for load in self.scene.loads:
            share = next(acting) if isinstance(load, PressForce) else 1.0
            if load.body == body.name:
                z, v, _ = self.point(load.at)
                yield AppliedForce(share * self._force(load), z, v, f"the load at {load.at}")
        for spring in self.scene.springs:
            for (name, point), (_, other) in ((spring.first, spring.second), (spring.second, spring.first)):
                if name == body.name:
                    z, v, _ = self.point(point)
                    towards = self.place(other) - z
                    distance = np.abs(towards)
                    unit = towards / np.where(distance > 0, distance, 1.0)
                    ends = " and ".join(".".join(end) for end in (spring.first, spring.second))
                    pull = spring.stiffness * (distance - spring.length) * unit
                    yield AppliedForce(pull, z, v, f"the spring between {ends}")
        if self.scene.gravity is not None:
            z, v, _ = self.com(body)
            weight = np.full(z.shape, (body.mass or 0.0) * complex(*self.scene.gravity))
            yield AppliedForce(weight, z, v, f"the weight of {body.name}")

    def _force(self, load: Load) -> Vectors:
        if not isinstance(load, ForceTable):
            return np.full(self.motion["time"].shape, complex(*load.force))
        body = self.scene.bodies[load.body]
        assert body.slide is not None
        force: Vectors = load.along(self.displacement(body)[0]) * np.array(complex(*body.slide.along))
        return force

    def joint_forces(self, body: Body) -> Iterator[tuple[Vectors, Vectors]]:
        """Yield every force of a pin, a guide or a slider's drive on the body, with its point of attack."""
        for pin in self.scene.pins:
            if body.name in (pin.first, pin.second):
                force = self.vector(f"{pin.channel}.", "fx", "fy")
                yield (force if body.name == pin.second else -force), self.place(pin.point)
        for sign, slider, slide in self._guides(body):
            normal = np.exp(1j * self.angle(slide.on)) * 1j * complex(*slide.along)
            yield sign * self.motion[f"{slider.name}.guide_force"] * normal, self.place(slider.points[0])
        if body.name == self.scene.drive.body and body.slide is not None:
            yield self.motion["drive.force"] * np.array(complex(*body.slide.along)), self.place(body.points[0])

    def couples(self, body: Body) -> Samples:
        """Return the pure moments on the body, N m."""
        couple = np.zeros(self.motion["time"].shape)
        for sign, slider, _ in self._guides(body):
            couple = couple + sign * self.motion[f"{slider.name}.guide_moment"]
        if body.name == self.scene.drive.body and body.slide is None:
            couple = couple + self.motion["drive.torque"]
        return couple

    def _guides(self, body: Body) -> Iterator[tuple[int, Body, Slide]]:
        """Yield each slider whose guide the body shares: its own with +1, those that slide on the body with -1."""
        for slider in self.scene.bodies.values():
            if slider.slide is not None and body.name in (slider.name, slider.slide.on):
                yield (1 if slider is body else -1), slider, slider.slide


def distances(body: Body) -> dict[tuple[str, str], float]:
    """Return the known distances of a body's points, m: of every two, or those that are given."""
    if body.local is not None:
        return {(p, q): abs(complex(*body.local[p]) - complex(*body.local[q])) for p, q in combinations(body.points, 2)}
    assert body.lengths is not None
    pairs = combinations(body.points, 2)
    return {(p, q): body.lengths[frozenset((p, q))] for p, q in pairs if frozenset((p, q)) in body.lengths}


def inertia(body: Body) -> float:
    """Return the inertia about the com, kg m^2: as given, or of a point, a uniform bar or a triangular plate."""
    if body.inertia is not None:
        return body.inertia
    sides = [length for ends, length in distances(body).items() if {*ends} <= {*body.corners}]
    return (body.mass or 0.0) * sum(side**2 for side in sides) / {1: 1, 2: 12, 3: 36}[len(body.corners)]


def first_point(body: Body) -> complex:
    """Return the body's first point in the body's frame, m."""
    return complex(*body.local[body.points[0]]) if body.local is not None else 0j


def arms(scene: Scene, body: Body) -> dict[str, complex]:
    """Return where a body's points are from its first one, m, in the body's frame.

    A point given by lengths is where the circles about its two bases meet, on the side that the sketch shows.
    """
    if body.local is not None:
        return {point: complex(*place) - first_point(body) for point, place in body.local.items()}
    drawn = {point: complex(*place) for point, place in (*scene.ground.items(), *scene.sketch.points.items())}
    length, (first, second, *others) = distances(body), body.points
    found = {first: 0j, second: complex(length[first, second])}
    for point in others:
        p, q = body.bases(point)
        way, a, b = found[q] - found[p], length[p, point], length[q, point]
        along = (a**2 - b**2 + abs(way) ** 2) / (2 * abs(way))
        side = np.sign(((drawn[q] - drawn[p]).conjugate() * (drawn[point] - drawn[p])).imag)
        found[point] = found[p] + way / abs(way) * (along + 1j * side * max(a**2 - along**2, 0.0) ** 0.5)
    return found
