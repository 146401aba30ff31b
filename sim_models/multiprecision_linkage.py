"""A planar linkage in absolute coordinates, in arbitrary-precision ball arithmetic.

The coordinates are q = (x, y, θ) of every body's centre of mass and x axis. A point of a body is r + e^{iθ} s, so every
pin, slide, drive, observed point and load of a planar linkage is a row of one form, linear but for the angles:

    f(q) = C q + U cos θ - V sin θ                                       (1)

Its Jacobian and its second derivative along a motion q(t) follow without further geometry:

    J = df/dq = C - (U diag(sin θ) + V diag(cos θ)) S,   θ = S q         (2)
    f'' = J q'' - (U diag(cos θ) - V diag(sin θ)) θ'^2                   (3)

Needs python-flint; every function works at the precision that the caller has set in `flint.ctx`. Balls keep the
rounding of the geometry, so a result's radius bounds its error.
"""

from itertools import combinations
from typing import TypeAlias

import numpy as np
from flint import arb, arb_mat

from scenes import Failure, Scene, Status
from scenes.scene import GROUND, Body

Point: TypeAlias = tuple[arb, arb]

FLAT = 1e-9  # rad; a sketched triangle flatter than this shows rounding, not a side


class Rows:
    """Rows of the form (1) over the coordinates of `bodies` bodies; zero until terms are added."""

    def __init__(self, count: int, bodies: int) -> None:
        self.C = arb_mat(count, 3 * bodies)
        self.U = arb_mat(count, bodies)
        self.V = arb_mat(count, bodies)
        self.S = arb_mat(bodies, 3 * bodies)
        for i in range(bodies):
            self.S[i, 3 * i + 2] = arb(1)

    def add_angle(self, row: int, body: int) -> None:
        """Add a body's angle θ to a row."""
        self.C[row, 3 * body + 2] += 1

    def add_point(self, row: int, weight: Point, body: int, arm: Point) -> None:
        """Add the projection w·p of a body's point p = r + e^{iθ} s to a row, s being the `arm` in the body's frame."""
        (wx, wy), (x, y) = weight, arm
        self.C[row, 3 * body] += wx
        self.C[row, 3 * body + 1] += wy
        self.U[row, body] += wx * x + wy * y
        self.V[row, body] += wx * y - wy * x

    def value(self, q: arb_mat) -> arb_mat:
        """Return f(q) of (1), shape (rows, 1)."""
        sin, cos = _sin_cos(q)
        return self.C * q + self.U * _column(cos) - self.V * _column(sin)

    def angle_jacobian(self, q: arb_mat) -> arb_mat:
        """Return the part of J that varies, as columns for the angles alone, shape (rows, bodies)."""
        sin, cos = _sin_cos(q)
        return -(self.U * _diagonal(sin) + self.V * _diagonal(cos))

    def jacobian(self, q: arb_mat) -> arb_mat:
        """Return J of (2), shape (rows, 3 bodies)."""
        return self.C + self.angle_jacobian(q) * self.S

    def centripetal(self, q: arb_mat, rate: arb_mat) -> arb_mat:
        """Return (U diag(cos θ) - V diag(sin θ)) θ'^2 of (3) for q' = `rate`, shape (rows, 1)."""
        sin, cos = _sin_cos(q)
        turning = [w * w for w in angles(rate)]
        return self.U * _column([c * w for c, w in zip(cos, turning, strict=True)]) - self.V * _column(
            [s * w for s, w in zip(sin, turning, strict=True)]
        )


class Linkage:
    """The equations of one scene: `constraints`, observed `points`, the `work` of constant forces, the masses.

    The constraint rows are in the order of the scene's force channels, and a multiplier is that channel: a pin's rows
    are second - first, so λ is the force of the first body on the second; a slide's are the offset of its first point
    along the guide's normal, and its angle; the last is the angle of the driven body.
    """

    def __init__(self, scene: Scene) -> None:
        """Set up the equations.

        Raises:
            Failure: the sketch does not show on which side a triangle's third point lies.
        """
        self.scene = scene
        self.index = {name: i for i, name in enumerate(scene.bodies)}
        self._crank = 3 * self.index[scene.drive.body] + 2
        self.arms, self.mass = {}, arb_mat(3 * len(self.index), 3 * len(self.index))
        for name, i in self.index.items():
            body = scene.bodies[name]
            local = _local_points(scene, body)
            com = _centre_of_mass(body, local)
            self.arms[name] = {point: (x - com[0], y - com[1]) for point, (x, y) in local.items()}
            mass = 1.0 if body.mass is None else body.mass
            for k, m in enumerate((arb(mass), arb(mass), _inertia(body, mass, local))):
                self.mass[3 * i + k, 3 * i + k] = m
        self.constraints, self._fixed = self._constraints()
        self.points = self._points()
        self.work = self._work()

    def goal(self, crank_angle: float) -> arb_mat:
        """Return what the constraints f(q) have to be at a crank angle, shape (rows, 1)."""
        goal = arb_mat(self._fixed)
        goal[goal.nrows() - 1, 0] = arb(crank_angle)
        return goal

    def drive_rate(self, speed: float) -> arb_mat:
        """Return the time derivative of `goal`, shape (rows, 1)."""
        rate = arb_mat(self._fixed.nrows(), 1)
        rate[rate.nrows() - 1, 0] = arb(speed)
        return rate

    def crank_angle(self, q: arb_mat) -> arb:
        """Return the angle of the driven body."""
        return q[self._crank, 0]

    def sketched_pose(self, crank_angle: float) -> arb_mat:
        """Return the pose where each body fits the sketch best, shape (3 bodies, 1); the driven one at a given angle.

        The turn that carries points s onto points z with the least squares is arg Σ z conj(s), both about their means.
        """
        scene = self.scene
        known = {name: complex(*at) for name, at in (dict(scene.ground) | dict(scene.sketch.points)).items()}
        q = arb_mat(3 * len(self.index), 1)
        for name, i in self.index.items():
            arms = {point: complex(float(x), float(y)) for point, (x, y) in self.arms[name].items() if point in known}
            s = np.array(list(arms.values()))
            z = np.array([known[point] for point in arms])
            if name == scene.drive.body:
                angle = crank_angle
            elif scene.bodies[name].slide is not None:
                angle = 0.0
            else:
                angle = float(np.angle(np.sum((z - z.mean()) * np.conj(s - s.mean()))))
            r = z.mean() - np.exp(1j * angle) * s.mean()
            q[3 * i, 0], q[3 * i + 1, 0], q[3 * i + 2, 0] = arb(r.real), arb(r.imag), arb(angle)
        return q

    def _constraints(self) -> tuple[Rows, arb_mat]:
        """Return the constraint rows and the values that the ground gives them."""
        scene = self.scene
        slides = [(body, body.slide) for body in scene.bodies.values() if body.slide is not None]
        count = 2 * len(scene.pins) + 2 * len(slides) + 1
        rows, fixed = Rows(count, len(self.index)), arb_mat(count, 1)
        for k, pin in enumerate(scene.pins):
            for row, axis in ((2 * k, 0), (2 * k + 1, 1)):
                rows.add_point(row, _unit(axis), self.index[pin.second], self.arms[pin.second][pin.point])
                if pin.first == GROUND:
                    fixed[row, 0] = arb(scene.ground[pin.point][axis])
                else:
                    rows.add_point(row, _unit(axis, -1), self.index[pin.first], self.arms[pin.first][pin.point])
        for k, (body, slide) in enumerate(slides):
            row = 2 * len(scene.pins) + 2 * k
            normal = -arb(slide.along[1]), arb(slide.along[0])
            rows.add_point(row, normal, self.index[body.name], self.arms[body.name][body.points[0]])
            fixed[row, 0] = normal[0] * slide.through[0] + normal[1] * slide.through[1]
            rows.add_angle(row + 1, self.index[body.name])
        rows.add_angle(count - 1, self.index[scene.drive.body])
        return rows, fixed

    def _points(self) -> Rows:
        """Return x and y of every moving point, two rows a point, as its first body carries it."""
        points = self.scene.moving_points
        rows = Rows(2 * len(points), len(self.index))
        for k, point in enumerate(points):
            owner = self.scene.owners[point][0]
            for axis in (0, 1):
                rows.add_point(2 * k + axis, _unit(axis), self.index[owner], self.arms[owner][point])
        return rows

    def _work(self) -> Rows:
        """Return the work Σ F·p + Σ m g·r of the loads and the weight; its Jacobian is the generalised force Q^T."""
        scene = self.scene
        rows = Rows(1, len(self.index))
        for load in scene.loads:
            force = arb(load.force[0]), arb(load.force[1])
            rows.add_point(0, force, self.index[load.body], self.arms[load.body][load.at])
        if scene.gravity is not None:
            for i in self.index.values():
                m = self.mass[3 * i, 3 * i]
                rows.add_point(0, (m * scene.gravity[0], m * scene.gravity[1]), i, (arb(0), arb(0)))
        return rows


# --- body geometry ---------------------------------------------------------------------------------------------------


def _local_points(scene: Scene, body: Body) -> dict[str, Point]:
    """Return the points in the body's own frame; a triangle from its sides by the law of cosines."""
    if body.local is not None:
        return {point: (arb(x), arb(y)) for point, (x, y) in body.local.items()}
    assert body.lengths is not None
    length = {pair: arb(value) for pair, value in body.lengths.items()}
    A, B = body.points[:2]
    c = length[frozenset((A, B))]
    local = {A: (arb(0), arb(0)), B: (c, arb(0))}
    if len(body.points) == 3:
        C = body.points[2]
        a, b = length[frozenset((B, C))], length[frozenset((A, C))]
        x = (b * b + c * c - a * a) / (2 * c)
        local[C] = x, _sketched_side(scene, body) * (b * b - x * x).sqrt()
    return local


def _sketched_side(scene: Scene, body: Body) -> int:
    """Return +1 where the sketch shows a body's third point to the left of the way from its first to its second."""
    known = dict(scene.ground) | dict(scene.sketch.points)
    A, B, C = (complex(*known[point]) for point in body.points)
    sine = ((B - A).conjugate() * (C - A)).imag / abs(B - A) / abs(C - A)
    if not abs(sine) > FLAT:
        points = ", ".join(body.points)
        raise Failure(Status.cannot_assemble, f"the sketch shows {points} of '{body.name}' on one line, on no side")
    return 1 if sine > 0 else -1


def _centre_of_mass(body: Body, local: dict[str, Point]) -> Point:
    """Return the centre of mass; that of a point, a uniform bar or a uniform triangle is the mean of its points."""
    if body.com is not None:
        return arb(body.com[0]), arb(body.com[1])
    x, y = zip(*local.values(), strict=True)
    return sum(x, arb(0)) / len(x), sum(y, arb(0)) / len(y)


def _inertia(body: Body, mass: float, local: dict[str, Point]) -> arb:
    """Return the inertia about the centre of mass: m l^2/12 for a bar, m (a^2 + b^2 + c^2)/36 for a triangle."""
    if body.inertia is not None:
        return arb(body.inertia)
    sides = [(x - u) ** 2 + (y - v) ** 2 for (x, y), (u, v) in combinations(local.values(), 2)]
    return arb(mass) * sum(sides, arb(0)) / (12 if len(local) == 2 else 36)


# --- columns and diagonals -------------------------------------------------------------------------------------------


def angles(q: arb_mat) -> list[arb]:
    """Return the angle, or its derivative, of every body."""
    return [q[k, 0] for k in range(2, q.nrows(), 3)]


def _sin_cos(q: arb_mat) -> tuple[list[arb], list[arb]]:
    sin, cos = zip(*(angle.sin_cos() for angle in angles(q)), strict=True)
    return list(sin), list(cos)


def _column(entries: list[arb]) -> arb_mat:
    return arb_mat(len(entries), 1, entries)


def _diagonal(entries: list[arb]) -> arb_mat:
    matrix = arb_mat(len(entries), len(entries))
    for i, entry in enumerate(entries):
        matrix[i, i] = entry
    return matrix


def _unit(axis: int, sign: int = 1) -> Point:
    return (arb(sign), arb(0)) if axis == 0 else (arb(0), arb(sign))
