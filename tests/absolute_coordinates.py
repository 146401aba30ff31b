"""A linkage solved from its scene alone, in redundant coordinates: a second opinion that shares no formula.

A body's coordinates are its frame's origin and the unit vector (c, s) of its x axis. Every point of a body is linear in
them, so that pins are linear equations, and guides, like c^2 + s^2 = 1, quadratic ones: Garcia de Jalon and Bayo,
"Kinematic and Dynamic Simulation of Multibody Systems" (1994), chapter 2. With a constant 1 as the last coordinate,

    C = Q' H Q,    0 = 2 Q' H dQ,    0 = 2 Q' H ddQ + 2 dQ' H dQ,                                                   (1)

but for what the drive asks for, are exact with their derivatives. Reactions and the drive's effort follow from Newton's
and Euler's equations of all bodies, each about its centre of mass, as one linear system.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import hypot, inf, pi

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.scene import GROUND, ConstantSpeed, PressForce

from .absolute_bodies import TURNED, Floats, local_points, sketched
from .absolute_forces import Instant, reactions, twists

ITERATIONS = 100
STEPS = 240  # over a turn, or over the drive's way: from one pose to the next


def solve(
    scene: Scene, position: ArrayLike, rate: ArrayLike, acceleration: ArrayLike, time: ArrayLike | None = None
) -> dict[str, Floats]:
    """Return every channel of the scene but the time, shape (n,), at positions of the drive and its rates there.

    The instants, s, are needed for tables over the time where the drive's speed changes.
    """
    model = Absolute(scene)
    found = [model.channels(now) for now in instants(model, position, rate, acceleration, time)]
    return {name: np.array([row[name] for row in found]) for name in scene.channels.names() if name != "time"}


def instants(
    model: "Absolute", position: ArrayLike, rate: ArrayLike, acceleration: ArrayLike, time: ArrayLike | None = None
) -> Iterator[Instant]:
    """Yield what is known of each instant but its forces."""
    if time is None and isinstance(model.scene.drive.law, ConstantSpeed):
        time = (np.asarray(position) - model.scene.drive.law.start) / model.scene.drive.law.speed
    given = (position, rate, acceleration, np.nan if time is None else time)
    asked = np.stack(np.broadcast_arrays(*map(np.atleast_1d, given)), dtype=float)
    poses = model.poses(asked[0])
    phi = twists(model, poses)
    for here, *rates, at in asked.T.tolist():
        twisted = {spring: of[here] for spring, of in phi.items()}
        yield Instant(poses[here], *model.rates(poses[here], here, *rates), here, at, twisted)


@dataclass(frozen=True)
class Absolute:
    """The equations of one scene; Q has four coordinates a body, x, y, c, s, and a last one that is 1."""

    scene: Scene

    @cached_property
    def forms(self) -> Floats:
        """Return H of every equation, shape (4 bodies, N, N); the drive's is the last."""
        one, forms = np.eye(self.size)[-1], []
        for name in self.scene.bodies:
            u = self.vector(name, (1.0, 0.0))
            forms.append(u.T @ u - np.outer(one, one))
        for pin in self.scene.pins:
            gap = self.point(pin.first, pin.point) - self.point(pin.second, pin.point)
            forms += [np.outer(row, one) for row in gap]
        for slider, body in self.scene.bodies.items():
            if body.slide is not None:
                on = body.slide.on
                off = self.point(slider, body.points[0]) - self.place(on, body.slide.through)
                forms.append((TURNED @ self.vector(on, body.slide.along)).T @ off)
                forms.append((TURNED @ self.vector(on, (1.0, 0.0))).T @ self.vector(slider, (1.0, 0.0)))
        return _symmetric(np.array([*forms, np.zeros((self.size, self.size))]))

    @property
    def size(self) -> int:
        return 4 * len(self.scene.bodies) + 1

    def place(self, body: str, local: ArrayLike) -> Floats:
        """Return the matrix, shape (2, N), that takes Q to the point at a place in a body's frame, or the ground's."""
        matrix = self.vector(body, local)
        if body != GROUND:
            first = 4 * list(self.scene.bodies).index(body)
            matrix[:, first : first + 2] += np.eye(2)
        return matrix

    def vector(self, body: str, local: ArrayLike) -> Floats:
        """Return the matrix that takes Q to a vector that is fixed in a body's frame, or the ground's."""
        matrix: Floats = np.zeros((2, self.size))
        x, y = np.asarray(local, float)
        if body == GROUND:
            matrix[:, -1] = x, y
        else:
            first = 4 * list(self.scene.bodies).index(body)
            matrix[:, first + 2 : first + 4] = (x, -y), (y, x)
        return matrix

    def point(self, body: str, point: str) -> Floats:
        return self.place(body, self.scene.ground[point] if body == GROUND else self.local[body][point])

    def drive(self, position: float) -> tuple[Floats, float]:
        """Return the form and the value of the drive's equation, Q' H Q = value; its rates are the drive's own."""
        name, on = self.scene.drive.body, self.scene.drive.on
        if self.scene.drive.slide is not None:
            return self.displacement(name), position
        square = self.vector(on, (-np.sin(position), np.cos(position)))  # to where the x axis is to be
        return _symmetric(square.T @ self.vector(name, (1.0, 0.0))), 0.0

    def residual(self, Q: Floats, position: float) -> Floats:
        form, value = self.drive(position)
        open_by: Floats = np.einsum("i,kij,j->k", Q, self.forms, Q)
        open_by[-1] = Q @ form @ Q - value
        return open_by

    def jacobian(self, Q: Floats, position: float) -> Floats:
        J: Floats = (2 * self.forms @ Q)[:, :-1]
        J[-1] = (2 * self.drive(position)[0] @ Q)[:-1]
        return J

    def assembled(self) -> Floats:
        """Return Q near the sketch, where all closes."""
        Q = sketched(self.scene, self.local)
        for _ in range(ITERATIONS):
            step = self.correction(Q, self.scene.sketch.drive)
            size = float(np.abs(step.reshape(-1, 4) / (self.span, self.span, 1, 1)).max())
            Q[:-1] -= step / max(1.0, 10 * size)
            if size < 1e-13:
                return Q
        raise AssertionError("does not assemble near the sketch")

    def poses(self, positions: Floats) -> dict[float, Floats]:
        """Return Q by the position of the drive, at those asked for, at its start, and at some between for twists."""
        at, found = self.scene.sketch.drive, dict[float, Floats]()
        stops = np.append(positions, self.scene.drive.law.start)
        if self.scene.torsion_springs:
            stops = np.append(stops, np.arange(stops.min(), stops.max(), self.step))
        Q = self.assembled()
        for stop in np.unique(stops).tolist():
            Q, at = self.follow(Q, at, stop), stop
            found[stop] = Q
        return found

    @property
    def step(self) -> float:
        """The longest way of the drive from one pose to the next."""
        least, most = self.scene.drive.law.extent
        return 2 * pi / STEPS if self.scene.drive.slide is None else (most - least) / STEPS

    def follow(self, Q: Floats, start: float, end: float) -> Floats:
        """Return Q at another position of the drive, by short steps."""
        for position in np.linspace(start, end, 1 + int(np.ceil(abs(end - start) / self.step)))[1:]:
            h, (dQ, ddQ) = position - start, self.rates(Q, start, 1.0, 0.0)
            expected = Q + h * dQ + h**2 / 2 * ddQ
            move, Q, start = np.abs(expected - Q).max(), self.closed(expected, position), position
            assert np.abs(Q - expected).max() < 0.1 * move + 1e-7 * self.span, "lost the branch"
        return self.closed(Q, end)

    def closed(self, Q: Floats, position: float) -> Floats:
        """Return Q with the least corrections that roundings allow."""
        Q, last = Q.copy(), inf
        for _ in range(ITERATIONS):
            step = self.correction(Q, position)
            length = float(np.abs(step).max())
            if not length < last / 2:
                assert last < 1e-7 * max(1.0, self.span), f"does not close, {self.scene.where(position)}"
                return Q
            Q[:-1], last = Q[:-1] - step, length
        raise AssertionError("Newton's method does not end")

    def correction(self, Q: Floats, position: float) -> Floats:
        step: Floats = np.asarray(np.linalg.solve(self.jacobian(Q, position), self.residual(Q, position)), float)
        return step

    def rates(self, Q: Floats, position: float, rate: float, acceleration: float) -> tuple[Floats, Floats]:
        """Return Q' and Q''."""
        J, driven = self.jacobian(Q, position), np.zeros(len(self.forms))
        driven[-1] = rate
        dQ = np.append(np.linalg.solve(J, driven), 0.0)
        right = -2 * np.einsum("i,kij,j->k", dQ, self.forms, dQ)
        right[-1] = acceleration - 2 * dQ @ self.drive(position)[0] @ dQ
        return dQ, np.append(np.linalg.solve(J, right), 0.0)

    @cached_property
    def local(self) -> Mapping[str, Mapping[str, Floats]]:
        """Return the points of each body in its own frame."""
        return {name: local_points(self.scene, body) for name, body in self.scene.bodies.items()}

    @cached_property
    def span(self) -> float:
        """Return how far points are from their frames' origins, m."""
        return max(hypot(*xy) for local in self.local.values() for xy in local.values()) or 1.0

    def channels(self, now: Instant) -> dict[str, float]:
        """Return every channel but the time."""
        scene, motion = self.scene, (now.Q, now.dQ, now.ddQ)
        found = {scene.channels.drive.position: now.position}
        for point in scene.moving_points:
            matrix = self.point(scene.owners[point][0], point)
            for prefix, of in zip(("", "v", "a"), motion, strict=True):
                found[f"{point}.{prefix}x"], found[f"{point}.{prefix}y"] = matrix @ of
        for name in scene.turning:
            angle, omega, alpha = self.turning(name, *motion)
            found |= {f"{name}.angle": angle, f"{name}.omega": omega, f"{name}.alpha": alpha}
        return found | (reactions(self, now) if scene.has_masses else {})

    def turning(self, name: str, Q: Floats, dQ: Floats, ddQ: Floats) -> tuple[float, float, float]:
        matrix = self.vector(name, (1.0, 0.0))
        u, du, ddu = matrix @ Q, matrix @ dQ, matrix @ ddQ
        normal = TURNED @ u
        return float(np.arctan2(u[1], u[0])), float(normal @ du), float(normal @ ddu)

    def displacement(self, name: str) -> Floats:
        """Return the form of the displacement of a body that slides."""
        body = self.scene.bodies[name]
        assert body.slide is not None
        off = self.point(name, body.points[0]) - self.place(body.slide.on, body.slide.through)
        return _symmetric(self.vector(body.slide.on, body.slide.along).T @ off)

    def displaced(self, name: str, Q: Floats, *rates: Floats) -> list[float]:
        """Return a displacement, m, and its derivative, and the second one of a body that slides on the ground."""
        form = self.displacement(name)
        return [float(Q @ form @ Q), *(float(2 * Q @ form @ rate) for rate in rates)]

    @cached_property
    def stroke_ends(self) -> dict[PressForce, float]:
        """Return the furthest displacement of each pressed slider in its closing direction, over one cycle."""
        presses = [load for load in self.scene.loads if isinstance(load, PressForce)]
        ends = dict.fromkeys(presses, -inf)
        if presses:
            Q, before = self.assembled(), self.scene.sketch.drive
            for position in np.linspace(*self.scene.drive.law.extent, STEPS):
                Q, before = self.follow(Q, before, position), position
                for load in presses:
                    ends[load] = max(ends[load], load.closing * self._peak(load, Q, position))
        return {load: load.closing * end for load, end in ends.items()}

    def _peak(self, load: PressForce, Q: Floats, position: float) -> float:
        """Return the displacement at the dead point next to a position, or there if there is none within a step."""
        least, most = self.scene.drive.law.extent
        (best,), here = self.displaced(load.body, Q), position
        for _ in range(8):
            _, slope, bend = self.displaced(load.body, Q, *self.rates(Q, here, 1.0, 0.0))
            if not abs(slope) < abs(bend) * (most - least) / STEPS:
                return best
            step = -slope / bend
            if not least <= here + step <= most:
                return best
            Q, here = self.follow(Q, here, here + step), here + step
        return self.displaced(load.body, Q)[0]


def _symmetric(forms: Floats) -> Floats:
    halves: Floats = (forms + np.swapaxes(forms, -1, -2)) / 2
    return halves
