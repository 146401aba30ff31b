"""What is placed so far, how it moves, and how points, bodies and guides are carried along by what is placed.

A leg of two bodies with the drive between them, a cylinder and its rod, or two bodies that the drive turns, goes from
its outer pin to the inner one by an arm L, in the frame of the body with the outer pin, that the drive changes. As a
vector of the plane that is p = u L, u the attitude of that frame: with a bar's own terms it changes by p (L' / L), and
its rate by p (L'' / L) + 2 i omega p (L' / L).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes import Scene
from scenes.drive import Driven, Samples
from scenes.scene import GROUND

from .decomposition import Guided, Leg, Linkage, Pinned
from .dyads import Vectors, closing, dot, rrr_position, turned
from .geometry import as_complex, guide_of
from .groups.group_equations import FramePoses, GroupEquations
from .numbers import Vector, samples

Plane: TypeAlias = tuple[Vectors, Vectors, Vectors]  # position, velocity, acceleration
Spin: TypeAlias = tuple[Samples, Samples]  # omega, alpha
RRRPosition: TypeAlias = Callable[[Vectors, Samples, float, float, Samples, int], tuple[Vectors, Vectors, Samples]]


class Closure(NamedTuple):
    """How a dyad closes; it is singular where det is zero.

    At an inner pin, g is what a leg moves the pin by per unit of its freedom. RPP: the directions of both guides. RPR:
    the guide's normal, and from the second leg's pin to the first's.
    """

    g1: Vectors
    g2: Vectors
    det: Samples  # g1 x g2


@dataclass(frozen=True)
class Kinematics:
    """Where everything is and how it moves. Arrays of shape (n,), or of shape () for what does not change."""

    drive: Samples  # the rate of the drive, rad/s or m/s
    z: dict[str, Vectors] = field(default_factory=dict)  # points: position, m
    v: dict[str, Vectors] = field(default_factory=dict)  # m/s
    a: dict[str, Vectors] = field(default_factory=dict)  # m/s^2
    u: dict[str, Vectors] = field(default_factory=dict)  # bodies: attitude exp(i angle)
    omega: dict[str, Samples] = field(default_factory=dict)  # rad/s
    alpha: dict[str, Samples] = field(default_factory=dict)  # rad/s^2
    rate: dict[str, Vectors] = field(default_factory=dict)  # i alpha - omega^2
    foot: dict[str, str] = field(default_factory=dict)  # bodies: the point by which they were placed
    closure: dict[str, Closure] = field(default_factory=dict)  # dyads, by inner joint
    jacobian: dict[str, tuple[GroupEquations, FramePoses, Samples]] = field(default_factory=dict)  # larger groups, by P
    reach: dict[str, Samples] = field(default_factory=dict)  # by inner joint: positive where the group can be assembled
    to_lock: dict[str, Samples] = field(default_factory=dict)  # dyads, by inner joint, m

    def direction(self, leg: Guided) -> Vectors:
        """Return the direction of a leg's guide in the plane."""
        return samples(leg.t) if leg.on == GROUND else self.u[leg.on] * leg.t

    def displaced(self, scene: Scene, point: str) -> tuple[Samples, Samples, Samples]:
        """Return a slider's displacement at its point along its guide on the ground from `through`, with its rates."""
        t, through = guide_of(scene, point)
        return dot(t, self.z[point] - through), dot(t, self.v[point]), dot(t, self.a[point])


class Placing:
    """Places one body after the other, at positions of the drive of one shape and precision.

    Without `rates` only positions are found; velocities and accelerations are then zero where they are passed on, and
    absent from the result.
    """

    def __init__(
        self, scene: Scene, linkage: Linkage, driven: Driven, *, rates: bool = True, rrr: RRRPosition = rrr_position
    ) -> None:
        self.scene, self.linkage, self.driven, self.rates, self.rrr_position = scene, linkage, driven, rates, rrr
        self.real, self.complex = driven.position.dtype, np.result_type(driven.position.dtype, np.complex64)
        self.still: Vectors = np.zeros((), self.complex)
        self.changing: dict[Leg, tuple[Vector, Vector]] = {}  # of legs with the drive in them: L' / L and L'' / L
        k = self.k = Kinematics(driven.rate)
        for point, xy in scene.ground.items():
            k.z[point], k.v[point], k.a[point] = self.constant(as_complex(xy)), self.still, self.still
        k.u[GROUND], k.omega[GROUND], k.alpha[GROUND] = self.constant(1), self.still.real, self.still.real

    def constant(self, value: Vector) -> Vectors:
        """Return a vector that is the same at all positions."""
        return samples(value).astype(self.complex)

    def guide_through(self, leg: Guided, P: str) -> Plane:
        """Return where P is, fixed to what the leg slides on, while the leg's displacement is zero."""
        return self.fixed(leg.on, leg.G + (self.linkage.bodies[leg.body].local[P] - leg.F))

    def fixed(self, body: str, local: complex) -> Plane:
        """Return a point fixed to a placed body, or the ground, at a place in its frame."""
        if body == GROUND:
            return self.constant(local), self.still, self.still
        k, foot = self.k, self.k.foot[body]
        r = k.u[body] * (local - self.linkage.bodies[body].local[foot])
        return self.carried(body, (k.z[foot], k.v.get(foot, self.still), k.a.get(foot, self.still)), r)

    def carried(self, body: str, C: Plane, r: Vectors) -> Plane:
        """Return the point fixed to a body that is off another such point by r."""
        if body == GROUND or not self.rates:
            return C[0] + r, C[1], C[2]
        k = self.k
        return C[0] + r, C[1] + 1j * k.omega[body] * r, C[2] + k.rate[body] * r

    def coriolis(self, body: str, slip: Vectors) -> Vectors:
        """Return the acceleration of what slips along a guide that the body turns."""
        return self.still if body == GROUND else 2j * self.k.omega[body] * slip

    def crossing(self, closure: Closure, on_1: str, C1: Plane, on_2: str, C2: Plane) -> Plane:
        """Return the point that runs along two guides through C1 and C2, each fixed to a placed body."""
        t1, t2, _ = closure
        # C1 + s1 t1 = C2 + s2 t2, and the same once and twice differentiated: guides that turn add the rates of their
        # points and Coriolis terms.
        s1, s2 = closing(C2[0] - C1[0], *closure)
        state_1, state_2 = self.carried(on_1, C1, s1 * t1), self.carried(on_2, C2, s2 * t2)
        if not self.rates:
            return state_1
        ds1, ds2 = closing(state_2[1] - state_1[1], *closure)
        a1, a2 = state_1[2] + self.coriolis(on_1, ds1 * t1), state_2[2] + self.coriolis(on_2, ds2 * t2)
        dds1, _ = closing(a2 - a1, *closure)
        return state_1[0], state_1[1] + ds1 * t1, a1 + dds1 * t1

    def place_along(self, body: str, foot: str, on: str) -> None:
        """Carry the body's own points along with its placed point `foot`; it turns with another."""
        self.place(body, foot, self.k.u[on], (self.k.omega[on], self.k.alpha[on]) if self.rates else None)

    def place(self, body: str, foot: str, u: Vectors, spin: Spin | None) -> None:
        """Carry the body's own points along with its placed point `foot`."""
        k, local = self.k, self.linkage.bodies[body].local
        k.u[body], k.foot[body] = u, foot
        if spin is not None:
            k.omega[body], k.alpha[body] = spin
            k.rate[body] = turned(*spin)
        for point in self.linkage.carries[body]:
            if point not in k.z:
                r = u * (local[point] - local[foot])
                k.z[point] = k.z[foot] + r
                if spin is not None:
                    k.v[point] = k.v[foot] + r * (1j * spin[0])
                    k.a[point] = k.a[foot] + r * k.rate[body]

    def bar(self, leg: Pinned, P: str) -> Vector:
        """The arm of a leg from its outer pin to the inner one, m."""
        if leg.via is None:
            local = self.linkage.bodies[leg.body].local
            return local[P] - local[leg.A]
        arm, rate, acceleration = self.arm(leg, P)
        self.changing[leg] = rate / arm, acceleration / arm
        return arm

    def arm(self, leg: Pinned, P: str) -> tuple[Vector, Vector, Vector]:
        """L, L' and L'' of a leg with the drive in it, m."""
        drive, driven = leg.drive, self.driven
        assert drive is not None, "only of a leg with one"
        body, on = drive.body, drive.on
        x, rate, acceleration = driven.position, driven.rate, driven.acceleration
        b, c = self.linkage.bodies[body].local, self.linkage.bodies[on].local
        sign = 1 if leg.body == body else -1
        if (slide := drive.slide) is not None:
            along = as_complex(slide.along)
            way = as_complex(slide.through) - self.linkage.bodies[body].first + along * x
            L = way + b[P] - c[leg.A] if sign > 0 else c[P] - b[leg.A] - way
            return L, sign * along * rate, sign * along * acceleration
        near, far = (c, b) if sign > 0 else (b, c)
        pin = next(point for point in near if point in far)
        swing = np.exp(1j * (sign * x)) * (far[P] - far[pin])
        turning = sign * rate * 1j
        return near[pin] - near[leg.A] + swing, turning * swing, (sign * acceleration * 1j + turning * turning) * swing

    def foot_v(self, leg: Pinned, p: Vectors) -> Vectors:
        """The velocity of the inner pin as the leg has it where it does not turn, m/s."""
        v = self.k.v[leg.A]
        return v if leg not in self.changing else samples(v + p * self.changing[leg][0])

    def foot_a(self, leg: Pinned, p: Vectors, omega: Samples) -> Vectors:
        """Its acceleration but for what a bar of constant length has, m/s^2."""
        a = self.k.a[leg.A]
        if leg not in self.changing:
            return a
        rate, acceleration = self.changing[leg]
        return samples(a + p * (acceleration + 2j * omega * rate))

    def place_bar(self, leg: Pinned, P: str, p: Vectors, u: Vectors, spin: Spin | None) -> None:
        """Place a leg whose arm is p, and whose body with the outer pin has the attitude u."""
        k = self.k
        if leg.via is None:
            self.place(leg.body, leg.A, u, spin)
            return
        self.place(leg.via, leg.A, u, spin)
        if P not in k.z:
            k.z[P] = k.z[leg.A] + p
            if spin is not None:
                k.v[P] = self.foot_v(leg, p) + p * (1j * spin[0])
                k.a[P] = self.foot_a(leg, p, spin[0]) + p * k.rate[leg.via]
        if leg.drive is not None and leg.drive.slide is None:
            sign: Any = 1 if leg.body == leg.drive.body else -1
            u = u * np.exp(1j * (sign * self.driven.position))
            if spin is not None:
                spin = spin[0] + sign * self.driven.rate, spin[1] + sign * self.driven.acceleration
        self.place(leg.body, P, u, spin)
